//! The second derivative of the volume behind a membrane.
//!
//! With W_u x = w_u × x for the edge w_u opposite to the corner u (b - c of a), and X x = D x_m × x, the
//! derivative D N / 3 + ½ w_u × D x_m by the corner u has the derivatives
//!
//! ```text
//! ∂²V/∂u∂u = (W_u D - D W_u) / 6
//! ∂²V/∂u∂v = (W_u D - D W_v) / 6 ∓ ½ X
//! ```
//!
//! by itself, the next corner (-) and the one before (+). Where two triangles meet the two X nearly cancel.

use nalgebra::Matrix3;

use super::{Corner, Membrane};
use crate::Vec3;
use crate::relax::curvature::{Block3, Curvature};

impl Membrane {
    /// Adds the second derivative of p V to `to`, times `scale`.
    pub(super) fn bend(&self, at: &[Vec3], scale: f64, to: &mut Curvature) {
        let Some(room) = &self.room else { return };
        let d =
            Matrix3::from_columns(&[Vec3::x(), Vec3::y(), Vec3::z()].map(|e| self.field(room, &e)));
        let strength = self.pressure * scale;
        self.each_place(at, |triangle, [a, b, c]| {
            let edges = [b - c, c - a, a - b].map(|edge| edge.cross_matrix());
            let half = (d * (a + b + c) / 6.0).cross_matrix();
            let corners = triangle.map(|corner| &self.corners[corner as usize]);
            for u in 0..3 {
                let own = (edges[u] * d - d * edges[u]) / 6.0;
                let block = free(&(own * strength), corners[u], corners[u]);
                to.own.push((corners[u].grain, rows(&block)));
                let v = (u + 1) % 3;
                let pair = (edges[u] * d - d * edges[v]) / 6.0 - half;
                let block = free(&(pair * strength), corners[u], corners[v]);
                match [corners[u].grain, corners[v].grain] {
                    [i, j] if i == j => to.own.push((i, rows(&(block + block.transpose())))),
                    grains => to.pairs.push((grains, rows(&block))),
                }
            }
        });
    }
}

/// `block` without the coordinates of the corners that are on walls.
fn free(block: &Matrix3<f64>, row: &Corner, column: &Corner) -> Matrix3<f64> {
    let entry = |r: usize, c: usize| match (row.on[r], column.on[c]) {
        (None, None) => block[(r, c)],
        _ => 0.0,
    };
    Matrix3::from_fn(entry)
}

fn rows(block: &Matrix3<f64>) -> Block3 {
    [0, 1, 2].map(|r| [0, 1, 2].map(|c| block[(r, c)] as f32))
}
