//! What a contact history must keep to, whoever made it.

use super::{BondMemory, ContactMemory, History, Layer, MOST_BODIES, body_of, wall_index};
use crate::wall;

/// Most contacts a grain on average; spheres of one size have 6.
const MOST_CONTACTS: usize = 100;
/// What rounding may add to a ratio of 1.
const RATIO_SLACK: f64 = 1e-9;

impl History {
    /// Checks the history of a pack of `grains` grains between six walls; says which entry is wrong
    /// and what is allowed.
    ///
    /// # Errors
    /// That sentence.
    pub fn check(&self, grains: usize) -> Result<(), String> {
        self.check_among(grains, wall::COUNT)
    }

    /// The same for grains that `bodies` walls and points surround, at most
    /// [`MOST_BODIES`](super::MOST_BODIES).
    ///
    /// # Errors
    /// As [`check`](Self::check).
    pub fn check_among(&self, grains: usize, bodies: usize) -> Result<(), String> {
        let bodies = bodies.min(MOST_BODIES);
        if self.rotation.len() != grains {
            let found = self.rotation.len();
            return Err(format!("rotations: {found} entries; allowed: {grains}, one a grain"));
        }
        let most = MOST_CONTACTS * grains;
        for (list, found) in [("contacts", self.contacts.len()), ("bonds", self.bonds.len())] {
            if found > most {
                return Err(format!("{list}: {found} entries; allowed: at most {most}"));
            }
        }
        for (grain, rotation) in self.rotation.iter().enumerate() {
            finite(rotation).map_err(|fault| format!("rotations[{grain}]{fault}"))?;
        }
        for (index, contact) in self.contacts.iter().enumerate() {
            contact.check(grains, bodies).map_err(|fault| format!("contacts[{index}]{fault}"))?;
        }
        for (index, bond) in self.bonds.iter().enumerate() {
            bond.check(grains, bodies).map_err(|fault| format!("bonds[{index}]{fault}"))?;
        }
        ascending("contacts", self.contacts.iter().map(|c| (c.first, c.second)))?;
        ascending("bonds", self.bonds.iter().map(|b| (b.first, b.second)))
    }
}

/// Whether each pair follows the one before it.
fn ascending(list: &str, pairs: impl Iterator<Item = (u32, u32)>) -> Result<(), String> {
    let mut before = None;
    for (index, now) in pairs.enumerate() {
        if let Some(then) = before.replace(now).filter(|then| *then >= now) {
            return Err(format!(
                "{list}[{index}]: (first, second) = {now:?} follows {then:?}; allowed: \
                 ascending, each pair once"
            ));
        }
    }
    Ok(())
}

/// Checks that `first` is a grain of `grains`, and `second` a later one or one of `walls` walls.
fn bodies(first: u32, second: u32, grains: usize, walls: usize) -> Result<(), String> {
    let last = grains - 1;
    if first as usize > last {
        return Err(format!(".first: {first}; allowed: a grain, 0 to {last}"));
    }
    let is_grain = first < second && second as usize <= last;
    if !is_grain && body_of(second).is_none_or(|body| usize::from(body) >= walls) {
        let [low, high] = [walls.saturating_sub(1) as u8, 0].map(wall_index);
        return Err(format!(
            ".second: {second}; allowed: a grain above first = {first} and up to {last}, or \
                 {low} to {high} for a wall"
        ));
    }
    Ok(())
}

impl ContactMemory {
    fn check(&self, grains: usize, walls: usize) -> Result<(), String> {
        bodies(self.first, self.second, grains, walls)?;
        finite(&self.shear).map_err(|fault| format!(".shear{fault}"))?;
        finite(&[self.torsion]).map_err(|_| wrong(".torsion", self.torsion, "a finite number"))?;
        let mut reached = 0.0;
        for (index, layer) in self.layers.iter().enumerate() {
            layer.check(reached).map_err(|fault| format!(".layers[{index}]{fault}"))?;
            reached = layer.reach;
        }
        Ok(())
    }
}

impl BondMemory {
    fn check(&self, grains: usize, walls: usize) -> Result<(), String> {
        bodies(self.first, self.second, grains, walls)?;
        for (field, length) in [(".distance", self.distance), (".radius", self.radius)] {
            if !(length.is_finite() && length > 0.0) {
                return Err(wrong(field, length, "a finite number above 0 m"));
            }
        }
        for (field, value) in [(".overlap", self.overlap), (".work", self.work)] {
            finite(&[value]).map_err(|_| wrong(field, value, "a finite number"))?;
        }
        if let Some(force) = self.normal_force {
            finite(&[force]).map_err(|_| wrong(".normal_force", force, "a finite number"))?;
        }
        match (0.0..=1.0).contains(&self.share) {
            true => Ok(()),
            false => Err(wrong(".share", self.share, "0 to 1")),
        }
    }
}

impl Layer {
    /// Checks a layer around one that ends at `reached`.
    fn check(&self, reached: f64) -> Result<(), String> {
        if !(self.reach.is_finite() && self.reach > reached) {
            let allowed = format!("a finite number above {reached:?} m, where the layer begins");
            return Err(wrong(".reach", self.reach, &allowed));
        }
        finite(&self.ratio).map_err(|fault| format!(".ratio{fault}"))?;
        let length = self.ratio.iter().map(|d| d * d).sum::<f64>().sqrt();
        if length > 1.0 + RATIO_SLACK {
            return Err(format!(".ratio: its length is {length:?}; allowed: 0 to 1"));
        }
        Ok(())
    }
}

fn finite(values: &[f64]) -> Result<(), String> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(index) => Err(wrong(&format!("[{index}]"), values[index], "a finite number")),
    }
}

fn wrong(field: &str, value: f64, allowed: &str) -> String {
    format!("{field}: {value:?}; allowed: {allowed}")
}
