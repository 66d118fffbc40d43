//! What a frictional contact adds to the stiffness of one of its grains while it sticks: an upper
//! bound of the stiffness that it has when it slides.

use crate::relax::sym3::Sym3;
use crate::relax::sym6::Sym6;
use crate::relax::tangential::{Held, Traction};

/// The block of grain i (`second` false) or j of the contact, for displacement u and rotation times
/// radius w, with the normal part of cement alone; `scale` multiplies stiffnesses.
///
/// The sliding displacement is ±T u + λ n̂ × w with λ = arm/R.
pub(super) fn block(
    held: &Held,
    traction: &Traction,
    second: bool,
    radius: f64,
    scale: f64,
) -> Sym6 {
    let n = traction.normal;
    let shear = (held.stiffness * scale) as f32;
    let twist = (held.torsion_stiffness * scale / (radius * radius)) as f32;
    let lever = traction.arm[usize::from(second)] / radius as f32;
    let a = if second { -lever * shear } else { lever * shear };
    let axial = (f64::from(traction.axial) * scale) as f32;
    Sym6 {
        u: isotropic_across(n, shear, axial.max(0.0)),
        w: isotropic_across(n, lever * lever * shear, twist),
        uw: [[0.0, -a * n[2], a * n[1]], [a * n[2], 0.0, -a * n[0]], [-a * n[1], a * n[0], 0.0]],
    }
}

/// across (I - n nᵀ) + along n nᵀ.
pub(super) fn isotropic_across(n: [f32; 3], across: f32, along: f32) -> Sym3 {
    let rest = along - across;
    let [x, y, z] = n;
    Sym3::new([
        across + rest * x * x,
        across + rest * y * y,
        across + rest * z * z,
        rest * x * y,
        rest * x * z,
        rest * y * z,
    ])
}
