//! Damaged and foreign model files.
