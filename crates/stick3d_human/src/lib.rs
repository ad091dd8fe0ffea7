//! The trained model of the human, embedded: nothing but its bytes, and what its figure is called.

/// The name of the figure, as sketch files have it.
pub const FIGURE: &str = "human";

/// The bytes of `assets/models/human.stick3d`, for `stick3d_model::Model::from_bytes`.
pub const MODEL: &[u8] = include_bytes!("../../../assets/models/human.stick3d");
