//! The controls and poses of the shipped bodies.

/// What a shipped body is posed with.
#[derive(Debug, Clone, Copy)]
pub struct ShippedBody {
    /// The figure's name, which is also that of `assets/rigs/NAME.glb`.
    pub name: &'static str,
    /// `assets/rigs/NAME.controls.ron`.
    pub controls: &'static str,
    /// `assets/poses/NAME.ron`.
    pub poses: &'static str,
    /// How many key meshes of this kind of body the paper has.
    pub paper_meshes: usize,
}

/// The shipped bodies.
pub const SHIPPED: [ShippedBody; 2] = [
    ShippedBody {
        name: "human",
        controls: include_str!("../../../../assets/rigs/human.controls.ron"),
        poses: include_str!("../../../../assets/poses/human.ron"),
        paper_meshes: 72,
    },
    ShippedBody {
        name: "horse",
        controls: include_str!("../../../../assets/rigs/horse.controls.ron"),
        poses: include_str!("../../../../assets/poses/horse.ron"),
        paper_meshes: 8,
    },
];

impl ShippedBody {
    /// The shipped body called `name`.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        SHIPPED.into_iter().find(|body| body.name == name)
    }
}
