//! From positions of joints to targets of walls.

use std::collections::BTreeMap;

use crate::scene::{Joint, Zero};
use crate::wall::{self, WallTarget};

/// What the walls shall do, or what is wrong with the positions.
pub(super) type Targets = Result<[WallTarget; wall::COUNT], String>;

/// The joints that move a wall.
#[derive(Clone, Debug)]
pub(super) struct Joints(Vec<Mapped>);

#[derive(Clone, Debug)]
struct Mapped {
    name: String,
    joint: Joint,
    /// Position where the wall is at its start; `None` until a first message tells it.
    zero: Option<f64>,
}

impl Joints {
    pub(super) fn new(joints: &BTreeMap<String, Joint>) -> Self {
        let mapped = |(name, joint): (&String, &Joint)| Mapped {
            name: name.clone(),
            joint: *joint,
            zero: match joint.zero {
                Zero::At(position) => Some(position),
                Zero::First => None,
            },
        };
        Self(joints.iter().map(mapped).collect())
    }

    /// Where each joint is among `names`.
    pub(super) fn places(&self, names: &[String]) -> Result<Vec<usize>, String> {
        let place = |mapped: &Mapped| {
            let name = &mapped.name;
            let mut places = names.iter().enumerate().filter(|(_, found)| *found == name);
            match (places.next(), places.next()) {
                (Some((place, _)), None) => Ok(place),
                (None, _) => Err(format!("joint `{name}` is missing: it moves a wall")),
                (Some(_), Some(_)) => {
                    Err(format!("joint `{name}` is there twice: once is allowed"))
                }
            }
        };
        self.0.iter().map(place).collect()
    }

    /// Targets for joints that are at `positions`, each at its one of `places`. Those whose zero
    /// is not known yet are at it.
    pub(super) fn targets(&self, names: &[String], places: &[usize], positions: &[f64]) -> Targets {
        let mut targets = [WallTarget::Keep; wall::COUNT];
        for (mapped, &place) in self.0.iter().zip(places) {
            let name = &mapped.name;
            if positions.len() != names.len() {
                return Err(format!(
                    "{} positions for {} names do not tell where joint `{name}` is: as many of \
                     one as of the other are needed",
                    positions.len(),
                    names.len()
                ));
            }
            let position = positions[place];
            let Joint { sign, gear, wall, .. } = mapped.joint;
            let displacement = sign * gear * (position - mapped.zero.unwrap_or(position));
            if !displacement.is_finite() {
                return Err(format!(
                    "joint `{name}` is at {position:e}: a finite position is needed that moves {} \
                     by a finite number of metres",
                    wall::NAMES[wall.index()]
                ));
            }
            targets[wall.index()] = WallTarget::Displacement(displacement);
        }
        Ok(targets)
    }

    /// Takes `positions` as the zeros that are not known yet.
    pub(super) fn set_zeros(&mut self, places: &[usize], positions: &[f64]) {
        for (mapped, &place) in self.0.iter_mut().zip(places) {
            mapped.zero.get_or_insert(positions[place]);
        }
    }

    /// What stands for targets that nobody can tell.
    pub(super) fn unknown(&self) -> [WallTarget; wall::COUNT] {
        let mut targets = [WallTarget::Keep; wall::COUNT];
        for mapped in &self.0 {
            targets[mapped.joint.wall.index()] = WallTarget::Displacement(f64::NAN);
        }
        targets
    }
}
