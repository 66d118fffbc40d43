//! Choosing the grains that are hydrate (T 5.2.1).

use rand::SeedableRng;
use rand_pcg::Pcg64;

use super::generate::{GenerateError, compact};
use super::{Grain, Pack, properties};
use crate::contact::neighbours::Neighbours;
use crate::measure::contacts::Contacts;
use crate::measure::porosity::{pores, solids};
use crate::model::Model;
use crate::scene::{Material, Solver, Walls};
use crate::state::State;

/// Set apart from the stream that a pack itself is drawn from.
const STREAM: u64 = 0x6879_6472_6174_6500;
/// Most times that a pack is brought back to its stress with other grains of hydrate.
const ROUNDS: u32 = 5;

/// Hydrate for a pack.
#[derive(Clone, Copy, Debug)]
pub struct Filling<'a> {
    /// Saturation wanted, counted as in [`crate::model::hydrate`].
    pub saturation: f64,
    /// What hydrate is made of.
    pub material: &'a Material,
    /// Seed of its spread.
    pub seed: u64,
}

/// The smallest grains of `pack`, in the order of radius and then of the file, become hydrate:
/// at least one, and as many as bring the saturation closest to the one wanted. Nothing moves.
#[must_use]
pub fn fill(pack: &Pack, filling: &Filling<'_>) -> Pack {
    let hydrate = of_hydrate(pack, filling);
    let chosen = chosen(pack, filling.saturation);
    with(pack, &pack.grains, &hydrate, &chosen)
}

/// The same for a pack whose three normal stresses are `stress` \[Pa\]: it is brought back to them
/// with the stiffness of the hydrate. The box follows, and with it how many grains are needed.
///
/// # Errors
/// When no equilibrium at that stress is found.
pub fn fill_at(
    pack: &Pack,
    filling: &Filling<'_>,
    stress: f64,
    walls: &Walls,
    solver: Solver,
) -> Result<Pack, GenerateError> {
    let (others, hydrate) = (&pack.grains, of_hydrate(pack, filling));
    let mut filled = pack.clone();
    for _ in 0..ROUNDS {
        let chosen = chosen(&filled, filling.saturation);
        if filled.grains.iter().map(|grain| grain.hydrate).eq(chosen.iter().copied()) {
            break;
        }
        filled = compact(&with(&filled, others, &hydrate, &chosen), stress, walls, solver)?;
    }
    Ok(filled)
}

/// `pack` with the grains that are `chosen` of hydrate and the rest as in `others`.
fn with(pack: &Pack, others: &[Grain], hydrate: &[Grain], chosen: &[bool]) -> Pack {
    let mut filled = pack.clone();
    for (k, grain) in filled.grains.iter_mut().enumerate() {
        let Grain { position, radius, .. } = *grain;
        *grain = Grain { position, radius, ..if chosen[k] { hydrate[k] } else { others[k] } };
    }
    filled
}

/// Every grain of `pack` as it would be of hydrate.
fn of_hydrate(pack: &Pack, filling: &Filling<'_>) -> Vec<Grain> {
    let Filling { material, seed, .. } = *filling;
    let mut rng = Pcg64::seed_from_u64(seed ^ STREAM);
    let one = |grain: &Grain| {
        let (young, poisson) = properties::draw(material, &mut rng);
        Grain { young, poisson, density: material.density, hydrate: true, ..*grain }
    };
    pack.grains.iter().map(one).collect()
}

/// Grains of hydrate in `pack`, and the saturation that they make.
#[must_use]
pub fn present(pack: &Pack) -> (usize, f64) {
    let (model, contacts) = as_it_is(pack);
    let grains = pack.grains.iter().filter(|grain| grain.hydrate).count();
    (grains, pores(&model, &contacts.list, &pack.bounds).saturation())
}

/// The geometry of `pack`, nothing moved.
fn as_it_is(pack: &Pack) -> (Model, Contacts) {
    let model =
        Model::with(pack, &Walls::default(), [0.0; 3], Solver::default(), Some(pack.bounds));
    let state = State::new(&model);
    let mut near = Neighbours::default();
    near.refresh(&model, &state.position, &state.bounds(&model));
    let contacts = Contacts::of(&model, &state, &near);
    (model, contacts)
}

/// Which grains of `pack`, in its order, bring it closest to `saturation`.
fn chosen(pack: &Pack, saturation: f64) -> Vec<bool> {
    let (model, contacts) = as_it_is(pack);
    let solid = solids(&model, &contacts.list);
    let mut smallest: Vec<usize> = (0..model.len()).collect();
    smallest.sort_by(|&a, &b| {
        let radius = model.radius[a].total_cmp(&model.radius[b]);
        radius.then(model.order[a].cmp(&model.order[b]))
    });
    let mut chosen = vec![false; model.len()];
    let mut pores = pack.bounds.volume() - solid.iter().sum::<f64>();
    let mut hydrate = 0.0;
    let mut closest = f64::INFINITY;
    for k in smallest {
        // What becomes hydrate adds to it and to the pores that it counts in.
        hydrate += solid[k];
        pores += solid[k];
        let off = (hydrate / pores - saturation).abs();
        if off >= closest {
            break;
        }
        closest = off;
        chosen[model.order[k] as usize] = true;
    }
    chosen
}
