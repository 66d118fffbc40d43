//! The exact derivative of the balance at one configuration, in double precision, contact by
//! contact: of the forces on the grains and of the normal forces on the walls, with respect to the
//! motion of both.

use crate::Vec3;
use crate::contact::neighbours::wall_gap;
use crate::contact::{Other, hertz};
use crate::model::Model;
use crate::relax::balance::Configuration;
use crate::relax::tangential::{Along, Pose, Slope};
use crate::wall;

/// Normal contact of two grains.
#[derive(Clone, Copy, Debug)]
struct Pair {
    first: u32,
    second: u32,
    normal: Vec3,
    /// kn + P/r \[N/m\].
    along: f64,
    /// P/r \[N/m\].
    bending: f64,
}

/// Normal contact of a grain with a wall.
#[derive(Clone, Copy, Debug)]
struct Side {
    grain: u32,
    wall: u8,
    /// kn \[N/m\].
    stiffness: f64,
}

/// The derivative. Vectors over the grains hold displacements \[m\] or forces \[N\], and with
/// friction behind them rotations times radius \[m\] or moments over radius \[N\].
#[derive(Clone, Debug)]
pub(super) struct Hessian<'a> {
    model: &'a Model,
    pairs: Vec<Pair>,
    sides: Vec<Side>,
    slopes: Vec<Slope>,
    turns: bool,
}

impl<'a> Hessian<'a> {
    /// At the configuration `at`.
    pub(super) fn new(at: &Configuration<'a>) -> Self {
        let Configuration { model, neighbours, position, carries, rotation, bounds, .. } = *at;
        let (mut pairs, mut sides) = (Vec::new(), Vec::new());
        for i in (0..position.len()).filter(|&i| carries[i]) {
            for k in neighbours.row(i) {
                let j = neighbours.second[k] as usize;
                let branch = position[i] - position[j];
                let distance = branch.norm();
                let overlap = neighbours.reach(model, i, k) - distance;
                if overlap > 0.0 && carries[j] {
                    let bending = hertz::force(neighbours.modulus[k], overlap) / distance;
                    pairs.push(Pair {
                        first: i as u32,
                        second: j as u32,
                        normal: branch / distance,
                        along: hertz::stiffness(neighbours.modulus[k], overlap) + bending,
                        bending,
                    });
                }
            }
            for (wall, reach) in neighbours.walls_near(model, i) {
                let overlap = reach - wall_gap(&position[i], usize::from(wall), bounds);
                if overlap > 0.0 {
                    let stiffness =
                        hertz::stiffness(neighbours.wall_modulus(i, usize::from(wall)), overlap);
                    sides.push(Side { grain: i as u32, wall, stiffness });
                }
            }
        }
        let pose = Pose { model, position, rotation, bounds };
        for Along { first, second, normal, stiffness, bending } in
            at.reference.cement_normals(&pose, carries)
        {
            match second {
                Other::Grain(second) => {
                    pairs.push(Pair { first, second, normal, along: stiffness + bending, bending });
                }
                Other::Wall(wall) => sides.push(Side { grain: first, wall, stiffness }),
            }
        }
        let slopes = at.reference.slopes(&pose, carries);
        Self { model, pairs, sides, slopes, turns: at.reference.active }
    }

    /// Length of a vector over the grains.
    pub(super) fn len(&self) -> usize {
        self.model.len() * if self.turns { 2 } else { 1 }
    }

    /// Change of the gradient \[N\] and of the normal forces on the walls \[N\] when the grains
    /// move by `grains` and the walls by `walls` \[m\] inwards.
    pub(super) fn times(
        &self,
        grains: &[Vec3],
        walls: &[f64; wall::COUNT],
    ) -> (Vec<Vec3>, [f64; wall::COUNT]) {
        let mut gradient = vec![Vec3::zeros(); self.len()];
        let mut forces = [0.0; wall::COUNT];
        for pair in &self.pairs {
            let (i, j) = (pair.first as usize, pair.second as usize);
            let moved = grains[i] - grains[j];
            let push = pair.normal * (pair.along * pair.normal.dot(&moved)) - moved * pair.bending;
            gradient[i] += push;
            gradient[j] -= push;
        }
        for side in &self.sides {
            let (i, w) = (side.grain as usize, usize::from(side.wall));
            let inward = wall::inward(w);
            let push = side.stiffness * (walls[w] - grains[i][wall::axis(w)] * inward);
            gradient[i][wall::axis(w)] -= push * inward;
            forces[w] += push;
        }
        for slope in &self.slopes {
            self.add(slope, grains, walls, &mut gradient);
        }
        (gradient, forces)
    }

    /// Adds the change of the tangential load of one contact.
    fn add(
        &self,
        slope: &Slope,
        grains: &[Vec3],
        walls: &[f64; wall::COUNT],
        gradient: &mut [Vec3],
    ) {
        let n = self.model.len();
        let radius = &self.model.radius;
        let turned = |k: usize| grains[n + k] / radius[k];
        let i = slope.first as usize;
        match slope.second {
            Other::Grain(j) => {
                let j = j as usize;
                let by = slope.changed(&(grains[i] - grains[j]), 0.0, [turned(i), turned(j)]);
                gradient[i] -= by.force;
                gradient[j] += by.force;
                gradient[n + i] += by.moment[0] / radius[i];
                gradient[n + j] += by.moment[1] / radius[j];
            }
            Other::Wall(w) => {
                let by =
                    slope.changed(&grains[i], walls[usize::from(w)], [turned(i), Vec3::zeros()]);
                gradient[i] -= by.force;
                gradient[n + i] += by.moment[0] / radius[i];
            }
        }
    }
}
