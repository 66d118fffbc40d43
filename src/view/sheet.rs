//! Charts on a white card.

use super::chart::Chart;
use super::draw::draw;
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

/// Size of one chart where all are planes \[pixels\].
const PLANE: [f64; 2] = [560.0, 640.0];

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
            _ if self.charts.iter().all(plane) => PLANE,
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
}
