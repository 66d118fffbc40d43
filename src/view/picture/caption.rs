//! A line of text above the pack.

use super::Canvas;
use super::walls::shape;
use crate::msg::picture::{ColorRGBA, Marker};
use crate::report::Measures;
use crate::view::Unit;

/// Height of the letters over the largest side of the box.
const LETTERS: f64 = 0.04;

/// Strains below are those of rounding.
const ROUNDING: f64 = 1e-12;

/// Seen on black and on white.
const COLOR: ColorRGBA = ColorRGBA { r: 0.5, g: 0.5, b: 0.5, a: 1.0 };

pub(super) fn caption(canvas: &Canvas, name: &str, measures: &Measures) -> Marker {
    let (sides, [x, y, _]) = shape(&measures.walls);
    let letters = LETTERS * sides.into_iter().fold(0.0, f64::max);
    let position = &measures.walls.position;
    let at = match canvas.plane {
        false => [x, y, position[5] + 2.0 * letters],
        true => [x, position[3] + 2.0 * letters, 0.0],
    };
    let mut marker = canvas.marker("text", 0, Marker::TEXT_VIEW_FACING);
    marker.pose.position = canvas.point(at);
    marker.scale = [0.0, 0.0, letters * canvas.scale].into();
    marker.color = COLOR;
    marker.text = text(name, measures, canvas);
    marker
}

/// What there is to say: the strain along the scene's axis, the loss of volume, and stresses.
fn text(name: &str, measures: &Measures, canvas: &Canvas) -> String {
    let mut text = format!("{name}, increment {}", measures.increment);
    if let Some(state) = &measures.state {
        let loss = 1.0 - state.strain.iter().map(|strain| 1.0 - strain).product::<f64>();
        // A constant volume is one to rounding.
        let loss = if loss.abs() < ROUNDING { 0.0 } else { loss };
        text.push_str(&format!(
            ", axial strain {}, volumetric {}, confining stress {}, deviatoric {}",
            quantity(state.strain[if canvas.plane { 1 } else { 2 }], Unit::Strain),
            quantity(loss, Unit::Strain),
            quantity(state.confining_stress, Unit::Si("Pa")),
            quantity(state.deviatoric_stress, Unit::Si("Pa")),
        ));
    }
    text.push_str(&format!(", drawn {} : 1", canvas.scale));
    text
}

/// A value with four digits and its unit.
fn quantity(value: f64, unit: Unit) -> String {
    let (factor, name) = unit.for_magnitude(value.abs());
    let value = value / factor;
    let decimals =
        if value == 0.0 { 0 } else { (3.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize };
    format!("{value:.decimals$} {name}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quantity_has_four_digits_and_a_unit_that_keeps_it_short() {
        assert_eq!(quantity(1.23456e7, Unit::Si("Pa")), "12.35 MPa");
        assert_eq!(quantity(-987.64, Unit::Si("Pa")), "-987.6 Pa");
        assert_eq!(quantity(1.5e-3, Unit::Strain), "0.1500 %");
        assert_eq!(quantity(0.0, Unit::Si("Pa")), "0 Pa");
    }
}
