//! Figures 2.10 and 2.12.

use graintwin::view::{Axis, Chart, Pattern, Series, Sheet, Stroke, Unit};

use super::{Point, Seed};

const MARK: Stroke = Stroke { color: "#a50f15", width: 2.4, pattern: Pattern::Dots };
/// An event is marked on the cycle that released this share of what all did.
const LARGE: f64 = 0.02;
/// Points of the zoom on each side of the event.
const NEAR: usize = 6;

/// Fig. 2.10: mean stress against volumetric strain for every seed, with the events of the first,
/// and a zoom around the one that took a grain furthest.
pub(super) fn loading(seeds: &[Seed]) -> Sheet {
    let mut all: Vec<Series> = Vec::new();
    for (number, seed) in seeds.iter().enumerate() {
        let points = seed.loading.points.iter().map(mean_stress);
        all.push(Series::new(number, &format!("seed {}", seed.seed), points));
    }
    let course = &seeds[0].loading;
    all.push(marks("events of the first", course.points.iter(), mean_stress));
    let at = course.furthest();
    let near = &course.points[at.saturating_sub(NEAR)..(at + NEAR).min(course.points.len())];
    let mut zoom =
        vec![Series::new(0, &format!("seed {}", seeds[0].seed), near.iter().map(mean_stress))];
    zoom.push(marks("events", near.iter(), mean_stress));
    let four = course.points[at - 2..=at + 1].iter().map(mean_stress);
    let ring = Stroke { color: "#e69f00", width: 5.0, pattern: Pattern::Dots };
    zoom.insert(1, Series { stroke: ring, ..Series::new(1, "configurations 1 to 4", four) });
    let chart = |title: &str, series| Chart {
        title: title.into(),
        x: Axis::linear("volumetric strain", Unit::Strain),
        y: Axis::linear("mean stress", Unit::Si("Pa")),
        series,
        notes: Vec::new(),
    };
    Sheet {
        title: "Isotropic loading without friction (thesis fig. 2.10)".into(),
        subtitle: "306 glass beads from 1 MPa in increments of 5e-5 on each axis; a mark is an \
                   increment with an event."
            .into(),
        charts: vec![
            chart("Mean stress against volumetric strain", all),
            chart("Around the event that took one grain furthest", zoom),
        ],
    }
}

/// Fig. 2.12: the three stresses on a polyaxial cycle, and where its work went.
pub(super) fn hysteresis(seed: &Seed) -> Sheet {
    let points = &seed.cycle.points;
    let turn = points.len() / 2;
    let least = LARGE * points[points.len() - 1].state().event_energy;
    let mut lines: Vec<Series> = Vec::new();
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let along = |point: &Point| [point.strain[axis], point.stress()[axis]];
        let up = Series::new(axis, &format!("σ{name}, loading"), points[..=turn].iter().map(along));
        let mut down =
            Series::new(axis, &format!("σ{name}, unloading"), points[turn..].iter().map(along));
        down.stroke.pattern = Pattern::Dashed;
        lines.extend([up, down]);
        let name = if axis == 0 { "large events" } else { "" };
        lines.push(marks(name, points.iter().filter(|point| released(point) > least), along));
    }
    let work = seed.cycle.work();
    let start = points[0].state().stored_energy;
    let numbered = |of: &dyn Fn(usize) -> f64| {
        (0..points.len()).map(|k| [k as f64, of(k)]).collect::<Vec<_>>()
    };
    let lost = numbered(&|k| work[k] - (points[k].state().stored_energy - start));
    let released = numbered(&|k| points[k].state().event_energy);
    let stored = numbered(&|k| points[k].state().stored_energy - start);
    let stroke = Stroke::solid("#f2b98c", 5.0);
    Sheet {
        title: "A polyaxial cycle without friction (thesis fig. 2.12)".into(),
        subtitle: format!(
            "2740 glass beads, seed {}, from 4 MPa: strains in the ratio 0.6 : 0.8 : 1 up to 1 % \
             and back, in increments of 1e-4; marked are increments whose events released more \
             than 2 % of what all did.",
            seed.seed
        ),
        charts: vec![
            Chart {
                title: "Stress against strain".into(),
                x: Axis::linear("strain of the axis", Unit::Strain),
                y: Axis::linear("stress", Unit::Si("Pa")),
                series: lines,
                notes: Vec::new(),
            },
            Chart {
                title: "Energy that went away".into(),
                x: Axis::count("increment"),
                y: Axis::linear("energy", Unit::Si("J")),
                series: vec![
                    Series {
                        stroke,
                        ..Series::new(1, "work of the walls less what is stored", lost)
                    },
                    Series::new(0, "released in events", released),
                ],
                notes: vec![format!(
                    "Stored at the top: {} more than at the start.",
                    Unit::Si("J").written(stored[turn][1])
                )],
            },
        ],
    }
}

fn mean_stress(point: &Point) -> [f64; 2] {
    [point.volumetric(), point.state().confining_stress]
}

/// Energy that the events on the way to a point released \[J\].
fn released(point: &Point) -> f64 {
    point.measures.events.iter().map(|event| event.energy_released).sum()
}

/// Marks on the points with an event.
fn marks<'a>(
    name: &str,
    points: impl Iterator<Item = &'a Point>,
    at: impl Fn(&Point) -> [f64; 2],
) -> Series {
    let eventful = points.filter(|point| !point.measures.events.is_empty());
    Series { stroke: MARK, ..Series::new(3, name, eventful.map(at)) }
}
