//! What one increment says: the answers of the twin, in SI units, compression positive.

mod cement;

mod motion;

mod fabric;

mod hydrate;

mod plane;

mod rearrangement;

mod shear;

mod tangent;

use serde::Serialize;

use crate::command::{Disposition, Stamp};
use crate::wall;
pub use cement::{BondCondition, Bonds, Crack, Cracks};
pub use motion::{Band, GrainMotion, Localisation};

pub use hydrate::Hydrate;

pub use shear::Shear;

pub use plane::{PlaneState, Polar, Rings};

pub use fabric::{AngularForm, ByAngle, Chains, Directions, Fabric};

pub use rearrangement::{EventEnd, Rearrangement, Snapshot};
pub use tangent::{Tangent, TangentModuli};

/// Which measures somebody wants; what is not wanted is not computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Demand {
    /// Stresses, porosity, coordination, energies: [`PackState`].
    pub state: bool,
    /// Moduli, of the kind that the scene asks for: [`Moduli`].
    pub moduli: bool,
    /// Tangent moduli, where the scene asks for that kind: [`Tangent`].
    pub tangent: bool,
    /// Every contact: [`ContactNetwork`].
    pub contact_network: bool,
    /// Every grain: [`Grains`].
    pub grains: bool,
    /// Displacements and rotations of the grains in the increment: [`GrainMotion`].
    pub grain_motion: bool,
    /// Statistics of the force network: [`Fabric`].
    pub fabric: bool,
    /// Hydrate and pore pressure, where the pack has hydrate: [`Hydrate`].
    pub hydrate: bool,
    /// How a box of discs is sheared: [`Shear`].
    pub shear: bool,
    /// What is measured of discs alone: [`PlaneState`]; nothing of spheres.
    pub plane: bool,
    /// What each event did: [`Rearrangement`].
    pub rearrangements: bool,
    /// All grains before and after each event: [`Snapshot`].
    pub snapshots: bool,
    /// What cement carries: [`Bonds`]; nothing without cement.
    pub bonds: bool,
    /// Which bonds broke: [`Cracks`]; nothing without cement.
    pub cracks: bool,
}

impl Demand {
    /// Everything.
    pub const ALL: Self = Self {
        state: true,
        moduli: true,
        tangent: true,
        contact_network: true,
        grains: true,
        grain_motion: true,
        fabric: true,
        hydrate: true,
        shear: true,
        plane: true,
        rearrangements: true,
        snapshots: true,
        bonds: true,
        cracks: true,
    };

    /// Nothing but what every increment tells.
    pub const NONE: Self = Self {
        state: false,
        moduli: false,
        tangent: false,
        contact_network: false,
        grains: false,
        grain_motion: false,
        fabric: false,
        hydrate: false,
        shear: false,
        plane: false,
        rearrangements: false,
        snapshots: false,
        bonds: false,
        cracks: false,
    };

    /// What this or the `other` wants.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            state: self.state || other.state,
            moduli: self.moduli || other.moduli,
            tangent: self.tangent || other.tangent,
            contact_network: self.contact_network || other.contact_network,
            grains: self.grains || other.grains,
            grain_motion: self.grain_motion || other.grain_motion,
            fabric: self.fabric || other.fabric,
            hydrate: self.hydrate || other.hydrate,
            shear: self.shear || other.shear,
            plane: self.plane || other.plane,
            rearrangements: self.rearrangements || other.rearrangements,
            snapshots: self.snapshots || other.snapshots,
            bonds: self.bonds || other.bonds,
            cracks: self.cracks || other.cracks,
        }
    }
}

/// What became of one command.
#[derive(Clone, Debug)]
pub struct Report {
    /// Stamp of the command.
    pub stamp: Stamp,
    /// Session of the command.
    pub session: String,
    /// Sequence of the command.
    pub sequence: u64,
    /// The increment after the command: one more than before when it was served, else unchanged.
    pub increment: u64,
    /// What became of it.
    pub disposition: Disposition,
    /// Equilibria that were found on the way.
    pub substeps: u32,
    /// One sentence for a person; empty when there is nothing to say.
    pub text: String,
    /// The new state as measured; `None` when the walls did not move, and for a command that was
    /// merged into a later one.
    pub measures: Option<Measures>,
}

/// Measures of one equilibrium.
#[derive(Clone, Debug)]
pub struct Measures {
    /// Stamp of the command served.
    pub stamp: Stamp,
    /// 0 for the initial equilibrium, then one more per command served.
    pub increment: u64,
    /// Sudden changes on the way to this equilibrium, in order.
    pub events: Vec<Event>,
    /// The same events in full, where [`Demand::rearrangements`] was set.
    pub rearrangements: Vec<Rearrangement>,
    /// Two for each stress drop among them, before and after, where [`Demand::snapshots`] was set.
    pub snapshots: Vec<Snapshot>,
    /// Forces on the walls.
    pub walls: WallForces,
    /// Estimate of the largest error of a wall's normal force \[N\] against the exact equilibrium;
    /// it bounds the error in nearly all increments (`docs/accuracy.md`).
    pub wall_force_error: f64,
    /// Present when [`Demand::state`] was set.
    pub state: Option<PackState>,
    /// Present when [`Demand::moduli`] was set.
    pub moduli: Option<Moduli>,
    /// Present when [`Demand::tangent`] was set and the scene asks for that kind of moduli.
    pub tangent: Option<Tangent>,
    /// Present when [`Demand::contact_network`] was set.
    pub network: Option<ContactNetwork>,
    /// Present when [`Demand::grains`] was set.
    pub grains: Option<Grains>,
    /// The membranes on spheres, when [`Demand::grains`] was set.
    pub surfaces: Vec<Surface>,
    /// Present when [`Demand::grain_motion`] was set, or [`Demand::grains`] with a scene whose pictures
    /// show it, unless the scene says never.
    pub motion: Option<GrainMotion>,
    /// Present when [`Demand::fabric`] was set.
    pub fabric: Option<Fabric>,
    /// Present when [`Demand::hydrate`] was set and the pack has hydrate.
    pub hydrate: Option<Hydrate>,
    /// Present when [`Demand::shear`] was set and the grains are discs.
    pub shear: Option<Shear>,
    /// Present when [`Demand::plane`] was set and the scene is of discs.
    pub plane: Option<PlaneState>,
    /// Present when [`Demand::bonds`] was set and the scene has cement.
    pub bonds: Option<Bonds>,
    /// Present when [`Demand::cracks`] was set and the scene has cement.
    pub cracks: Option<Cracks>,
}

/// The surface of a membrane on spheres.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Its side.
    pub side: usize,
    /// Corners of its triangles, to the left as seen from outside of the pack \[m\].
    pub triangles: Vec<[[f64; 3]; 3]>,
}

/// What kind of event, as `graintwin_msgs/Event` numbers it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[repr(u8)]
pub enum EventKind {
    /// The pack lost its stability and came to another equilibrium while the walls stood still.
    StressDrop = 0,
    /// Cement broke.
    ContactBreak = 1,
}

/// A sudden change inside the pack.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Event {
    /// What happened.
    pub kind: EventKind,
    /// Confining stress of the contacts where stability was lost \[Pa\]: a third of the trace of
    /// the Love-Weber stress, at the walls of `stress_after`. Of a crack that of the equilibrium in
    /// which it broke.
    pub stress_before: f64,
    /// The same at the equilibrium that followed \[Pa\].
    pub stress_after: f64,
    /// Energy that the pack lost between the two, beyond what slip took \[J\].
    pub energy_released: f64,
    /// Grains that carry load and went further than the mean overlap, in the order of the pack
    /// file. Of a crack its two bodies, a wall as the contact network names it.
    pub grains: Vec<u32>,
    /// How far each of them went from where stability was lost, or the bond broke \[m\].
    pub displacement: Vec<f64>,
}

/// Forces on the six walls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct WallForces {
    /// Normal force \[N\], negative only where cement pulls.
    pub normal_force: [f64; wall::COUNT],
    /// Inward displacement since the start of the run \[m\].
    pub displacement: [f64; wall::COUNT],
    /// Position along the wall's own axis \[m\].
    pub position: [f64; wall::COUNT],
    /// Force that the pack exerts on the wall \[N\].
    pub force: [[f64; 3]; wall::COUNT],
    /// Moment of these forces about the pack's centre \[N m\].
    pub moment: [[f64; 3]; wall::COUNT],
}

/// The pack as a whole.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PackState {
    /// Engineering strain of the box since the start (T 2.10 with the sign of compression).
    pub strain: [f64; 3],
    /// Logarithmic strain of the box since the start.
    pub natural_strain: [f64; 3],
    /// Stress from the wall forces on the current areas \[Pa\], row major (T 2.11).
    pub stress_walls: [f64; 9],
    /// Love-Weber stress from the contacts \[Pa\], row major (T 2.13, halved as it must be).
    pub stress_contacts: [f64; 9],
    /// Trace of the wall stress over three, of discs over two \[Pa\].
    pub confining_stress: f64,
    /// Axial stress (z) minus the mean of the other two, of discs that along y minus that along x
    /// \[Pa\].
    pub deviatoric_stress: f64,
    /// Pore volume over total volume (T 2.19).
    pub porosity: f64,
    /// (2 grain-grain + grain-wall contacts) / grains.
    pub coordination_number: f64,
    /// Sliding contacts over all contacts: those whose tangential force is at μP (T 3.6.2).
    pub sliding_ratio: f64,
    /// Contacts that slid in the increment. With a limit frozen at its start they can end below μP.
    pub slipped: u32,
    /// Mean normal force of a contact \[N\].
    pub mean_normal_force: f64,
    /// Mean magnitude of the tangential force of a contact \[N\].
    pub mean_tangential_force: f64,
    /// Largest couple of opposite walls about the pack's centre, as a pair of forces the box
    /// apart, over the normal force on them (T 3.5).
    pub wall_couple: f64,
    /// Largest part of a tangential force that the limit of the present normal force would
    /// change, over the mean normal force: what freezing the limit within the increment costs.
    pub friction_defect: f64,
    /// Contacts that lost their shear in the increment because they opened.
    pub opened: u32,
    /// Contacts that formed in the increment, without shear as yet.
    pub formed: u32,
    /// Elastic and gravitational energy \[J\].
    pub stored_energy: f64,
    /// Part of it in shear and torsion of the contacts \[J\].
    pub shear_energy: f64,
    /// Energy that slip took since the start \[J\]; part of `dissipated_energy`.
    pub slip_energy: f64,
    /// Energy lost since the start where the law forgets \[J\]: contacts that opened under shear,
    /// stiffnesses renewed under load (a gain when negative); part of `dissipated_energy`.
    pub renewal_energy: f64,
    /// Energy that the stress drops since the start released \[J\]; part of `dissipated_energy`.
    pub event_energy: f64,
    /// Energy lost since the start with bonds that broke \[J\]; part of `dissipated_energy`.
    pub broken_energy: f64,
    /// Work of the walls since the start, trapezoidal over the equilibria \[J\].
    pub wall_work: f64,
    /// Energy lost in events, sliding and breaking since the start \[J\].
    pub dissipated_energy: f64,
    /// Load-carrying contacts.
    pub contacts: u32,
    /// Grains that carry no load.
    pub rattlers: u32,
    /// Steps of the solver's method in the increment.
    pub iterations: u32,
    /// Residual of the equilibrium, relative to the mean contact force.
    pub residual: f64,
    /// Wall-clock time of the increment \[s\]; the twin has no clock, whoever serves it fills this in.
    pub solve_seconds: f64,
    /// Whether the residual is below the tolerance.
    pub converged: bool,
}

/// Elastic moduli \[Pa\]; NaN where the path cannot tell one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Moduli {
    /// Whether at least one modulus is known.
    pub valid: bool,
    /// Bulk modulus K.
    pub bulk: f64,
    /// Shear modulus G.
    pub shear: f64,
    /// Young's modulus E.
    pub young: f64,
    /// Poisson's ratio ν \[1\].
    pub poisson: f64,
    /// Lamé's first parameter λ.
    pub lame: f64,
    /// P-wave modulus K + 4/3 G.
    pub p_wave: f64,
    /// dσ_l/dε_m over xx, yy, zz, row major; NaN when not asked for.
    pub tangent: [f64; 9],
    /// Compressional wave speed (T 2.20a) \[m/s\].
    pub p_speed: f64,
    /// Shear wave speed (T 2.20b) \[m/s\].
    pub s_speed: f64,
}

/// A contact's state as `graintwin_msgs/ContactNetwork` numbers it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum ContactState {
    /// Carries its load without slipping.
    Stick = 0,
    /// Slides at the Coulomb limit.
    Slide = 1,
    /// Held together by cement.
    Bonded = 2,
    /// Its cement broke.
    Broken = 3,
}

/// Every load-carrying contact, sorted by (first, second).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactNetwork {
    /// Grain index in the order of the pack file.
    pub first: Vec<u32>,
    /// Grain index, or `u32::MAX - w` for wall w.
    pub second: Vec<u32>,
    /// Unit normal from second to first, three numbers a contact.
    pub normal: Vec<f64>,
    /// Normal force \[N\].
    pub normal_force: Vec<f64>,
    /// Tangential force on `first` \[N\], three numbers a contact.
    pub tangential_force: Vec<f64>,
    /// Overlap h \[m\].
    pub overlap: Vec<f64>,
    /// [`ContactState`] as a number.
    pub state: Vec<u8>,
}

/// Every grain, in the order of the pack file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Grains {
    /// Centre \[m\].
    pub position: Vec<[f64; 3]>,
    /// Radius \[m\].
    pub radius: Vec<f64>,
    /// Mean pressure \[Pa\]: a third of the trace of the grain's Love-Weber stress, half of a disc's.
    pub pressure: Vec<f64>,
    /// Way of the centre since the start of the run, from where the pack as given had it \[m\].
    pub displacement: Vec<[f64; 3]>,
    /// Turn of a disc about z \[rad\]; empty for spheres and without friction.
    pub turn: Vec<f64>,
}
