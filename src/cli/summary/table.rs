//! The summary as a table: start and end side by side.

use std::fmt::Write as _;

use graintwin::report::{Hydrate, Moduli, PlaneState, Tangent};
use graintwin::wall;

use super::{Moment, Summary};
use crate::cli::output::significant;
use crate::cli::specimen;

pub(super) fn write(summary: &Summary) -> String {
    let mut text = String::new();
    let sides = summary.bounds.sides().map(|side| significant(side * 1e3, 5));
    line(&mut text, "scene", &format!("{}, {}", summary.scene, summary.file.display()));
    line(&mut text, "pack", &format!("{} grains in {} mm", summary.grains, sides.join(" x ")));
    for reached in &summary.prepared {
        line(&mut text, &format!("step {}", reached.step + 1), &specimen::now(reached));
    }
    let commands: u64 = summary.commands.values().sum();
    let kinds: Vec<_> =
        summary.commands.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
    line(&mut text, "commands", &format!("{commands} ({})", kinds.join(", ")));
    if let Some(first) = &summary.first_refusal {
        line(&mut text, "first refusal", first);
    }
    line(
        &mut text,
        "solver",
        &format!(
            "{} increments, {} equilibria, {} iterations, residual at most {:.1e}, {} s",
            summary.increments,
            summary.substeps,
            summary.iterations,
            summary.worst_residual,
            significant(summary.solve_seconds, 3),
        ),
    );
    if let Some(last) = summary.events.last() {
        let what = format!(
            "{}, the last in increment {} with {} grains",
            summary.events.len(),
            last.increment,
            last.event.grains.len()
        );
        line(&mut text, "events", &what);
    }
    if summary.frictional {
        let what = format!("{} contacts opened, {} formed", summary.opened, summary.formed);
        line(&mut text, "friction", &what);
    }
    if let Some(cement) = &summary.cement {
        let what = format!(
            "{} of {} bonds hold, {} broke by tension and {} by shear, {} J lost with them",
            cement.intact,
            cement.bonds,
            cement.broken_by_tension,
            cement.broken_by_shear,
            significant(cement.broken_energy, 4),
        );
        line(&mut text, "cement", &what);
    }
    if let Some(motion) = summary.grain_motion.filter(|motion| motion.non_affine_ratio.is_finite())
    {
        let part = |value: f64| significant(value, 3);
        let what = format!(
            "last increment: non-affine over affine {}, participation {}, top tenth in D²min {}",
            part(motion.non_affine_ratio),
            part(motion.participation),
            part(motion.d2min_top_10),
        );
        line(&mut text, "grain motion", &what);
    }
    #[cfg(feature = "ros")]
    if let Some(node) = &summary.node {
        line(
            &mut text,
            "ROS 2",
            &format!("{} commands in, {} messages out", node.commands, node.published),
        );
    }
    #[cfg(feature = "ros")]
    if let Some(rig) = &summary.virtual_rig {
        let trip = |seconds: f64| significant(seconds * 1e3, 3);
        line(
            &mut text,
            "virtual rig",
            &format!(
                "{} of {} commands answered, command to report {} ms median, {} ms worst",
                rig.answered,
                rig.sent,
                trip(rig.round_trip_median),
                trip(rig.round_trip_worst),
            ),
        );
    }
    #[cfg(feature = "mcap")]
    if let Some(recording) = &summary.recording {
        let megabytes = significant(recording.bytes as f64 * 1e-6, 3);
        let what = format!(
            "{}, {} messages, {megabytes} MB",
            recording.folder.display(),
            recording.messages
        );
        line(&mut text, "recording", &what);
    }
    for lost in &summary.lost {
        line(&mut text, "LOST", lost);
    }
    if let (Some(start), Some(end)) = (&summary.start, &summary.end) {
        text.push('\n');
        let from = format!("increment {}", start.increment);
        row(&mut text, "", "", &from, &format!("increment {}", end.increment));
        for (name, unit, from, to) in rows(start, end, summary.axes, summary.frictional) {
            row(&mut text, name, unit, &shown(from), &shown(to));
        }
    }
    text
}

type Row = (&'static str, &'static str, Option<f64>, Option<f64>);

fn rows(start: &Moment, end: &Moment, axes: usize, frictional: bool) -> Vec<Row> {
    let mut rows = Vec::new();
    let mut add = |name, unit, of: &dyn Fn(&Moment) -> Option<f64>| {
        rows.push((name, unit, of(start), of(end)));
    };
    for (axis, name) in ["strain x", "strain y", "strain z"].into_iter().take(axes).enumerate() {
        add(name, "", &|moment| Some(moment.state?.strain[axis]));
    }
    for (axis, name) in ["stress x", "stress y", "stress z"].into_iter().take(axes).enumerate() {
        add(name, "MPa", &|moment| Some(moment.state?.stress_walls[4 * axis] * 1e-6));
    }
    add("confining stress", "MPa", &|moment| Some(moment.state?.confining_stress * 1e-6));
    add("deviatoric stress", "MPa", &|moment| Some(moment.state?.deviatoric_stress * 1e-6));
    for (wall, name) in wall::NAMES.into_iter().take(2 * axes).enumerate() {
        add(name, "N", &|moment| Some(moment.walls.normal_force[wall]));
    }
    add("error of them", "N", &|moment| Some(moment.wall_force_error));
    add("porosity", "", &|moment| Some(moment.state?.porosity));
    add("coordination", "", &|moment| Some(moment.state?.coordination_number));
    add("contacts", "", &|moment| Some(f64::from(moment.state?.contacts)));
    add("rattlers", "", &|moment| Some(f64::from(moment.state?.rattlers)));
    if frictional {
        add("sliding ratio", "", &|moment| Some(moment.state?.sliding_ratio));
        add("tangential/normal", "", &|moment| {
            let state = moment.state?;
            Some(state.mean_tangential_force / state.mean_normal_force)
        });
    }
    add("stored energy", "J", &|moment| Some(moment.state?.stored_energy));
    if frictional {
        add("dissipated energy", "J", &|moment| Some(moment.state?.dissipated_energy));
    }
    let mut add = |name, unit, of: fn(&Moduli) -> f64| {
        let known = |moment: &Moment| moment.moduli.as_ref().map(of);
        rows.push((name, unit, known(start), known(end)));
    };
    // No interval ends at the start.
    let of_states = start.moduli.is_some_and(|moduli| moduli.valid);
    let bulk = if of_states { "K, of the state" } else { "K, last interval" };
    add(bulk, "GPa", |moduli| moduli.bulk * 1e-9);
    add("G", "GPa", |moduli| moduli.shear * 1e-9);
    add("E", "GPa", |moduli| moduli.young * 1e-9);
    add("Poisson's ratio", "", |moduli| moduli.poisson);
    add("Lamé's lambda", "GPa", |moduli| moduli.lame * 1e-9);
    add("P-wave modulus", "GPa", |moduli| moduli.p_wave * 1e-9);
    if end.hydrate.is_some() {
        let mut add = |name, unit, of: fn(&Hydrate) -> f64| {
            let known = |moment: &Moment| moment.hydrate.as_ref().map(of);
            rows.push((name, unit, known(start), known(end)));
        };
        add("hydrate saturation", "", |hydrate| hydrate.saturation);
        add("pore pressure", "MPa", |hydrate| hydrate.pore_pressure * 1e-6);
        add("effective stress", "MPa", |hydrate| hydrate.effective_stress * 1e-6);
        add("total stress", "MPa", |hydrate| hydrate.total_stress * 1e-6);
        add("pores and hydrate", "", |hydrate| hydrate.pore_fraction);
    }
    if end.plane.is_some() {
        let mut add = |name, unit, of: fn(&PlaneState) -> f64| {
            let known = |moment: &Moment| moment.plane.as_ref().map(of);
            rows.push((name, unit, known(start), known(end)));
        };
        add("sigma1 of the interior", "MPa", |plane| plane.principal_stress[0] * 1e-6);
        add("sigma3 of the interior", "MPa", |plane| plane.principal_stress[1] * 1e-6);
        add("contacts per grain", "", |plane| plane.contacts_per_grain);
        add("contacts per volume", "", |plane| plane.contact_density);
        add("share of broken bonds", "", |plane| plane.share_broken);
        add("mean rotation", "rad", |plane| plane.mean_rotation);
    }
    if end.tangent.is_none() {
        return rows;
    }
    let mut add = |name, unit, of: fn(&Tangent) -> f64| {
        let known = |moment: &Moment| moment.tangent.as_ref().map(of);
        rows.push((name, unit, known(start), known(end)));
    };
    add("K, tangent", "GPa", |tangent| tangent.stands.bulk * 1e-9);
    add("G, tangent", "GPa", |tangent| tangent.stands.shear * 1e-9);
    add("K, all stick", "GPa", |tangent| tangent.sticks.bulk * 1e-9);
    add("G, all stick", "GPa", |tangent| tangent.sticks.shear * 1e-9);
    // Along the axis of loading.
    if end.plane.is_some() {
        add("P-wave speed, y", "m/s", |tangent| tangent.sticks.p_speed[1]);
        add("S-wave speed, xy", "m/s", |tangent| tangent.sticks.s_speed[0]);
    } else {
        add("P-wave speed, z", "m/s", |tangent| tangent.sticks.p_speed[2]);
        add("S-wave speed, zx", "m/s", |tangent| tangent.sticks.s_speed[2]);
    }
    add("isotropy index", "", |tangent| tangent.stands.isotropy_index);
    rows
}

/// Whole numbers as such; what is not known as a dash.
fn shown(value: Option<f64>) -> String {
    match value {
        None => "-".into(),
        Some(value) if value.is_nan() => "-".into(),
        Some(value) if value.fract() == 0.0 && value.abs() < 1e9 => format!("{value:.0}"),
        Some(value) => significant(value, 6),
    }
}

// Writing to a string cannot fail.
fn line(to: &mut String, name: &str, text: &str) {
    let _ = writeln!(to, "{name:<18} {text}");
}

fn row(to: &mut String, name: &str, unit: &str, from: &str, until: &str) {
    let _ = writeln!(to, "{name:<18} {from:>14} {until:>14} {unit}");
}
