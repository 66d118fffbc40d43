//! How the volume changed.

use super::measures::series;
use super::strain::{LEAST, Strain};
use crate::view::chart::Chart;
use crate::view::run::Run;
use crate::view::scale::Axis;
use crate::view::unit::Unit;

/// Volumetric strain, compression positive.
pub(super) fn change(run: &Run, strain: &Strain) -> Chart {
    Chart {
        title: format!("Volume change against {}", strain.name()),
        x: strain.axis(),
        y: Axis::linear("volumetric strain", Unit::Strain),
        series: vec![series(0, "", run, strain, |state| volumetric(state.strain))],
        notes: vec![
            "Engineering strain, loss of volume over the volume at the start or at the scene's \
             reference; a pack that dilates goes down."
                .into(),
        ],
    }
}

/// Loss of volume over the volume at the reference, from the engineering strains of the sides.
fn volumetric(strain: [f64; 3]) -> f64 {
    // Expanded: 1 - (1 - x)(1 - y)(1 - z) would lose the digits of small strains.
    let [x, y, z] = strain;
    let strain = x + y + z - x * y - y * z - z * x + x * y * z;
    if strain.abs() < LEAST { 0.0 } else { strain }
}

/// Pore volume over total volume.
pub(super) fn porosity(run: &Run, strain: &Strain) -> Chart {
    Chart {
        title: format!("Porosity against {}", strain.name()),
        x: strain.axis(),
        y: Axis::linear("porosity", Unit::None),
        series: vec![series(2, "porosity", run, strain, |state| state.porosity)],
        notes: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_two_sides_is_three_quarters_of_the_volume() {
        assert_eq!(volumetric([0.5, 0.0, 0.5]), 0.75);
        // A box of 1 by 2 by 4 that became 2 by 2 by 2.
        assert_eq!(volumetric([-1.0, 0.0, 0.5]), 0.0);
    }

    #[test]
    fn small_strains_keep_their_digits_and_rounding_is_no_strain() {
        assert!((volumetric([1e-10, 2e-10, 3e-10]) / 6e-10 - 1.0).abs() < 1e-9);
        assert_eq!(volumetric([1e-3, 0.0, -1e-3 / (1.0 - 1e-3)]), 0.0);
    }
}
