//! The stage the figure stands on: sky, ground and light.

use bevy::asset::RenderAssetUsages;
use bevy::camera::visibility::NoFrustumCulling;
use bevy::color::Mix;
use bevy::light::{
    CascadeShadowConfigBuilder, DirectionalLightShadowMap, NotShadowCaster, NotShadowReceiver,
};
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use bevy::render::render_resource::Face;

use super::viewport::EditedFigure;

const ZENITH: Srgba = Srgba::rgb(0.50, 0.66, 0.80);
const HORIZON: Srgba = Srgba::rgb(0.92, 0.92, 0.91);
const NADIR: Srgba = Srgba::rgb(0.91, 0.90, 0.88);
const GROUND: Srgba = Srgba::rgb(0.70, 0.69, 0.68);

const SKY_RADIUS_M: f32 = 60.0;
/// The ground is solid up to here, then fades.
const GROUND_SOLID_M: f32 = 2.5;
const GROUND_RADIUS_M: f32 = 14.0;

/// What goes along with a figure that walks, so that the world has no end.
#[derive(Component)]
pub(super) struct Endless;

/// Keeps the ground and the sky round the figure that is shown.
pub(super) fn follow(
    figures: Query<(&Transform, &EditedFigure), Without<Endless>>,
    mut stage: Query<&mut Transform, With<Endless>>,
) {
    let shown = figures.iter().find(|(_, edited)| edited.is_shown);
    let Some((body, _)) = shown else {
        return;
    };
    let wanted = Transform::from_translation(body.translation.with_y(0.0));
    for mut transform in &mut stage {
        transform.set_if_neq(wanted);
    }
}

/// Sky, ground and lights.
pub(super) fn build(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    // Few texels for a small scene: the filter then spans centimetres, and shadows have soft edges.
    commands.insert_resource(DirectionalLightShadowMap { size: 2048 });
    commands.insert_resource(GlobalAmbientLight::NONE);
    commands.spawn((
        Name::new("sky"),
        Endless,
        Mesh3d(meshes.add(sky_mesh())),
        MeshMaterial3d(materials.add(StandardMaterial {
            unlit: true,
            fog_enabled: false,
            cull_mode: Some(Face::Front),
            ..default()
        })),
        NotShadowCaster,
        NotShadowReceiver,
        NoFrustumCulling,
    ));
    commands.spawn((
        Name::new("ground"),
        Endless,
        Mesh3d(meshes.add(ground_mesh())),
        MeshMaterial3d(materials.add(StandardMaterial {
            perceptual_roughness: 0.95,
            reflectance: 0.1,
            alpha_mode: AlphaMode::Blend,
            ..default()
        })),
        NotShadowCaster,
    ));
    commands.spawn((
        Name::new("key light"),
        DirectionalLight {
            color: Color::srgb(1.0, 0.96, 0.90),
            illuminance: 6_200.0,
            shadow_maps_enabled: true,
            shadow_depth_bias: 0.03,
            shadow_normal_bias: 1.2,
            ..default()
        },
        CascadeShadowConfigBuilder {
            num_cascades: 1,
            minimum_distance: 0.5,
            maximum_distance: 14.0,
            ..default()
        }
        .build(),
        Transform::from_xyz(-2.2, 4.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    commands.spawn((
        Name::new("rim light"),
        DirectionalLight {
            color: Color::srgb(0.80, 0.90, 1.0),
            illuminance: 3_000.0,
            shadow_maps_enabled: false,
            ..default()
        },
        Transform::from_xyz(3.0, 2.5, -3.5).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}

/// The light that comes from everywhere: blue above, warm below.
pub(super) fn ambient(images: &mut Assets<Image>) -> EnvironmentMapLight {
    EnvironmentMapLight {
        intensity: 900.0,
        ..EnvironmentMapLight::hemispherical_gradient(
            images,
            Color::srgb(0.88, 0.94, 1.0),
            Color::srgb(0.93, 0.93, 0.93),
            Color::srgb(0.72, 0.68, 0.62),
        )
    }
}

/// The colour of the sky at a height from -1 (straight down) to 1 (straight up).
fn sky_color(height: f32) -> LinearRgba {
    let horizon = LinearRgba::from(HORIZON);
    if height >= 0.0 {
        horizon.mix(&LinearRgba::from(ZENITH), height.powf(0.55))
    } else {
        horizon.mix(&LinearRgba::from(NADIR), (-height).powf(0.7))
    }
}

fn sky_mesh() -> Mesh {
    // Fine stacks, since the gradient is steepest at the horizon.
    // Bevy's UV spheres have their poles on z.
    let pole_up = Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2);
    let mesh = Sphere::new(SKY_RADIUS_M)
        .mesh()
        .uv(24, 96)
        .rotated_by(pole_up);
    let colors: Vec<[f32; 4]> = mesh
        .attribute(Mesh::ATTRIBUTE_POSITION)
        .and_then(|positions| positions.as_float3())
        .unwrap_or_default()
        .iter()
        .map(|position| sky_color(position[1] / SKY_RADIUS_M).to_f32_array())
        .collect();
    mesh.with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colors)
}

/// A disc of rings whose opacity falls off outward.
fn ground_mesh() -> Mesh {
    const RINGS: usize = 24;
    const SECTORS: usize = 72;
    let mut positions = Vec::new();
    let mut colors = Vec::new();
    let mut indices = Vec::new();
    let ground = LinearRgba::from(GROUND);
    for ring in 0..=RINGS {
        let radius_m = GROUND_RADIUS_M * (ring as f32 / RINGS as f32).powf(1.5);
        let fade =
            ((radius_m - GROUND_SOLID_M) / (GROUND_RADIUS_M - GROUND_SOLID_M)).clamp(0.0, 1.0);
        let alpha = (1.0 - fade).powi(2);
        for sector in 0..SECTORS {
            let angle = sector as f32 / SECTORS as f32 * std::f32::consts::TAU;
            positions.push([radius_m * angle.sin(), 0.0, radius_m * angle.cos()]);
            colors.push(ground.with_alpha(alpha).to_f32_array());
        }
    }
    for ring in 0..RINGS {
        for sector in 0..SECTORS {
            let next = (sector + 1) % SECTORS;
            let [a, b] = [ring * SECTORS + sector, ring * SECTORS + next];
            let [c, d] = [a + SECTORS, b + SECTORS];
            indices.extend([a, c, b, b, c, d].map(|index| index as u32));
        }
    }
    let normals = vec![[0.0, 1.0, 0.0]; positions.len()];
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
    .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colors)
    .with_inserted_indices(Indices::U32(indices))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ground_faces_up() {
        let mesh = ground_mesh();
        let positions = mesh
            .attribute(Mesh::ATTRIBUTE_POSITION)
            .and_then(|values| values.as_float3())
            .unwrap();
        let indices: Vec<usize> = mesh.indices().unwrap().iter().collect();
        for triangle in indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|i| Vec3::from(positions[triangle[i]]));
            assert!((b - a).cross(c - a).y >= -1.0e-6);
        }
    }

    #[test]
    fn the_sky_gets_bluer_upward() {
        let blueness = |height| {
            let color = sky_color(height);
            color.blue - color.red
        };
        assert!(blueness(1.0) > blueness(0.2));
        assert!(blueness(0.2) > blueness(0.0));
        let horizon = sky_color(0.0);
        assert!((horizon.red - LinearRgba::from(HORIZON).red).abs() < 1.0e-6);
    }
}
