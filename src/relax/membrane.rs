//! Membranes: a pressure p on the surface of a pack of spheres, which bends with the grains (as B 2.5
//! has it for discs).
//!
//! The surface is made of triangles between the centres of the outermost grains ([`surface`]) and goes
//! straight on to the walls at its edges, which do not feel it. With the volume V behind it the pressure
//! has the potential p V as long as the triangles are between the same grains, which they are until the
//! next reference.
//!
//! With D = ½ diag(1, 1, 0) about the axis of a round room, or e eᵀ for a face across e, the field D x has
//! the divergence 1 and no part across the walls at the edges, so that V = Σ (D x_m)·N over the triangles,
//! with the middle x_m and the area vector N = ½ (b - a) × (c - a) out of the pack: exact, for the field
//! is linear. Its derivative by the corner a is D N / 3 + ½ (b - c) × D x_m.

mod bend;
mod surface;

use std::f64::consts::PI;

use crate::Vec3;
use crate::heap;
use crate::model::Model;
use crate::plane::Cell;
use crate::plane::boundary::SIDES;
use crate::relax::curvature::Curvature;
use crate::report::Surface;
use crate::state::State;
use crate::wall::{self, Room};

/// Where membranes are on average changes by no more than this share of the box once it is settled.
const SETTLED: f64 = 1e-12;

/// A corner of the surface: the centre of a grain, or what is straight beside it on the walls there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corner {
    grain: u32,
    /// The wall that each coordinate is on; `None` where it is that of the grain.
    on: [Option<u8>; 3],
}

/// The membrane of one side.
#[derive(Clone, Debug, Default)]
pub(super) struct Membrane {
    side: usize,
    /// Pressure \[Pa\].
    pressure: f64,
    corners: Vec<Corner>,
    /// Corners of the triangles, to the left as seen from outside of the pack.
    triangles: Vec<[u32; 3]>,
    room: Option<Room>,
    before: Before,
}

/// Where a membrane was when its work began to be counted.
#[derive(Clone, Copy, Debug, Default)]
struct Before {
    pressure: f64,
    volume: f64,
    planes: [f64; wall::COUNT],
    /// ∂V by the place of each wall at the edges \[m²\].
    areas: [f64; wall::COUNT],
}

/// Positions of the walls along their axes \[m\].
fn planes(room: &Room) -> [f64; wall::COUNT] {
    std::array::from_fn(|w| room.position(w))
}

impl Membrane {
    /// The membrane of `side` around the grains at `at`, in `room` under `pressure` \[Pa\].
    fn around(model: &Model, state: &State, side: usize) -> Self {
        let (room, pressure, at) = (state.bounds(model), state.pressure[side], &state.position);
        let (corners, triangles) = surface::find(model, state, &room, side);
        let room = Some(room);
        let mut membrane =
            Self { side, pressure, corners, triangles, room, before: Before::default() };
        membrane.before = membrane.now(at);
        membrane
    }

    /// Where a corner is, from the axis of a round room.
    fn place(&self, corner: u32, at: &[Vec3], planes: &[f64; wall::COUNT], centre: &Vec3) -> Vec3 {
        let Corner { grain, on } = self.corners[corner as usize];
        let mut place = at[grain as usize];
        for (axis, wall) in on.into_iter().enumerate() {
            if let Some(wall) = wall {
                place[axis] = planes[usize::from(wall)];
            }
        }
        place - centre
    }

    /// D x.
    fn field(&self, room: &Room, x: &Vec3) -> Vec3 {
        if room.is_round() {
            return Vec3::new(0.5 * x.x, 0.5 * x.y, 0.0);
        }
        let mut field = Vec3::zeros();
        let axis = wall::axis(self.side);
        field[axis] = x[axis];
        field
    }

    /// Hands over the corners of each triangle and where they are, from the axis of a round room \[m\].
    fn each_place(&self, at: &[Vec3], mut take: impl FnMut(&[u32; 3], [Vec3; 3])) {
        let Some(room) = &self.room else { return };
        let planes = planes(room);
        let mut centre = Vec3::zeros();
        if room.is_round() {
            let [x, y, _] = room.center();
            centre = Vec3::new(x, y, 0.0);
        }
        for triangle in &self.triangles {
            take(triangle, triangle.map(|corner| self.place(corner, at, &planes, &centre)));
        }
    }

    /// Hands over each triangle: its corners, its part of V \[m³\] and the derivatives of that by the
    /// corners \[m²\].
    fn each(&self, at: &[Vec3], mut take: impl FnMut(&[u32; 3], f64, [Vec3; 3])) {
        let Some(room) = &self.room else { return };
        self.each_place(at, |triangle, [a, b, c]| {
            let area = (b - a).cross(&(c - a)) * 0.5;
            let middle = self.field(room, &((a + b + c) / 3.0));
            let even = self.field(room, &area) / 3.0;
            let slope = |to: Vec3, from: Vec3| even + (to - from).cross(&middle) * 0.5;
            take(triangle, middle.dot(&area), [slope(b, c), slope(c, a), slope(a, b)]);
        });
    }

    /// Its triangles with the edges on the walls of `room` \[m\].
    fn surface(&self, at: &[Vec3], room: &Room) -> Surface {
        let planes = planes(room);
        let place = |corner: u32| self.place(corner, at, &planes, &Vec3::zeros()).into();
        let triangles = self.triangles.iter().map(|triangle| triangle.map(place)).collect();
        Surface { side: self.side, triangles }
    }

    /// V \[m³\]: inside of the surface, or behind it from where the coordinate is 0.
    fn volume(&self, at: &[Vec3]) -> f64 {
        let mut volume = 0.0;
        self.each(at, |_, part, _| volume += part);
        volume
    }

    fn now(&self, at: &[Vec3]) -> Before {
        let mut areas = [0.0; wall::COUNT];
        let mut volume = 0.0;
        self.each(at, |triangle, part, slopes| {
            volume += part;
            for (corner, slope) in triangle.iter().zip(slopes) {
                let on = self.corners[*corner as usize].on;
                for (axis, wall) in on.into_iter().enumerate() {
                    if let Some(wall) = wall {
                        areas[usize::from(wall)] += slope[axis];
                    }
                }
            }
        });
        let planes = self.room.as_ref().map(planes).unwrap_or_default();
        Before { pressure: self.pressure, volume, planes, areas }
    }

    /// Adds the gradient of p V; returns p V \[J\].
    fn press(&self, at: &[Vec3], gradient: &mut [Vec3]) -> f64 {
        let mut volume = 0.0;
        self.each(at, |triangle, part, slopes| {
            volume += part;
            for (corner, slope) in triangle.iter().zip(slopes) {
                let Corner { grain, on } = self.corners[*corner as usize];
                for axis in (0..3).filter(|&axis| on[axis].is_none()) {
                    gradient[grain as usize][axis] += self.pressure * slope[axis];
                }
            }
        });
        self.pressure * volume
    }

    /// Work of the pressure on the grains since the surface was found \[J\]. What walls at its edges did
    /// to V is none.
    fn work(&self, at: &[Vec3]) -> f64 {
        let (from, to) = (&self.before, self.now(at));
        let edges: f64 = (0..wall::COUNT)
            .map(|w| 0.5 * (from.areas[w] + to.areas[w]) * (to.planes[w] - from.planes[w]))
            .sum();
        -0.5 * (from.pressure + to.pressure) * (to.volume - from.volume - edges)
    }

    /// Where the surface is on average, out of the pack \[m\]: a radius, or along the normal.
    fn position(&self, at: &[Vec3]) -> f64 {
        let Some(room) = &self.room else { return 0.0 };
        let volume = self.volume(at);
        match room.is_round() {
            true => (volume / (PI * room.sides()[2])).max(0.0).sqrt(),
            false => volume / room.area(self.side),
        }
    }
}

/// The membranes of a pack.
#[derive(Clone, Debug, Default)]
pub(crate) struct Membranes {
    all: Vec<Membrane>,
    /// Whether each grain is pressed on, shape (n); empty without membranes.
    under: Vec<bool>,
}

impl Membranes {
    /// Whether there are none.
    pub(super) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Whether a membrane presses on grain `i`.
    pub(super) fn press_on(&self, i: usize) -> bool {
        self.under.get(i).copied().unwrap_or(false)
    }

    /// Finds the surfaces of `state` anew, each under the pressure that the state has.
    pub(super) fn wrap(&mut self, model: &Model, state: &State) {
        self.all.clear();
        self.under.clear();
        let Some(cell) = &model.cell else { return };
        for side in (0..SIDES).filter(|&side| cell.is_membrane(side)) {
            self.under.resize(model.len(), false);
            let membrane = Membrane::around(model, state, side);
            membrane.corners.iter().for_each(|c| self.under[c.grain as usize] = true);
            self.all.push(membrane);
        }
    }

    /// Takes the edges to the walls of `state` and its pressures.
    pub(super) fn follow(&mut self, model: &Model, state: &State) {
        for membrane in &mut self.all {
            membrane.room = Some(state.bounds(model));
            membrane.pressure = state.pressure[membrane.side];
        }
    }

    /// Adds the gradient of the potential of the pressures to `gradient`; returns the potential \[J\].
    pub(super) fn press(&self, at: &[Vec3], gradient: &mut [Vec3]) -> f64 {
        self.all.iter().map(|membrane| membrane.press(at, gradient)).sum()
    }

    /// Takes the second derivative of the potential, times `scale`, to `curvature`.
    pub(super) fn bend(&self, at: &[Vec3], scale: f64, curvature: &mut Curvature) {
        curvature.clear();
        self.all.iter().for_each(|membrane| membrane.bend(at, scale, curvature));
    }

    /// Work of the pressures on the grains since the surfaces were found \[J\].
    pub(super) fn work(&self, state: &State) -> f64 {
        self.all.iter().map(|membrane| membrane.work(&state.position)).sum()
    }

    /// The surfaces of `state`.
    pub(crate) fn surfaces(&self, model: &Model, state: &State) -> Vec<Surface> {
        let room = state.bounds(model);
        self.all.iter().map(|membrane| membrane.surface(&state.position, &room)).collect()
    }

    /// Notes where the surfaces of `state` are at the start, and takes its sides there.
    pub(super) fn mark(&self, model: &Model, state: &mut State) {
        for membrane in &self.all {
            state.outline[membrane.side] = membrane.position(&state.position);
        }
        self.lead(model, state);
    }

    /// Takes the sides of `state` to where its surfaces are on average; says whether any moved.
    pub(super) fn lead(&self, model: &Model, state: &mut State) -> bool {
        let mut moved = false;
        for membrane in &self.all {
            let Some(cell) = &model.cell else { continue };
            let outermost = cell.outermost(membrane.side);
            let displacement = outermost - membrane.position(&state.position);
            let way = displacement - state.displacement[membrane.side];
            moved |= way.abs() > SETTLED * model.start.sides()[wall::axis(membrane.side)];
            state.displacement[membrane.side] = displacement;
        }
        moved
    }

    /// Memory that its lists hold \[bytes\].
    pub(super) fn heap_bytes(&self) -> usize {
        let lists = |m: &Membrane| heap::bytes(&m.corners) + heap::bytes(&m.triangles);
        heap::bytes(&self.all)
            + heap::bytes(&self.under)
            + self.all.iter().map(lists).sum::<usize>()
    }
}

/// Gives `state` the pressures that the scene has at the start.
pub(crate) fn begin(cell: &Cell, state: &mut State) {
    for (side, pressure) in state.pressure.iter_mut().enumerate() {
        if let Some(at_first) = cell.first_pressure(side) {
            *pressure = at_first;
        }
    }
}
