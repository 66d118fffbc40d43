//! What a specimen remembers of its loading besides where its grains are.

mod bond;
mod check;
mod file;

use serde::{Deserialize, Serialize};

use crate::scene::MOST_POINTS;
use crate::wall;

pub use bond::{BondMemory, Kept};
pub use file::history_file;
pub(super) use file::{parse, read, to_json};

/// Most walls and points that surround a pack.
pub const MOST_BODIES: usize = wall::COUNT + MOST_POINTS;

/// Rotations and contact history of a pack, in the order of the pack file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "`{rotations: [...], contacts: [...]}`")]
pub struct History {
    /// Sum of the rotation increments of each grain \[rad\], shape (grains).
    #[serde(rename = "rotations")]
    pub rotation: Vec<[f64; 3]>,
    /// The load-carrying contacts, sorted by (first, second).
    pub contacts: Vec<ContactMemory>,
    /// What was cemented, sorted by (first, second); empty without cement.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bonds: Vec<BondMemory>,
}

/// What one contact remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a contact, `{first: 0, second: 1, ...}`")]
pub struct ContactMemory {
    /// Grain index.
    pub first: u32,
    /// Grain index above `first`, or `u32::MAX - w` for wall w; points of discs follow the four sides.
    pub second: u32,
    /// Tangential force on `first` \[N\].
    pub shear: [f64; 3],
    /// Torsional couple on `first` about the normal from `second` to `first` \[N m\].
    pub torsion: f64,
    /// Whether the contact slides.
    pub sliding: bool,
    /// Layers of the law `mindlin_deresiewicz`, from the contact's centre outwards; empty for the
    /// other laws.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub layers: Vec<Layer>,
}

/// A ring of the contact in which the memory of slip is uniform.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a layer, `{reach: 1e-9, ratio: [x, y, z]}`")]
pub struct Layer {
    /// Overlap at which the contact circle reaches the outer edge of the ring \[m\].
    pub reach: f64,
    /// Tangential over normal displacement increment when the ring came into contact or slipped,
    /// in units of its limit: a vector in the contact plane, |D| <= 1. The force on `first` points
    /// along it.
    pub ratio: [f64; 3],
}

impl History {
    /// Number of contacts that slide.
    #[must_use]
    pub fn sliding(&self) -> usize {
        self.contacts.iter().filter(|contact| contact.sliding).count()
    }
}

impl Layer {
    /// The ring as the other body sees it, for `sign` -1.
    #[must_use]
    pub fn times(&self, sign: f64) -> Self {
        Self { reach: self.reach, ratio: self.ratio.map(|d| d * sign) }
    }
}

/// The index by which files and messages name wall `wall` among grains.
#[must_use]
pub fn wall_index(wall: u8) -> u32 {
    u32::MAX - u32::from(wall)
}

/// The wall that `index` names; `None` for a grain.
#[must_use]
pub fn wall_of(index: u32) -> Option<u8> {
    u8::try_from(u32::MAX - index).ok().filter(|&w| usize::from(w) < wall::COUNT)
}

/// The wall, or the point beyond the first of a side of discs, that `index` names; `None` for a grain.
#[must_use]
pub fn body_of(index: u32) -> Option<u8> {
    u8::try_from(u32::MAX - index).ok().filter(|&body| usize::from(body) < MOST_BODIES)
}
