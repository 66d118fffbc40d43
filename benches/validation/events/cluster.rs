//! Fig. 2.11: the grains and force chains around the grain that an event took furthest, in four
//! consecutive configurations, as seen along the axis that it moved along least.

use std::fmt::Write;

use super::{Course, Point};

/// Share of the contacts whose forces are drawn: the largest ones (T: τ_FC = 0.1).
const CHAINS: f64 = 0.1;
/// Grains whose centres are nearer than this are drawn \[mean radii\].
const REACH: f64 = 4.2;
/// Size of a panel and of what is around it \[pixels\].
const PANEL: f64 = 300.0;
const GAP: f64 = 20.0;
const HEAD: f64 = 76.0;

/// The image.
pub(super) fn svg(course: &Course) -> String {
    let at = course.furthest();
    let view = View::of(course, at);
    let (width, height) = (4.0 * (PANEL + GAP) + GAP, HEAD + PANEL + 36.0 + GAP);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
         width=\"{width}\" height=\"{height}\" role=\"img\">\n\
         <title>Grains and force chains around a jump (thesis fig. 2.11)</title>\n\
         <style>text{{font-family:system-ui,-apple-system,'Segoe UI','DejaVu Sans',Helvetica,Arial,\
         sans-serif;fill:#24292f}}.heading{{font-size:18px;font-weight:600}}\
         .note{{font-size:11px;fill:#57606a}}.label{{font-size:12px}}</style>\n\
         <rect x=\"0.5\" y=\"0.5\" width=\"{}\" height=\"{}\" rx=\"10\" fill=\"#ffffff\" \
         stroke=\"#d0d7de\"/>\n\
         <text class=\"heading\" x=\"{left}\" y=\"38\">Grains and force chains around a jump \
         (thesis fig. 2.11)</text>\n\
         <text class=\"note\" x=\"{left}\" y=\"58\">306 glass beads, isotropic loading in increments \
         of 5e-5; the grain that jumps in brown, dashed where it was; lines: contacts with the largest tenth of all \
         forces, as wide as their force.</text>\n",
        width - 1.0,
        height - 1.0,
        left = GAP + 12.0,
    );
    for (k, point) in course.points[at - 2..=at + 1].iter().enumerate() {
        let left = GAP + k as f64 * (PANEL + GAP);
        panel(&mut svg, &view, course, point, [left, HEAD]);
        if k == 2 {
            let was = course.points[at - 1].positions()[view.grain];
            let [x, y] = view.pixel(was, [left, HEAD]);
            write(
                &mut svg,
                format_args!(
                    "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\" fill=\"none\" \
                     stroke=\"#8c510a\" stroke-width=\"1.6\" stroke-dasharray=\"4 3\"/>\n",
                    view.scale() * course.radius[view.grain]
                ),
            );
        }
        let stress = point.state().confining_stress / 1e6;
        let event = if k == 2 { ", after the event" } else { "" };
        write(
            &mut svg,
            format_args!(
                "<text class=\"label\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}: mean stress \
                 {stress:.3} MPa{event}</text>\n",
                left + 0.5 * PANEL,
                HEAD + PANEL + 24.0,
                k + 1
            ),
        );
    }
    svg.push_str("</svg>\n");
    svg
}

/// What is looked at, and from where.
struct View {
    grain: usize,
    centre: [f64; 3],
    /// Axes to the right and upwards, and the one that is looked along.
    axes: [usize; 3],
    mean_radius: f64,
    /// Largest force of the four configurations \[N\].
    largest: f64,
}

impl View {
    fn of(course: &Course, at: usize) -> Self {
        let events = &course.points[at].measures.rearrangements;
        let ways = events.iter().flat_map(|event| event.grains.iter().zip(&event.displacement));
        let far = |way: &[f64; 3]| way.iter().map(|x| x * x).sum::<f64>();
        let (grain, way) =
            ways.max_by(|a, b| far(a.1).total_cmp(&far(b.1))).expect("it has an event");
        let grain = *grain as usize;
        let along = (0..3).min_by(|&a, &b| way[a].abs().total_cmp(&way[b].abs())).unwrap_or(1);
        let [right, up] = match along {
            0 => [1, 2],
            1 => [0, 2],
            _ => [0, 1],
        };
        let before = course.points[at - 1].positions()[grain];
        let after = course.points[at].positions()[grain];
        let forces = course.points[at - 2..=at + 1].iter().flat_map(|point| {
            point.measures.network.as_ref().expect("it was demanded").normal_force.iter().copied()
        });
        Self {
            grain,
            centre: std::array::from_fn(|k| 0.5 * (before[k] + after[k])),
            axes: [right, up, along],
            mean_radius: course.radius.iter().sum::<f64>() / course.radius.len() as f64,
            largest: forces.fold(0.0, f64::max),
        }
    }

    /// Whether what is at `at` is drawn.
    fn holds(&self, at: [f64; 3]) -> bool {
        let square: f64 = at.iter().zip(self.centre).map(|(a, c)| (a - c).powi(2)).sum();
        square.sqrt() < REACH * self.mean_radius
    }

    /// Pixels of a length \[m\].
    fn scale(&self) -> f64 {
        0.5 * PANEL / ((REACH + 1.2) * self.mean_radius)
    }

    fn pixel(&self, at: [f64; 3], [left, top]: [f64; 2]) -> [f64; 2] {
        let [right, up, _] = self.axes;
        let middle = 0.5 * PANEL;
        [
            left + middle + self.scale() * (at[right] - self.centre[right]),
            top + middle - self.scale() * (at[up] - self.centre[up]),
        ]
    }
}

fn panel(svg: &mut String, view: &View, course: &Course, point: &Point, corner: [f64; 2]) {
    let positions = point.positions();
    let depth = view.axes[2];
    let mut shown: Vec<usize> =
        (0..positions.len()).filter(|&k| k == view.grain || view.holds(positions[k])).collect();
    // From behind: the one that is looked at lies over the others, pale ones in front of it.
    shown.sort_by(|&a, &b| positions[a][depth].total_cmp(&positions[b][depth]));
    for &k in &shown {
        let [x, y] = view.pixel(positions[k], corner);
        let (fill, opacity) = match k == view.grain {
            true => ("#8c510a", 0.9),
            false => ("#8c959f", 0.22),
        };
        write(
            svg,
            format_args!(
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\" fill=\"{fill}\" \
                 fill-opacity=\"{opacity}\" stroke=\"#57606a\" stroke-opacity=\"0.5\" \
                 stroke-width=\"0.8\"/>\n",
                view.scale() * course.radius[k]
            ),
        );
    }
    let network = point.measures.network.as_ref().expect("it was demanded");
    let mut forces = network.normal_force.clone();
    forces.sort_by(f64::total_cmp);
    let least = forces[((1.0 - CHAINS) * forces.len() as f64) as usize];
    for (contact, force) in network.normal_force.iter().enumerate() {
        let [first, second] = [network.first[contact], network.second[contact]];
        let Some(other) = positions.get(second as usize) else { continue };
        let ends = [positions[first as usize], *other];
        if *force < least || !ends.iter().any(|at| view.holds(*at)) {
            continue;
        }
        let [from, to] = ends.map(|at| view.pixel(at, corner));
        write(
            svg,
            format_args!(
                "<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" stroke=\"#0072b2\" \
                 stroke-linecap=\"round\" stroke-width=\"{:.1}\"/>\n",
                from[0],
                from[1],
                to[0],
                to[1],
                12.0 * force / view.largest
            ),
        );
    }
}

fn write(svg: &mut String, text: std::fmt::Arguments<'_>) {
    svg.write_fmt(text).expect("a string takes everything");
}
