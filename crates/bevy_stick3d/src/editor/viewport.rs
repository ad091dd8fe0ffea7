//! The 3D view: its camera, the image it renders to, and the figure in it.

use bevy::camera::RenderTarget;
use bevy::camera::primitives::Aabb;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::light::{NotShadowCaster, NotShadowReceiver, ShadowFilteringMethod};
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureFormat};
use bevy::render::view::Msaa;
use bevy_egui::{EguiTextureHandle, EguiUserTextures, egui};

use super::orbit::{FOV_Y_RAD, Framing, Orbit, camera_transform};
use super::timeline::perform::Ghost;
use super::{EditorClock, stage};
use crate::material::figure_material;
use crate::sketch_input::SketchPreview;

/// The 3D view.
#[derive(Resource)]
pub(super) struct View {
    /// What the 3D camera renders to and egui shows.
    pub(super) image: Handle<Image>,
    /// The same, as egui knows it.
    pub(super) texture: egui::TextureId,
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

/// The extents that the stage is made for, metres; other bodies are shown larger or smaller than they are.
const STAGE_EXTENTS_M: [f32; 2] = [0.35, 2.5];

/// The bodies of the keys before and after: warm is past, cool is to come.
const GHOST_BEFORE: Srgba = Srgba::rgb(0.78, 0.52, 0.37);
const GHOST_AFTER: Srgba = Srgba::rgb(0.42, 0.66, 0.72);
const GHOST_OPACITY: f32 = 0.45;
/// Ghosts are drawn as if they were some decimetres farther away: where they are inside the body, only the body is seen.
const GHOST_DEPTH_BIAS: f32 = -900_000.0;

/// A figure that is drawn, and how it is looked at.
#[derive(Component)]
pub(super) struct EditedFigure {
    /// Where the user looks from.
    pub(super) orbit: Orbit,
    /// Whether it is the one that is drawn now.
    pub(super) is_shown: bool,
    /// Whether a motion poses it, and not the drawing.
    pub(super) is_performing: bool,
    /// Half of its largest extent at rest, as shown.
    extent_m: f32,
    scale: f32,
    /// What the camera keeps in view, once there is a body.
    framing: Option<Framing>,
}

impl EditedFigure {
    /// A figure of this size, half of its largest extent at rest.
    pub(super) fn new(extent_m: f32, yaw_rad: Option<f32>, is_shown: bool) -> Self {
        let [least, most] = STAGE_EXTENTS_M;
        let shown_m = extent_m.clamp(least, most);
        let usual = Orbit::default();
        Self {
            orbit: Orbit {
                yaw_rad: yaw_rad.unwrap_or(usual.yaw_rad),
                ..usual
            },
            is_shown,
            is_performing: false,
            extent_m: shown_m,
            scale: if extent_m > 0.0 {
                shown_m / extent_m
            } else {
                1.0
            },
            framing: None,
        }
    }

    /// Fits the body to the stage.
    pub(super) fn scale(&self) -> Transform {
        Transform::from_scale(Vec3::splat(self.scale))
    }
}

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
            .add_systems(PostStartup, dress_ghosts)
            .add_systems(
                PostUpdate,
                (
                    resize_image.before(bevy::camera::CameraUpdateSystems),
                    (show_or_hide, frame_figure, stage::follow)
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

/// Ghosts are seen through, and have the colour of their side in time.
///
/// Their share of each pixel's samples is drawn opaque, so that nothing of a ghost shines through itself.
fn dress_ghosts(
    mut commands: Commands,
    ghosts: Query<(Entity, &Ghost)>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let mut material = |tint: Srgba| {
        let tint = LinearRgba::from(tint);
        materials.add(StandardMaterial {
            base_color: Color::from((tint * 0.4).with_alpha(GHOST_OPACITY)),
            emissive: tint * 0.75,
            perceptual_roughness: 1.0,
            reflectance: 0.0,
            alpha_mode: AlphaMode::AlphaToCoverage,
            depth_bias: GHOST_DEPTH_BIAS,
            ..figure_material()
        })
    };
    let [before, after] = [GHOST_BEFORE, GHOST_AFTER].map(&mut material);
    for (entity, ghost) in &ghosts {
        let material = match ghost {
            Ghost::Before => before.clone(),
            Ghost::After => after.clone(),
        };
        let dress = (MeshMaterial3d(material), NotShadowCaster, NotShadowReceiver);
        commands.entity(entity).insert(dress);
    }
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

/// The body of the figure that is drawn is there once it has a pose, and pale until the sketch is complete.
fn show_or_hide(
    mut figures: Query<(
        Has<crate::StickSketch>,
        Has<SketchPreview>,
        &mut Visibility,
        Option<&mut MeshMaterial3d<StandardMaterial>>,
        &EditedFigure,
    )>,
    materials: Res<FigureMaterials>,
) {
    for (has_sketch, is_preview, mut visibility, material, edited) in &mut figures {
        let has_pose = has_sketch || edited.is_performing;
        visibility.set_if_neq(if has_pose && edited.is_shown {
            Visibility::Inherited
        } else {
            Visibility::Hidden
        });
        let wanted = if is_preview && !edited.is_performing {
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

/// Keeps the body in view, gently; one that has not been drawn yet where it will stand.
fn frame_figure(
    view: Res<View>,
    mut figures: Query<(Option<&Aabb>, &Transform, &mut EditedFigure), Without<ViewCamera>>,
    mut cameras: Query<&mut Transform, With<ViewCamera>>,
    clock: Res<EditorClock>,
) {
    for (aabb, body, mut edited) in &mut figures {
        if !edited.is_shown {
            continue;
        }
        let (scale, extent_m) = (edited.scale, edited.extent_m);
        let goal = aabb.map(|aabb| {
            let [low, high] = [aabb.min(), aabb.max()]
                .map(|corner| Vec3::from(corner) * scale + body.translation);
            Framing::around(low, high, extent_m)
        });
        if let Some(goal) = goal {
            let framing = edited.framing.get_or_insert(goal);
            framing.approach(&goal, clock.share_of_way(0.18));
        }
        let framing = edited.framing.unwrap_or(Framing::of_extent(extent_m));
        let wanted = camera_transform(&edited.orbit, &framing, view.aspect());
        for mut transform in &mut cameras {
            transform.set_if_neq(wanted);
        }
    }
}
