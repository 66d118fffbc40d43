//! What became of the cement.

use super::strain::Strain;
use crate::view::chart::{Chart, Pattern, Series};
use crate::view::run::Run;
use crate::view::run::cement::Standing;
use crate::view::scale::Axis;
use crate::view::unit::Unit;

/// How the points of both kinds of cracks are called.
const MODES: [&str; 2] = ["by tension", "by shear"];

/// The charts; none where nothing broke.
pub(super) fn cracks(run: &Run, strain: &Strain) -> Vec<Chart> {
    match run.cement.places.iter().all(Vec::is_empty) {
        true => Vec::new(),
        false => {
            let mut charts = vec![intact(run, strain), broken(run, strain)];
            let planes: &[[usize; 2]] = if run.is_plane() { &[[0, 1]] } else { &[[0, 2], [1, 2]] };
            charts.extend(planes.iter().map(|&axes| places(run, axes)));
            charts
        }
    }
}

/// Share of the bonds that hold.
fn intact(run: &Run, strain: &Strain) -> Chart {
    let share = |now: &Standing| {
        let [tension, shear] = now.broken.map(f64::from);
        let intact = f64::from(now.intact);
        [strain.at(now.increment), intact / (intact + tension + shear)]
    };
    Chart {
        title: format!("Bonds against {}", strain.name()),
        x: strain.axis(),
        y: Axis::linear("share of the bonds that hold", Unit::None),
        series: vec![Series::new(0, "", run.cement.standing.iter().map(share))],
        notes: Vec::new(),
    }
}

/// Bonds that broke so far, by how.
fn broken(run: &Run, strain: &Strain) -> Chart {
    let line = |(mode, name): (usize, &str)| {
        let point = |now: &Standing| [strain.at(now.increment), f64::from(now.broken[mode])];
        Series::new(mode, name, run.cement.standing.iter().map(point))
    };
    Chart {
        title: format!("Cracks against {}", strain.name()),
        x: strain.axis(),
        y: Axis::count("bonds that broke"),
        series: MODES.into_iter().enumerate().map(line).collect(),
        notes: vec!["Since the cement was deposited.".into()],
    }
}

/// Where the cracks of the run are, seen along the third axis.
fn places(run: &Run, axes: [usize; 2]) -> Chart {
    let dots = |(mode, name): (usize, &str)| {
        let places = run.cement.places[mode].iter();
        let mut series = Series::new(mode, name, places.map(|at| axes.map(|axis| at[axis])));
        series.stroke.pattern = Pattern::Dots;
        series
    };
    let [x, y] = axes.map(|axis| ["x", "y", "z"][axis]);
    let axis = if run.is_plane() { Axis::plane } else { Axis::linear };
    Chart {
        title: format!("Where bonds broke, in {x} and {y}"),
        x: axis(x, Unit::Si("m")),
        y: axis(y, Unit::Si("m")),
        series: MODES.into_iter().enumerate().map(dots).collect(),
        notes: vec!["Projections of the centres of the contacts, as they were then.".into()],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::msg::Cracks;

    #[test]
    fn cracks_in_chunks_are_drawn_where_they_are_and_none_without_them() {
        let chunk = |chunk, mode: &[u8], position: &[f64]| Cracks {
            increment: 3,
            chunk,
            intact: 6,
            broken_by_tension: 2,
            broken_by_shear: 2,
            mode: mode.to_vec(),
            position: position.to_vec(),
            ..Cracks::default()
        };
        let mut run = Run::default();
        run.cement.add(&chunk(0, &[1, 2], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
        run.cement.add(&chunk(1, &[1], &[7.0, 8.0, 9.0]));
        let strain = Strain::of(&run);
        let charts = cracks(&run, &strain);
        assert_eq!(charts[0].series[0].points, [[3.0, 0.6]]);
        assert_eq!(charts[1].series[1].points, [[3.0, 2.0]]);
        assert_eq!(charts[2].series[0].points, [[1.0, 3.0], [7.0, 9.0]]);
        assert_eq!(charts[3].series[1].points, [[5.0, 6.0]]);
        assert!(cracks(&Run::default(), &strain).is_empty());
    }
}
