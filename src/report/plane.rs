//! What is measured of discs alone.

use serde::Serialize;

/// A pack of discs in one equilibrium, beside its [`PackState`](super::PackState). Angles are from the
/// x-axis to the left.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PlaneState {
    /// d̄, mean diameter of the grains \[m\].
    pub mean_diameter: f64,
    /// γ by which the pack and its side walls lean (B 3.3.4).
    pub tilt: f64,
    /// The interior is further than this from every wall \[m\]: the largest diameter.
    pub margin: f64,
    /// Area of the interior \[m²\].
    pub area: f64,
    /// xx, yy and xy of the stress in the interior, from the contacts (A.41) \[Pa\]; NaN without an
    /// interior.
    pub stress: [f64; 3],
    /// Its major and minor principal value \[Pa\].
    pub principal_stress: [f64; 2],
    /// Direction of the major one, from -π/2 to π/2 \[rad\]; NaN when all are alike.
    pub principal_direction: f64,
    /// n_c/g, mean number of contacts of the grains in the interior that carry load.
    pub contacts_per_grain: f64,
    /// n_c/v = d̄³ n_c/V of the interior (A.83).
    pub contact_density: f64,
    /// Broken bonds over all that there were; 0 without bonds.
    pub share_broken: f64,
    /// Mean rotation of the grains that carry load, to the left \[rad\]: -γ_μ of (30), when the pack was
    /// given without a history.
    pub mean_rotation: f64,
    /// xx, yy and xy of the strain of the increment from the ways of the centres between which contacts
    /// are (A.51), shrinking positive; 0 at the start.
    pub network_strain: [f64; 3],
    /// xx and yy of the same as A.49 and A.50 have it.
    pub contact_strain: [f64; 2],
    /// The contacts of the interior against their direction.
    pub polar: Polar,
    /// Rings about the centre of a pack between circles; empty in a box.
    pub rings: Rings,
}

/// Sums over the contacts between grains in 36 directions: bin k holds normals from 10 k to 10 (k+1)
/// degrees. A contact counts in its direction and in the opposite one.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Polar {
    /// Contacts.
    pub contacts: Vec<u32>,
    /// Sum of F_n \[N\].
    pub normal: Vec<f64>,
    /// Sum of F_s \[N\]: the force is (c F_n + s F_s, s F_n - c F_s) (A.42-A.45).
    pub shear: Vec<f64>,
}

/// Profiles along the radius, from inside to outside.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Rings {
    /// Middle of the ring \[m\].
    pub radius: Vec<f64>,
    /// σ_rr \[Pa\].
    pub radial_stress: Vec<f64>,
    /// σ_tt \[Pa\].
    pub hoop_stress: Vec<f64>,
    /// n_c/v.
    pub contact_density: Vec<f64>,
}
