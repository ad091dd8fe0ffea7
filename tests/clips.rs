//! Clips are Bevy animations: the mesh follows them, they blend, go over into each other, seek, repeat, and walk.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and may say why it skips"
)]

mod support;

use std::path::Path;
use std::time::Duration;

use bevy::animation::{ActiveAnimation, AnimationEvent};
use bevy::prelude::*;
use bevy_stick3d::HUMAN_MODEL;
use bevy_stick3d::animation::{
    ClipPlayback, LatentCurve, LatentProperty, STICK_TARGET, StartedClip,
};
use bevy_stick3d::prelude::*;
use support::{TICK, add_clip, app, app_with, cheer, positions, status, t_pose, writes_in};

/// From arms stretched out to arms up in half a second, then as `finish` says.
fn raise(
    finish: impl FnOnce(
        bevy_stick3d::animation::StickClipBuilder<'static>,
    ) -> bevy_stick3d::animation::StickClipBuilder<'static>,
) -> StickClip {
    let builder = StickClip::builder(Figure::human())
        .sketch(0.0, t_pose())
        .sketch(0.5, cheer())
        .extrapolation(Extrapolation::Hold);
    finish(builder).build().unwrap()
}

/// A man who plays a clip, after the first update.
fn playing(app: &mut App, clip: StickClip) -> (Entity, Handle<StickClip>) {
    let clip = add_clip(app, clip);
    let man = app
        .world_mut()
        .spawn((StickFigure::human(), PlayStickClip(clip.clone())))
        .id();
    app.update();
    assert_eq!(status(app, man), FigureStatus::Ready);
    (man, clip)
}

fn curve(app: &App, clip: &Handle<StickClip>) -> LatentCurve {
    let clips = app.world().resource::<StickClips>();
    clips.curve(clip, &HUMAN_MODEL).unwrap().clone()
}

fn latent(app: &App, figure: Entity) -> Vec<f32> {
    app.world().get::<Latent>(figure).unwrap().0.clone()
}

/// The one animation that a figure's [`PlayStickClip`] plays.
fn active(app: &mut App, figure: Entity) -> Mut<'_, ActiveAnimation> {
    let node = app.world().get::<StartedClip>(figure).unwrap().node();
    let player = app.world_mut().get_mut::<AnimationPlayer>(figure).unwrap();
    player.map_unchanged(|player| player.animation_mut(node.unwrap()).unwrap())
}

fn distance(a: &[f32], b: &[f32]) -> f32 {
    assert_eq!(a.len(), b.len());
    let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
    squares.sum::<f32>().sqrt()
}

/// The mesh of a man in the pose of a sketch.
fn drawn(sketch: StickSketch) -> Vec<Vec3> {
    let mut app = app();
    let man = app.world_mut().spawn((StickFigure::human(), sketch)).id();
    app.update();
    positions(&app, man).unwrap()
}

#[test]
fn a_clip_is_shown_from_the_first_frame_on_and_meets_its_keys() {
    let mut app = app();
    let (man, clip) = playing(&mut app, raise(|clip| clip));
    assert_eq!(positions(&app, man).unwrap(), drawn(t_pose()));
    let curve = curve(&app, &clip);
    assert_eq!(curve.duration_s(), 0.5);
    let mut before = positions(&app, man).unwrap();
    for frame in 1..=29 {
        app.update();
        let seek_s = active(&mut app, man).seek_time();
        assert!((seek_s - frame as f32 * TICK.as_secs_f32()).abs() < 1e-4);
        assert_eq!(latent(&app, man), curve.latent(seek_s).unwrap());
        let now = positions(&app, man).unwrap();
        assert_ne!(now, before, "the mesh follows in frame {frame}");
        before = now;
    }
    for _ in 0..5 {
        app.update();
    }
    assert!(
        app.world()
            .get::<AnimationPlayer>(man)
            .unwrap()
            .all_finished()
    );
    assert_eq!(
        positions(&app, man).unwrap(),
        drawn(cheer()),
        "it rests on its last key"
    );
    assert_eq!(status(&app, man), FigureStatus::Ready);
}

#[test]
fn seeking_speed_and_direction_are_bevys() {
    let mut app = app();
    let (man, clip) = playing(&mut app, raise(|clip| clip));
    let curve = curve(&app, &clip);
    active(&mut app, man).set_seek_time(0.5).pause();
    app.update();
    assert_eq!(positions(&app, man).unwrap(), drawn(cheer()));
    active(&mut app, man)
        .set_seek_time(0.25)
        .resume()
        .set_speed(2.0);
    for _ in 0..3 {
        app.update();
    }
    let expected_s = 0.25 + 6.0 * TICK.as_secs_f32();
    assert!(distance(&latent(&app, man), &curve.latent(expected_s).unwrap()) < 1e-3);
    active(&mut app, man).set_speed(-1.0);
    app.update();
    app.update();
    let expected_s = expected_s - 2.0 * TICK.as_secs_f32();
    assert!(distance(&latent(&app, man), &curve.latent(expected_s).unwrap()) < 1e-3);
}

#[test]
fn a_loop_repeats_by_itself_and_a_clip_that_turns_back_does_too() {
    for repeat in [
        Repeat::Loop {
            closing_s: Some(0.1),
        },
        Repeat::PingPong,
    ] {
        let mut app = app();
        let (man, clip) = playing(&mut app, raise(|clip| clip.repeat(repeat)));
        let round_s = curve(&app, &clip).duration_s();
        let frames = (round_s / TICK.as_secs_f32()).round() as usize;
        app.update();
        let early = latent(&app, man);
        for _ in 0..3 * frames {
            app.update();
        }
        // The clock's ticks do not divide the round evenly.
        assert!(distance(&latent(&app, man), &early) < 0.02 * early.len() as f32);
        assert!(active(&mut app, man).completions() >= 2);
    }
}

#[test]
fn a_paused_or_finished_clip_costs_nothing() {
    let mut app = app();
    let (man, _) = playing(&mut app, raise(|clip| clip));
    app.update();
    assert_eq!(writes_in(&mut app, 5), 5);
    active(&mut app, man).pause();
    app.update();
    assert_eq!(writes_in(&mut app, 5), 0, "paused");
    active(&mut app, man).resume();
    assert!(writes_in(&mut app, 40) > 20);
    assert_eq!(writes_in(&mut app, 5), 0, "finished");
}

/// A man with two clips, up and down, in a graph of his own; and the clips' nodes.
fn with_graph(app: &mut App) -> (Entity, [AnimationNodeIndex; 2], [LatentCurve; 2]) {
    let up = add_clip(app, raise(|clip| clip));
    let down = StickClip::builder(Figure::human())
        .sketch(0.0, cheer())
        .sketch(0.5, StickSketch::new(Figure::human().template.clone()))
        .build();
    let down = add_clip(app, down.unwrap());
    let (graph, nodes) = app
        .world_mut()
        .resource_scope(|world, mut clips: Mut<StickClips>| {
            let animations = world.resource::<Assets<AnimationClip>>();
            let handles = [&up, &down].map(|clip| clips.animation(clip, &HUMAN_MODEL, animations));
            AnimationGraph::from_clips(handles)
        });
    let graph = app
        .world_mut()
        .resource_mut::<Assets<AnimationGraph>>()
        .add(graph);
    let man = app
        .world_mut()
        .spawn((
            StickFigure::human(),
            AnimationPlayer::default(),
            AnimationGraphHandle(graph),
            AnimationTransitions::new(),
        ))
        .id();
    app.update();
    let curves = [curve(app, &up), curve(app, &down)];
    (man, [nodes[0], nodes[1]], curves)
}

#[test]
fn a_graph_blends_two_clips() {
    let mut app = app();
    let (man, nodes, curves) = with_graph(&mut app);
    app.world_mut()
        .entity_mut(man)
        .remove::<AnimationTransitions>();
    let mut player = app.world_mut().get_mut::<AnimationPlayer>(man).unwrap();
    player.play(nodes[0]).set_weight(0.25);
    player.play(nodes[1]).set_weight(0.75);
    for _ in 0..6 {
        app.update();
        let player = app.world().get::<AnimationPlayer>(man).unwrap();
        let seek_s = player.animation(nodes[0]).unwrap().seek_time();
        let [a, b] = [0, 1].map(|clip| curves[clip].latent(seek_s).unwrap());
        let mixed: Vec<f32> = a.iter().zip(&b).map(|(a, b)| 0.25 * a + 0.75 * b).collect();
        assert!(distance(&latent(&app, man), &mixed) < 1e-4, "at {seek_s} s");
    }
}

#[test]
fn a_transition_goes_over_without_a_jump() {
    let mut app = app();
    let (man, nodes, curves) = with_graph(&mut app);
    let start = |app: &mut App, node, over_s: f32| {
        let mut man = app.world_mut().entity_mut(man);
        let (mut transitions, mut player) = man
            .get_components_mut::<(&mut AnimationTransitions, &mut AnimationPlayer)>()
            .unwrap();
        transitions
            .play(&mut player, node, Duration::from_secs_f32(over_s))
            .repeat();
    };
    start(&mut app, nodes[0], 0.0);
    for _ in 0..8 {
        app.update();
    }
    start(&mut app, nodes[1], 0.2);
    let whole = distance(
        &curves[0].latent(0.15).unwrap(),
        &curves[1].latent(0.0).unwrap(),
    );
    let mut before = latent(&app, man);
    for frame in 0..14 {
        app.update();
        let now = latent(&app, man);
        assert!(
            distance(&now, &before) < 0.35 * whole,
            "a jump in frame {frame}"
        );
        before = now;
    }
    let player = app.world().get::<AnimationPlayer>(man).unwrap();
    assert!(!player.is_playing_animation(nodes[0]));
    let seek_s = player.animation(nodes[1]).unwrap().seek_time();
    assert!(distance(&before, &curves[1].latent(seek_s).unwrap()) < 1e-4);
}

#[derive(AnimationEvent, Clone)]
struct HandsUp;

#[derive(Resource, Default)]
struct HandsUps(Vec<Entity>);

#[test]
fn events_come_once_a_round_and_outlive_a_new_build() {
    let mut app = app();
    app.init_resource::<HandsUps>();
    app.add_observer(|event: On<HandsUp>, mut seen: ResMut<HandsUps>| {
        seen.0.push(event.trigger().target);
    });
    let clip = add_clip(&mut app, raise(|clip| clip.repeat(Repeat::PingPong)));
    app.world_mut()
        .resource_scope(|world, mut clips: Mut<StickClips>| {
            let mut animations = world.resource_mut::<Assets<AnimationClip>>();
            clips.finish_with(&clip, &HUMAN_MODEL, &mut animations, |animation| {
                animation.add_event(0.5, HandsUp);
            });
        });
    let man = app
        .world_mut()
        .spawn((StickFigure::human(), PlayStickClip(clip.clone())))
        .id();
    for _ in 0..62 {
        app.update();
    }
    assert_eq!(app.world().resource::<HandsUps>().0, [man]);
    let again = raise(|clip| clip.repeat(Repeat::PingPong));
    app.world_mut()
        .resource_mut::<Assets<StickClip>>()
        .insert(&clip, again)
        .unwrap();
    for _ in 0..62 {
        app.update();
    }
    assert_eq!(app.world().resource::<HandsUps>().0, [man, man]);
}

/// An app with this repository's assets, a man who plays a clip from there, and the clip.
fn walking(bundle: impl Bundle) -> (App, Entity, Handle<StickClip>) {
    let assets = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets");
    let mut app = app_with(Path::new(assets), |_| {});
    let walk: Handle<StickClip> = app
        .world()
        .resource::<AssetServer>()
        .load("clips/walk.clip.ron");
    let man = app
        .world_mut()
        .spawn((StickFigure::human(), PlayStickClip(walk.clone()), bundle))
        .id();
    let start = std::time::Instant::now();
    while app
        .world()
        .get::<StartedClip>(man)
        .unwrap()
        .node()
        .is_none()
    {
        app.update();
        assert!(
            start.elapsed() < Duration::from_secs(60),
            "the walk never starts"
        );
        std::thread::sleep(Duration::from_millis(2));
    }
    (app, man, walk)
}

fn place(app: &App, figure: Entity) -> Vec3 {
    app.world().get::<Transform>(figure).unwrap().translation
}

#[test]
fn a_looped_walk_walks_on() {
    let (mut app, man, walk) = walking(());
    let curve = curve(&app, &walk);
    let motion = curve.motion();
    let root = |time_s: f32| motion.root_translation(time_s).unwrap();
    let (mut clock_s, mut farthest) = (0.0, 0.0_f32);
    for _ in 0..200 {
        let before = place(&app, man);
        app.update();
        clock_s += TICK.as_secs_f32();
        let expected = (root(clock_s) - root(0.0)) * Vec3::new(1.0, 0.0, 1.0);
        farthest = farthest.max(place(&app, man).distance(expected));
        assert!(place(&app, man).distance(before) < 0.08, "a jump");
    }
    assert!(
        active(&mut app, man).completions() >= 2,
        "the loop ends and starts"
    );
    assert!(farthest < 0.01, "{farthest} m off");
    assert!(place(&app, man).length() > 2.0, "{}", place(&app, man));
    let (low, _) = support::bounds(&positions(&app, man).unwrap());
    assert!(low.y.abs() < 1e-5, "he walks on the ground: {}", low.y);
}

#[test]
fn the_walk_goes_where_its_figure_is_turned_and_from_where_it_is_put() {
    let (mut straight, man, _) = walking(());
    let turned = Transform::from_xyz(5.0, 1.0, 0.0)
        .with_rotation(Quat::from_rotation_y(1.0))
        .with_scale(Vec3::splat(2.0));
    let (mut other, other_man, _) = walking(turned);
    for _ in 0..20 {
        straight.update();
        other.update();
    }
    let way = place(&straight, man);
    let expected = Vec3::new(5.0, 1.0, 0.0) + Quat::from_rotation_y(1.0) * (2.0 * way);
    assert!(way.length() > 0.1);
    assert!(place(&other, other_man).distance(expected) < 1e-4);
    // A game may put it anywhere; the next step starts there.
    let mut transform = other.world_mut().get_mut::<Transform>(other_man).unwrap();
    transform.translation = Vec3::ZERO;
    other.update();
    assert!(place(&other, other_man).length() < 0.2);
}

#[test]
fn steps_can_be_told_instead_and_a_seek_takes_none() {
    let (mut app, man, walk) = walking(RootMotion::Report);
    let root = curve(&app, &walk).motion().clone();
    let mut way = Vec3::ZERO;
    for _ in 0..90 {
        app.update();
        way += app.world().get::<ClipPlayback>(man).unwrap().step_m;
    }
    assert_eq!(place(&app, man), Vec3::ZERO);
    let clock_s = 90.0 * TICK.as_secs_f32();
    let expected = root.root_translation(clock_s).unwrap() - root.root_translation(0.0).unwrap();
    assert!(
        (way - expected).with_y(0.0).length() < 0.01,
        "{way} {expected}"
    );

    *app.world_mut().get_mut::<RootMotion>(man).unwrap() = RootMotion::MoveTransform;
    active(&mut app, man).set_seek_time(0.1);
    app.update();
    assert!(place(&app, man).length() < 0.06, "{}", place(&app, man));
    active(&mut app, man).pause();
    let before = place(&app, man);
    for _ in 0..3 {
        app.update();
    }
    assert_eq!(place(&app, man), before, "a pause is a pause");
}

#[test]
fn a_long_frame_takes_all_of_its_steps() {
    let (mut app, man, walk) = walking(());
    let curve = curve(&app, &walk);
    let round = {
        let root = |time_s: f32| curve.motion().root_translation(time_s).unwrap();
        (root(curve.duration_s()) - root(0.0)).with_y(0.0)
    };
    app.update();
    app.world_mut()
        .resource_mut::<Time<Virtual>>()
        .set_max_delta(Duration::from_secs(60));
    let before = place(&app, man);
    let rounds = 3.0;
    let long = Duration::from_secs_f32(rounds * curve.duration_s());
    app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(long));
    app.update();
    assert!((place(&app, man) - before).distance(rounds * round) < 0.02);
}

#[test]
fn taking_the_component_away_stops_the_clip() {
    let mut app = app();
    let (man, _) = playing(&mut app, raise(|clip| clip.repeat(Repeat::PingPong)));
    for _ in 0..10 {
        app.update();
    }
    app.world_mut().entity_mut(man).remove::<PlayStickClip>();
    app.update();
    let kept = latent(&app, man);
    for _ in 0..5 {
        app.update();
    }
    assert_eq!(latent(&app, man), kept);
    // A drawing poses him again.
    app.world_mut().entity_mut(man).insert(cheer());
    app.update();
    assert_eq!(positions(&app, man).unwrap(), drawn(cheer()));
}

#[test]
fn another_clip_starts_at_once_and_clips_that_nobody_plays_are_dropped() {
    let mut app = app();
    let (man, first) = playing(&mut app, raise(|clip| clip));
    let second = StickClip::builder(Figure::human())
        .sketch(0.0, cheer())
        .sketch(0.5, t_pose())
        .build();
    let second = add_clip(&mut app, second.unwrap());
    app.world_mut()
        .entity_mut(man)
        .insert(PlayStickClip(second));
    app.update();
    assert_eq!(positions(&app, man).unwrap(), drawn(cheer()));
    for _ in 0..3 {
        app.update();
    }
    let clips = app.world().resource::<StickClips>();
    assert!(clips.curve(&first, &HUMAN_MODEL).is_none());
    assert_eq!(app.world().resource::<Assets<AnimationClip>>().len(), 1);
    app.world_mut().despawn(man);
    for _ in 0..3 {
        app.update();
    }
    assert_eq!(app.world().resource::<Assets<AnimationClip>>().len(), 0);
}

#[test]
fn a_curve_of_ones_own_moves_the_latent_too() {
    let mut app = app();
    let raised = app.world_mut().spawn((StickFigure::human(), cheer())).id();
    let level = app.world_mut().spawn((StickFigure::human(), t_pose())).id();
    app.update();
    let [from, to] = [level, raised].map(|man| Latent(latent(&app, man)));
    let keys = [
        (0.0, from.clone()),
        (0.5, to.clone()),
        (1.0, Latent(vec![0.0; 3])),
    ];
    let curve = AnimatableKeyframeCurve::new(keys).unwrap();
    let mut animation = AnimationClip::default();
    animation.add_curve_to_target(STICK_TARGET, AnimatableCurve::new(LatentProperty, curve));
    let animation = app
        .world_mut()
        .resource_mut::<Assets<AnimationClip>>()
        .add(animation);
    let (graph, node) = AnimationGraph::from_clip(animation);
    let graph = app
        .world_mut()
        .resource_mut::<Assets<AnimationGraph>>()
        .add(graph);
    let mut player = AnimationPlayer::default();
    player.play(node).set_seek_time(0.25).pause();
    let man = app
        .world_mut()
        .spawn((StickFigure::human(), player, AnimationGraphHandle(graph)))
        .id();
    app.update();
    app.update();
    let half = Latent::interpolate(&from, &to, 0.5);
    assert!(distance(&latent(&app, man), &half.0) < 1e-5);
    let shown = positions(&app, man).unwrap();

    // On to a key that is no latent of the model.
    let mut player = app.world_mut().get_mut::<AnimationPlayer>(man).unwrap();
    player.animation_mut(node).unwrap().set_seek_time(0.9);
    app.update();
    let problem = status(&app, man).problem().unwrap().to_owned();
    assert!(problem.contains("NaN"), "{problem}");
    assert_eq!(positions(&app, man).unwrap(), shown);
}

#[test]
fn a_time_that_is_none_is_told_and_overcome() {
    let mut app = app();
    let (man, _) = playing(&mut app, raise(|clip| clip));
    app.update();
    let shown = positions(&app, man).unwrap();
    active(&mut app, man).set_seek_time(f32::NAN).pause();
    app.update();
    let problem = status(&app, man).problem().unwrap().to_owned();
    assert!(problem.contains("NaN s"), "{problem}");
    assert_eq!(positions(&app, man).unwrap(), shown);
    active(&mut app, man).set_seek_time(0.3);
    app.update();
    assert_eq!(status(&app, man), FigureStatus::Ready);
    assert_ne!(positions(&app, man).unwrap(), shown);
}
