//! Simple shear (A.24, A.25) and true simple shear (A.26-A.29) of the bilinear material.
//!
//! Simple shear keeps σxx and σyy; once the box fails nothing but strain grows. True simple shear
//! keeps the width instead. Its plastic phase follows from A.9, A.13, A.15 and A.16: with λ = ε̇1(1+μ)/2
//! and cos 2α = (σyy - σxx)/2R, sin 2α = σxy/R of the Mohr circle's radius R,
//!
//! ```text
//! ε̇xx,p = -λ (sin ψ + cos 2α)    ε̇yy,p = -λ (sin ψ - cos 2α)    ε̇xy,p = λ sin 2α
//! σ̇xx = -E ε̇xx,p                                  the width stays, and σyy
//! σ̇xy = D σ̇xx, D = [σyy (1+sin²φ') - σxx (1-sin²φ') + c' sin 2φ']/4σxy        the circle touches
//! γ̇ = 2(1+ν)/E σ̇xy + 2λ sin 2α
//! ε̇yy = -ν/E σ̇xx + ε̇yy,p
//! ```
//!
//! so that ε̇yy,p/σ̇xy = (1-J)/(1+J)/ED with the J = sin ψ/cos 2α of A.27, where A.28 prints something
//! else. The angles stay finite where J does not, at σxx = σyy. It ends at cos 2α = -sin ψ with
//! σxx/σyy = (1 + sin φ' sin ψ)/(1 - sin φ' sin ψ) for sand, which is (28) when ψ = φ'.

use super::model::Bilinear;
use super::tensor::Tensor;

/// A place on the curves of a shear test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheared {
    /// γ = 2 εxy.
    pub gamma: f64,
    /// The stress \[Pa\].
    pub stress: Tensor,
    /// εxx, of the shearing.
    pub lateral_strain: f64,
    /// εyy, of the shearing: negative while the box grows higher.
    pub vertical_strain: f64,
}

/// Simple shear at constant σxx = `xx` and σyy = `yy` \[Pa\] up to γ; nothing when these two alone make
/// it fail.
#[must_use]
pub fn simple(material: &Bilinear, xx: f64, yy: f64, gamma: f64) -> Option<Sheared> {
    let limit = material.strength.shear(xx, yy)?;
    let modulus = material.elastic.shear_modulus();
    let xy = f64::min(modulus * gamma, limit);
    let stress = Tensor { xx, yy, xy };
    let plastic = f64::max(gamma - limit / modulus, 0.0);
    if plastic == 0.0 {
        return Some(Sheared { gamma, stress, lateral_strain: 0.0, vertical_strain: 0.0 });
    }
    let slope = Slope::at(material, &stress);
    // A.17 with γ̇ = 2 λ sin 2α.
    let lambda = plastic / (2.0 * slope.sine);
    let dilation = slope.dilatancy;
    Some(Sheared {
        gamma,
        stress,
        lateral_strain: -lambda * (dilation + slope.cosine),
        vertical_strain: -lambda * (dilation - slope.cosine),
    })
}

/// Steps of the integration between two places that are asked for.
const STEPS: u32 = 64;

/// True simple shear from σxx = `xx` at constant σyy = `yy` \[Pa\] at every γ of `gamma`, which do not
/// fall; nothing when these two alone make it fail.
#[must_use]
pub fn true_simple(material: &Bilinear, xx: f64, yy: f64, gamma: &[f64]) -> Option<Vec<Sheared>> {
    let modulus = material.elastic.shear_modulus();
    let failing = material.strength.shear(xx, yy)? / modulus;
    // σxx, εyy and the γ where they are.
    let mut state = [xx, 0.0];
    let mut reached = failing;
    let place = |&gamma: &f64| {
        if gamma <= failing {
            let stress = Tensor { xx, yy, xy: modulus * gamma };
            return Some(Sheared { gamma, stress, lateral_strain: 0.0, vertical_strain: 0.0 });
        }
        let step = (gamma - reached) / f64::from(STEPS);
        for _ in 0..STEPS {
            state = advanced(material, yy, state, step)?;
        }
        reached = gamma;
        let [xx, vertical_strain] = state;
        let stress = Tensor { xx, yy, xy: material.strength.shear(xx, yy)? };
        Some(Sheared { gamma, stress, lateral_strain: 0.0, vertical_strain })
    };
    gamma.iter().map(place).collect()
}

/// A step of γ by the method of Runge and Kutta. The shear stress is that of failure everywhere, so
/// that the state cannot leave it.
fn advanced(material: &Bilinear, yy: f64, from: [f64; 2], step: f64) -> Option<[f64; 2]> {
    let rate = |[xx, _]: [f64; 2]| {
        let stress = Tensor { xx, yy, xy: material.strength.shear(xx, yy)? };
        Some(Slope::at(material, &stress).rates(material))
    };
    let moved = |by: f64, rate: [f64; 2]| [from[0] + by * rate[0], from[1] + by * rate[1]];
    let first = rate(from)?;
    let second = rate(moved(0.5 * step, first))?;
    let third = rate(moved(0.5 * step, second))?;
    let fourth = rate(moved(step, third))?;
    let mean = |k: usize| (first[k] + 2.0 * (second[k] + third[k]) + fourth[k]) / 6.0;
    Some(moved(step, [mean(0), mean(1)]))
}

/// Directions at a stress that fails.
struct Slope {
    /// cos 2α.
    cosine: f64,
    /// sin 2α.
    sine: f64,
    /// D = σ̇xy/σ̇xx at constant σyy (A.27).
    shear: f64,
    /// sin ψ.
    dilatancy: f64,
}

impl Slope {
    fn at(material: &Bilinear, stress: &Tensor) -> Self {
        let (radius, half) = (stress.radius(), 0.5 * (stress.yy - stress.xx));
        // d(R² - half²)/dσxx with R = mean sin φ' + c' cos φ'.
        let shear = (radius * material.strength.friction.sin() + half) / (2.0 * stress.xy);
        let dilatancy = material.dilatancy.sin();
        Self { cosine: half / radius, sine: stress.xy / radius, shear, dilatancy }
    }

    /// σ̇xx/γ̇ \[Pa\] and ε̇yy/γ̇ of true simple shear.
    fn rates(&self, material: &Bilinear) -> [f64; 2] {
        let elastic = &material.elastic;
        let widening = self.dilatancy + self.cosine;
        let gamma = 2.0 * (1.0 + elastic.poisson) * self.shear * widening + 2.0 * self.sine;
        let lambda = gamma.recip();
        let vertical = -elastic.poisson * widening - (self.dilatancy - self.cosine);
        [elastic.young * widening * lambda, vertical * lambda]
    }
}
