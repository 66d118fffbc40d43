//! Tangent moduli as a message.

use super::pack_header;
use crate::msg::{Tangent, TangentModuli};
use crate::report::{self, Measures};

/// The tangent moduli, when they were asked for.
#[must_use]
pub fn tangent(measures: &Measures) -> Option<Tangent> {
    measures.tangent.as_ref().map(|tangent| Tangent {
        header: pack_header(measures.stamp),
        increment: measures.increment,
        density: tangent.density,
        products: tangent.products,
        stands: moduli(&tangent.stands),
        sticks: moduli(&tangent.sticks),
    })
}

fn moduli(of: &report::TangentModuli) -> TangentModuli {
    TangentModuli {
        valid: of.valid,
        error: of.error,
        relaxed: of.relaxed,
        affine: of.affine,
        wall_stiffness: of.wall_stiffness.concat(),
        bulk: of.bulk,
        shear: of.shear,
        young: of.young,
        poisson: of.poisson,
        lame: of.lame,
        p_wave: of.p_wave,
        shear_pairs: of.shear_pairs,
        p_speed: of.p_speed,
        s_speed: of.s_speed,
        isotropy_index: of.isotropy_index,
    }
}
