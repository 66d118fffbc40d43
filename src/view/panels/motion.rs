//! How unevenly the grains moved.

use super::strain::Strain;
use crate::msg::GrainMotion;
use crate::view::chart::{Chart, Series};
use crate::view::forces::density;
use crate::view::run::Run;
use crate::view::scale::Axis;
use crate::view::unit::Unit;

/// A line of one value of the motion. Increment 0 is not on the path: it tells how far the pack was
/// from equilibrium.
fn series(
    number: usize,
    name: &str,
    run: &Run,
    strain: &Strain,
    value: impl Fn(&GrainMotion) -> f64,
) -> Series {
    let on_the_path = run.motions.whole.iter().filter(|motion| motion.increment > 0);
    let point = |motion: &GrainMotion| [strain.at(motion.increment), value(motion)];
    Series::new(number, name, on_the_path.map(point))
}

/// Non-affine over affine displacement of each increment.
pub(super) fn non_affine(run: &Run, strain: &Strain) -> Chart {
    Chart {
        title: format!("Non-affine motion against {}", strain.name()),
        x: strain.axis(),
        y: Axis::log("non-affine over affine displacement"),
        series: vec![series(0, "", run, strain, |motion| motion.non_affine_ratio)],
        notes: vec![
            "Root mean squares over the grains that carry load, of each increment; affine: as the \
             box, against its centre."
                .into(),
        ],
    }
}

/// Participation ratios, and the share of D²min that a tenth of the grains has.
pub(super) fn localisation(run: &Run, strain: &Strain) -> Chart {
    Chart {
        title: format!("Localisation against {}", strain.name()),
        x: strain.axis(),
        y: Axis::linear("share", Unit::None),
        series: vec![
            series(0, "participation of displacements", run, strain, |motion| motion.participation),
            series(1, "of rotations", run, strain, |motion| motion.rotation_participation),
            series(2, "top tenth in D²min", run, strain, |motion| motion.d2min_top_10),
        ],
        notes: vec![
            "Participation ratio: share of the grains that take part in the non-affine motion. \
             Tenth: the grains with the most D²min."
                .into(),
        ],
    }
}

/// How the most sheared grains lie.
pub(super) fn band(run: &Run, strain: &Strain) -> Chart {
    let names: &[&str] = match run.is_plane() {
        false => &["across the plane they lie in", "along it", "along it, the other way"],
        true => &["across the line they lie on", "along it"],
    };
    let line = |(k, name): (usize, &&str)| {
        series(k, name, run, strain, move |motion| motion.band_spread[k])
    };
    Chart {
        title: format!("Spread of the most sheared tenth against {}", strain.name()),
        x: strain.axis(),
        y: Axis::linear("spread over that of all grains", Unit::None),
        series: names.iter().enumerate().map(line).collect(),
        notes: vec![
            "A shear band has a small spread across and 1 along; all are 1 where nothing localises."
                .into(),
        ],
    }
}

/// Distribution of the non-affine displacements in the last increment.
pub(super) fn distribution(run: &Run) -> Chart {
    let lengths = &run.motions.last;
    let increment = run.motions.increment().unwrap_or_default();
    let mean = lengths.iter().sum::<f64>() / lengths.len() as f64;
    let known = increment > 0 && mean > 0.0;
    let notes = known.then(|| {
        let (mean, grains) = (Unit::Si("m").written(mean), lengths.len());
        format!("Increment {increment}, {grains} grains that carry load. Mean: {mean}.")
    });
    Chart {
        title: "Distribution of non-affine displacements".into(),
        x: Axis::linear("displacement u over its mean", Unit::None),
        y: Axis::log("probability density P(u)"),
        series: if known { vec![Series::new(0, "", density(lengths))] } else { Vec::new() },
        notes: notes.into_iter().collect(),
    }
}
