//! What the contacts of discs are made of, as the scene and the pack of a recording tell it.

use std::path::Path;

use crate::analytic::contact::stiffness_ratio;
use crate::pack::{self, Pack, Texts};
use crate::record::reader::Bag;
use crate::scene::{self, Normal};

/// Contacts of discs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Contacts {
    /// Hertz and Mindlin.
    Hertz {
        /// G of the grains \[Pa\], their mean.
        shear_modulus: f64,
        /// ν, their mean.
        poisson: f64,
    },
    /// Of constant stiffness.
    Linear {
        /// k_n \[N/m\].
        stiffness: f64,
        /// κ = k_s/k_n.
        kappa: f64,
        /// c_μ of bonds that break \[Pa\].
        cohesion: Option<f64>,
    },
}

impl Contacts {
    /// Those of the discs of `bag`; nothing of spheres, and where the attachments are not there or not of
    /// this version.
    pub(in crate::view) fn read(bag: &Bag) -> Option<Self> {
        let text = |name: &str| String::from_utf8(bag.attachment(name).ok()??).ok();
        let scene = scene::parse(&text("scene.yaml")?, Path::new("scene.yaml")).ok()?;
        if scene.dimension != 2 {
            return None;
        }
        let texts = Texts { csv: text("pack.csv")?, json: text("pack.json")?, history: None };
        let pack = pack::from_texts(&scene, &texts, Path::new("pack.csv")).ok()?;
        Some(Self::of(&scene.contact.normal, &pack))
    }

    fn of(law: &Normal, pack: &Pack) -> Self {
        let mean = |value: fn(&pack::Grain) -> f64| {
            pack.grains.iter().map(value).sum::<f64>() / pack.grains.len().max(1) as f64
        };
        let poisson = mean(|grain| grain.poisson);
        match law {
            Normal::Linear(linear) => Self::Linear {
                stiffness: linear.stiffness,
                kappa: linear.shear_ratio.unwrap_or_else(|| stiffness_ratio(poisson)),
                cohesion: linear.bond.map(|bond| bond.cohesion).filter(|c| c.is_finite()),
            },
            Normal::Hertz | Normal::Cement(_) => Self::Hertz {
                shear_modulus: mean(|grain| 0.5 * grain.young / (1.0 + grain.poisson)),
                poisson,
            },
        }
    }
}
