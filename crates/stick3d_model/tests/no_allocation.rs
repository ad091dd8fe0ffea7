//! A frame allocates nothing: sketch to latent, latent to mesh and normals, latent to joints, a motion's time to latent.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use glam::Vec3;
use stick3d_figure::sketch::Sketch;
use stick3d_model::latent::{Easing, MotionSettings};
use stick3d_model::{Alternatives, Inference, LatentKey, Model, Motion};

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

struct Counting;

#[allow(
    unsafe_code,
    reason = "the trait of allocators is unsafe; this one hands on to the system's"
)]
// SAFETY: every call is handed on to `System` unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller keeps the contract of `GlobalAlloc::alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: `pointer` came from `System` with this layout.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

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

    let before = ALLOCATIONS.with(Cell::get);
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
    assert_eq!(ALLOCATIONS.with(Cell::get) - before, 0);
    assert!(before > 0, "the counter counts");
    assert!(positions.iter().any(|p| p[1] > 0.3), "he stands");
}
