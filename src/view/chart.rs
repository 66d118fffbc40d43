//! What is to be seen in a chart.

use super::scale::Axis;

/// A chart: lines over two axes.
#[derive(Clone, Debug)]
pub struct Chart {
    /// What it shows, in a few words.
    pub title: String,
    /// The axis to the right.
    pub x: Axis,
    /// The axis upwards.
    pub y: Axis,
    /// The lines; later ones are drawn over earlier ones.
    pub series: Vec<Series>,
    /// Sentences below it.
    pub notes: Vec<String>,
}

/// A line of a chart.
#[derive(Clone, Debug)]
pub struct Series {
    /// Its name in the legend, where a series without a name is not.
    pub name: String,
    /// Places in the units of the axes; what has none breaks the line.
    pub points: Vec<[f64; 2]>,
    /// Lowest and highest y about each point, in their order, drawn as a pale band; may be empty.
    pub spread: Vec<[f64; 2]>,
    /// How it is drawn.
    pub stroke: Stroke,
}

/// A line of more points is drawn finely.
const MANY: usize = 300;

/// Width of a fine line \[pixels\].
const FINE: f64 = 1.1;

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// A colour as SVG has it.
    pub color: &'static str,
    /// Width \[pixels\].
    pub width: f64,
    /// Unbroken, dashed or none.
    pub pattern: Pattern,
}

/// What joins the points of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// A line; its points are marked when they are few.
    Solid,
    /// A dashed line without marks, for theories and limits.
    Dashed,
    /// Nothing: the points are marked.
    Dots,
    /// A line without marks, for drawings.
    Bare,
}

impl Stroke {
    /// Colours that the colour-blind tell apart (Okabe and Ito 2008), on white.
    const COLORS: [&'static str; 6] =
        ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];

    /// The stroke of the `number`th line of a chart.
    #[must_use]
    pub const fn of(number: usize) -> Self {
        Self::solid(Self::COLORS[number % Self::COLORS.len()], 1.8)
    }

    /// An unbroken line of a colour and width \[pixels\].
    #[must_use]
    pub const fn solid(color: &'static str, width: f64) -> Self {
        Self { color, width, pattern: Pattern::Solid }
    }
}

impl Series {
    /// A line in the colour of its `number` in the chart, thinner when it has many points: loops
    /// that lie close together stay apart.
    pub fn new(number: usize, name: &str, points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let points: Vec<[f64; 2]> = points.into_iter().collect();
        let mut stroke = Stroke::of(number);
        if points.len() > MANY {
            stroke.width = FINE;
        }
        Self { name: name.into(), points, spread: Vec::new(), stroke }
    }
}

impl Chart {
    /// Whether anything can be drawn.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        !self.series.iter().any(|series| self.has_points(series))
    }

    /// The series that can be drawn, at least in part.
    pub(super) fn shown(&self) -> impl Iterator<Item = &Series> {
        self.series.iter().filter(|series| self.has_points(series))
    }

    /// The places of a band between which it is drawn, piece by piece.
    pub(super) fn bands(&self, series: &Series) -> Vec<Vec<[f64; 3]>> {
        let places = series.points.iter().zip(&series.spread);
        let places: Vec<[f64; 3]> =
            places.map(|(at, between)| [at[0], between[0], between[1]]).collect();
        let drawn = |[x, low, high]: &[f64; 3]| self.takes([*x, *low]) && self.takes([*x, *high]);
        let pieces = places.split(|place| !drawn(place)).filter(|piece| piece.len() > 1);
        pieces.map(<[_]>::to_vec).collect()
    }

    /// The unbroken pieces of a series.
    pub(super) fn pieces<'a>(&'a self, series: &'a Series) -> impl Iterator<Item = &'a [[f64; 2]]> {
        let pieces = series.points.split(|point| !self.takes(*point));
        pieces.filter(|piece| !piece.is_empty())
    }

    /// The notes, and which series are left out.
    pub(super) fn all_notes(&self) -> Vec<String> {
        let missing = self.series.iter().filter(|series| !self.has_points(series));
        let missing: Vec<&str> = missing.map(|series| series.name.as_str()).collect();
        let mut notes = self.notes.clone();
        if !missing.is_empty() {
            notes.push(format!("No values: {}.", missing.join(", ")));
        }
        notes
    }

    fn has_points(&self, series: &Series) -> bool {
        series.points.iter().any(|point| self.takes(*point))
    }

    fn takes(&self, [x, y]: [f64; 2]) -> bool {
        self.x.takes(x) && self.y.takes(y)
    }
}
