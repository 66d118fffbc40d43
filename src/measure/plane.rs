//! What is told of discs alone: stress and contacts away from the walls, their directions, rotation,
//! strain of the network, profiles of rings (VB-45 to VB-49).

pub mod region;
pub mod strain;

use std::f64::consts::TAU;

use crate::analytic::tensor::Tensor;
use crate::contact::Other;
use crate::measure::contacts::{Contact, Contacts};
use crate::model::Model;
use crate::plane::Vec2;
use crate::relax::jump::Pose;
use crate::report::{PlaneState, Polar, Rings};
use crate::state::{Condition, State};
use region::Region;

/// Directions that contacts are counted in.
pub const DIRECTIONS: usize = 36;

/// Most rings of a profile.
const RINGS: usize = 40;

/// What is told of `state` with its `contacts`; the increment began at `before`.
#[must_use]
pub fn state(
    model: &Model,
    state: &State,
    contacts: &Contacts,
    before: Option<&Pose>,
) -> PlaneState {
    let at: Vec<Vec2> = state.position.iter().map(|at| Vec2::new(at.x, at.y)).collect();
    let whole = whole(model, state);
    let margin = 2.0 * model.max_radius;
    let interior = inset(whole, margin);
    let depth = state.bounds(model).sides()[2];
    let counted: Vec<Contact> = contacts.counted().copied().collect();
    let pack = Network { at: &at, contacts: &counted, depth, diameter: 2.0 * model.mean_radius };
    let (stress, contact_density) = pack.stress(&interior, None);
    let sum = strain_of(&at, &counted, before);
    let bonds = state.bonds.iter().filter(|bond| bond.condition != Condition::Bare);
    let broken = bonds.clone().filter(|bond| !bond.holds()).count();
    PlaneState {
        mean_diameter: pack.diameter,
        tilt: state.tilt,
        margin,
        area: interior.area(),
        stress: [stress.xx, stress.yy, stress.xy],
        principal_stress: [stress.major(), stress.minor()],
        principal_direction: stress.direction().unwrap_or(f64::NAN),
        contacts_per_grain: pack.contacts_per_grain(&interior),
        contact_density,
        share_broken: broken as f64 / bonds.count().max(1) as f64,
        mean_rotation: mean_rotation(state),
        network_strain: sum.network,
        contact_strain: sum.printed,
        polar: pack.polar(&interior),
        rings: match whole {
            Region::Ring { .. } => pack.rings(&whole),
            Region::Box { .. } => Rings::default(),
        },
    }
}

/// The contacts of grains.
#[derive(Clone, Copy, Debug)]
pub struct Network<'a> {
    /// Centres of the grains \[m\].
    pub at: &'a [Vec2],
    /// Contacts of these grains.
    pub contacts: &'a [Contact],
    /// Depth of the pack \[m\].
    pub depth: f64,
    /// d̄ \[m\].
    pub diameter: f64,
}

impl Network<'_> {
    /// Stress \[Pa\] and n_c/v (A.83) in `region`, with what of every branch lies in it; about
    /// `centre` xx is the radial and yy the hoop stress. NaN where there is no region.
    #[must_use]
    pub fn stress(&self, region: &Region, centre: Option<Vec2>) -> (Tensor, f64) {
        let mut sum = Tensor::default();
        let mut count = 0.0;
        for contact in self.contacts {
            let from = self.at[contact.first as usize];
            let normal = Vec2::new(contact.normal.x, contact.normal.y);
            let branch = normal * contact.distance;
            let shear = Vec2::new(contact.shear.x, contact.shear.y);
            let force = normal * contact.force + shear;
            for [begin, end] in region.pieces(from, from - branch) {
                let share = end - begin;
                if share <= 0.0 {
                    continue;
                }
                let middle = from - branch * (0.5 * (begin + end));
                let [along, across] = axes(centre.map(|centre| middle - centre));
                let part = |one: Vec2, other: Vec2| share * branch.dot(&one) * force.dot(&other);
                sum.xx += part(along, along);
                sum.yy += part(across, across);
                sum.xy += 0.5 * (part(along, across) + part(across, along));
                count += share;
            }
        }
        let volume = region.area() * self.depth;
        let over = |sum: f64| if volume > 0.0 { sum / volume } else { f64::NAN };
        let stress = Tensor { xx: over(sum.xx), yy: over(sum.yy), xy: over(sum.xy) };
        (stress, over(count * self.diameter.powi(3)))
    }

    /// Mean number of contacts of the grains in `region` that have any.
    fn contacts_per_grain(&self, region: &Region) -> f64 {
        let mut numbers = vec![0_u32; self.at.len()];
        for contact in self.contacts {
            numbers[contact.first as usize] += 1;
            if let Other::Grain(second) = contact.second {
                numbers[second as usize] += 1;
            }
        }
        let inside = self.at.iter().zip(numbers).filter(|(at, _)| region.holds(**at));
        let (count, sum) = inside
            .filter(|(_, number)| *number > 0)
            .fold((0_u32, 0_u32), |(count, sum), (_, number)| (count + 1, sum + number));
        f64::from(sum) / f64::from(count.max(1))
    }

    /// The contacts between grains whose middle is in `region`, by direction.
    #[must_use]
    pub fn polar(&self, region: &Region) -> Polar {
        let zeros = || vec![0.0; DIRECTIONS];
        let mut polar = Polar { contacts: vec![0; DIRECTIONS], normal: zeros(), shear: zeros() };
        for contact in self.contacts {
            let normal = Vec2::new(contact.normal.x, contact.normal.y);
            let middle = self.at[contact.first as usize] - normal * (0.5 * contact.distance);
            if matches!(contact.second, Other::Wall(_)) || !region.holds(middle) {
                continue;
            }
            let shear = normal.y * contact.shear.x - normal.x * contact.shear.y;
            let turns = normal.y.atan2(normal.x).rem_euclid(TAU) / TAU;
            let bin = ((turns * DIRECTIONS as f64) as usize).min(DIRECTIONS - 1);
            for bin in [bin, (bin + DIRECTIONS / 2) % DIRECTIONS] {
                polar.contacts[bin] += 1;
                polar.normal[bin] += contact.force;
                polar.shear[bin] += shear;
            }
        }
        polar
    }

    /// Profiles of the pack that fills `whole`: rings of equal width, none narrower than d̄.
    #[must_use]
    pub fn rings(&self, whole: &Region) -> Rings {
        let Region::Ring { centre, inner, outer } = *whole else { return Rings::default() };
        let count = (((outer - inner) / self.diameter) as usize).clamp(1, RINGS);
        let width = (outer - inner) / count as f64;
        let mut rings = Rings::default();
        for ring in 0..count {
            let inner = inner + width * ring as f64;
            let region = Region::Ring { centre, inner, outer: inner + width };
            let (stress, density) = self.stress(&region, Some(centre));
            rings.radius.push(inner + 0.5 * width);
            rings.radial_stress.push(stress.xx);
            rings.hoop_stress.push(stress.yy);
            rings.contact_density.push(density);
        }
        rings
    }
}

/// Axes of the tensor: radial and to the left of it away from a centre, else x and y.
fn axes(from_centre: Option<Vec2>) -> [Vec2; 2] {
    let away = from_centre.filter(|away| away.norm() > 0.0);
    let along = away.map_or_else(Vec2::x, |away| away / away.norm());
    [along, crate::plane::left_of(along)]
}

/// What the pack fills: between circles where there are some, else the box.
fn whole(model: &Model, state: &State) -> Region {
    let cell = model.plane.as_ref().map(|setup| &setup.cell);
    if let Some(cell) = cell
        && let Some([inner, outer]) = cell.radii(&state.displacement)
    {
        return Region::Ring { centre: cell.centre(), inner, outer };
    }
    let bounds = state.bounds(model);
    let [min, max] = [bounds.min, bounds.max].map(|[x, y, _]| Vec2::new(x, y));
    Region::Box { min, max, tilt: state.tilt, middle: model.start.center()[1] }
}

/// What of `region` is further than `margin` from its walls.
fn inset(region: Region, margin: f64) -> Region {
    match region {
        Region::Box { min, max, tilt, middle } => {
            let off = Vec2::new(margin * tilt.hypot(1.0), margin);
            Region::Box { min: min + off, max: max - off, tilt, middle }
        }
        Region::Ring { centre, inner, outer } => {
            let inner = if inner > 0.0 { inner + margin } else { 0.0 };
            Region::Ring { centre, inner, outer: outer - margin }
        }
    }
}

fn strain_of(at: &[Vec2], contacts: &[Contact], before: Option<&Pose>) -> strain::Strain {
    let Some(before) = before else { return strain::Strain::default() };
    let way: Vec<Vec2> = (at.iter().zip(&before.position))
        .map(|(now, then)| now - Vec2::new(then.x, then.y))
        .collect();
    strain::strain(at, &way, contacts)
}

fn mean_rotation(state: &State) -> f64 {
    let carrying = state.rotation.iter().zip(&state.carries).filter(|(_, carries)| **carries);
    let (count, sum) =
        carrying.fold((0_u32, 0.0), |(count, sum), (turn, _)| (count + 1, sum + turn.z));
    sum / f64::from(count.max(1))
}
