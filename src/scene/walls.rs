//! The walls' material.

use serde::{Deserialize, Serialize};

use super::check::{Field, Problems};
use super::{Cell, PointSides, Targets, WallName};

/// The elastic walls; T 2.7.1 takes 100 times the grains' modulus.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Walls {
    /// Young's modulus \[Pa\], above 0.
    pub young: f64,
    /// Poisson's ratio, -1 < ν < 0.5.
    pub poisson: f64,
    /// Coefficient of friction between grains and walls, 0 to infinite; without it that of
    /// `contact.friction`. Without friction in `contact` the walls are smooth too.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction: Option<f64>,
    /// Whether discs that touch a wall when the run begins stick to it: they move and turn with it.
    #[serde(skip_serializing_if = "is_false")]
    pub glue: bool,
    /// What the walls do from the initial equilibrium on; those that are not named stand where the
    /// pack has them.
    #[serde(skip_serializing_if = "Targets::is_empty")]
    pub targets: Targets,
    /// What the walls enclose.
    #[serde(skip_serializing_if = "is_box")]
    pub cell: Cell,
    /// Discs in the place of walls: supports and loads at points.
    #[serde(skip_serializing_if = "PointSides::is_empty")]
    pub points: PointSides,
    /// Sides without a wall.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub open: Vec<WallName>,
    /// Sides that are membranes: a pressure on the outline of the pack, which bends with the grains.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub membranes: Vec<WallName>,
}

fn is_box(cell: &Cell) -> bool {
    cell.is_box()
}

impl Default for Walls {
    fn default() -> Self {
        Self {
            young: 7.0e12,
            poisson: 0.495,
            friction: None,
            glue: false,
            targets: Targets::default(),
            cell: Cell::Box,
            points: PointSides::default(),
            open: Vec::new(),
            membranes: Vec::new(),
        }
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands out references")]
fn is_false(flag: &bool) -> bool {
    !flag
}

impl Walls {
    pub(super) fn check(&self, at: &Field, problems: &mut Problems) {
        problems.positive(at.key("young"), self.young, "young > 0 Pa");
        problems
            .number(at.key("poisson"), self.poisson, "-1 < nu < 0.5", |nu| -1.0 < nu && nu < 0.5);
        if let Some(friction) = self.friction {
            problems.at_least_zero(at.key("friction"), friction, "friction >= 0, .inf included");
        }
        self.targets.check(&at.key("targets"), self.cell.is_box(), problems);
    }
}
