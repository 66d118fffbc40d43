//! Every pair of grains and walls of a snapshot, one by one: what contacts there are, and what they
//! hold.

use graintwin::Vec3;
use graintwin::pack::Grain;
use graintwin::report::Snapshot;
use graintwin::wall;

use crate::hard::Hard;

/// Overlap over the mean from which on a pair is a contact, as `docs/events.md` has it.
const FAINT: f64 = 1e-4;

/// The touching pairs of a snapshot of a frictionless pack, or of its normal forces.
pub(crate) struct Pairs {
    /// (first, second), sorted; walls as `u32::MAX - w`.
    pub(crate) contacts: Vec<[u32; 2]>,
    /// Sum of 2/5 M h^2.5 \[J\].
    pub(crate) energy: f64,
    /// A third of the trace of Σ P r over the volume \[Pa\].
    pub(crate) stress: f64,
    /// Largest sum of normal forces on a grain over the mean force.
    pub(crate) residual: f64,
    /// \[m\].
    pub(crate) mean_overlap: f64,
}

impl Pairs {
    pub(crate) fn of(hard: &Hard, snapshot: &Snapshot) -> Self {
        let grains = &hard.pack.grains;
        let at: Vec<Vec3> = snapshot.position.iter().map(|at| Vec3::from(*at)).collect();
        let compliance = |grain: &Grain| (1.0 - grain.poisson.powi(2)) / grain.young;
        let walls = &hard.scene.walls;
        let wall_compliance = (1.0 - walls.poisson.powi(2)) / walls.young;
        let mut touching: Vec<([u32; 2], f64)> = Vec::new();
        let mut unbalanced = vec![Vec3::zeros(); at.len()];
        let (mut energy, mut force, mut virial) = (0.0, 0.0, 0.0);
        // Overlap, R* and 1/E* of a pair, its normal towards the first and its distance.
        let mut add =
            |pair: [u32; 2], overlap: f64, radius: f64, compliance: f64, normal: Vec3, r: f64| {
                if overlap <= 0.0 {
                    return;
                }
                // M = 4/3 E* √R* (T 2.2)
                let modulus = 4.0 / 3.0 / compliance * radius.sqrt();
                let normal_force = modulus * overlap.powf(1.5);
                touching.push((pair, overlap));
                energy += 0.4 * modulus * overlap.powf(2.5);
                force += normal_force;
                virial += normal_force * r;
                unbalanced[pair[0] as usize] += normal * normal_force;
                if let Some(second) = unbalanced.get_mut(pair[1] as usize) {
                    *second -= normal * normal_force;
                }
            };
        for (i, one) in grains.iter().enumerate() {
            for (j, other) in grains.iter().enumerate().skip(i + 1) {
                let branch = at[i] - at[j];
                let distance = branch.norm();
                let overlap = one.radius + other.radius - distance;
                let radius = 1.0 / (1.0 / one.radius + 1.0 / other.radius);
                let compliance = compliance(one) + compliance(other);
                add([i as u32, j as u32], overlap, radius, compliance, branch / distance, distance);
            }
            for w in 0..wall::COUNT {
                let mut normal = Vec3::zeros();
                normal[w / 2] = if w % 2 == 0 { 1.0 } else { -1.0 };
                let gap = (at[i][w / 2] - snapshot.wall_position[w]) * normal[w / 2];
                let compliance = compliance(one) + wall_compliance;
                let pair = [i as u32, u32::MAX - w as u32];
                add(pair, one.radius - gap, one.radius, compliance, normal, gap);
            }
        }
        let count = touching.len() as f64;
        let mean_overlap = touching.iter().map(|(_, overlap)| overlap).sum::<f64>() / count;
        let mut contacts: Vec<[u32; 2]> = touching
            .iter()
            .filter(|(_, overlap)| *overlap >= FAINT * mean_overlap)
            .map(|(pair, _)| *pair)
            .collect();
        contacts.sort_unstable();
        let walls = snapshot.wall_position;
        let volume = (walls[1] - walls[0]) * (walls[3] - walls[2]) * (walls[5] - walls[4]);
        let largest = unbalanced.iter().map(Vec3::norm).fold(0.0, f64::max);
        Self {
            contacts,
            energy,
            stress: virial / (3.0 * volume),
            residual: largest * count / force,
            mean_overlap,
        }
    }

    /// The contacts that are here and not `there`, and those that are there and not here.
    pub(crate) fn apart(&self, there: &Self) -> (Vec<[u32; 2]>, Vec<[u32; 2]>) {
        let without = |these: &Self, those: &Self| {
            these.contacts.iter().filter(|pair| !those.contacts.contains(pair)).copied().collect()
        };
        (without(self, there), without(there, self))
    }
}
