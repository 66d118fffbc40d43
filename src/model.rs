//! What stays constant after loading: grains, walls, laws and settings, in the solver's own order.
//!
//! Radii and weights follow from the grains as loaded and from what dissociation has done to them,
//! two numbers of the state ([`hydrate`]).

pub mod cement;
pub mod hydrate;

use crate::Vec3;
use crate::contact::{Other, hertz, mindlin};
use crate::pack::{Grain, Pack};
use crate::plane;
use crate::scene::{self, Cement, Coulomb, Law, Scene, Solver, Update, Walls};
use crate::wall::{self, Bounds, Room};
use hydrate::Hydrate;

/// Streams into which the grains are cut, then dealt one after the other.
///
/// Successive rows of the triangular sweeps then lie far apart in the pack and do not wait
/// for each other.
const STREAMS: usize = 4;

/// Least grains of a part: what is gained on a second core must be more than the separators cost.
const PART: usize = 5000;
/// Most parts.
pub(crate) const MOST_PARTS: usize = 8;

/// Approach of cement over the mean radius whose force is faint.
const FAINT_STRAIN: f64 = 1e-6;
/// Roundings that a contact's force may be off by.
const ROUNDINGS: f64 = 10.0;

/// Constants of a specimen. Arrays have one entry a grain, in the solver's order.
#[derive(Clone, Debug)]
pub struct Model {
    /// Grain index in the pack file of each grain here, shape (n).
    pub order: Vec<u32>,
    /// Constants of each grain; positions and radii are those at load.
    pub grains: Vec<Grain>,
    /// Radii R now \[m\], shape (n).
    pub radius: Vec<f64>,
    /// (1-ν²)/E of each grain \[1/Pa\], shape (n).
    pub compliance: Vec<f64>,
    /// (1-ν²)/E of the walls \[1/Pa\].
    pub wall_compliance: f64,
    /// Weight of each grain \[N\]; empty without gravity.
    pub weight: Vec<Vec3>,
    /// Arithmetic mean of the radii R̄ \[m\].
    pub mean_radius: f64,
    /// Largest radius \[m\].
    pub max_radius: f64,
    /// Box at load.
    pub start: Bounds,
    /// Box that engineering strain refers to.
    pub reference: Bounds,
    /// Settings of the relaxation.
    pub solver: Solver,
    /// Gravitational acceleration \[m/s²\].
    pub gravity: Vec3,
    /// The grains that are hydrate, and what became of them.
    pub hydrate: Hydrate,
    /// Friction and cement in shear; `None` when no contact can carry shear, and then no rotation is
    /// solved for.
    pub friction: Option<Friction>,
    /// Cement.
    pub cement: Option<Cement>,
    /// Mean contact force below which residuals are those of this force \[N\]: cement can be free of
    /// any load, and so can discs that just touch. 0 without cement and linear contacts.
    pub least_force: f64,
    /// What surrounds spheres besides six plane walls; `None` for these and for discs.
    pub cell: Option<plane::Cell>,
    /// What makes the grains discs; `None` for spheres.
    pub plane: Option<plane::Setup>,
    /// What the rounding of coordinates makes of cement, or of discs, that are free of load \[N\]; 0
    /// without cement and linear contacts.
    pub rounding_force: f64,
}

/// Constants of the frictional laws. Arrays have one entry a grain, in the solver's order.
#[derive(Clone, Debug)]
pub struct Friction {
    /// How the tangential force follows the tangential displacement.
    pub law: Law,
    /// Which normal force limits it.
    pub update: Update,
    /// Whether contacts resist torsion.
    pub torsion: bool,
    /// Coefficient μ of each grain; of two grains the smaller one counts.
    pub coefficient: Vec<f64>,
    /// Coefficient between grains and walls.
    pub wall_coefficient: f64,
    /// (2-ν)/G of each grain \[1/Pa\] (T 3.5a).
    pub shear_compliance: Vec<f64>,
    /// (2-ν)/G of the walls \[1/Pa\].
    pub wall_shear_compliance: f64,
    /// 1/G of each grain \[1/Pa\] (T 3.9a).
    pub torsion_compliance: Vec<f64>,
    /// 1/G of the walls \[1/Pa\].
    pub wall_torsion_compliance: f64,
}

impl Friction {
    /// Of `grains` and `walls`; `None` when no coefficient is above zero.
    #[must_use]
    pub fn new(grains: &[Grain], walls: &Walls, coulomb: &Coulomb, torsion: bool) -> Option<Self> {
        let wall_coefficient = walls.friction.unwrap_or(coulomb.coefficient);
        if wall_coefficient == 0.0 && grains.iter().all(|grain| grain.friction == 0.0) {
            return None;
        }
        Some(Self {
            law: coulomb.law,
            update: coulomb.update,
            coefficient: grains.iter().map(|g| g.friction).collect(),
            wall_coefficient,
            ..Self::smooth(grains, walls, torsion)
        })
    }

    /// Of grains and walls that slide freely where no cement holds them.
    #[must_use]
    pub fn smooth(grains: &[Grain], walls: &Walls, torsion: bool) -> Self {
        let shear = |young: f64, poisson: f64| mindlin::shear_compliance(young, poisson);
        let torsional = |young: f64, poisson: f64| mindlin::torsion_compliance(young, poisson);
        Self {
            law: Law::ReturnMap,
            update: Update::Frozen,
            torsion,
            coefficient: vec![0.0; grains.len()],
            wall_coefficient: 0.0,
            shear_compliance: grains.iter().map(|g| shear(g.young, g.poisson)).collect(),
            wall_shear_compliance: shear(walls.young, walls.poisson),
            torsion_compliance: grains.iter().map(|g| torsional(g.young, g.poisson)).collect(),
            wall_torsion_compliance: torsional(walls.young, walls.poisson),
        }
    }
}

impl Friction {
    /// Whether nothing but cement resists sliding.
    #[must_use]
    pub fn is_smooth(&self) -> bool {
        self.wall_coefficient == 0.0 && self.coefficient.iter().all(|&mu| mu == 0.0)
    }

    /// μ between grain `first` and `second`.
    #[must_use]
    pub fn between(&self, first: u32, second: Other) -> f64 {
        match second {
            Other::Grain(j) => self.coefficient[j as usize].min(self.coefficient[first as usize]),
            Other::Wall(_) => self.wall_coefficient,
        }
    }
}

impl Model {
    /// The model of `pack` under the walls, gravity and solver of `scene`.
    #[must_use]
    pub fn new(pack: &Pack, scene: &Scene) -> Self {
        let mut model =
            Self::with(pack, &scene.walls, scene.gravity, scene.solver, scene.reference);
        let torsion = scene.contact.torsion;
        if let scene::Friction::Coulomb(coulomb) = &scene.contact.friction {
            model.friction = Friction::new(&model.grains, &scene.walls, coulomb, torsion);
        }
        if let scene::Normal::Cement(cement) = scene.contact.normal {
            model.cement = Some(cement);
            let stiffness = model.typical_stiffness();
            model.least_force = stiffness * FAINT_STRAIN * model.mean_radius;
            model.rounding_force = stiffness * ROUNDINGS * f64::EPSILON * furthest(&pack.bounds);
            let smooth = || Friction::smooth(&model.grains, &scene.walls, torsion);
            model.friction = model.friction.or_else(|| Some(smooth()));
        }
        if scene.dimension == 2 {
            if matches!(scene.contact.normal, scene::Normal::Linear(linear) if linear.bond.is_some())
            {
                let smooth = || Friction::smooth(&model.grains, &scene.walls, torsion);
                model.friction = model.friction.or_else(|| Some(smooth()));
            }
            let setup = plane::Setup::new(&model, scene);
            if let plane::Law::Linear { normal, .. } = setup.law {
                model.least_force = normal * FAINT_STRAIN * model.mean_radius;
                model.rounding_force = normal * ROUNDINGS * f64::EPSILON * furthest(&pack.bounds);
            }
            model.plane = Some(setup);
            model.cell = None;
        }
        model.hydrate = Hydrate::of(&model);
        model
    }

    /// A frictionless model, from the parts of a scene.
    #[must_use]
    pub fn with(
        pack: &Pack,
        walls: &Walls,
        gravity: [f64; 3],
        solver: Solver,
        reference: Option<Bounds>,
    ) -> Self {
        let order = solver_order(pack);
        let grains: Vec<Grain> = order.iter().map(|&g| pack.grains[g as usize]).collect();
        let count = grains.len().max(1) as f64;
        let gravity = Vec3::from(gravity);
        let weight = if gravity == Vec3::zeros() {
            Vec::new()
        } else {
            grains.iter().map(|g| gravity * (g.density * sphere_volume(g.radius))).collect()
        };
        Self {
            order,
            radius: grains.iter().map(|g| g.radius).collect(),
            compliance: grains.iter().map(|g| hertz::compliance(g.young, g.poisson)).collect(),
            wall_compliance: hertz::compliance(walls.young, walls.poisson),
            weight,
            mean_radius: grains.iter().map(|g| g.radius).sum::<f64>() / count,
            max_radius: grains.iter().map(|g| g.radius).fold(0.0, f64::max),
            start: pack.bounds,
            reference: reference.unwrap_or(pack.bounds),
            solver,
            gravity,
            hydrate: Hydrate::default(),
            friction: None,
            cement: None,
            least_force: 0.0,
            cell: plane::Cell::of_spheres(walls, &pack.bounds),
            plane: None,
            rounding_force: 0.0,
            grains,
        }
    }

    /// Volume of a grain of radius `radius` \[m\]: of a sphere, or of a disc as deep as the pack \[m³\].
    #[must_use]
    pub fn grain_volume(&self, radius: f64) -> f64 {
        self.plane.as_ref().map_or_else(|| sphere_volume(radius), |plane| plane.volume(radius))
    }

    /// 3 for spheres, 2 for discs.
    #[must_use]
    pub fn dimensions(&self) -> u8 {
        if self.plane.is_some() { 2 } else { 3 }
    }

    /// The room between the walls displaced inwards by `displacement` \[m\].
    #[must_use]
    pub fn bounds(&self, displacement: &[f64; wall::COUNT]) -> Room {
        match (&self.plane, &self.cell) {
            (None, None) => self.start.displaced(displacement).into(),
            (None, Some(cell)) => cell.room(displacement),
            (Some(setup), _) => setup.cell.bounds(displacement).into(),
        }
    }

    /// Whether spheres are in a cylinder.
    #[must_use]
    pub fn is_round(&self) -> bool {
        self.cell.as_ref().is_some_and(|cell| cell.inner.is_some())
    }

    /// R* of grain `i` at wall `w` \[m\]: √(R' R'') of the relative radii of curvature, which is its
    /// own radius r at a plane and r / √(1 ± r/R) at a cylinder of radius R that bends away from it or
    /// around it.
    #[must_use]
    pub fn wall_radius(&self, i: usize, w: usize) -> f64 {
        let radius = self.radius[i];
        match self.cell.as_ref().and_then(|cell| cell.curvature(w)) {
            None => radius,
            Some(curvature) => radius / (1.0 + radius * curvature).sqrt(),
        }
    }

    /// Area of wall `w` then \[m²\].
    #[must_use]
    pub fn wall_area(&self, w: usize, displacement: &[f64; wall::COUNT]) -> f64 {
        match &self.plane {
            None => self.bounds(displacement).area(w),
            Some(setup) => setup.cell.area(w, displacement),
        }
    }

    /// Number of grains.
    #[must_use]
    pub fn len(&self) -> usize {
        self.radius.len()
    }

    /// Whether there is no grain.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.radius.is_empty()
    }

    /// Whether grains have weight.
    #[must_use]
    pub fn has_gravity(&self) -> bool {
        !self.weight.is_empty()
    }

    /// Whether the contact forces are the gradient of a potential. With friction only those of the
    /// radial return are.
    #[must_use]
    pub fn has_potential(&self) -> bool {
        self.friction.as_ref().is_none_or(|friction| friction.law == Law::ReturnMap)
    }

    /// Contacts that a grain needs to carry load without friction: four, or three under its weight.
    #[must_use]
    pub fn contacts_to_carry(&self) -> u32 {
        if self.has_gravity() { 3 } else { 4 }
    }

    /// Stiffness of a contact whose overlap is 1e-2 of the mean radius \[N/m\].
    fn typical_stiffness(&self) -> f64 {
        let compliance = self.compliance.iter().sum::<f64>() / self.len().max(1) as f64;
        let modulus = hertz::modulus(0.5 * self.mean_radius, 2.0 * compliance);
        hertz::stiffness(modulus, 1e-2 * self.mean_radius)
    }

    /// Force of a contact that is as good as open \[N\]: an overlap of 1e-7 of the mean radius,
    /// where positions in double precision cannot resolve a residual any more.
    #[must_use]
    pub fn negligible_force(&self) -> f64 {
        let compliance = self.compliance.iter().sum::<f64>() / self.len().max(1) as f64;
        let modulus = hertz::modulus(0.5 * self.mean_radius, 2.0 * compliance);
        hertz::force(modulus, 1e-7 * self.mean_radius)
    }
}

/// Largest coordinate of a box \[m\].
fn furthest(bounds: &Bounds) -> f64 {
    bounds.min.iter().chain(&bounds.max).fold(0.0, |far, x| far.max(x.abs()))
}

/// Volume of a sphere \[m³\].
#[must_use]
pub fn sphere_volume(radius: f64) -> f64 {
    4.0 / 3.0 * std::f64::consts::PI * radius.powi(3)
}

/// Parts into which the order of `n` grains is cut, so that several threads can work on it.
#[must_use]
pub fn parts(n: usize) -> usize {
    let most = (n / PART).clamp(1, MOST_PARTS);
    1 << most.ilog2()
}

/// Grains along a Morton curve through the box, cut into [`parts`], each of them cut into
/// [`STREAMS`] and dealt in turn.
fn solver_order(pack: &Pack) -> Vec<u32> {
    let sides = pack.bounds.sides();
    let key = |g: &Grain| -> u64 {
        let cell: [u64; 3] = std::array::from_fn(|axis| {
            let at = (g.position[axis] - pack.bounds.min[axis]) / sides[axis];
            (at.clamp(0.0, 1.0) * 1023.0) as u64
        });
        spread_bits(cell[0]) | spread_bits(cell[1]) << 1 | spread_bits(cell[2]) << 2
    };
    let mut curve: Vec<u32> = (0..pack.grains.len() as u32).collect();
    curve.sort_by_key(|&g| (key(&pack.grains[g as usize]), g));
    let part = curve.len().div_ceil(parts(curve.len())).max(1);
    let mut order = Vec::with_capacity(curve.len());
    for curve in curve.chunks(part) {
        let length = curve.len().div_ceil(STREAMS);
        let dealt = (0..length).flat_map(|k| (0..STREAMS).map(move |s| (s * length + k, s)));
        order.extend(
            dealt.filter_map(|(k, s)| curve.get(k).filter(|_| k < (s + 1) * length).copied()),
        );
    }
    order
}

/// Ten bits of `cell`, each followed by two zeros.
fn spread_bits(cell: u64) -> u64 {
    (0..10).map(|bit| (cell >> bit & 1) << (3 * bit)).sum()
}
