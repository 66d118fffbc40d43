//! Balances and their slopes, for what holds one against differences of the other.

use graintwin::Vec3;
use graintwin::contact::neighbours::Neighbours;
use graintwin::model::Model;
use graintwin::relax::balance::{Balance, Configuration};
use graintwin::relax::tangential::Reference;
use graintwin::wall;

/// Stiffness that the linearisation is scaled by here \[N/m\]; any number will do.
const REFERENCE: f64 = 3e5;

/// The balance of grains at `at`, of which `carries` take part, between walls displaced inwards.
pub(crate) fn balance(
    model: &Model,
    (at, carries): (&[Vec3], &[bool]),
    displacement: &[f64; wall::COUNT],
) -> (Balance, Neighbours) {
    let bounds = &model.bounds(displacement);
    let mut neighbours = Neighbours::default();
    neighbours.refresh(model, at, bounds);
    let mut balance = Balance::default();
    balance.evaluate(&Configuration {
        model,
        neighbours: &neighbours,
        position: at,
        rotation: &[],
        reference: &Reference::default(),
        carries,
        bounds,
        reference_stiffness: REFERENCE,
    });
    (balance, neighbours)
}

/// H d by the links and wall stiffnesses of the linearisation \[N/m times d\].
pub(crate) fn hessian_times(balance: &Balance, near: &Neighbours, d: &[Vec3]) -> Vec<Vec3> {
    let mut product = vec![Vec3::zeros(); d.len()];
    for i in 0..d.len() {
        let first = near.row(i).start;
        for link in &balance.links[first..first + balance.links_in_row[i] as usize] {
            let j = link.second as usize;
            let m = Vec3::from(link.m.map(f64::from));
            let relative = d[i] - d[j];
            let force = m * m.dot(&relative) - relative * f64::from(link.b);
            product[i] += force;
            product[j] -= force;
        }
        let [xx, yy, zz] = balance.wall_stiffness[i].map(f64::from);
        let xy = f64::from(balance.cross_stiffness(i));
        let v = d[i];
        product[i] += Vec3::new(xx * v.x + xy * v.y, xy * v.x + yy * v.y, zz * v.z);
    }
    product.into_iter().map(|p| p * REFERENCE).collect()
}

/// Vectors of numbers between -1 and 1.
pub(crate) fn vectors(seed: u64, n: usize) -> Vec<Vec3> {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    (0..n).map(|_| Vec3::new(next(), next(), next())).collect()
}

/// `at` moved by `step` along `d`.
pub(crate) fn along(at: &[Vec3], d: &[Vec3], step: f64) -> Vec<Vec3> {
    at.iter().zip(d).map(|(x, d)| x + d * step).collect()
}
