//! Masses that let all grains follow one time step.
//!
//! The stiffness of all contacts together is at most twice the block diagonal D of what holds each
//! grain alone (once for a contact with a wall), because k(a - b)² <= 2ka² + 2kb². With the largest
//! row sum of |D| as the mass of a grain all frequencies are below √2 (Gershgorin).

use crate::contact::Other;
use crate::heap;
use crate::model::Model;
use crate::relax::dynamic::leap::raise;
use crate::relax::sym3::Sym3;
use crate::relax::sym6::Sym6;
use crate::relax::{Workspace, sticking};

/// Mass of each grain and of its rotation times radius \[N/m\].
#[derive(Clone, Debug, Default)]
pub(super) struct Masses {
    mass: Vec<[f64; 2]>,
    /// Stiffness in shear and torsion, in units of the reference, shape (n).
    shear: Vec<Sym6>,
    /// The same with the normal stiffness, where a wall counts by half.
    stiffness: Vec<Sym6>,
}

impl Masses {
    /// Memory that its lists hold \[bytes\].
    pub(super) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.mass) + heap::bytes(&self.shear) + heap::bytes(&self.stiffness)
    }

    pub(super) fn of(&self, i: usize) -> [f64; 2] {
        self.mass[i]
    }

    /// Takes the masses from the contacts of the balance taken last.
    pub(super) fn take(&mut self, model: &Model, work: &Workspace) {
        self.take_shear(model, work);
        self.take_normal(work);
        let unit = work.reference_stiffness;
        self.mass.clear();
        self.mass.extend(self.stiffness.iter().map(|s| row_sums(s).map(|sum| sum * unit)));
        raise(&mut self.mass, unit);
    }

    /// Raises masses that are too small for the contacts of the balance taken last, and tells what
    /// share of the new mass the old one was.
    pub(super) fn grow(&mut self, work: &Workspace, mut tell: impl FnMut(usize, [f64; 2])) {
        self.take_normal(work);
        for (i, (mass, stiffness)) in self.mass.iter_mut().zip(&self.stiffness).enumerate() {
            let [u, w] = row_sums(stiffness).map(|sum| sum * work.reference_stiffness);
            if u > mass[0] || w > mass[1] {
                let now = [u.max(mass[0]), w.max(mass[1])];
                tell(i, [mass[0] / now[0], mass[1] / now[1]]);
                *mass = now;
            }
        }
    }

    fn take_shear(&mut self, model: &Model, work: &Workspace) {
        let Workspace { balance, reference, reference_stiffness, .. } = work;
        let scale = 1.0 / reference_stiffness;
        self.shear.clear();
        self.shear.resize(model.len(), Sym6::default());
        for (held, traction) in reference.contacts.iter().zip(&balance.tractions) {
            if !traction.live {
                continue;
            }
            let i = held.first as usize;
            match held.second {
                Other::Grain(j) => {
                    for (i, second) in [(i, false), (j as usize, true)] {
                        let radius = model.radius[i];
                        self.shear[i].add(&sticking::block(held, traction, second, radius, scale));
                    }
                }
                Other::Wall(_) => {
                    let half = 0.5 * scale;
                    let radius = model.radius[i];
                    self.shear[i].add(&sticking::block(held, traction, false, radius, half));
                }
            }
        }
    }

    fn take_normal(&mut self, work: &Workspace) {
        let Workspace { balance, neighbours, .. } = work;
        self.stiffness.clone_from(&self.shear);
        for (i, &[x, y, z]) in balance.wall_stiffness.iter().enumerate() {
            let xy = 0.5 * balance.cross_stiffness(i);
            self.stiffness[i].u.add(&Sym3::new([0.5 * x, 0.5 * y, 0.5 * z, xy, 0.0, 0.0]));
            let first = neighbours.row(i).start;
            for link in &balance.links[first..first + balance.links_in_row[i] as usize] {
                let normal = Sym3::outer_minus(link.m, 0.0);
                self.stiffness[i].u.add(&normal);
                self.stiffness[link.second as usize].u.add(&normal);
            }
        }
    }
}

/// Largest sum of the absolute values of a row, of the displacement's and of the rotation's.
fn row_sums(block: &Sym6) -> [f64; 2] {
    let sum = |row: [f32; 3]| row.iter().map(|entry| entry.abs()).sum::<f32>();
    let (u, w) = (block.u.columns(), block.w.columns());
    let mut largest = [0.0f32; 2];
    for k in 0..3 {
        let coupling = [block.uw[k], [0, 1, 2].map(|row| block.uw[row][k])];
        for (kind, own) in [u[k], w[k]].into_iter().enumerate() {
            largest[kind] = largest[kind].max(sum(own) + sum(coupling[kind]));
        }
    }
    largest.map(f64::from)
}
