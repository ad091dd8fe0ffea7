//! Drawings of random poses must be recovered.

use super::*;
use crate::simulate::{self, Hand, STYLES, Style};

/// Largest and mean distance between recognised and meant joints, in parts of the body height.
fn error_of(figure: &Figure, strokes: &[Stroke], meant: &[Vec2], height_px: f32) -> (f32, f32) {
    let sketch = recognize(figure, strokes).unwrap();
    let distances: Vec<f32> =
        sketch.points().iter().zip(meant).map(|(a, b)| a.distance(*b) / height_px).collect();
    let mean = distances.iter().sum::<f32>() / distances.len() as f32;
    (distances.into_iter().fold(0.0, f32::max), mean)
}

#[test]
fn study() {
    let human = Figure::human();
    for style in STYLES {
        let mut good = 0;
        let mut complete = 0;
        let mut sum = 0.0;
        let mut worst = vec![];
        let n = 300;
        let mut sec = 0.0;
        for seed in 0..n {
            let mut rng = simulate::rng(seed);
            let hand = Hand::default();
            let meant = simulate::on_canvas(&simulate::pose(&mut rng), hand.height_px);
            let cuts = simulate::cuts(&mut rng, style);
            let strokes = simulate::draw(&mut rng, &meant, &cuts, hand);
            let (max, mean) = error_of(human, &strokes, &meant, hand.height_px);
            let t = (0..3).map(|_| {let t = std::time::Instant::now(); std::hint::black_box(recognize(human,&strokes).is_ok()); t.elapsed().as_secs_f64()}).fold(1.0,f64::min);
            sec += t;
            if max < 0.06 { good += 1 } else { worst.push((seed, max)) }
            sum += mean;
            if progress(human, &strokes, Pen::Up).complete { complete += 1 }
        }
        worst.sort_by(|a, b| b.1.total_cmp(&a.1));
        worst.truncate(8);
        println!("{style:?}: good {good}/{n} complete {complete} mean {:.4} ms {:.2} worst {worst:?}", sum / n as f32, sec*1e3/n as f64);
    }
}
#[test]
fn detail() {
    let human = Figure::human();
    for (style, seeds) in [(Style::Mix, [172u64,236,288,170,65]), (Style::OneLine, [125,41,107,56,102]), (Style::StrokePerLimb, [113,213,74,23,276])] {
        for seed in seeds {
            let mut rng = simulate::rng(seed);
            let hand = Hand::default();
            let meant = simulate::on_canvas(&simulate::pose(&mut rng), hand.height_px);
            let cuts = simulate::cuts(&mut rng, style);
            let strokes = simulate::draw(&mut rng, &meant, &cuts, hand);
            let plan = Plan::new(human);
            let ink = Ink::new(&strokes).unwrap();
            let search = Search::run(&plan, &ink);
            let r = search.complete().unwrap();
            println!("{style:?} {seed} cost {} cuts {cuts:?}", r.cost);
            println!("   read {:?}", r.visits.iter().map(|v| (v.path_index, ink.strokes.iter().position(|s| s.contains(&v.sample)).unwrap(), ink.samples[v.sample].as_ivec2().to_array())).collect::<Vec<_>>());
            let p = placed_joints(&plan,&ink,&r);
            for (j,m) in meant.iter().enumerate() { let e = p[j].unwrap().distance(*m)/450.0; if e > 0.05 { println!("    {} {:.2} meant {:?} got {:?}", human.joints[j].name, e, m.as_ivec2().to_array(), p[j].unwrap().as_ivec2().to_array()); } }
            println!("    meant {:?}", human.joints.iter().zip(&meant).map(|(j,p)| format!("{}{:?}", j.name, p.as_ivec2().to_array())).collect::<Vec<_>>().join(" "));
        }
    }
}
