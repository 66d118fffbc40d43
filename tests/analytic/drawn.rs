//! Charts of predictions beside measurements, read back from the image.

use std::f64::consts::TAU;

use graintwin::analytic::fit::biaxial::Test;
use graintwin::analytic::hooke::Hooke;
use graintwin::analytic::model::Bilinear;
use graintwin::analytic::strength::MohrCoulomb;
use graintwin::analytic::tensor::Tensor;
use graintwin::view::biaxial::{self, Drawn};
use graintwin::view::mohr::{self, Failures};
use graintwin::view::rose::{self, ByDirection, Predicted};
use graintwin::view::{Chart, Pattern, Sheet};
use roxmltree::Document;

use crate::{close, near};

#[test]
fn a_test_of_the_bilinear_material_lies_on_its_curves() {
    let material = Bilinear {
        elastic: Hooke { young: 50e6, poisson: 0.15 },
        strength: MohrCoulomb { friction: 0.52, cohesion: 0.0 },
        dilatancy: 0.22,
    };
    // A recording that does not begin at no strain.
    let strain: Vec<f64> = (0..800).map(|step| 2e-3 + 5e-5 * f64::from(step)).collect();
    let states: Vec<_> = strain.iter().map(|strain| material.biaxial(2e5, strain - 2e-3)).collect();
    let major: Vec<f64> = states.iter().map(|state| state.major).collect();
    let area: Vec<f64> = states.iter().map(|state| 1e-3 + state.area_strain).collect();
    let minor = vec![2e5; 800];
    let test = Test { axial_strain: &strain, area_strain: &area, major: &major, minor: &minor };
    let read = test.material().unwrap();
    close(read.elastic.young, 50e6, 1e-10);
    close(read.elastic.poisson, 0.15, 1e-9);
    close(read.strength.friction, 0.52, 1e-12);
    close(read.dilatancy, 0.22, 1e-9);
    let charts = biaxial::charts(&[Drawn { name: "2 bar", test, material: Some(read) }]);
    for Chart { series, .. } in &charts {
        let [measured, curve] = series.as_slice() else { panic!("{series:?}") };
        assert_eq!((curve.stroke.color, curve.points.len()), (measured.stroke.color, 3));
        for [x, y] in &measured.points {
            let pair = curve.points.windows(2).find(|pair| *x <= pair[1][0] + 1e-12).unwrap();
            let [[x0, y0], [x1, y1]] = [pair[0], pair[1]];
            near(*y, y0 + (x - x0) / (x1 - x0) * (y1 - y0), 1e-6);
        }
    }
    let empty = Test { axial_strain: &[], area_strain: &[], major: &[], minor: &[] };
    assert_eq!(empty.material(), None);
    let charts = biaxial::charts(&[Drawn { name: "", test: empty, material: Some(read) }]);
    assert!(charts.iter().all(Chart::is_empty));
}

#[test]
fn circles_touch_the_line_of_their_strength() {
    let rock = MohrCoulomb { friction: 0.38, cohesion: 9.3e6 };
    let states = [0.0, 2e6, 1e7].map(|minor| [minor, rock.major(minor)]);
    let chart = mohr::chart(&[Failures { name: "A", states: &states, strength: Some(rock) }]);
    let [circles, line] = chart.series.as_slice() else { panic!("{chart:?}") };
    let [[x0, y0], [x1, y1]] = [line.points[0], line.points[1]];
    // How far the circles stay below the line.
    let below = |[x, y]: &[f64; 2]| y0 + (y1 - y0) / (x1 - x0) * (x - x0) - y;
    let pieces = circles.points.split(|[x, _]| x.is_nan()).filter(|piece| !piece.is_empty());
    let least: Vec<f64> =
        pieces.map(|piece| piece.iter().map(below).fold(f64::MAX, f64::min)).collect();
    assert_eq!(least.len(), 3);
    // Within a step along the circle of the place where it touches.
    assert!(least.iter().all(|&least| (-1e-3..1e4).contains(&least)), "{least:?}");
    near(y0, 0.0, 1e-6);
    // Half circles are as high as half of their width.
    let [width, height] = span(&chart);
    assert!(width > 50.0);
    near(width, 2.0 * height, 0.5);
    assert!(mohr::chart(&[]).is_empty());
}

#[test]
fn roses_are_round_and_as_long_as_the_forces() {
    let angle: Vec<f64> = (0..36).map(|bin| TAU * (f64::from(bin) + 0.5) / 36.0).collect();
    let (count, force) = (vec![50.0; 36], vec![2e-3; 36]);
    let measured = ByDirection { angle: &angle, count: &count, normal: &force, shear: &force };
    let stress = Tensor { xx: 1e5, yy: 3e5, xy: 0.0 };
    let predicted = Predicted { stress, diameter: 2e-4, contact_density: 1.9 };
    let charts = rose::charts(&measured, Some(&predicted));
    let longest = |chart: &Chart, number: usize| {
        let lengths = chart.series[number].points.iter().map(|[x, y]| x.hypot(*y));
        lengths.fold(0.0, f64::max)
    };
    // 2 d̄² σ1/n_c/v along y, and half of the difference at 45°.
    close(longest(&charts[1], 1), 2.0 * 4e-8 * 3e5 / 1.9, 1e-12);
    close(longest(&charts[2], 1), 2.0 * 4e-8 * 1e5 / 1.9, 1e-3);
    for (chart, length) in charts.iter().zip([50.0, 2e-3, 2e-3]) {
        close(longest(chart, 0), length, 1e-12);
        assert_eq!(chart.series[0].stroke.pattern, Pattern::Dots);
    }
    let [width, height] = span(&charts[0]);
    assert!(width > 100.0);
    near(width, height, 0.5);
}

/// Width and height of the first line of a chart as it is drawn \[pixels\].
fn span(chart: &Chart) -> [f64; 2] {
    let sheet =
        Sheet { title: String::new(), subtitle: String::new(), charts: vec![chart.clone()] };
    let text = sheet.to_svg();
    let svg = Document::parse(&text).unwrap();
    let series = svg.descendants().filter(|node| node.attribute("class") == Some("series"));
    let line = series.flat_map(|node| node.children()).find(|node| node.has_tag_name("polyline"));
    let line = line.unwrap().attribute("points").unwrap();
    let places = line.split(' ').map(|place| place.split_once(',').unwrap());
    let (x, y): (Vec<f64>, Vec<f64>) =
        places.map(|(x, y)| (x.parse::<f64>().unwrap(), y.parse::<f64>().unwrap())).unzip();
    [x, y].map(|values| {
        let ends = values.iter().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
        ends.1 - ends.0
    })
}
