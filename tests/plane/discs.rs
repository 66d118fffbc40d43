//! Packs of discs for the tests: sand and sandstone of B tables 1 and 8, in small.
#![allow(dead_code, reason = "each test takes what it needs of it")]

use graintwin::command::{Ask, Command, Disposition, Mode, Stamp};
use graintwin::pack::{Grain, Pack};
use graintwin::report::{Demand, Measures, Report};
use graintwin::scene::Scene;
use graintwin::twin::Twin;
use graintwin::wall::{Bounds, WallTarget};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Mean radius \[m\].
pub(crate) const RADIUS: f64 = 1e-4;
/// Shear modulus of sand in B table 1, 1 GPa, as Young's modulus at ν = 0.16 \[Pa\].
pub(crate) const YOUNG: f64 = 2.32e9;
pub(crate) const POISSON: f64 = 0.16;

/// A scene of discs with `contact` as its contact laws and `rest` besides.
pub(crate) fn scene(contact: &str, rest: &str) -> Scene {
    let text = format!(
        "dimension: 2\npack: {{file: none.csv}}\nwalls: {{friction: 0.0}}\n\
         contact: {contact}\n{rest}\n"
    );
    graintwin::scene::parse(&text, "discs.yaml".as_ref()).unwrap()
}

/// Sand with the coefficient of friction `friction`, `none` for smooth grains.
pub(crate) fn sand(friction: &str) -> Scene {
    match friction {
        "none" => scene("{normal: hertz}", ""),
        _ => scene(&format!("{{friction: {{coefficient: {friction}}}}}"), ""),
    }
}

pub(crate) fn disc(x: f64, y: f64, radius: f64, friction: f64) -> Grain {
    Grain {
        position: [x, y, 0.0],
        radius,
        young: YOUNG,
        poisson: POISSON,
        density: 2650.0,
        friction,
        hydrate: false,
    }
}

/// A box as deep as the mean diameter.
pub(crate) fn boxed(min: [f64; 2], max: [f64; 2]) -> Bounds {
    Bounds { min: [min[0], min[1], -RADIUS], max: [max[0], max[1], RADIUS] }
}

/// `columns` by `rows` discs of sizes between 0.7 and 1.3 of the mean, apart from each other, at random
/// places of a grid.
pub(crate) fn loose(columns: usize, rows: usize, seed: u64, friction: f64) -> Pack {
    let mut rng = Pcg64::seed_from_u64(seed);
    let pitch = 2.7 * RADIUS;
    let mut grains = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let radius = RADIUS * (0.7 + 0.6 * rng.random::<f64>());
            let mut near =
                |k: usize| (k as f64 + 0.5) * pitch + 0.02 * RADIUS * rng.random::<f64>();
            let (x, y) = (near(column), near(row));
            grains.push(disc(x, y, radius, friction));
        }
    }
    let bounds = boxed([0.0; 2], [columns as f64 * pitch, rows as f64 * pitch]);
    Pack { bounds, grains, history: None }
}

/// A twin that serves commands one after the other.
pub(crate) struct Rig {
    pub(crate) twin: Twin,
    sequence: u64,
}

impl Rig {
    pub(crate) fn new(scene: &Scene, pack: &Pack) -> (Self, Report) {
        let mut twin = Twin::new(scene, pack, 1).unwrap();
        let report = twin.start(Demand::ALL);
        (Self { twin, sequence: 0 }, report)
    }

    pub(crate) fn ask(&mut self, ask: Ask) -> Report {
        self.sequence += 1;
        let command = Command {
            stamp: Stamp::default(),
            session: "test".into(),
            sequence: self.sequence,
            mode: Mode::Absolute,
            ask,
            age: None,
        };
        self.twin.apply(&command, Demand::ALL)
    }

    /// Asks and expects it to be done.
    pub(crate) fn go(&mut self, ask: Ask) -> Measures {
        let report = self.ask(ask);
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
        report.measures.unwrap()
    }

    /// Brings the sides to these stresses along x and y \[Pa\].
    pub(crate) fn stress(&mut self, stress: [f64; 2]) -> Measures {
        let [x, y] = stress.map(WallTarget::Stress);
        self.go(Ask::Targets([x, x, y, y, WallTarget::Keep, WallTarget::Keep]))
    }

    /// Keeps the lateral stress \[Pa\] and moves the platens inwards by `way` each \[m\].
    pub(crate) fn biaxial(&mut self, lateral: f64, way: f64) -> Measures {
        let (x, y) = (WallTarget::Stress(lateral), WallTarget::Displacement(way));
        self.go(Ask::Targets([x, x, y, y, WallTarget::Keep, WallTarget::Keep]))
    }
}

/// A dense pack under `stress` on all sides \[Pa\], made without friction; the grains then have the
/// coefficient `friction`.
pub(crate) fn dense(columns: usize, rows: usize, seed: u64, stress: f64, friction: f64) -> Pack {
    let (mut rig, report) = Rig::new(&sand("none"), &loose(columns, rows, seed, 0.0));
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    rig.stress([stress; 2]);
    let mut pack = rig.twin.pack();
    pack.grains.iter_mut().for_each(|grain| grain.friction = friction);
    pack
}
