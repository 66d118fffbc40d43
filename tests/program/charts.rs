//! Charts as a program draws them: marks, bands and legends in the SVG, read by another library.

use graintwin::view::{Axis, Chart, Pattern, Series, Sheet, Stroke, Unit};
use roxmltree::{Document, Node};

const POINTS: [[f64; 2]; 3] = [[0.0, 1.0], [1.0, 2.0], [2.0, 1.5]];

fn series(pattern: Pattern) -> Series {
    let stroke = Stroke { pattern, ..Stroke::of(0) };
    Series { stroke, ..Series::new(0, "measured", POINTS) }
}

fn svg(series: Vec<Series>) -> String {
    let axis = |label| Axis::linear(label, Unit::None);
    let (x, y) = (axis("x"), axis("y"));
    let chart = Chart { title: "chart".into(), x, y, series, notes: Vec::new() };
    Sheet { title: "sheet".into(), subtitle: String::new(), charts: vec![chart] }.to_svg()
}

/// The elements `name` within the groups of class `class`.
fn within<'a>(svg: &'a Document, class: &str, name: &str) -> Vec<Node<'a, 'a>> {
    let groups = svg.descendants().filter(|node| node.attribute("class") == Some(class));
    groups.flat_map(|group| group.children()).filter(|node| node.has_tag_name(name)).collect()
}

/// The places of a `points` attribute.
fn places(node: Node) -> Vec<[f64; 2]> {
    let place = |place: &str| {
        let (x, y) = place.split_once(',').unwrap();
        [x.parse().unwrap(), y.parse().unwrap()]
    };
    node.attribute("points").unwrap().split(' ').map(place).collect()
}

#[test]
fn dots_are_not_joined_and_dashes_are_not_marked() {
    let text = svg(vec![series(Pattern::Dots)]);
    let dots = Document::parse(&text).unwrap();
    assert_eq!(within(&dots, "series", "circle").len(), POINTS.len());
    assert!(within(&dots, "series", "polyline").is_empty());
    assert_eq!(within(&dots, "sample", "circle").len(), 1);

    let text = svg(vec![series(Pattern::Dashed)]);
    let dashes = Document::parse(&text).unwrap();
    assert!(within(&dashes, "series", "circle").is_empty());
    let lines = within(&dashes, "series", "polyline");
    assert!(lines.len() == 1 && lines[0].has_attribute("stroke-dasharray"));
}

#[test]
fn a_band_lies_about_its_line_and_within_the_axes() {
    let spread = vec![[-3.0, 1.2], [1.8, 9.0], [1.5, 1.5]];
    let text = svg(vec![Series { spread, ..series(Pattern::Solid) }]);
    let svg = Document::parse(&text).unwrap();
    let line = places(within(&svg, "series", "polyline")[0]);
    let band = places(within(&svg, "series", "polygon")[0]);
    assert_eq!(band.len(), 6);
    for (at, [x, y]) in line.iter().enumerate() {
        let (low, high) = (band[at], band[5 - at]);
        assert!(low[0] == *x && high[0] == *x);
        // Up is less in an image.
        assert!(high[1] <= *y && *y <= low[1], "{high:?} {y} {low:?}");
    }
    let grid: Vec<f64> = svg
        .descendants()
        .filter(|node| node.attribute("class") == Some("grid"))
        .filter(|node| node.attribute("y1") == node.attribute("y2"))
        .map(|node| node.attribute("y1").unwrap().parse().unwrap())
        .collect();
    let (top, bottom) = (grid.iter().copied().fold(f64::MAX, f64::min), grid[0]);
    assert!(band.iter().all(|[_, y]| (top..=bottom).contains(y)), "{band:?}");
}

#[test]
fn a_band_is_broken_where_it_has_no_value() {
    let spread = vec![[0.5, 1.5], [f64::NAN, 2.5], [1.0, 2.0]];
    let text = svg(vec![Series { spread, ..series(Pattern::Solid) }]);
    let svg = Document::parse(&text).unwrap();
    // What is left on either side is a single place, which has no width.
    assert!(within(&svg, "series", "polygon").is_empty());
    assert_eq!(places(within(&svg, "series", "polyline")[0]).len(), POINTS.len());
}

#[test]
fn a_series_without_a_name_is_drawn_but_not_in_the_legend() {
    let nameless = Series { name: String::new(), ..series(Pattern::Dashed) };
    let text = svg(vec![series(Pattern::Solid), nameless]);
    let svg = Document::parse(&text).unwrap();
    assert_eq!(within(&svg, "series", "polyline").len(), 2);
    assert_eq!(within(&svg, "sample", "polyline").len(), 1);
}

#[test]
fn a_line_of_a_million_points_is_thinned_and_keeps_its_extremes() {
    let wave = |at: u32| {
        let spike = match at {
            300_001 => 9.0,
            700_003 => -7.0,
            _ => 0.0,
        };
        [f64::from(at), spike + f64::from(at.wrapping_mul(2_654_435_761)) / f64::from(u32::MAX)]
    };
    let of = |count: u32| svg(vec![Series::new(0, "measured", (0..count).map(wave))]);
    let text = of(1_000_000);
    assert!(text.len() < 2_000_000, "{} bytes", text.len());
    let svg = Document::parse(&text).unwrap();
    let drawn: Vec<f64> =
        within(&svg, "series", "polyline").into_iter().flat_map(places).map(|at| at[1]).collect();
    // The places of 9 and −7, of which 10 and 0 are labelled.
    let label = |number: &str| {
        let label = svg.descendants().find(|node| {
            node.text() == Some(number) && node.attribute("text-anchor") == Some("end")
        });
        label.unwrap().attribute("y").unwrap().parse::<f64>().unwrap() - 4.0
    };
    let height = |value: f64| label("0") + value / 10.0 * (label("10") - label("0"));
    let (top, bottom) =
        drawn.iter().fold((f64::MAX, f64::MIN), |(top, bottom), y| (top.min(*y), bottom.max(*y)));
    let at = |spike: u32| height(wave(spike)[1]);
    assert!((top - at(300_001)).abs() < 0.02, "{top} {}", at(300_001));
    assert!((bottom - at(700_003)).abs() < 0.02, "{bottom} {}", at(700_003));
}

#[test]
fn a_loop_of_few_points_is_drawn_whole_however_often_it_turns() {
    let turn = |at: u32| (f64::from(at) * 0.3).sin_cos();
    let points = (0..2_000).map(|at| [turn(at).0, turn(at).1]);
    let text = svg(vec![Series::new(0, "loop", points)]);
    let svg = Document::parse(&text).unwrap();
    assert_eq!(places(within(&svg, "series", "polyline")[0]).len(), 2_000);
}
