//! What a scene says about discs.

use super::Cell;
use crate::contact::Other;
use crate::contact::mindlin;
use crate::model::Model;
use crate::scene::{self, BondForm, Linear, LinearBond, Normal, Scene};

/// Constants of a pack of discs.
#[derive(Clone, Debug)]
pub struct Setup {
    /// What the sides enclose.
    pub cell: Cell,
    /// Depth D of the pack \[m\].
    pub depth: f64,
    /// Normal law and its shear stiffness.
    pub law: Law,
    /// Whether grains turn.
    pub turns: bool,
    /// What bonds of cohesive grains bear; `None` where grains do not stick together.
    pub strength: Option<Strength>,
    /// Whether grains that touch a wall at the start stick to it.
    pub glue: bool,
}

/// Stiffness of the contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// Hertz (1) and Mindlin (3).
    Hertz,
    /// The same for all contacts (8-10).
    Linear {
        /// k_n \[N/m\].
        normal: f64,
        /// k_s \[N/m\].
        shear: f64,
    },
}

/// Strength of bonds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strength {
    /// c_μ \[Pa\].
    pub cohesion: f64,
    /// Which mean of the radii it acts on.
    pub form: BondForm,
    /// Whether tension breaks a bond (12).
    pub tension: bool,
    /// Share of the strength where the contact's normal is along x; 1 for all directions alike (B 4.4.4).
    pub along_x: f64,
}

impl Setup {
    /// Of `scene`; `model` has its grains.
    #[must_use]
    pub fn new(model: &Model, scene: &Scene) -> Self {
        let sides = model.start.sides();
        let linear = match scene.contact.normal {
            Normal::Linear(linear) => Some(linear),
            Normal::Hertz | Normal::Cement(_) => None,
        };
        let law = linear.map_or(Law::Hertz, |Linear { stiffness, shear_ratio, .. }| {
            let ratio = shear_ratio.unwrap_or_else(|| shear_ratio_of(model));
            Law::Linear { normal: stiffness, shear: ratio * stiffness }
        });
        let bond = linear.and_then(|linear| linear.bond);
        Self {
            cell: Cell::new(&scene.walls, &model.start),
            depth: sides[2],
            law,
            turns: model.friction.is_some() && scene.contact.rotation == scene::Rotation::Free,
            strength: bond.map(|LinearBond { cohesion, form, tension, along_x }| Strength {
                cohesion,
                form,
                tension,
                along_x,
            }),
            glue: scene.walls.glue,
        }
    }
}

impl Setup {
    /// Volume of a disc of radius `radius` \[m\] as deep as the pack \[m³\].
    #[must_use]
    pub fn volume(&self, radius: f64) -> f64 {
        std::f64::consts::PI * radius * radius * self.depth
    }
}

/// κ of the mean Poisson's ratio of the grains (6).
fn shear_ratio_of(model: &Model) -> f64 {
    let poisson = model.grains.iter().map(|grain| grain.poisson).sum::<f64>();
    shear_ratio(poisson / model.len().max(1) as f64)
}

/// κ = k_s/k_n of two grains of Poisson's ratio ν, k_n the secant stiffness P/h of Hertz (6).
#[must_use]
pub fn shear_ratio(poisson: f64) -> f64 {
    3.0 * (1.0 - poisson) / (2.0 - poisson)
}

impl Law {
    /// k_s \[N/m\] of the contact of grain `first` with `second`, of the effective radius `radius` \[m\],
    /// at the overlap `overlap` \[m\].
    #[must_use]
    pub fn shear_stiffness(
        self,
        model: &Model,
        (first, second): (u32, Other),
        radius: f64,
        overlap: f64,
    ) -> f64 {
        match self {
            Self::Linear { shear, .. } => shear,
            Self::Hertz if overlap <= 0.0 => 0.0,
            Self::Hertz => {
                let Some(friction) = &model.friction else { return 0.0 };
                let other = match second {
                    Other::Grain(j) => friction.shear_compliance[j as usize],
                    Other::Wall(_) => friction.wall_shear_compliance,
                };
                let contact = mindlin::contact_radius(radius, overlap);
                mindlin::shear_stiffness(contact, friction.shear_compliance[first as usize] + other)
            }
        }
    }
}

impl Strength {
    /// F_t \[N\] of a bond between grains of the radii `radii` \[m\] (12), `share` of it.
    #[must_use]
    pub fn force(&self, radius: f64, share: f64) -> f64 {
        self.cohesion * radius * radius * share
    }

    /// The radius \[m\] that F_t goes with: r̄, or √(r_i r_j) (12).
    #[must_use]
    pub fn radius(&self, [one, other]: [f64; 2]) -> f64 {
        match self.form {
            BondForm::Mean => 2.0 * one * other / (one + other),
            BondForm::Product => (one * other).sqrt(),
        }
    }

    /// Share of the strength of a bond whose unit normal has the component `x` along x: all where it
    /// points along y.
    #[must_use]
    pub fn share(&self, x: f64) -> f64 {
        1.0 + (self.along_x - 1.0) * x * x
    }
}
