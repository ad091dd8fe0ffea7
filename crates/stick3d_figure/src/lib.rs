//! What a figure is and what a drawing of it says: figures, strokes, sketches, recognition, meshes.
