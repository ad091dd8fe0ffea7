//! The networks, the model file and the frame-rate decoder of stick3d.
