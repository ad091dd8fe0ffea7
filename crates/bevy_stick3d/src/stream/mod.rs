//! From latents to bodies: what a figure's own mesh is, and when it is written.

mod cpu;
mod sight;

use bevy::asset::RenderAssetUsages;
use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::{NoAutoAabb, VisibilityPlugin};
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use stick3d_model::Model;

use crate::animation::ClipPlayback;
use crate::figure::{FigureStatus, Grounded, Latent, StickFigure};
use crate::inference::{ReadyModel, StickInference};
use crate::model_asset::StickModel;
use crate::schedule::Stick3dSystems;

use cpu::BodyBounds;
pub use cpu::StreamError;
use sight::{Sight, SightIsChecked};

/// The body of a figure, as the plugin keeps it. Written by the plugin.
///
/// The mesh belongs to this entity alone; it is in its `Mesh3d` too, and is freed with it.
#[derive(Component, Clone, Debug, Default, Reflect)]
#[reflect(Component, Debug, Default, Clone)]
pub struct StreamedBody {
    mesh: Option<Handle<Mesh>>,
    model: Option<AssetId<StickModel>>,
    generation: u64,
    failed: bool,
    /// Whether it was out of sight when it last had to be decoded.
    stale: bool,
    /// How high the lowest vertex is while grounded, metres.
    lift_m: f32,
    root_height_m: f32,
}

impl StreamedBody {
    /// The mesh, once there is one.
    pub fn mesh(&self) -> Option<&Handle<Mesh>> {
        self.mesh.as_ref()
    }

    /// Of which model the mesh is; `None` before the first.
    pub fn model(&self) -> Option<AssetId<StickModel>> {
        self.model
    }

    /// Which ready model made the mesh; 0 before the first.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// Whether the mesh is older than the latent, as the figure was out of sight; see
    /// [`DecodeOutOfSight`](crate::animation::DecodeOutOfSight).
    pub fn is_stale(&self) -> bool {
        self.stale
    }

    /// How high the figure's root joint is above the entity's origin, metres; 0 unless the figure is
    /// [grounded](Grounded).
    pub fn root_height_m(&self) -> f32 {
        self.root_height_m
    }

    /// Whether the last latent could not be decoded.
    pub(crate) fn has_failed(&self) -> bool {
        self.failed
    }
}

/// Decodes changed latents into meshes, on the CPU.
#[derive(Debug, Default, Clone, Copy)]
pub struct Stick3dStreamPlugin;

impl Plugin for Stick3dStreamPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<StreamedBody>()
            .register_type::<Grounded>()
            .add_systems(PostUpdate, stream_bodies.in_set(Stick3dSystems::Decode));
    }

    fn finish(&self, app: &mut App) {
        // An app without a renderer has no meshes of its own accord.
        if !app.world().contains_resource::<Assets<Mesh>>() {
            app.init_asset::<Mesh>();
        }
        if app.is_plugin_added::<VisibilityPlugin>() {
            app.init_resource::<SightIsChecked>();
        }
    }
}

/// Changed latents become vertices; a figure without a mesh for its model gets one.
fn stream_bodies(
    mut commands: Commands,
    mut figures: Query<(
        Entity,
        &StickFigure,
        Ref<Latent>,
        Ref<Grounded>,
        Option<&ClipPlayback>,
        &mut StreamedBody,
        &mut FigureStatus,
        Option<&mut Aabb>,
        Sight,
    )>,
    mut inference: ResMut<StickInference>,
    mut meshes: ResMut<Assets<Mesh>>,
    sight_is_checked: Option<Res<SightIsChecked>>,
) {
    for (entity, figure, latent, grounded, playback, mut body, mut status, aabb, sight) in
        &mut figures
    {
        let Some(ready) = inference.get_mut(&figure.0) else {
            continue;
        };
        let other_model = body.generation != ready.generation;
        let lift_m = playback.map_or(0.0, |playback| playback.lift_m);
        let changed = latent.is_changed() || grounded.is_changed() || body.lift_m != lift_m;
        if !(other_model || changed || body.stale) {
            continue;
        }
        let is_new = other_model || body.mesh.is_none();
        if !is_new && sight_is_checked.is_some() && sight.is_out() {
            if !body.stale {
                body.stale = true;
                if let Some(mut aabb) = aabb {
                    *aabb = sight::any_pose(&aabb);
                }
            }
            continue;
        }
        body.stale = false;
        body.lift_m = lift_m;
        if is_new {
            let mesh = meshes.add(empty_mesh(ready.model.model()));
            commands
                .entity(entity)
                .insert((Mesh3d(mesh.clone()), NoAutoAabb));
            body.mesh = Some(mesh);
            body.model = Some(figure.0.id());
            body.generation = ready.generation;
        }
        let shown = body
            .mesh
            .as_ref()
            .and_then(|handle| meshes.get_mut(handle))
            .ok_or(StreamError::MeshGone)
            .and_then(|mesh| show(ready, &latent, grounded.0.then_some(lift_m), mesh));
        match shown {
            Ok(bounds) => {
                body.root_height_m = bounds.root_height_m;
                let bounds = Aabb::from_min_max(bounds.low, bounds.high);
                match aabb {
                    Some(mut aabb) => *aabb = bounds,
                    None => {
                        commands.entity(entity).insert(bounds);
                    }
                }
                if body.failed || *status == FigureStatus::Waiting {
                    status.set_if_neq(FigureStatus::Ready);
                }
                body.failed = false;
            }
            Err(error) => {
                body.failed = true;
                status.set_if_neq(FigureStatus::Failed(error.to_string()));
            }
        }
    }
}

/// Decodes into the mesh, which counts as changed only if the latent is fit to be decoded.
fn show(
    ready: &mut ReadyModel,
    latent: &Latent,
    lowest_m: Option<f32>,
    mut mesh: bevy::asset::AssetMut<Mesh>,
) -> Result<BodyBounds, StreamError> {
    cpu::check(&latent.0, ready.inference.latent_len())?;
    cpu::write_body(&mut ready.inference, &latent.0, lowest_m, &mut mesh)
}

/// A mesh of the model's topology and colours, all vertices at the origin.
fn empty_mesh(model: &Model) -> Mesh {
    let vertex_count = model.vertex_count();
    let indices = model.triangles().as_flattened().to_vec();
    let colors: Vec<[f32; 4]> = model
        .colors()
        .iter()
        .map(|color| color.map(|channel| f32::from(channel) / 255.0))
        .collect();
    // Meshes that live in the render world alone are not uploaded again when they change.
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, vec![[0.0_f32; 3]; vertex_count])
    .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0_f32; 3]; vertex_count])
    .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colors)
    .with_inserted_indices(Indices::U32(indices))
}
