//! The message about discs.

use serde::{Deserialize, Serialize};

use crate::msg::standard::Header;

/// A pack of discs, beside its state.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PlaneState {
    /// Stamp of the command served.
    pub header: Header,
    /// 0 for the initial equilibrium, then one more per command served.
    pub increment: u64,
    /// Mean diameter of the grains \[m\].
    pub mean_diameter: f64,
    /// γ by which the pack and its side walls lean.
    pub tilt: f64,
    /// The interior is further than this from every wall \[m\].
    pub margin: f64,
    /// Area of the interior \[m²\].
    pub area: f64,
    /// xx, yy and xy of the stress in the interior \[Pa\].
    pub stress: [f64; 3],
    /// Its major and minor principal value \[Pa\].
    pub principal_stress: [f64; 2],
    /// Direction of the major one \[rad\].
    pub principal_direction: f64,
    /// Mean number of contacts of the grains in the interior that carry load.
    pub contacts_per_grain: f64,
    /// d̄³ n_c/V of the interior.
    pub contact_density: f64,
    /// Broken bonds over all.
    pub share_broken: f64,
    /// Mean rotation of the grains that carry load, to the left \[rad\].
    pub mean_rotation: f64,
    /// xx, yy and xy of the strain of the increment from the ways of the grains (A.51).
    pub network_strain: [f64; 3],
    /// xx and yy of the same as A.49 and A.50 have it.
    pub contact_strain: [f64; 2],
    /// Contacts of the interior in 36 directions.
    pub polar_contacts: Vec<u32>,
    /// Sums of their normal forces \[N\].
    pub polar_normal: Vec<f64>,
    /// Sums of their shear forces \[N\].
    pub polar_shear: Vec<f64>,
    /// Middles of rings about the centre \[m\].
    pub ring_radius: Vec<f64>,
    /// Radial stress in them \[Pa\].
    pub ring_radial_stress: Vec<f64>,
    /// Hoop stress in them \[Pa\].
    pub ring_hoop_stress: Vec<f64>,
    /// d̄³ n_c/V of them.
    pub ring_contact_density: Vec<f64>,
}
