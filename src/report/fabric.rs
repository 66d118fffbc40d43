//! Statistics of the force network: chains, directions, forces against angle, distributions.

use serde::Serialize;

use crate::measure::coordination::Histograms;

/// Statistics of the force network of one equilibrium. Magnitudes and chains are of all contacts
/// that count, those with walls among them; directions of those between grains, since a wall
/// prescribes the normals of its own. What no contact tells is NaN.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fabric {
    /// Contacts that count.
    pub contacts: u32,
    /// Those of them between grains.
    pub grain_contacts: u32,
    /// Mean normal force of the contacts \[N\].
    pub mean_normal_force: f64,
    /// Mean magnitude of their tangential forces \[N\].
    pub mean_tangential_force: f64,
    /// Where contacts and forces point.
    pub directions: Directions,
    /// The network of the largest forces.
    pub chains: Chains,
    /// Forces against the angle to the axis.
    pub angle: ByAngle,
    /// Contacts by normal force over its mean; bins as [`distribution`] has them.
    ///
    /// [`distribution`]: crate::measure::fabric::distribution
    pub force_histogram: Vec<u32>,
    /// Contacts by tangential over largest possible tangential force; empty without friction.
    pub mobilised_histogram: Vec<u32>,
    /// Grains by coordination number.
    pub coordination: Histograms,
}

/// Where contacts and forces point; n is the normal, P the normal and Q the tangential force.
/// Tensors are row major.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Directions {
    /// Mean of n⊗n: the fabric tensor, of trace 1.
    pub fabric: [f64; 9],
    /// Σ P n⊗n / Σ P, of trace 1.
    pub force_fabric: [f64; 9],
    /// Σ Q⊗n / Σ P, of trace 0.
    pub shear_fabric: [f64; 9],
    /// a_c: axial anisotropy of the contacts, 15/2 (Φ_zz - (Φ_xx + Φ_yy)/2) of `fabric`.
    pub contact_anisotropy: f64,
    /// a_n: that of the normal forces, the same of `force_fabric` less `fabric`.
    pub normal_anisotropy: f64,
    /// a_t: that of the tangential forces, 5 times the axial part of `shear_fabric`.
    pub tangential_anisotropy: f64,
    /// Share of the contacts whose normal is within 45° of x, y and z; 1 - cos 45° = 29.3 % when
    /// all directions are alike.
    pub cone_all: [f64; 3],
    /// The same of the largest forces ([`Chains::threshold`]).
    pub cone_largest: [f64; 3],
}

/// The network of the largest normal forces: grains are its nodes, contacts its edges, and a chain
/// is what hangs together. Walls end chains and do not join them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Chains {
    /// τ_FC: the share of the contacts that was asked for.
    pub share: f64,
    /// Least normal force in the network \[N\].
    pub threshold: f64,
    /// Contacts in it: the share, rounded, and at least one; more when forces are equal.
    pub contacts: u32,
    /// Grains in it.
    pub grains: u32,
    /// Chains.
    pub count: u32,
    /// Grains in the largest of them.
    pub largest: u32,
    /// Sum of its normal forces over that of all contacts.
    pub load: f64,
    /// Whether a chain reaches from wall to opposite wall, along x, y and z.
    pub spans: [bool; 3],
    /// Largest force such that the contacts that carry at least it connect the walls across x, y
    /// and z \[N\]: the weakest contact of the strongest path. 0 when nothing connects them.
    pub strongest_path: [f64; 3],
}

/// Forces of the contacts between grains against the angle θ of their normals to the axis z, in
/// bins of equal |cos θ|, from the plane to the axis: equal parts of all directions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ByAngle {
    /// Contacts in each bin.
    pub count: Vec<u32>,
    /// Mean normal force \[N\]; NaN in an empty bin, as below.
    pub normal: Vec<f64>,
    /// Mean magnitude of the tangential force \[N\].
    pub tangential: Vec<f64>,
    /// Mean component of the tangential force along the axis' projection on the contact plane
    /// \[N\], positive where it adds to the axial stress.
    pub shear: Vec<f64>,
    /// Least squares over the contacts.
    pub fitted: AngularForm,
    /// What the stress predicts (B A.73 in three dimensions).
    pub predicted: AngularForm,
}

/// Forces of the form P(θ) = lateral sin²θ + axial cos²θ and Q(θ) = shear sin θ cos θ \[N\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AngularForm {
    /// Normal force of a contact across the axis \[N\].
    pub lateral: f64,
    /// Normal force of a contact along it \[N\].
    pub axial: f64,
    /// Twice the tangential force at 45° \[N\].
    pub shear: f64,
}
