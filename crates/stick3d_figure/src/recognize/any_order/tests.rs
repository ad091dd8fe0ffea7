//! Drawings of random poses in any order must be recovered.

use super::*;
use crate::simulate::any_order::{
    Freedom, HORSE_FREEDOM, HUMAN_FREEDOM, Habits, draw, flat_pose, is_readable,
};
use crate::simulate::{self, Hand};

/// A joint is right within this part of the figure's height.
const RIGHT: f32 = 0.06;
const HEIGHT_PX: f32 = 500.0;

fn hand() -> Hand {
    Hand {
        height_px: HEIGHT_PX,
        jitter_px: 3.0,
        ..Hand::default()
    }
}

fn habits(figure: &Figure) -> Habits {
    let habits = Habits::default();
    if figure.views.both_ways {
        // A long neck carries a small head.
        Habits {
            loop_radius: (0.15, 0.3),
            ..habits
        }
    } else {
        habits
    }
}

fn farthest(found: &[Option<Vec2>], meant: &[Vec2]) -> f32 {
    let pairs = found.iter().zip(meant);
    pairs
        .map(|(found, meant)| {
            found.map_or(f32::INFINITY, |found| found.distance(*meant)) / HEIGHT_PX
        })
        .fold(0.0, f32::max)
}

/// The least error over all ways to exchange pairs.
fn farthest_up_to_sides(figure: &Figure, found: &[Option<Vec2>], meant: &[Vec2]) -> f32 {
    let pairs = sides::pairs(figure);
    (0..1_u32 << pairs.len())
        .map(|mask| {
            let mut found = found.to_vec();
            for (i, pair) in pairs.iter().enumerate() {
                if mask >> i & 1 == 1 {
                    sides::swap(pair, &mut found);
                }
            }
            farthest(&found, meant)
        })
        .fold(f32::INFINITY, f32::min)
}

fn readable(figure: &Figure, seed: u64, freedom: Freedom) -> (Vec<Vec2>, rand_chacha::ChaCha8Rng) {
    let mut rng = simulate::rng(seed);
    loop {
        let pose = flat_pose(figure, &mut rng, freedom);
        if is_readable(figure, &pose) {
            return (simulate::on_canvas(&pose, HEIGHT_PX), rng);
        }
    }
}

#[test]
fn survey() {
    for (figure, freedom) in [
        (Figure::human(), HUMAN_FREEDOM),
        (Figure::horse(), HORSE_FREEDOM),
    ] {
        let count = 500;
        let mut right = 0;
        let started = std::time::Instant::now();
        let mut spent = std::time::Duration::ZERO;
        for seed in 0..count {
            let (meant, mut rng) = readable(figure, seed, freedom);
            let strokes = draw(figure, &mut rng, &meant, &[], hand(), habits(figure));
            let before = std::time::Instant::now();
            let found = recognize_any(figure, &strokes).unwrap();
            spent += before.elapsed();
            let error = farthest_up_to_sides(figure, &found.joints, &meant);
            if error < RIGHT {
                right += 1;
            } else {
                println!(
                    "{} {seed}: {error} cost {} confidence {} left {}",
                    figure.name, found.cost, found.confidence, found.leftover
                );
            }
        }
        println!(
            "{}: {right} of {count}, {:?} each, {:?}",
            figure.name,
            spent / count as u32,
            started.elapsed(),
        );
    }
}

#[test]
fn dump() {
    let Ok(which) = std::env::var("DUMP") else {
        return;
    };
    let Ok(seeds) = std::env::var("SEEDS") else {
        return;
    };
    let (figure, freedom) = if which == "human" {
        (Figure::human(), HUMAN_FREEDOM)
    } else {
        (Figure::horse(), HORSE_FREEDOM)
    };
    for seed in seeds.split(',').map(|s| s.parse::<u64>().unwrap()) {
        let (meant, mut rng) = readable(figure, seed, freedom);
        let strokes = draw(figure, &mut rng, &meant, &[], hand(), habits(figure));
        let found = recognize_any(figure, &strokes).unwrap();
        let ink = Ink::new(&strokes).unwrap();
        let marks = Marks::new(&ink);
        let body = Body::new(figure);
        let search = Search::new(&body, &ink, &marks);
        let snap = |j: usize| {
            if j == figure.path[0] && marks.head.is_some() {
                return (marks.places.len(), 0.0);
            }
            let d = marks
                .places
                .iter()
                .map(|p| p.distance(meant[j]))
                .enumerate()
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .unwrap();
            d
        };
        println!(
            "{seed}: found cost {} left {} head {}",
            found.cost,
            found.leftover,
            marks.head.is_some()
        );
        for &[a, b] in &figure.bones {
            let (p, q) = (snap(a), snap(b));
            let line = search.lines.between(p.0, q.0);
            println!(
                "   {} {:?} - {} {:?}: {:?}",
                figure.joints[a].name,
                p,
                figure.joints[b].name,
                q,
                line.map(|l| l.cost)
            );
        }
        let mut svg = String::from(
            "<svg xmlns='http://www.w3.org/2000/svg' width='800' height='800' viewBox='-200 0 1100 1100'><rect x='-200' width='1100' height='1100' fill='white'/>",
        );
        let error = farthest_up_to_sides(figure, &found.joints, &meant);
        println!("{error}");
        let f = |p: Vec2| format!("{:.1},{:.1}", p.x, 800.0 - p.y);
        for (i, s) in strokes.iter().enumerate() {
            let pts: Vec<String> = s.positions().map(f).collect();
            svg += &format!(
                "<polyline points='{}' fill='none' stroke='hsl({},70%,70%)' stroke-width='3'/>",
                pts.join(" "),
                i * 67 % 360
            );
        }
        for p in &marks.places {
            svg += &format!(
                "<circle cx='{}' cy='{}' r='4' fill='none' stroke='black'/>",
                p.x,
                800.0 - p.y
            );
        }
        if let Some(h) = &marks.head {
            svg += &format!(
                "<circle cx='{}' cy='{}' r='{}' fill='none' stroke='red'/>",
                h.center.x,
                800.0 - h.center.y,
                h.radius
            );
        }
        for &[a, b] in &figure.bones {
            svg += &format!(
                "<polyline points='{} {}' stroke='green' stroke-width='1'/>",
                f(meant[a]),
                f(meant[b])
            );
            if let (Some(p), Some(q)) = (found.joints[a], found.joints[b]) {
                svg += &format!(
                    "<polyline points='{} {}' stroke='red' stroke-width='1' stroke-dasharray='4 4'/>",
                    f(p),
                    f(q)
                );
            }
        }
        for (j, p) in found.joints.iter().enumerate() {
            if let Some(p) = p {
                svg += &format!(
                    "<text x='{}' y='{}' font-size='13' fill='red'>{}</text>",
                    p.x + 4.0,
                    800.0 - p.y,
                    figure.joints[j].name
                );
            }
        }
        svg += "</svg>";
        std::fs::write(format!("/tmp/any_{which}_{seed}.svg"), svg).unwrap();
    }
}
