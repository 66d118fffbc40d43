//! Biaxial tests beside the bilinear material (B figures 15 to 21, A.5).

use super::beside::{Beside, lines};
use super::{Axis, Chart, Series, Unit};
use crate::analytic::fit::biaxial::Test;
use crate::analytic::model::Bilinear;

/// A test that is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Drawn<'a> {
    /// Its name in the legend.
    pub name: &'a str,
    /// What was measured.
    pub test: Test<'a>,
    /// The material that is drawn dashed beside it, if any.
    pub material: Option<Bilinear>,
}

/// The charts of the stress ratio and of the change of the area against the axial strain.
#[must_use]
pub fn charts(tests: &[Drawn]) -> [Chart; 2] {
    let ratio = |test: &Test, place: usize| test.major[place] / test.minor[place];
    let area = |test: &Test, place: usize| test.area_strain[place] - test.area_strain[0];
    let start = |drawn: &Drawn| drawn.test.minor.first().copied().unwrap_or(f64::NAN);
    let ratios = series(tests, &ratio, &|drawn, material, strain| {
        material.biaxial(start(drawn), strain).major / start(drawn)
    });
    let areas = series(tests, &area, &|drawn, material, strain| {
        material.biaxial(start(drawn), strain).area_strain
    });
    let chart = |title: &str, label: &str, unit: Unit, series: Vec<Series>| Chart {
        title: title.into(),
        x: Axis::linear("axial strain", Unit::Strain),
        y: Axis::linear(label, unit),
        series,
        notes: vec!["Dashed: Hooke, then Mohr and Coulomb with dilatancy.".into()],
    };
    [
        chart("Stress ratio against axial strain", "σ1/σ3", Unit::None, ratios),
        chart("Change of the area", "area strain, shrinking", Unit::Strain, areas),
    ]
}

type Predicted<'a> = &'a dyn Fn(&Drawn, &Bilinear, f64) -> f64;

fn series(
    tests: &[Drawn],
    measured: &dyn Fn(&Test, usize) -> f64,
    predicted: Predicted,
) -> Vec<Series> {
    let quantity = |drawn: &Drawn| {
        let test = &drawn.test;
        let lengths = [test.area_strain, test.major, test.minor].map(<[f64]>::len);
        let count = lengths.into_iter().fold(test.axial_strain.len(), usize::min);
        let strain = |place: usize| test.axial_strain[place] - test.axial_strain[0];
        let last = (0..count).map(strain).fold(0.0, f64::max);
        let curve = |material: Bilinear| {
            let bend = material.failure_strain(test.minor[0]).clamp(0.0, last);
            [0.0, bend, last].map(|strain| [strain, predicted(drawn, &material, strain)]).to_vec()
        };
        Beside {
            name: drawn.name.into(),
            measured: (0..count).map(|place| [strain(place), measured(test, place)]).collect(),
            predicted: drawn.material.filter(|_| count > 0).map_or_else(Vec::new, curve),
        }
    };
    lines(&tests.iter().map(quantity).collect::<Vec<_>>())
}
