//! A sample of discs between its walls, and the tests on it.

use std::path::Path;

use graintwin::analytic::contact;
use graintwin::analytic::fit::record;
use graintwin::command::{Ask, Command, Disposition, Mode, Stamp};
use graintwin::pack::{self, Pack};
use graintwin::report::{BondCondition, Crack, Demand, PackState, Report};
use graintwin::scene::{self, Loaded, Scene};
use graintwin::twin::Twin;
use graintwin::wall::{self, WallTarget};

use super::{DIAMETER, INCREMENT};
use crate::specimen::TOLERANCE;

/// The scene with these lines in its `pack`, and its `contact` and keys of its `solver`.
pub(crate) fn scene(pack: &str, contact: &str, solver: &str) -> Loaded {
    surrounded(pack, "friction: 0.0", contact, solver)
}

/// The same with these keys of its `walls`.
pub(crate) fn surrounded(pack: &str, walls: &str, contact: &str, solver: &str) -> Loaded {
    let text = format!(
        "dimension: 2\n\
         materials: {{sand: {{young: 2.32e9, poisson: 0.16, density: 2650.0}}}}\n\
         pack:\n{pack}\nwalls: {{{walls}}}\ncontact: {contact}\n\
         solver: {{tolerance: {TOLERANCE:e}, {solver}}}\n"
    );
    let scene = scene::parse(&text, Path::new("validation.yaml")).expect("the scene is right");
    Loaded { scene, file: "validation.yaml".into() }
}

/// The pack of a scene.
pub(crate) fn made(loaded: &Loaded) -> Pack {
    pack::build(loaded).expect("the pack is found")
}

/// The pack of a scene, or nothing where it does not come to rest.
pub(crate) fn made_if(loaded: &Loaded) -> Option<Pack> {
    pack::build(loaded).map_err(|error| println!("    {error}")).ok()
}

/// A sample between its walls.
pub(crate) struct Rig {
    twin: Twin,
    sequence: u64,
    /// Height at the start \[m\].
    height: f64,
    volume: f64,
    /// The last equilibrium.
    pub(crate) last: PackState,
    /// Inward displacement of the side walls and of the platens \[m\].
    sides: [f64; 2],
    travel: [f64; 2],
}

/// What a test was, from its isotropic or first state on; a place for each equilibrium.
#[derive(Clone, Debug, Default)]
pub(crate) struct Course {
    /// ε1.
    pub(crate) axial: Vec<f64>,
    /// ε1 + ε3.
    pub(crate) area: Vec<f64>,
    /// σ1 on the platens \[Pa\].
    pub(crate) major: Vec<f64>,
    /// σ3 on the side walls \[Pa\].
    pub(crate) minor: Vec<f64>,
    /// Contacts a grain.
    pub(crate) coordination: Vec<f64>,
    /// Bonds that broke so far.
    pub(crate) broken: Vec<u32>,
    /// They themselves, in order.
    pub(crate) cracks: Vec<Crack>,
    /// Bonds at the start.
    pub(crate) bonds: u32,
    /// n_c/v at the start (A.82).
    pub(crate) density: f64,
    /// Whether every increment found an equilibrium.
    pub(crate) whole: bool,
}

impl Rig {
    /// Puts `pack` between the walls.
    pub(crate) fn new(scene: &Scene, pack: &Pack) -> Self {
        let mut twin = Twin::new(scene, pack, 1).expect("the pack has grains");
        let report = twin.start(Demand { state: true, ..Demand::NONE });
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
        let last = report.measures.and_then(|measures| measures.state).expect("it was asked for");
        let height = pack.bounds.sides()[1];
        Self {
            twin,
            sequence: 0,
            height,
            volume: pack.bounds.volume(),
            last,
            sides: [0.0; 2],
            travel: [0.0; 2],
        }
    }

    fn ask(&mut self, targets: [WallTarget; wall::COUNT]) -> Report {
        self.go(targets, Demand { state: true, cracks: true, ..Demand::NONE })
    }

    /// Brings the sides to `targets` and measures what `demand` names.
    pub(crate) fn go(&mut self, targets: [WallTarget; wall::COUNT], demand: Demand) -> Report {
        self.sequence += 1;
        let command = Command {
            stamp: Stamp::default(),
            session: "validation".into(),
            sequence: self.sequence,
            mode: Mode::Absolute,
            ask: Ask::Targets(targets),
            age: None,
        };
        let report = self.twin.apply(&command, demand);
        if let Some(state) = report.measures.as_ref().and_then(|measures| measures.state) {
            self.last = state;
        }
        report
    }

    /// Brings all sides to `stress` \[Pa\].
    pub(crate) fn isotropic(&mut self, stress: f64) {
        let side = WallTarget::Stress(stress);
        let keep = WallTarget::Keep;
        let report = self.ask([side, side, side, side, keep, keep]);
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
        let measures = report.measures.expect("it was served");
        self.sides = [0, 1].map(|side| measures.walls.displacement[side]);
        self.travel = [2, 3].map(|side| measures.walls.displacement[side]);
    }

    /// Strains the sample along y in steps of [`INCREMENT`] with σ3 as it is, or with the sides
    /// standing, until `end` says so.
    pub(crate) fn press(
        &mut self,
        lateral: Option<f64>,
        mut end: impl FnMut(&Course) -> bool,
    ) -> Course {
        let mut course = Course { whole: true, ..Course::default() };
        let start = self.last;
        course.density = contact::density(f64::from(start.contacts), DIAMETER, self.volume);
        course.take(&start, &start);
        // A wall that carries a load keeps it unless it is asked to stand.
        let [left, right] =
            self.sides.map(|at| lateral.map_or(WallTarget::Displacement(at), WallTarget::Stress));
        let keep = WallTarget::Keep;
        while !end(&course) {
            self.travel = self.travel.map(|travel| travel + 0.5 * INCREMENT * self.height);
            let [low, high] = self.travel.map(WallTarget::Displacement);
            let report = self.ask([left, right, low, high, keep, keep]);
            if report.disposition != Disposition::Applied {
                println!("    {:?}: {}", report.disposition, report.text);
                course.whole = false;
                break;
            }
            course.take(&self.last, &start);
            if let Some(cracks) = report.measures.and_then(|measures| measures.cracks) {
                course.bonds = cracks.bonds();
                course.cracks.extend(cracks.list);
            }
            *course.broken.last_mut().expect("one was taken") = course.cracks.len() as u32;
        }
        course
    }
}

impl Course {
    fn take(&mut self, now: &PackState, start: &PackState) {
        let strain = [0, 1].map(|axis| now.strain[axis] - start.strain[axis]);
        self.axial.push(strain[1]);
        self.area.push(strain[0] + strain[1]);
        self.major.push(now.stress_walls[4]);
        self.minor.push(now.stress_walls[0]);
        self.coordination.push(now.coordination_number);
        self.broken.push(self.cracks.len() as u32);
    }

    /// The strain so far.
    pub(crate) fn strain(&self) -> f64 {
        self.axial.last().copied().unwrap_or(0.0)
    }

    /// σ1 now \[Pa\].
    pub(crate) fn pressed(&self) -> f64 {
        self.major.last().copied().unwrap_or(0.0)
    }

    /// σ1 - σ3 \[Pa\].
    pub(crate) fn deviator(&self) -> Vec<f64> {
        self.major.iter().zip(&self.minor).map(|(major, minor)| major - minor).collect()
    }

    /// The place of the greatest deviator.
    pub(crate) fn peak(&self) -> usize {
        record::peak(&self.deviator()).expect("stresses are numbers")
    }

    /// Share of the bonds that were broken at the peak.
    pub(crate) fn broken_share(&self) -> f64 {
        f64::from(self.broken[self.peak()]) / f64::from(self.bonds.max(1))
    }

    /// Share of the cracks up to the peak, or of all, that broke by tension.
    pub(crate) fn tension_share(&self, all: bool) -> f64 {
        let cracks = self.cracks_until(all);
        let tension = cracks.iter().filter(|crack| crack.mode == BondCondition::Tension).count();
        tension as f64 / cracks.len() as f64
    }

    /// Share of the cracks within 45° of the axis: their contacts are nearer to x than to y.
    pub(crate) fn axial_share(&self, all: bool) -> f64 {
        let cracks = self.cracks_until(all);
        let axial = cracks.iter().filter(|crack| crack.normal[0].abs() > crack.normal[1].abs());
        axial.count() as f64 / cracks.len() as f64
    }

    fn cracks_until(&self, all: bool) -> &[Crack] {
        let place = if all { self.broken.len() - 1 } else { self.peak() };
        &self.cracks[..self.broken[place] as usize]
    }
}
