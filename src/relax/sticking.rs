//! What a frictional contact adds to the stiffness of one of its grains while it sticks: an upper
//! bound of the stiffness that it has when it slides.

use crate::relax::sym3::Sym3;
use crate::relax::sym6::Sym6;
use crate::relax::tangential::{Held, Traction};

/// The block of grain i (`second` false) or j of the contact, for displacement u and rotation times
/// radius w, without its normal part; `scale` multiplies stiffnesses.
///
/// The sliding displacement is ±T u + λ n̂ × w with λ = arm/R.
pub(super) fn block(
    held: &Held,
    traction: &Traction,
    second: bool,
    radius: f64,
    scale: f64,
) -> Sym6 {
    let n = <[f64; 3]>::from(traction.normal).map(|n| n as f32);
    let shear = (held.stiffness * scale) as f32;
    let twist = (held.torsion_stiffness * scale / (radius * radius)) as f32;
    let lever = (traction.arm[usize::from(second)] / radius) as f32;
    let across = |stiffness: f32, along: f32| {
        let mut block = Sym3::diagonal([stiffness; 3]);
        block.add_outer(along - stiffness, n);
        block
    };
    let a = if second { -lever * shear } else { lever * shear };
    Sym6 {
        u: across(shear, 0.0),
        w: across(lever * lever * shear, twist),
        uw: [[0.0, -a * n[2], a * n[1]], [a * n[2], 0.0, -a * n[0]], [-a * n[1], a * n[0], 0.0]],
    }
}
