//! A line of text above the pack.

use super::Canvas;
use super::walls::shape;
use crate::msg::picture::{ColorRGBA, Marker};
use crate::report::Measures;
use crate::view::Unit;

/// Height of the letters over the largest side of the box.
const LETTERS: f64 = 0.04;

/// Seen on black and on white.
const COLOR: ColorRGBA = ColorRGBA { r: 0.5, g: 0.5, b: 0.5, a: 1.0 };

pub(super) fn caption(canvas: &Canvas, name: &str, measures: &Measures) -> Marker {
    let (sides, [x, y, _]) = shape(&measures.walls);
    let letters = LETTERS * sides.into_iter().fold(0.0, f64::max);
    let top = measures.walls.position[5] + 2.0 * letters;
    let mut marker = canvas.marker("text", 0, Marker::TEXT_VIEW_FACING);
    marker.pose.position = canvas.point([x, y, top]);
    marker.scale = [0.0, 0.0, letters * canvas.scale].into();
    marker.color = COLOR;
    marker.text = text(name, measures, canvas.scale);
    marker
}

/// What there is to say: the strain along the scene's axis, the loss of volume, and stresses.
fn text(name: &str, measures: &Measures, scale: f64) -> String {
    let mut text = format!("{name}, increment {}", measures.increment);
    if let Some(state) = &measures.state {
        let volume = state.strain.iter().map(|strain| 1.0 - strain).product::<f64>();
        text.push_str(&format!(
            ", axial strain {}, volumetric {}, confining stress {}, deviatoric {}",
            quantity(state.strain[2], Unit::Strain),
            quantity(1.0 - volume, Unit::Strain),
            quantity(state.confining_stress, Unit::Si("Pa")),
            quantity(state.deviatoric_stress, Unit::Si("Pa")),
        ));
    }
    text.push_str(&format!(", drawn {scale} : 1"));
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
