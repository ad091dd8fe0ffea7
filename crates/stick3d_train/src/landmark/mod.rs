//! Finding a figure's joints on a mesh that has no rig: by the shape of its surface.
//!
//! A *preset* is a known kind of body. Its limbs end where the surface sticks out farthest; which end is which follows from
//! the distances between them along the surface, which hardly change when a body moves. Joints are rings around limbs
//! and trunk at known shares of these distances. What a figure file gets is lists of vertices, so that the joints are
//! found in every registered mesh alike. No axis, unit or heading is assumed.

mod biped;
mod limbs;
mod quadruped;
mod surface;

use glam::{Mat3, Vec2, Vec3};
use stick3d_figure::figure::{Anchor, Figure, FigureError};
use stick3d_figure::mesh::TriangleMesh;
use thiserror::Error;

use surface::{Ring, Surface};

/// A kind of body whose joints are known where to look for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Preset {
    /// A person, as in the SCAPE set: the joints and the path of the human.
    Scape,
    /// A horse, as in the TOSCA set: the joints and the path of the horse.
    ToscaHorse,
}

/// Why joints were not found.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LandmarkError {
    /// The mesh is not one surface.
    #[error(
        "the mesh has no piece of surface that limbs could stick out of; is it one closed body?"
    )]
    Pieces,
    /// The body has too few of them.
    #[error(
        "only {found} limbs stick out of the mesh, {needed} are needed (head and tail counted); is it the right preset?"
    )]
    Limbs {
        /// How many there are.
        found: usize,
        /// How many the preset has.
        needed: usize,
    },
    /// The ends of limbs do not come in pairs.
    #[error(
        "the {tips} points that stick out farthest are no two pairs of limbs (their distances differ by {percent:.0} %); take another mesh of the set as pilot, one that stands"
    )]
    Asymmetric {
        /// How many ends were looked for.
        tips: usize,
        /// How far the two sides differ, per cent of the longest distance.
        percent: f32,
    },
    /// There is no ring where a joint should be.
    #[error(
        "joint `{joint}` is not found: the surface has no ring there; take another mesh as pilot"
    )]
    NoRing {
        /// The joint.
        joint: &'static str,
    },
    /// The figure that came out is not sound.
    #[error(transparent)]
    Figure(#[from] FigureError),
}

impl Preset {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Scape, Self::ToscaHorse];

    /// What it is called: `scape`, `tosca-horse`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Scape => "scape",
            Self::ToscaHorse => "tosca-horse",
        }
    }

    /// The figure with its joints as vertices of `pilot`, and its template as the pilot stands, as large as the shipped
    /// figure of its kind.
    ///
    /// # Errors
    /// [`LandmarkError`].
    pub fn figure(self, pilot: &TriangleMesh) -> Result<Figure, LandmarkError> {
        let surface = Surface::new(pilot);
        let (like, found) = match self {
            Self::Scape => (Figure::human(), biped::joints(&surface)?),
            Self::ToscaHorse => (Figure::horse(), quadruped::joints(&surface)?),
        };
        let mut figure = like.clone();
        self.name().clone_into(&mut figure.name);
        for (joint, vertices) in found.joints {
            let index = figure.joint_index(joint)?;
            figure.joints[index].anchor = Anchor::Vertices(vertices);
        }
        figure.template = template(&figure, pilot, found.axes);
        // What the file's reader checks holds of what is written, too.
        Ok(Figure::from_ron(&figure.to_ron()?)?)
    }
}

/// Joints of a body, and which way it stands.
#[derive(Debug)]
struct Found {
    joints: Vec<(&'static str, Vec<u32>)>,
    /// Columns: what is right, up and toward the viewer in the figure's template.
    axes: Mat3,
}

/// The end of a limb.
#[derive(Debug)]
struct Tip {
    vertex: u32,
    /// Of every vertex from it, along the surface.
    distances: Vec<f32>,
}

/// The longest ring at a level.
fn longest(
    surface: &Surface<'_>,
    field: &[f32],
    level: f32,
    joint: &'static str,
) -> Result<Ring, LandmarkError> {
    let ring = surface.rings(field, level).into_iter().next();
    ring.filter(|ring| ring.vertices.len() > 3)
        .ok_or(LandmarkError::NoRing { joint })
}

/// The vertices among `candidates` nearest to where a ray from `middle` leaves the surface, nearest first.
pub(crate) fn facing(
    positions: &[Vec3],
    candidates: impl IntoIterator<Item = u32>,
    middle: Vec3,
    toward: Vec3,
) -> Vec<u32> {
    const VERTICES: usize = 12;
    let mut near: Vec<(f32, u32)> = candidates
        .into_iter()
        .map(|vertex| {
            let from_middle = positions[vertex as usize] - middle;
            (from_middle.angle_between(toward), vertex)
        })
        .collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    near.into_iter().take(VERTICES).map(|(_, v)| v).collect()
}

/// The vertices where a field is below `level` and a ray from `middle` leaves the surface, sorted.
fn facing_below(
    surface: &Surface<'_>,
    field: &[f32],
    level: f32,
    middle: Vec3,
    toward: Vec3,
) -> Vec<u32> {
    let below = (0_u32..)
        .zip(field)
        .filter(|(_, value)| **value < level)
        .map(|(vertex, _)| vertex);
    let mut vertices = facing(&surface.mesh.positions, below, middle, toward);
    vertices.sort_unstable();
    vertices
}

/// For every vertex the smaller of two values.
fn lower(a: &[f32], b: &[f32]) -> Vec<f32> {
    a.iter().zip(b).map(|(a, b)| a.min(*b)).collect()
}

/// The joints of the pilot on the sketch plane: as large and as high as the template was that the figure came with.
fn template(figure: &Figure, pilot: &TriangleMesh, axes: Mat3) -> Vec<Vec2> {
    let mean = |anchor: &Anchor| match anchor {
        Anchor::Vertices(vertices) => {
            let sum: Vec3 = vertices.iter().map(|v| pilot.positions[*v as usize]).sum();
            axes.transpose() * (sum / vertices.len().max(1) as f32)
        }
        Anchor::Bones(_) => Vec3::ZERO,
    };
    let flat: Vec<Vec2> = figure
        .joints
        .iter()
        .map(|j| mean(&j.anchor).truncate())
        .collect();
    let bounds = |points: &[Vec2]| {
        let low = points.iter().copied().fold(Vec2::MAX, Vec2::min);
        (low, points.iter().copied().fold(Vec2::MIN, Vec2::max) - low)
    };
    let ((low, size), (like_low, like_size)) = (bounds(&flat), bounds(&figure.template));
    let scale = like_size.y / size.y.max(f32::MIN_POSITIVE);
    // Middle over middle, feet as high.
    let (from, to) = (
        low + Vec2::new(size.x / 2.0, 0.0),
        like_low + Vec2::new(like_size.x / 2.0, 0.0),
    );
    let place = |p: &Vec2| to + scale * (*p - from);
    // A tenth of a millimetre is enough for a file that people read.
    flat.iter()
        .map(place)
        .map(|p| (1e4 * p).round() / 1e4)
        .collect()
}

#[cfg(test)]
mod tests;
