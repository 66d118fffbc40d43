//! The memory that state and scratch say they hold, against what the allocator gave them.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]
#![allow(unsafe_code, reason = "an allocator that counts is unsafe to write")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use graintwin::model::Model;
use graintwin::pack;
use graintwin::relax::advance::advance;
use graintwin::relax::{Workspace, relax};
use graintwin::scene::{self, Law, Method};
use graintwin::state::State;
use graintwin::wall::standing;

/// The system's allocator, counting the bytes in use.
struct Counting;

static IN_USE: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        IN_USE.fetch_add(layout.size(), Ordering::SeqCst);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        IN_USE.fetch_sub(layout.size(), Ordering::SeqCst);
        // SAFETY: the caller keeps the contract of `dealloc`, and `alloc` gave `at`.
        unsafe { System.dealloc(at, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// The only test of this program: others beside it would allocate too.
#[test]
fn state_and_scratch_hold_what_they_say() {
    let path = Path::new("scene.yaml");
    let text = "pack: {generate: {grains: 120, radius: {uniform: [0.07e-3, 0.13e-3]}, \
                material: glass, confining_stress: 1.0e6}}\n";
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().unwrap();
    for (law, gravity) in [(None, 0.0), (None, -9.81)]
        .into_iter()
        .chain([Law::ReturnMap, Law::MindlinDeresiewicz].map(|law| (Some(law), -9.81)))
    {
        let friction = match law {
            None => String::from("none"),
            Some(law) => {
                let name = serde_json::to_string(&law).unwrap();
                format!("{{coefficient: 0.3, law: {name}}}")
            }
        };
        let more = format!("contact: {{friction: {friction}}}\ngravity: [0, 0, {gravity:?}]\n");
        let scene = scene::parse(&format!("{text}{more}"), path).unwrap();
        let pack = pack::build(&scene::Loaded { scene: scene.clone(), file: path.into() }).unwrap();
        for method in Method::ALL {
            let mut model = Model::new(&pack, &scene);
            model.solver.method = method;
            model.solver.tolerance = 1e-4;
            pool.install(|| {
                let before = IN_USE.load(Ordering::SeqCst);
                let mut state = State::new(&model);
                let mut work = Workspace::new(&model);
                work.start(&model, &state);
                let here = relax(&model, &mut state, &mut work);
                work.commit(&model, &mut state);
                let travel = 1e-4 * model.start.sides()[2];
                let target = [0.0, 0.0, 0.0, 0.0, travel, 0.0];
                advance(&model, &mut state, &mut work, &standing(&target), here);
                let held = IN_USE.load(Ordering::SeqCst) - before;
                let said = state.heap_bytes() + work.heap_bytes();
                assert_eq!(said, held, "{method:?} {law:?} {gravity}");
            });
        }
    }
}
