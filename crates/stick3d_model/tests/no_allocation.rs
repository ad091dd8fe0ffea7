//! A frame allocates nothing: sketch to latent, latent to mesh and normals, latent to joints, a motion's time to latent.

#[path = "../../../tests/support/counting.rs"]
mod counting;

use counting::allocations_so_far;
use glam::Vec3;
use stick3d_figure::sketch::Sketch;
use stick3d_model::latent::{Easing, MotionSettings};
use stick3d_model::{Alternatives, Inference, LatentKey, Model, Motion};

#[test]
fn a_frame_allocates_nothing() {
    let model = Model::from_bytes(include_bytes!("../../../assets/models/human.stick3d")).unwrap();
    let mut inference = Inference::new(&model).unwrap();
    let sketch = Sketch::template(model.figure());
    let mut latent = vec![0.0; inference.latent_len()];
    let mut positions = vec![[0.0; 3]; inference.vertex_count()];
    let mut normals = positions.clone();
    let mut joints = vec![Vec3::ZERO; model.figure().joint_count()];

    let mut alternatives = Alternatives::default();
    inference.encode(&sketch, &mut latent).unwrap();
    inference.infer(&sketch, &mut alternatives).unwrap();
    let keys = [0.0_f32, 1.0].map(|time_s| LatentKey {
        latent: latent.iter().map(|x| x * (1.0 - 0.3 * time_s)).collect(),
        time_s,
        easing: Easing::InOut,
    });
    let motion = Motion::new(&keys, MotionSettings::default(), &mut inference).unwrap();

    let before = allocations_so_far();
    for _ in 0..3 {
        inference.encode(&sketch, &mut latent).unwrap();
        inference.infer(&sketch, &mut alternatives).unwrap();
        inference
            .decode(&latent, &mut positions, &mut normals)
            .unwrap();
        inference.joints(&latent, &mut joints).unwrap();
    }
    for frame in 0..40 {
        let time_s = 0.1 * frame as f32 - 1.0;
        motion.sample_into(time_s, &mut latent).unwrap();
        assert!(motion.root_translation(time_s).is_some() && motion.trust(time_s) > 0.0);
        inference.trust(&latent).unwrap();
    }
    assert_eq!(allocations_so_far() - before, 0);
    assert!(before > 0, "the counter counts");
    assert!(positions.iter().any(|p| p[1] > 0.3), "he stands");
}
