//! The 3D view: its camera, the image it renders to, and the figure in it.

use bevy::camera::RenderTarget;
use bevy::camera::primitives::Aabb;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::light::ShadowFilteringMethod;
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureFormat};
use bevy::render::view::Msaa;
use bevy_egui::{EguiTextureHandle, EguiUserTextures, egui};

use super::orbit::{FOV_Y_RAD, Framing, Orbit, camera_transform};
use super::{EditorClock, stage};
use crate::figure::StickFigure;
use crate::material::figure_material;
use crate::sketch_input::SketchPreview;
use crate::stream::StreamedBody;

/// The 3D view.
#[derive(Resource)]
pub(super) struct View {
    /// What the 3D camera renders to and egui shows.
    pub(super) image: Handle<Image>,
    /// The same, as egui knows it.
    pub(super) texture: egui::TextureId,
    /// Where the user looks from.
    pub(super) orbit: Orbit,
    framing: Framing,
    size_px: UVec2,
}

impl View {
    /// Asks for an image of this size from the next frame on.
    pub(super) fn set_size(&mut self, size_px: UVec2) {
        self.size_px = size_px.clamp(UVec2::splat(16), UVec2::splat(8192));
    }

    fn aspect(&self) -> f32 {
        self.size_px.x as f32 / self.size_px.y as f32
    }
}

/// The 3D camera.
#[derive(Component)]
pub(super) struct ViewCamera;

/// The figure that is drawn.
#[derive(Component)]
pub(super) struct EditedFigure;

/// The materials of a finished and of an unfinished figure.
#[derive(Resource)]
pub(super) struct FigureMaterials {
    finished: Handle<StandardMaterial>,
    preview: Handle<StandardMaterial>,
}

pub(super) struct ViewportPlugin;

impl Plugin for ViewportPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Startup, (stage::build, spawn_view))
            .add_systems(
                PostUpdate,
                (
                    resize_image.before(bevy::camera::CameraUpdateSystems),
                    (show_or_hide, frame_figure)
                        .after(crate::Stick3dSystems::Dress)
                        .before(TransformSystems::Propagate)
                        .before(bevy::camera::visibility::VisibilitySystems::VisibilityPropagate),
                ),
            );
    }
}

fn spawn_view(
    mut commands: Commands,
    mut images: ResMut<Assets<Image>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut textures: ResMut<EguiUserTextures>,
) {
    let size_px = UVec2::new(960, 900);
    let image = images.add(Image::new_target_texture(
        size_px.x,
        size_px.y,
        TextureFormat::Rgba8UnormSrgb,
        None,
    ));
    let texture = textures.add_image(EguiTextureHandle::Strong(image.clone()));
    commands.spawn((
        ViewCamera,
        Camera3d::default(),
        Camera {
            order: -1,
            ..default()
        },
        RenderTarget::Image(image.clone().into()),
        Projection::from(PerspectiveProjection {
            fov: FOV_Y_RAD,
            near: 0.05,
            far: 200.0,
            ..default()
        }),
        Tonemapping::KhronosPbrNeutral,
        Msaa::Sample4,
        ShadowFilteringMethod::Gaussian,
        stage::ambient(&mut images),
        Transform::default(),
    ));
    commands.insert_resource(View {
        image,
        texture,
        orbit: Orbit::default(),
        framing: Framing::default(),
        size_px,
    });
    let finished = figure_material();
    let preview = StandardMaterial {
        base_color: Color::srgba(0.62, 0.62, 0.62, 1.0),
        emissive: LinearRgba::rgb(0.30, 0.30, 0.29),
        perceptual_roughness: 1.0,
        reflectance: 0.0,
        ..figure_material()
    };
    commands.insert_resource(FigureMaterials {
        finished: materials.add(finished),
        preview: materials.add(preview),
    });
}

/// Gives the image the size of its place in the window.
fn resize_image(view: Res<View>, mut images: ResMut<Assets<Image>>) {
    let wanted = Extent3d {
        width: view.size_px.x,
        height: view.size_px.y,
        depth_or_array_layers: 1,
    };
    let differs = images
        .get(&view.image)
        .is_some_and(|image| image.texture_descriptor.size != wanted);
    if differs && let Some(mut image) = images.get_mut(&view.image) {
        image.resize(wanted);
    }
}

/// The body is there once it has a pose, and pale until the sketch is complete.
fn show_or_hide(
    mut figures: Query<
        (
            Has<crate::StickSketch>,
            Has<SketchPreview>,
            &mut Visibility,
            Option<&mut MeshMaterial3d<StandardMaterial>>,
        ),
        With<EditedFigure>,
    >,
    materials: Res<FigureMaterials>,
) {
    for (has_sketch, is_preview, mut visibility, material) in &mut figures {
        visibility.set_if_neq(if has_sketch {
            Visibility::Inherited
        } else {
            Visibility::Hidden
        });
        let wanted = if is_preview {
            &materials.preview
        } else {
            &materials.finished
        };
        if let Some(mut material) = material
            && material.0 != *wanted
        {
            material.0 = wanted.clone();
        }
    }
}

/// Keeps the body in view, gently.
fn frame_figure(
    mut view: ResMut<View>,
    figures: Query<
        (&Aabb, &Visibility, Ref<StreamedBody>),
        (With<EditedFigure>, With<StickFigure>),
    >,
    mut cameras: Query<&mut Transform, With<ViewCamera>>,
    clock: Res<EditorClock>,
) {
    let goal = figures
        .iter()
        .find(|(_, visibility, _)| **visibility != Visibility::Hidden)
        .map_or_else(Framing::default, |(aabb, ..)| {
            Framing::around(aabb.min().into(), aabb.max().into())
        });
    view.framing.approach(&goal, clock.share_of_way(0.18));
    let wanted = camera_transform(&view.orbit, &view.framing, view.aspect());
    for mut transform in &mut cameras {
        transform.set_if_neq(wanted);
    }
}
