//! The sudden changes of an increment in their order: stress drops and cracks.

use crate::measure::{cement, rearrangement};
use crate::model::Model;
use crate::relax::advance::Advance;
use crate::relax::breakage::Crack;
use crate::relax::jump::Jump;
use crate::report::{Event, Rearrangement, Snapshot};

/// A sudden change.
#[derive(Clone, Copy, Debug)]
pub enum Sudden<'a> {
    /// An instability.
    Jump(&'a Jump),
    /// A bond that broke.
    Crack(&'a Crack),
}

/// Those of `reached`: a crack comes before the jumps that it set off.
#[must_use]
pub fn in_order(reached: &Advance) -> Vec<Sudden<'_>> {
    let mut all = Vec::with_capacity(reached.jumps.len() + reached.cracks.len());
    let mut cracks = reached.cracks.iter().peekable();
    for (jump, before) in reached.jumps.iter().zip(0..) {
        while let Some(crack) = cracks.next_if(|crack| crack.relaxed.jumps <= before) {
            all.push(Sudden::Crack(crack));
        }
        all.push(Sudden::Jump(jump));
    }
    all.extend(cracks.map(Sudden::Crack));
    all
}

impl Sudden<'_> {
    /// In short.
    #[must_use]
    pub fn event(&self, model: &Model) -> Event {
        match self {
            Self::Jump(jump) => rearrangement::event(model, jump),
            Self::Crack(crack) => cement::event(model, crack),
        }
    }

    /// In full.
    #[must_use]
    pub fn rearrangement(&self, model: &Model) -> Rearrangement {
        match self {
            Self::Jump(jump) => rearrangement::rearrangement(model, jump),
            Self::Crack(crack) => cement::rearrangement(model, crack),
        }
    }

    /// All grains before and after it, the one that is number `event` of its increment; of a crack
    /// there are none, a run can have many.
    #[must_use]
    pub fn snapshots(&self, model: &Model, event: u32) -> Vec<Snapshot> {
        match self {
            Self::Jump(jump) => rearrangement::snapshots(model, jump, event).to_vec(),
            Self::Crack(_) => Vec::new(),
        }
    }
}
