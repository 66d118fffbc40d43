//! Cemented scenes and packs.
#![allow(dead_code, reason = "each test takes what it needs of it")]

use graintwin::command::Disposition;
use graintwin::pack::Pack;
use graintwin::scene::{
    Cement, CementLaw, CementStrength, Exponential, Normal, Parallel, Power, Scene, Solution,
};

use crate::packs::{Rig, by_strain, made, scene_to};

pub(crate) const EXPONENTIAL: CementLaw = CementLaw::Exponential(Exponential { gamma: 3000.0 });
pub(crate) const POWER: CementLaw = CementLaw::Power(Power { eta: 1111.0, omega: 1.3 });
pub(crate) const PARALLEL: CementLaw = CementLaw::Parallel(Parallel {
    young: 70e9,
    shear: 29.2e9,
    radius_ratio: 0.003,
    length_ratio: 0.001,
});
/// The five laws.
pub(crate) const LAWS: [CementLaw; 5] =
    [CementLaw::Fixed, CementLaw::LinearElastic, EXPONENTIAL, POWER, PARALLEL];

/// Cement as the thesis has it, unbreakable.
pub(crate) fn cement(law: CementLaw) -> Cement {
    Cement {
        law,
        kappa: 0.01,
        partial_slip: 0.1,
        bridge: 0.1,
        walls: true,
        solution: Solution::Nonlinear,
        strength: None,
    }
}

/// A scene of smooth grains that `cement` holds together.
pub(crate) fn scene(cement: Cement, tolerance: f64) -> Scene {
    let mut scene = scene_to(tolerance);
    scene.contact.normal = Normal::Cement(cement);
    scene
}

/// Cement that breaks.
pub(crate) fn breakable(law: CementLaw, tension: f64, shear: f64) -> Cement {
    Cement { strength: Some(CementStrength { tension, shear }), ..cement(law) }
}

/// A cemented pack of glass beads that was pressed along z and bulged, and sheared by unequal
/// lateral strains, in four increments of 1e-4.
pub(crate) fn loaded(scene: &Scene, grains: usize, seed: u64) -> Pack {
    let pack = made(grains, 1e7, seed);
    let (mut rig, report) = Rig::start(scene, &pack);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    for k in 1..=4 {
        let strain = [-5e-5, 1e-5, 1e-4].map(|strain| strain * f64::from(k));
        rig.go(by_strain(&pack.bounds, strain));
    }
    rig.twin.pack()
}
