//! Poses: controls, libraries and the sampler.
