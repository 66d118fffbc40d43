//! The tangent stiffness of cemented packs against differences of equilibria.

use crate::cemented::{LAWS, cement, loaded, scene};
use crate::increments::Increment;

#[test]
fn stiffness_is_that_of_re_equilibrated_walls() {
    for law in LAWS {
        for torsion in [false, true] {
            let mut scene = scene(cement(law), 1e-12);
            scene.contact.torsion = torsion;
            let pack = loaded(&scene, 100, 1);
            let increment = Increment::new(&scene, &pack, [0.0, 0.0, 1e-5]);
            let found = increment.tangent().stands.unwrap();
            let want = increment.differences(1e-9);
            let off = (found.walls - want).amax() / want.amax();
            assert!(off < 1e-7, "{law:?}, torsion {torsion}: off by {off:e}");
            assert!(found.error < 1e-9, "{:e}", found.error);
        }
    }
}
