//! The trained model of the horse, embedded: nothing but its bytes, and what its figure is called.

/// The name of the figure, as sketch files have it.
pub const FIGURE: &str = "horse";

/// The bytes of `assets/models/horse.stick3d`, for `stick3d_model::Model::from_bytes`.
pub const MODEL: &[u8] = include_bytes!("../../../assets/models/horse.stick3d");
