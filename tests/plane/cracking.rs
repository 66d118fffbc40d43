//! Bonds that break while walls carry loads.

use std::path::Path;

use graintwin::command::Ask;
use graintwin::pack;
use graintwin::report::EventKind;
use graintwin::scene::{self, Loaded};
use graintwin::wall::WallTarget;

use crate::discs::*;

#[test]
fn walls_carry_their_loads_again_after_cracks() {
    let file = Path::new("scene.yaml");
    let scene = scene::parse(
        "dimension: 2\n\
         materials: {stone: {young: 2.32e9, poisson: 0.16, density: 2650.0}}\n\
         pack: {crystal: {rows: 9, columns: [4, 5], radius: 0.1e-3, material: stone}}\n\
         walls: {friction: 0.0}\n\
         contact: {normal: {linear: {stiffness: 1.0e6, bond: {cohesion: 5.0e6}}}, \
         friction: {coefficient: 0.6}}\n\
         solver: {max_overlap_share: 100.0}",
        file,
    )
    .unwrap();
    let pack = pack::build(&Loaded { scene: scene.clone(), file: file.into() }).unwrap();
    let height = pack.bounds.sides()[1];
    let (mut rig, _) = Rig::new(&scene, &pack);
    let lateral = 5e5;
    let start = rig.stress([lateral; 2]).walls.displacement;
    let mut cracks = 0;
    for k in 1..=40 {
        let way = 0.5 * 5e-4 * f64::from(k) * height;
        let [low, high] = [2, 3].map(|side| WallTarget::Displacement(start[side] + way));
        let [x, keep] = [WallTarget::Stress(lateral), WallTarget::Keep];
        let measures = rig.go(Ask::Targets([x, x, low, high, keep, keep]));
        let state = measures.state.unwrap();
        assert!((state.stress_walls[0] / lateral - 1.0).abs() < 1e-6, "{k}");
        cracks +=
            measures.events.iter().filter(|event| event.kind == EventKind::ContactBreak).count();
        if cracks > 10 {
            return;
        }
    }
    panic!("{cracks} cracks");
}
