//! The neighbour list: every pair that can touch before grains have moved further than the skin.

use crate::Vec3;
use crate::contact::cells::Cells;
use crate::contact::{Other, hertz};
use crate::heap;
use crate::model::Model;
use crate::wall::{self, Bounds, Room};

/// Skin over the mean radius: at first, and at least and at most.
const SKIN: f64 = 0.2;
const SKINS: (f64, f64) = (0.15, 0.5);
/// A list that served fewer times than this gets a wider skin, one that served more often than
/// that a narrower one. The skin does not change what is found in contact, nor in which order.
const SERVICE: (u32, u32) = (30, 300);

/// Pairs (i, j > i) and (i, wall) within the skin, in rows by i.
#[derive(Clone, Debug, Default)]
pub struct Neighbours {
    /// First entry of each row in `second`, shape (n + 1).
    pub start: Vec<u32>,
    /// The second grain of each pair, ascending within a row.
    pub second: Vec<u32>,
    /// Hertz' M of each pair \[N/m^1.5\].
    pub modulus: Vec<f64>,
    /// First entry of each row in `walls`, shape (n + 1).
    pub wall_start: Vec<u32>,
    /// The wall of each grain-wall pair, ascending within a row.
    pub walls: Vec<u8>,
    /// Hertz' M of each grain with a plane wall \[N/m^1.5\], shape (n).
    wall_modulus: Vec<f64>,
    /// The same with the inner and the outer wall of a round room; empty for a box.
    round_modulus: Vec<[f64; 2]>,
    /// Mutual approach at which each pair, and each grain-wall pair, begins to press \[m\]: infinite
    /// where cement holds both as one. Empty where all do so at 0.
    unstressed: Vec<f64>,
    wall_unstressed: Vec<f64>,
    /// The pairs for which it is not 0, sorted.
    relieved: Vec<((u32, Other), f64)>,
    /// Positions when the list was made \[m\], shape (n); empty before the first list.
    made_at: Vec<Vec3>,
    /// Box when the list was made.
    made_in: Option<Room>,
    /// Skin \[m\], and how often the list was looked at since it was made.
    skin: f64,
    served: u32,
    /// How often the list was made.
    pub rebuilds: u64,
    cells: Cells,
}

impl Neighbours {
    /// Whether the list still holds every contact of `position` in the box `bounds`.
    ///
    /// A pair outside the list was at least a skin apart. The box strain brings it closer by at
    /// most its own share, the rest takes non-affine displacements.
    #[must_use]
    pub fn holds(&self, model: &Model, position: &[Vec3], bounds: &Room) -> bool {
        let Some(made_in) = &self.made_in else { return false };
        if self.made_at.len() != position.len() {
            return false;
        }
        let (sides, made) = (bounds.sides(), made_in.sides());
        let scale = Vec3::from_fn(|axis, _| sides[axis] / made[axis]);
        let (low, made_low) = (Vec3::from(bounds.min), Vec3::from(made_in.min));
        let closest = scale.min().min(1.0);
        let allowance = closest * self.skin
            - (1.0 - closest) * 2.0 * model.max_radius
            - self.hole_grew(bounds, scale.x);
        if allowance <= 0.0 || scale.max() > 2.0 {
            return false;
        }
        let limit = (0.5 * allowance).powi(2);
        position.iter().zip(&self.made_at).all(|(now, made)| {
            let affine = low + scale.component_mul(&(made - made_low));
            (now - affine).norm_squared() <= limit
        })
    }

    /// Makes the list anew for `position`.
    pub fn rebuild(&mut self, model: &Model, position: &[Vec3], bounds: &Room) {
        let least = SKINS.0 * model.mean_radius;
        let skin = match self.served {
            _ if self.made_in.is_none() => SKIN * model.mean_radius,
            served if served < SERVICE.0 => (1.5 * self.skin).min(SKINS.1 * model.mean_radius),
            served if served > SERVICE.1 => (0.7 * self.skin).max(least),
            _ => self.skin.max(least),
        };
        self.make(model, position, bounds, skin);
    }

    /// Makes the list anew for `position` with all pairs up to `skin` \[m\] apart.
    pub(crate) fn make(&mut self, model: &Model, position: &[Vec3], bounds: &Room, skin: f64) {
        self.skin = skin;
        self.served = 0;
        self.cells.sort(position, 2.0 * model.max_radius + skin);
        self.start.clear();
        self.second.clear();
        self.modulus.clear();
        self.wall_modulus.clear();
        self.round_modulus.clear();
        self.wall_start.clear();
        self.walls.clear();
        for (i, at) in position.iter().enumerate() {
            self.start.push(self.second.len() as u32);
            let row = self.second.len();
            self.cells.for_each_near(at, |j| {
                if j as usize > i {
                    let reach = model.radius[i] + model.radius[j as usize] + skin;
                    if (at - position[j as usize]).norm_squared() < reach * reach {
                        self.second.push(j);
                    }
                }
            });
            self.second[row..].sort_unstable();
            self.modulus.extend(self.second[row..].iter().map(|&j| {
                let effective = hertz::effective_radius(model.radius[i], model.radius[j as usize]);
                hertz::modulus(effective, model.compliance[i] + model.compliance[j as usize])
            }));
            let compliance = model.compliance[i] + model.wall_compliance;
            self.wall_modulus.push(hertz::modulus(model.radius[i], compliance));
            if bounds.is_round() {
                let modulus = |w| hertz::modulus(model.wall_radius(i, w), compliance);
                self.round_modulus.push([modulus(0), modulus(1)]);
            }
            self.wall_start.push(self.walls.len() as u32);
            for wall in (0..wall::COUNT).filter(|&wall| bounds.has(wall)) {
                let gap = wall_gap(at, wall, bounds);
                if gap < model.radius[i] + skin {
                    self.walls.push(wall as u8);
                }
            }
        }
        self.start.push(self.second.len() as u32);
        self.wall_start.push(self.walls.len() as u32);
        self.made_at.clear();
        self.made_at.extend_from_slice(position);
        self.made_in = Some(*bounds);
        self.rebuilds += 1;
        self.mark();
    }

    /// Takes `relieved`, the pairs that do not begin to press at an approach of 0 but at another
    /// \[m\], sorted by their bodies.
    pub fn relieve(&mut self, relieved: impl Iterator<Item = ((u32, Other), f64)>) {
        self.relieved.clear();
        self.relieved.extend(relieved);
        self.mark();
    }

    fn mark(&mut self) {
        let Self { start, second, walls, wall_start, unstressed, wall_unstressed, .. } = self;
        unstressed.clear();
        wall_unstressed.clear();
        if self.relieved.is_empty() {
            return;
        }
        unstressed.resize(second.len(), 0.0);
        wall_unstressed.resize(walls.len(), 0.0);
        for &((i, other), approach) in &self.relieved {
            let i = i as usize;
            // A pair that is not listed is too far apart to press.
            match other {
                Other::Grain(j) => {
                    let row = start[i] as usize..start[i + 1] as usize;
                    if let Ok(k) = second[row.clone()].binary_search(&j) {
                        unstressed[row.start + k] = approach;
                    }
                }
                Other::Wall(w) => {
                    let row = wall_start[i] as usize..wall_start[i + 1] as usize;
                    if let Ok(k) = walls[row.clone()].binary_search(&w) {
                        wall_unstressed[row.start + k] = approach;
                    }
                }
            }
        }
    }

    /// Makes the list anew when it no longer [`holds`](Self::holds).
    pub fn refresh(&mut self, model: &Model, position: &[Vec3], bounds: &Room) {
        match self.holds(model, position, bounds) {
            true => self.served += 1,
            false => self.rebuild(model, position, bounds),
        }
    }

    /// Forgets the list: radii have changed since it was made.
    pub fn forget(&mut self) {
        self.made_in = None;
    }

    /// Memory that its lists hold \[bytes\].
    pub(crate) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.start)
            + heap::bytes(&self.second)
            + heap::bytes(&self.modulus)
            + heap::bytes(&self.wall_start)
            + heap::bytes(&self.walls)
            + heap::bytes(&self.wall_modulus)
            + heap::bytes(&self.round_modulus)
            + heap::bytes(&self.unstressed)
            + heap::bytes(&self.wall_unstressed)
            + heap::bytes(&self.relieved)
            + heap::bytes(&self.made_at)
            + self.cells.heap_bytes()
    }

    /// The entries of row `i` in `second`.
    #[must_use]
    #[inline(always)]
    pub fn row(&self, i: usize) -> std::ops::Range<usize> {
        self.start[i] as usize..self.start[i + 1] as usize
    }

    /// Hertz' M of grain `i` with wall `wall` \[N/m^1.5\].
    #[must_use]
    #[inline(always)]
    pub fn wall_modulus(&self, i: usize, wall: usize) -> f64 {
        match self.round_modulus.get(i) {
            Some(modulus) if wall < 2 => modulus[wall],
            _ => self.wall_modulus[i],
        }
    }

    /// How much further out the inner wall of a round room is than the box took it along by `scale`
    /// \[m\].
    fn hole_grew(&self, room: &Room, scale: f64) -> f64 {
        match (self.made_in.and_then(|made| made.radii()), room.radii()) {
            (Some([before, _]), Some([now, _])) => (now - before * scale).max(0.0),
            _ => 0.0,
        }
    }

    /// Distance of the centres of grain `i` and the other of entry `k` of its row below which they
    /// press \[m\].
    #[must_use]
    #[inline(always)]
    pub fn reach(&self, model: &Model, i: usize, k: usize) -> f64 {
        let reach = model.radius[i] + model.radius[self.second[k] as usize];
        self.unstressed.get(k).map_or(reach, |approach| reach - approach)
    }

    /// The walls near grain `i`, with the distance below which it presses on them \[m\].
    #[inline(always)]
    pub fn walls_near(&self, model: &Model, i: usize) -> impl Iterator<Item = (u8, f64)> {
        let row = self.wall_start[i] as usize..self.wall_start[i + 1] as usize;
        let radius = model.radius[i];
        let reach = move |k: usize| {
            self.wall_unstressed.get(k).map_or(radius, |approach| radius - approach)
        };
        row.map(move |k| (self.walls[k], reach(k)))
    }
}

/// Distance of a point from a plane wall, positive inside \[m\].
#[must_use]
#[inline(always)]
pub fn plane_gap(at: &Vec3, wall: usize, bounds: &Bounds) -> f64 {
    (at[wall::axis(wall)] - bounds.position(wall)) * wall::inward(wall)
}

/// Distance of a point from a wall, positive inside \[m\].
#[must_use]
#[inline(always)]
pub fn wall_gap(at: &Vec3, wall: usize, room: &Room) -> f64 {
    room.gap(at, wall)
}
