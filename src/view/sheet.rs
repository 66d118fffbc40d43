//! Charts on a white card.

use super::chart::Chart;
use super::draw::{draw, flatness};
use super::layout::{NOTE, shortened, wrapped};
use super::scale::Kind;
use super::svg::{Anchor, Svg};

/// Charts on one image.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// Heading: the name of the scene.
    pub title: String,
    /// Below it, smaller.
    pub subtitle: String,
    /// The charts, row by row.
    pub charts: Vec<Chart>,
}

/// Size of one chart \[pixels\].
const CHART: [f64; 2] = [560.0, 380.0];

/// Width of one chart where all are planes, its lowest and largest height, and what of width and height is
/// beside and below the plane \[pixels\].
const PLANE: f64 = 560.0;
const PLANE_HEIGHTS: (f64, f64) = (280.0, 640.0);
const BESIDE: [f64; 2] = [100.0, 140.0];

/// Size of a chart that is alone \[pixels\].
const ALONE: [f64; 2] = [720.0, 440.0];

/// Between the charts and around them \[pixels\].
const GAP: f64 = 20.0;

/// The heading without its second line \[pixels\].
const HEAD: f64 = 36.0;

/// Size of the letters of the heading \[pixels\], and a fifth more, since they are bold.
const HEADING: f64 = 1.2 * 18.0;

/// Between lines of the subtitle \[pixels\].
const LINE: f64 = 16.0;

/// A card of its own: readable on light and dark pages.
const STYLE: &str = "\
    text{font-family:system-ui,-apple-system,'Segoe UI','DejaVu Sans',Helvetica,Arial,sans-serif;\
    fill:#24292f}\
    .heading{font-size:18px;font-weight:600}\
    .note{font-size:11px;fill:#57606a}\
    .title{font-size:14px;font-weight:600}\
    .label{font-size:12px}\
    .card{fill:#ffffff;stroke:#d0d7de}\
    .grid{stroke:#e6e9ed}\
    .axis{stroke:#57606a}\
    .zero{stroke:#8c959f}\
    polyline{stroke-linejoin:round;stroke-linecap:round}";

impl Sheet {
    /// The image as SVG.
    #[must_use]
    pub fn to_svg(&self) -> String {
        let columns = self.charts.len().clamp(1, 2);
        let plane = |chart: &Chart| chart.x.kind == Kind::Plane;
        let chart = match columns {
            1 => ALONE,
            _ if self.charts.iter().all(plane) => [PLANE, self.plane_height()],
            _ => CHART,
        };
        let rows = self.charts.len().div_ceil(columns).max(1);
        let width = GAP + columns as f64 * (chart[0] + GAP);
        let subtitle = wrapped(&self.subtitle, NOTE, width - 4.0 * GAP);
        let head = GAP + HEAD + LINE * subtitle.len() as f64;
        let height = head + rows as f64 * (chart[1] + GAP);

        let mut svg = Svg::default();
        svg.rect("card", [0.5, 0.5], [width - 1.0, height - 1.0], 10.0);
        let left = GAP + 12.0;
        let title = shortened(&self.title, HEADING, width - 2.0 * left);
        svg.text("heading", [left, GAP + 18.0], Anchor::Start, &title);
        for (line, text) in subtitle.iter().enumerate() {
            let y = GAP + HEAD + LINE * line as f64;
            svg.text("note", [left, y], Anchor::Start, text);
        }
        for (number, which) in self.charts.iter().enumerate() {
            let (row, column) = (number / columns, number % columns);
            let x = GAP + column as f64 * (chart[0] + GAP);
            let y = head + row as f64 * (chart[1] + GAP);
            draw(&mut svg, which, [x, y], chart);
        }
        svg.document([width, height], &self.title, STYLE)
    }

    /// Height of each chart where all are planes \[pixels\]: as the tallest of them needs it.
    fn plane_height(&self) -> f64 {
        let tallest = self.charts.iter().filter_map(flatness).fold(0.0, f64::max);
        let height = tallest * (PLANE - BESIDE[0]) + BESIDE[1];
        height.clamp(PLANE_HEIGHTS.0, PLANE_HEIGHTS.1)
    }
}

#[cfg(test)]
mod tests {
    use super::super::chart::Series;
    use super::super::scale::Axis;
    use super::super::unit::Unit;
    use super::*;

    fn drawn(width: f64, height: f64) -> f64 {
        let axis = || Axis::plane("x", Unit::Si("m"));
        let chart = Chart {
            title: "plane".into(),
            x: axis(),
            y: axis(),
            series: vec![Series::new(0, "", [[0.0, 0.0], [width, height]])],
            notes: Vec::new(),
        };
        let (title, subtitle) = ("scene".into(), String::new());
        let svg = Sheet { title, subtitle, charts: vec![chart.clone(), chart] }.to_svg();
        let height = svg.split("height=\"").nth(1).and_then(|rest| rest.split('"').next());
        height.unwrap().parse().unwrap()
    }

    #[test]
    fn flat_planes_take_less_room_than_tall_ones() {
        let [flat, square, tall] = [(4.0, 1.0), (1.0, 1.0), (1.0, 4.0)].map(|(w, h)| drawn(w, h));
        assert!(flat + 200.0 < square && square <= tall, "{flat} {square} {tall}");
    }
}
