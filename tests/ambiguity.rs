//! No two of the plugin's systems depend on an order that is not given.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and may say why it skips"
)]

mod support;

use bevy::ecs::schedule::{InternedScheduleLabel, LogLevel, ScheduleBuildSettings};
use bevy::prelude::*;

#[test]
fn our_systems_have_no_ambiguities() {
    let mut app = support::app();
    let counts = ambiguities(&mut app);
    assert!(
        counts
            .iter()
            .any(|(label, _)| format!("{label:?}") == "PostUpdate"),
        "the schedules were not looked at: {counts:?}"
    );
    let total: usize = counts.iter().map(|(_, count)| count).sum();
    assert_eq!(total, 0, "{counts:?}; run with RUST_LOG=warn to see which");
}

#[test]
fn the_count_sees_an_ambiguity() {
    fn spoil(mut latents: Query<&mut bevy_stick3d::Latent>) {
        for mut latent in &mut latents {
            latent.0.clear();
        }
    }
    let mut app = support::app();
    app.add_systems(PostUpdate, spoil);
    let total: usize = ambiguities(&mut app).iter().map(|(_, count)| count).sum();
    assert!(total > 0);
}

/// How many pairs of systems of each schedule touch the same data in no given order.
fn ambiguities(app: &mut App) -> Vec<(InternedScheduleLabel, usize)> {
    let mut schedules = app.world_mut().resource_mut::<Schedules>();
    for (_, schedule) in schedules.iter_mut() {
        schedule.set_build_settings(ScheduleBuildSettings {
            ambiguity_detection: LogLevel::Warn,
            // Inserted synchronisation would order systems by accident.
            auto_insert_apply_deferred: false,
            use_shortnames: false,
            ..default()
        });
    }
    let labels: Vec<InternedScheduleLabel> = schedules
        .iter()
        .map(|(_, schedule)| schedule.label())
        .collect();
    labels
        .into_iter()
        .map(|label| {
            let count = app.world_mut().schedule_scope(label, |world, schedule| {
                schedule.initialize(world).unwrap().unwrap();
                schedule.graph().conflicting_systems().len()
            });
            (label, count)
        })
        .collect()
}
