//! Directions of contacts and forces.

use super::strain::Strain;
use crate::msg::Fabric;
use crate::view::chart::{Chart, Pattern, Series, Stroke};
use crate::view::run::Run;
use crate::view::scale::Axis;
use crate::view::unit::Unit;

/// Share of all directions within 45° of an axis.
const UNIFORM: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// Places of a curve over the angle.
const STEPS: u32 = 180;

fn over_strain(
    number: usize,
    name: &str,
    run: &Run,
    strain: &Strain,
    value: impl Fn(&Fabric) -> f64,
) -> Series {
    let point = |fabric: &Fabric| [strain.at(fabric.increment), value(fabric)];
    Series::new(number, name, run.fabrics.iter().map(point))
}

/// A dashed line for theories and limits.
pub(super) fn guide(color: &'static str, name: &str, points: Vec<[f64; 2]>) -> Series {
    let stroke = Stroke { color, width: 1.4, pattern: Pattern::Dashed };
    Series { name: name.into(), points, spread: Vec::new(), stroke }
}

const GREY: &str = "#57606a";

/// Whether any contact ever carried a tangential force.
fn rubs(run: &Run) -> bool {
    run.fabrics.iter().any(|fabric| fabric.mean_tangential_force > 0.0)
}

/// Axial anisotropies of contacts and forces.
pub(super) fn anisotropy(run: &Run, strain: &Strain) -> Chart {
    let mut series = vec![
        over_strain(0, "contacts a_c", run, strain, |fabric| fabric.contact_anisotropy),
        over_strain(1, "normal forces a_n", run, strain, |fabric| fabric.normal_anisotropy),
    ];
    if rubs(run) {
        series.push(over_strain(2, "tangential forces a_t", run, strain, |fabric| {
            fabric.tangential_anisotropy
        }));
    }
    Chart {
        title: format!("Axial anisotropy against {}", strain.name()),
        x: strain.axis(),
        y: Axis::linear("anisotropy", Unit::None),
        series,
        notes: vec!["Along z; contacts between grains.".into()],
    }
}

/// The stress ratio, and what the anisotropies make of it.
pub(super) fn stress_ratio(run: &Run, strain: &Strain) -> Chart {
    let of_contacts = |fabric: &Fabric| {
        let normal = fabric.contact_anisotropy + fabric.normal_anisotropy;
        0.4 * (normal + 1.5 * fabric.tangential_anisotropy)
    };
    let ratio = |state: &crate::msg::PackState| {
        let stress = &state.stress_contacts;
        let lateral = 0.5 * (stress[0] + stress[4]);
        [strain.at(state.increment), 3.0 * (stress[8] - lateral) / (2.0 * lateral + stress[8])]
    };
    // Without statistics the ratio is on the sheet of the stresses already.
    let states = run.states.iter().filter(|_| !run.fabrics.is_empty());
    let mut measured = Series::new(0, "q/p of the contact stress", states.map(ratio));
    measured.stroke.width = 4.0;
    measured.stroke.color = "#9cc9e8";
    Chart {
        title: format!("Stress ratio against {}", strain.name()),
        x: strain.axis(),
        y: Axis::linear("deviatoric over mean stress", Unit::None),
        series: vec![
            measured,
            over_strain(1, "2/5 (a_c + a_n + 3/2 a_t)", run, strain, of_contacts),
        ],
        notes: vec!["Apart where long contacts carry more, and by the contacts with walls.".into()],
    }
}

/// Share of the contacts and of the largest forces within 45° of the axis.
pub(super) fn axial_share(run: &Run, strain: &Strain) -> Chart {
    let places = run.fabrics.iter().map(|fabric| strain.at(fabric.increment));
    let uniform = places.map(|at| [at, UNIFORM]).collect();
    let chains = run.fabrics.last().map_or(0.1, |fabric| fabric.chain_share);
    let largest = format!("largest {} % of the forces", 100.0 * chains);
    Chart {
        title: format!("Axial cone against {}", strain.name()),
        x: strain.axis(),
        y: Axis::linear("share within 45° of z", Unit::None),
        series: vec![
            over_strain(0, "all contacts", run, strain, |fabric| fabric.cone_all[2]),
            over_strain(1, &largest, run, strain, |fabric| fabric.cone_largest[2]),
            guide(GREY, "all directions alike: 0.293", uniform),
        ],
        notes: Vec::new(),
    }
}

/// Mean forces against the angle to the axis, at the end.
pub(super) fn by_angle(run: &Run) -> Chart {
    let series = run.fabrics.last().map_or_else(Vec::new, angular);
    let end = run.fabrics.last().map_or(0, |fabric| fabric.increment);
    Chart {
        title: format!("Mean force against angle, increment {end}"),
        x: Axis::linear("angle between normal and z [°]", Unit::None),
        y: Axis::linear("mean force", Unit::Si("N")),
        series,
        notes: vec![
            "Dashed: from the stress, with forces along the traction (B A.73) or normal forces \
             alone; directions all alike."
                .into(),
        ],
    }
}

fn angular(fabric: &Fabric) -> Vec<Series> {
    let bins = fabric.angle_count.len().max(1) as f64;
    let middle = |bin: usize| ((bin as f64 + 0.5) / bins).acos().to_degrees();
    let dots = |number: usize, name: &str, values: &[f64]| {
        let points = values.iter().enumerate().map(|(bin, &value)| [middle(bin), value]);
        let mut series = Series::new(number, name, points);
        series.stroke.pattern = Pattern::Dots;
        series
    };
    let curve = |of: &dyn Fn(f64, f64) -> f64| -> Vec<[f64; 2]> {
        let place = |step: u32| {
            let degrees = 90.0 * f64::from(step) / f64::from(STEPS);
            let (sine, cosine) = degrees.to_radians().sin_cos();
            [degrees, of(sine, cosine)]
        };
        (0..=STEPS).map(place).collect()
    };
    let normal = |[lateral, axial, _]: [f64; 3]| {
        curve(&move |sine, cosine| lateral * sine * sine + axial * cosine * cosine)
    };
    let shear = |[_, _, shear]: [f64; 3]| curve(&move |sine, cosine| shear * sine * cosine);
    let (fitted, predicted) = (fabric.angle_fitted, fabric.angle_predicted);
    let mut series = vec![
        dots(0, "P", &fabric.angle_normal),
        Series::new(0, "P fitted", normal(fitted)),
        guide("#0072b2", "P by A.73", normal(predicted)),
    ];
    if fabric.mean_tangential_force > 0.0 {
        series.extend([
            dots(1, "Q along the axis", &fabric.angle_shear),
            Series::new(1, "Q fitted", shear(fitted)),
            guide("#d55e00", "Q by A.73", shear(predicted)),
        ]);
    } else {
        series.push(guide(GREY, "P without tangential forces", normal(smooth(predicted))));
    }
    series
}

/// What is left of the form when normal forces alone carry the deviator: 5/2 of its part.
fn smooth([lateral, axial, _]: [f64; 3]) -> [f64; 3] {
    let mean = (2.0 * lateral + axial) / 3.0;
    let grown = |force: f64| mean + 2.5 * (force - mean);
    [grown(lateral), grown(axial), 0.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_forces_alone_carry_the_deviator_of_their_traction() {
        // ⟨P⟩ and ⟨P (n_z² - n_x²)⟩ over the sphere, by ⟨n_z⁴⟩ = 1/5 and ⟨n_z² n_x²⟩ = 1/15: with
        // shear the deviator gets another three fifths of (axial - lateral)/3.
        let moments = |[lateral, axial, shear]: [f64; 3]| {
            let normal = (axial - lateral) * (1.0 / 5.0 - 1.0 / 15.0);
            [(2.0 * lateral + axial) / 3.0, normal + shear / 5.0]
        };
        let with = [0.7, 1.6, 0.9];
        for (one, other) in moments(with).into_iter().zip(moments(smooth(with))) {
            assert!((one - other).abs() < 1e-15);
        }
    }
}
