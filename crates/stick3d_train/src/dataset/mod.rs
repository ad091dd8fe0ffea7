//! Training pairs: posed bodies and the sketches of them.
