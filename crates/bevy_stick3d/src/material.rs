//! The default clothes: a material that shows the colours of the model.

use bevy::prelude::*;

use crate::schedule::Stick3dSystems;
use crate::stream::StreamedBody;

/// Keeps the default material off a figure that brings a material of another type.
///
/// A figure with a `MeshMaterial3d<StandardMaterial>` of its own needs no such mark.
#[derive(Component, Clone, Copy, Debug, Default, Reflect)]
#[reflect(Component, Debug, Default, Clone)]
pub struct OwnMaterial;

/// The material of all figures that were given none: matt, in the vertex colours of the model.
#[derive(Resource, Clone, Debug, Default, Reflect)]
#[reflect(Resource, Debug, Default, Clone)]
pub struct DefaultFigureMaterial(pub Option<Handle<StandardMaterial>>);

/// Gives figures without a material the [`DefaultFigureMaterial`].
#[derive(Debug, Default, Clone, Copy)]
pub struct Stick3dMaterialPlugin;

impl Plugin for Stick3dMaterialPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<DefaultFigureMaterial>()
            .register_type::<DefaultFigureMaterial>()
            .register_type::<OwnMaterial>()
            .add_systems(
                PostUpdate,
                dress_bodies
                    .in_set(Stick3dSystems::Dress)
                    // An app without a renderer has no materials, and needs none.
                    .run_if(resource_exists::<Assets<StandardMaterial>>),
            );
    }
}

fn dress_bodies(
    mut commands: Commands,
    bare: Query<
        Entity,
        (
            With<StreamedBody>,
            With<Mesh3d>,
            Without<MeshMaterial3d<StandardMaterial>>,
            Without<OwnMaterial>,
        ),
    >,
    mut default: ResMut<DefaultFigureMaterial>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    for entity in &bare {
        let material = default
            .0
            .get_or_insert_with(|| materials.add(figure_material()))
            .clone();
        commands.entity(entity).insert(MeshMaterial3d(material));
    }
}

/// Cloth and skin rather than plastic.
pub(crate) fn figure_material() -> StandardMaterial {
    StandardMaterial {
        base_color: Color::WHITE,
        perceptual_roughness: 0.72,
        reflectance: 0.35,
        ..default()
    }
}
