//! The message with the statistics of the force network.

use serde::{Deserialize, Serialize};

use crate::msg::standard::Header;

/// Statistics of the force network; the axis is z.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Fabric {
    /// Stamp of the command served.
    pub header: Header,
    /// 0 for the initial equilibrium, then one more per command served.
    pub increment: u64,
    /// Contacts that carry load.
    pub contacts: u32,
    /// Those of them between grains.
    pub grain_contacts: u32,
    /// Mean normal force \[N\].
    pub mean_normal_force: f64,
    /// Mean magnitude of the tangential forces \[N\].
    pub mean_tangential_force: f64,
    /// Mean of n⊗n, row major.
    pub fabric: [f64; 9],
    /// Σ P n⊗n / Σ P, row major.
    pub force_fabric: [f64; 9],
    /// Σ Q⊗n / Σ P, row major.
    pub shear_fabric: [f64; 9],
    /// Axial anisotropy of the contacts.
    pub contact_anisotropy: f64,
    /// That of the normal forces.
    pub normal_anisotropy: f64,
    /// That of the tangential forces.
    pub tangential_anisotropy: f64,
    /// Share of the normals within 45° of x, y and z.
    pub cone_all: [f64; 3],
    /// The same of the largest forces.
    pub cone_largest: [f64; 3],
    /// Share of the contacts that make the force chains, as asked for.
    pub chain_share: f64,
    /// Least normal force in the chains \[N\].
    pub chain_threshold: f64,
    /// Contacts in the chains.
    pub chain_contacts: u32,
    /// Grains in the chains.
    pub chain_grains: u32,
    /// Connected parts.
    pub chains: u32,
    /// Grains in the largest of them.
    pub largest_chain: u32,
    /// Their part of the sum of the normal forces.
    pub chain_load: f64,
    /// Whether a chain reaches from wall to opposite wall along x, y and z.
    pub chain_spans: [bool; 3],
    /// Force of the weakest contact on the strongest path along x, y and z \[N\].
    pub strongest_path: [f64; 3],
    /// Contacts by normal force over its mean.
    pub force_histogram: Vec<u32>,
    /// Contacts by tangential force over its limit.
    pub mobilised_histogram: Vec<u32>,
    /// Contacts by |cos θ|.
    pub angle_count: Vec<u32>,
    /// Their mean normal force \[N\].
    pub angle_normal: Vec<f64>,
    /// Their mean tangential force \[N\].
    pub angle_tangential: Vec<f64>,
    /// Its mean component along the axis \[N\].
    pub angle_shear: Vec<f64>,
    /// Lateral, axial and shear force of the form fitted \[N\].
    pub angle_fitted: [f64; 3],
    /// The same, predicted from the stress \[N\].
    pub angle_predicted: [f64; 3],
    /// All grains by coordination number.
    pub coordination: Vec<u32>,
    /// Interior grains by coordination number.
    pub interior_coordination: Vec<u32>,
}
