//! Rigs, poses, data sets, training, evaluation and baking for stick3d.
