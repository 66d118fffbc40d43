//! What goes to the right: axial strain, or the increment where there is no such strain.

use std::collections::BTreeMap;

use crate::view::run::Run;
use crate::view::scale::Axis;
use crate::view::unit::Unit;

/// The scene's axis, of spheres and of discs.
const AXIAL: [usize; 2] = [2, 1];

/// Strains that differ less are none.
pub(super) const LEAST: f64 = 1e-12;

/// The axial strain of each increment.
#[derive(Clone)]
pub(super) struct Strain {
    by_increment: BTreeMap<u64, f64>,
    varies: bool,
}

/// A path turns when it is longer than its ends are apart by this share.
const TURNING: f64 = 0.05;

impl Strain {
    pub(super) fn of(run: &Run) -> Self {
        let axial = AXIAL[usize::from(run.is_plane())];
        let known = run.states.iter().map(|state| (state.increment, state.strain[axial]));
        let by_increment: BTreeMap<u64, f64> = known.collect();
        let finite = || by_increment.values().copied().filter(|strain| strain.is_finite());
        let low = finite().fold(f64::INFINITY, f64::min);
        let high = finite().fold(f64::NEG_INFINITY, f64::max);
        let varies = high - low > LEAST;
        Self { by_increment, varies }
    }

    /// The same, or the increment when the strain goes back and forth.
    pub(super) fn or_increment_where_it_turns(&self) -> Self {
        let strains = self.by_increment.values().copied().filter(|strain| strain.is_finite());
        let strains: Vec<f64> = strains.collect();
        let length: f64 = strains.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
        let apart = strains.first().zip(strains.last()).map_or(0.0, |(from, to)| (to - from).abs());
        let turns = length > (1.0 + TURNING) * apart;
        Self { varies: self.varies && !turns, ..self.clone() }
    }

    pub(super) fn axis(&self) -> Axis {
        match self.varies {
            true => Axis::linear("axial strain", Unit::Strain),
            false => Axis::count("increment"),
        }
    }

    /// What the title of a chart says after "against".
    pub(super) fn name(&self) -> &'static str {
        if self.varies { "axial strain" } else { "increment" }
    }

    /// The place of an increment; NaN when its strain is not known.
    pub(super) fn at(&self, increment: u64) -> f64 {
        match self.varies {
            true => self.by_increment.get(&increment).copied().unwrap_or(f64::NAN),
            false => increment as f64,
        }
    }
}
