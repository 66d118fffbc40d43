//! The pairs of discs that can touch, their shear, and the forces of all contacts.

use nalgebra::Vector2;

use super::motion::Discs;
use crate::contact::hertz;
use crate::contact::mindlin;

/// How stiff contacts are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Law {
    /// Hertz and Mindlin.
    Hertz,
    /// The same for all \[N/m\].
    Linear { normal: f64, shear: f64 },
}

impl Law {
    /// Normal force \[N\] and shear stiffness \[N/m\] at the overlap `h` \[m\]. The factors are those of
    /// a pair under Hertz' law: P = `normal` h^1.5, k_s = `shear` h^0.5.
    fn answer(self, normal: f64, shear: f64, h: f64) -> [f64; 2] {
        match self {
            Self::Hertz => {
                let root = h.sqrt();
                [normal * h * root, shear * root]
            }
            Self::Linear { normal, shear } => [normal * h, shear],
        }
    }
}

/// Two discs that can touch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub(super) first: u32,
    pub(super) second: u32,
    /// See [`Law::answer`]; of grown discs.
    normal: f64,
    slip: f64,
    /// Shear force on `first` along the normal, which points to it, turned left \[N\].
    pub(super) shear: f64,
}

/// Two discs that touch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    /// Unit vector from the second to the first.
    pub(super) along: Vector2<f64>,
    distance: f64,
    overlap: f64,
    /// Normal force \[N\].
    pub(super) normal: f64,
    /// Shear stiffness \[N/m\].
    stiffness: f64,
}

impl Pair {
    /// How the two discs touch; `None` when they do not.
    pub(super) fn touch(&self, discs: &Discs) -> Option<Touch> {
        let (i, j) = (self.first as usize, self.second as usize);
        let branch = discs.at[i] - discs.at[j];
        let reach = (discs.radius[i] + discs.radius[j]) * discs.grown;
        let square = branch.norm_squared();
        if square >= reach * reach || square == 0.0 {
            return None;
        }
        let distance = square.sqrt();
        let overlap = reach - distance;
        let [normal, stiffness] = discs.law.answer(self.normal, self.slip, overlap);
        Some(Touch { along: branch / distance, distance, overlap, normal, stiffness })
    }
}

/// `v` turned by a right angle to the left.
pub(super) fn left_of(v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

/// Sums over the contacts.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    /// Stress along x and y times the volume \[N m\].
    pub(super) moment: [f64; 2],
    /// Normal forces \[N\], overlaps \[m\] and contacts.
    force: f64,
    overlap: f64,
    contacts: f64,
}

impl Sums {
    pub(super) fn mean_force(&self) -> f64 {
        self.force / self.contacts.max(1.0)
    }

    pub(super) fn mean_overlap(&self) -> f64 {
        self.overlap / self.contacts.max(1.0)
    }

    fn count(&mut self, force: f64, overlap: f64) {
        self.force += force;
        self.overlap += overlap;
        self.contacts += 1.0;
    }
}

/// Takes the forces of all contacts on grown discs: `strain` and `time` are what the box and the clock
/// went in the last step, `friction` the limit of shear over normal force.
pub(super) fn press(discs: &mut Discs, friction: f64, strain: [f64; 2], time: f64) -> Sums {
    let mut sums = Sums::default();
    let mut pairs = std::mem::take(&mut discs.pairs);
    discs.force.fill([0.0; 3]);
    for pair in &mut pairs {
        let Some(touch) = pair.touch(discs) else {
            pair.shear = 0.0;
            continue;
        };
        let Touch { along, distance, overlap, normal, stiffness } = touch;
        let (i, j) = (pair.first as usize, pair.second as usize);
        let [ri, rj] = [i, j].map(|k| discs.radius[k] * discs.grown);
        // From the centres to the line through both points where the circles intersect.
        let arm = 0.5 * (distance + (ri - rj) * (ri + rj) / distance);
        let levers = [arm / ri, (distance - arm) / rj];
        let (branch, across) = (along * distance, left_of(along));
        if friction > 0.0 {
            let [a, b] = [discs.speed[i], discs.speed[j]];
            let rolled = levers[0] * a[2] + levers[1] * b[2];
            let slid = across.dot(&Vector2::new(a[0] - b[0], a[1] - b[1])) - rolled;
            let [at, from] = [i, j].map(|k| discs.frame.carried(discs.at[k], strain));
            let limit = friction * normal;
            let shear = pair.shear - stiffness * (slid * time + across.dot(&(at - from)));
            pair.shear = shear.clamp(-limit, limit);
        }
        let pull = along * normal + across * pair.shear;
        for (body, sign, lever) in [(i, 1.0, levers[0]), (j, -1.0, levers[1])] {
            let force = &mut discs.force[body];
            force[0] += sign * pull.x;
            force[1] += sign * pull.y;
            force[2] -= lever * pair.shear;
        }
        if discs.frame.counts_pairs() {
            sums.moment[0] += pull.x * branch.x;
            sums.moment[1] += pull.y * branch.y;
        }
        sums.count(normal, overlap);
    }
    discs.pairs = pairs;
    walls(discs, &mut sums);
    sums
}

/// Forces of the smooth walls.
fn walls(discs: &mut Discs, sums: &mut Sums) {
    let Discs { at, radius, grown, frame, law, at_wall, force, .. } = discs;
    for i in 0..at.len() {
        frame.each_wall(at[i], radius[i] * *grown, |wall| {
            let [normal, _] = law.answer(at_wall[i], 0.0, wall.overlap);
            force[i][0] += normal * wall.inward.x;
            force[i][1] += normal * wall.inward.y;
            sums.moment[0] += normal * wall.lever[0];
            sums.moment[1] += normal * wall.lever[1];
            sums.count(normal, wall.overlap);
        });
    }
}

/// Makes the list of pairs whose gap is below `skin` \[m\] anew; what touched keeps its shear.
pub(super) fn list(discs: &mut Discs, skin: f64) {
    let Discs { at, radius, grown, frame, compliance, shear_compliance, pairs, .. } = discs;
    let largest = radius.iter().fold(0.0, |most: f64, &radius| most.max(radius));
    let reach = 2.0 * largest * *grown + skin;
    let cells = Cells::new(at, frame.half(), reach);
    let before = std::mem::take(pairs);
    let mut old = before.iter().filter(|pair| pair.shear != 0.0).peekable();
    let mut near = Vec::new();
    for i in 0..at.len() {
        near.clear();
        cells.each_near(at[i], |j| {
            let far = (radius[i] + radius[j as usize]) * *grown + skin;
            if j as usize > i && (at[i] - at[j as usize]).norm_squared() < far * far {
                near.push(j);
            }
        });
        near.sort_unstable();
        for &j in &near {
            let key = (i as u32, j);
            while old.next_if(|pair| (pair.first, pair.second) < key).is_some() {}
            let kept = old.next_if(|pair| (pair.first, pair.second) == key);
            let j = j as usize;
            let effective = hertz::effective_radius(radius[i], radius[j]);
            let shears = shear_compliance[i] + shear_compliance[j];
            pairs.push(Pair {
                first: i as u32,
                second: j as u32,
                normal: hertz::modulus(effective, compliance[i] + compliance[j]),
                slip: mindlin::shear_stiffness(effective.sqrt(), shears),
                shear: kept.map_or(0.0, |pair| pair.shear),
            });
        }
    }
}

/// Discs by cells, each at least as wide as pairs reach.
struct Cells {
    /// First entry of each cell in `discs`.
    start: Vec<u32>,
    discs: Vec<u32>,
    numbers: [usize; 2],
    low: [f64; 2],
    width: [f64; 2],
}

impl Cells {
    fn new(at: &[Vector2<f64>], half: [f64; 2], reach: f64) -> Self {
        // No more cells than discs: when they are still small most cells would be empty.
        let most = (at.len() as f64).sqrt().ceil() as usize;
        let numbers = half.map(|half| ((2.0 * half / reach) as usize).clamp(1, most));
        let width = std::array::from_fn(|axis| 2.0 * half[axis] / numbers[axis] as f64);
        let low = half.map(|half| -half);
        let mut cells = Self { start: Vec::new(), discs: Vec::new(), numbers, low, width };
        let mut sorted: Vec<(usize, u32)> =
            at.iter().enumerate().map(|(i, at)| (cells.number(cells.cell(at)), i as u32)).collect();
        sorted.sort_unstable();
        cells.start = vec![0; numbers[0] * numbers[1] + 1];
        sorted.iter().for_each(|&(cell, _)| cells.start[cell + 1] += 1);
        for cell in 1..cells.start.len() {
            cells.start[cell] += cells.start[cell - 1];
        }
        cells.discs = sorted.into_iter().map(|(_, disc)| disc).collect();
        cells
    }

    fn cell(&self, at: &Vector2<f64>) -> [usize; 2] {
        std::array::from_fn(|axis| {
            let cell = (at[axis] - self.low[axis]) / self.width[axis];
            (cell.max(0.0) as usize).min(self.numbers[axis] - 1)
        })
    }

    fn number(&self, [x, y]: [usize; 2]) -> usize {
        y * self.numbers[0] + x
    }

    /// Tells of every disc in the cell of `at` and those around it.
    fn each_near(&self, at: Vector2<f64>, mut tell: impl FnMut(u32)) {
        let [x, y] = self.cell(&at);
        for y in y.saturating_sub(1)..=(y + 1).min(self.numbers[1] - 1) {
            for x in x.saturating_sub(1)..=(x + 1).min(self.numbers[0] - 1) {
                let cell = self.number([x, y]);
                let range = self.start[cell] as usize..self.start[cell + 1] as usize;
                self.discs[range].iter().for_each(|&disc| tell(disc));
            }
        }
    }
}
