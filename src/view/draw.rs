//! A chart as SVG elements.

use super::chart::{Chart, Pattern, Series};
use super::layout::{LABEL, NOTE, rows, width, wrapped};
use super::scale::{Kind, Scale};
use super::svg::{Anchor, Svg};
use super::thin::{apart, thinned};

/// Height of a row of the legend, and of a line of notes \[pixels\].
const ROW: f64 = 18.0;

/// Length of a line in the legend \[pixels\].
const SAMPLE: f64 = 20.0;

/// Width of a line in the legend, at most: its round end must not reach the name \[pixels\].
const WIDEST_SAMPLE: f64 = 6.5;

/// Points of a line that are marked one by one, at most.
const MOST_DOTS: usize = 60;

/// Where the lines are drawn.
struct Frame {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
    x: Scale,
    y: Scale,
}

impl Frame {
    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.across(self.x.place(x)), self.up(self.y.place(y))]
    }

    fn across(&self, share: f64) -> f64 {
        self.left + share * (self.right - self.left)
    }

    fn up(&self, share: f64) -> f64 {
        self.bottom - share * (self.bottom - self.top)
    }
}

/// Draws `chart` into the rectangle at `at`.
pub(super) fn draw(svg: &mut Svg, chart: &Chart, at: [f64; 2], size: [f64; 2]) {
    svg.begin("chart");
    let room = size[0] - 2.0 * LABEL;
    let left = at[0] + LABEL;
    svg.text("title", [left, at[1] + 18.0], Anchor::Start, &chart.title);
    let legend = legend(svg, chart, [left, at[1] + 36.0], room);
    let notes: Vec<String> =
        chart.all_notes().iter().flat_map(|note| wrapped(note, NOTE, room)).collect();
    let foot = at[1] + size[1] - ROW * notes.len() as f64;
    for (line, note) in notes.iter().enumerate() {
        svg.text("note", [left, foot + ROW * line as f64 + 10.0], Anchor::Start, note);
    }
    match frame(chart, [at[0], legend + 8.0], [at[0] + size[0], foot]) {
        Some(frame) => {
            axes(svg, &frame, chart);
            chart.shown().for_each(|series| line(svg, &frame, chart, series));
        }
        None => {
            let middle = [at[0] + 0.5 * size[0], 0.5 * (legend + foot)];
            svg.text("label", middle, Anchor::Middle, "no values");
        }
    }
    svg.end();
}

/// Draws the legend when there is more than one line; returns where it ends.
fn legend(svg: &mut Svg, chart: &Chart, [left, top]: [f64; 2], room: f64) -> f64 {
    let shown: Vec<&Series> = chart.shown().filter(|series| !series.name.is_empty()).collect();
    if shown.is_empty() {
        return top;
    }
    let widths: Vec<f64> =
        shown.iter().map(|series| SAMPLE + 6.0 + width(&series.name, LABEL)).collect();
    let mut end = top;
    for (series, (row, offset)) in shown.iter().zip(rows(&widths, 14.0, room)) {
        let at = [left + offset, top + ROW * row as f64];
        svg.begin_sample(series.stroke.color, series.stroke.width.min(WIDEST_SAMPLE));
        let middle = at[1] - 4.0;
        match series.stroke.pattern {
            Pattern::Solid | Pattern::Bare => {
                svg.polyline(&[[at[0], middle], [at[0] + SAMPLE, middle]]);
            }
            Pattern::Dashed => svg.dashed(&[[at[0], middle], [at[0] + SAMPLE, middle]]),
            Pattern::Dots => svg.dot([at[0] + 0.5 * SAMPLE, middle], dot_radius(series)),
        }
        svg.end();
        svg.text("label", [at[0] + SAMPLE + 6.0, at[1]], Anchor::Start, &series.name);
        end = at[1];
    }
    end
}

/// Height of a plane over its width; `None` when there is no point.
pub(super) fn flatness(chart: &Chart) -> Option<f64> {
    let [x, y] = scales(chart)?;
    Some(y.span() / x.span())
}

/// The scales of both axes; `None` when there is no point.
fn scales(chart: &Chart) -> Option<[Scale; 2]> {
    let coordinate = |which: usize| {
        let points = chart.shown().flat_map(|series| chart.pieces(series)).flatten();
        points.map(move |point| point[which])
    };
    let spread = || {
        let bands = chart.shown().flat_map(|series| chart.bands(series));
        bands.flatten().flat_map(|[_, low, high]| [low, high])
    };
    let y = Scale::fit(&chart.y, coordinate(1).chain(spread()), 5)?;
    let x = Scale::fit(&chart.x, coordinate(0), 6)?;
    Some([x, y])
}

/// Fits both axes between the corners; `None` when there is no point.
fn frame(chart: &Chart, [left, top]: [f64; 2], [right, bottom]: [f64; 2]) -> Option<Frame> {
    let [x, y] = scales(chart)?;
    let widest = y.ticks.labels.iter().map(|label| width(label, LABEL)).fold(0.0, f64::max);
    let mut frame = Frame {
        left: left + widest + 40.0,
        right: right - 22.0,
        top: top + 6.0,
        bottom: bottom - 46.0,
        x,
        y,
    };
    if [&chart.x, &chart.y].iter().all(|axis| axis.kind == Kind::Plane) {
        let (width, height) = (frame.x.span(), frame.y.span());
        let [across, up] =
            [(frame.right - frame.left) / width, (frame.bottom - frame.top) / height];
        let pixels = across.min(up);
        (frame.right, frame.bottom) = (frame.left + pixels * width, frame.top + pixels * height);
    }
    Some(frame)
}

fn axes(svg: &mut Svg, frame: &Frame, chart: &Chart) {
    for (value, label) in frame.y.ticks.values.iter().zip(&frame.y.ticks.labels) {
        let y = frame.up(frame.y.place_of_tick(*value));
        svg.line("grid", [frame.left, y], [frame.right, y]);
        svg.text("label", [frame.left - 7.0, y + 4.0], Anchor::End, label);
    }
    for (value, label) in frame.x.ticks.values.iter().zip(&frame.x.ticks.labels) {
        let x = frame.across(frame.x.place_of_tick(*value));
        svg.line("grid", [x, frame.top], [x, frame.bottom]);
        svg.text("label", [x, frame.bottom + 17.0], Anchor::Middle, label);
    }
    let corner = [frame.left, frame.bottom];
    svg.line("axis", corner, [frame.right, frame.bottom]);
    svg.line("axis", corner, [frame.left, frame.top]);
    let below_zero = frame.y.ticks.range().0 < 0.0;
    if chart.y.kind != Kind::Log && below_zero && frame.y.ticks.values.contains(&0.0) {
        let zero = frame.up(frame.y.place_of_tick(0.0));
        svg.line("zero", [frame.left, zero], [frame.right, zero]);
    }
    let middle = [0.5 * (frame.left + frame.right), 0.5 * (frame.top + frame.bottom)];
    svg.text("label", [middle[0], frame.bottom + 37.0], Anchor::Middle, &frame.x.title);
    let widest = frame.y.ticks.labels.iter().map(|label| width(label, LABEL)).fold(0.0, f64::max);
    svg.upward_text("label", [frame.left - widest - 18.0, middle[1]], &frame.y.title);
}

fn line(svg: &mut Svg, frame: &Frame, chart: &Chart, series: &Series) {
    let stroke = series.stroke;
    svg.begin_series(&series.name, stroke.color, stroke.width);
    for band in chart.bands(series) {
        let low = band.iter().map(|[x, low, _]| frame.place([*x, *low]));
        let high = band.iter().rev().map(|[x, _, high]| frame.place([*x, *high]));
        svg.area(&low.chain(high).collect::<Vec<_>>());
    }
    let few = stroke.pattern == Pattern::Solid && series.points.len() <= MOST_DOTS;
    let marked = few || stroke.pattern == Pattern::Dots;
    let place = |piece: &[[f64; 2]]| piece.iter().map(|point| frame.place(*point)).collect();
    let mut pieces: Vec<Vec<[f64; 2]>> = chart.pieces(series).map(place).collect();
    // A point between two gaps would not be seen as a line.
    let dots = pieces.iter().filter(|piece| marked || piece.len() == 1);
    let dots = apart(&dots.flatten().copied().collect::<Vec<_>>());
    pieces.retain(|piece| piece.len() > 1 && stroke.pattern != Pattern::Dots);
    for piece in thinned(pieces) {
        match stroke.pattern {
            Pattern::Dashed => svg.dashed(&piece),
            _ => svg.polyline(&piece),
        }
    }
    dots.iter().for_each(|place| svg.dot(*place, dot_radius(series)));
    svg.end();
}

/// Radius of a marked point \[pixels\].
fn dot_radius(series: &Series) -> f64 {
    0.5 * series.stroke.width + 1.5
}
