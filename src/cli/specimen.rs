//! The pack of a scene, and what to say of it.

use std::f64::consts::PI;

use indicatif::MultiProgress;

use graintwin::pack::prepare::{Reached, prepare};
use graintwin::pack::{self, History, Kept, Pack, PackError};
use graintwin::scene::Loaded;

use super::Failure;
use super::output::significant;
use super::progress::waiting;

/// A pack with what its preparation reached, one entry a step that looks for equilibrium.
pub(super) struct Specimen {
    pub(super) pack: Pack,
    pub(super) prepared: Vec<Reached>,
}

/// The scene's pack; making and preparing one takes a while and says so.
pub(super) fn build(
    loaded: &Loaded,
    threads: usize,
    bars: &MultiProgress,
) -> Result<Specimen, Failure> {
    let scene = &loaded.scene;
    // What is made does not depend on the threads, the time does.
    let pool =
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(Failure::other)?;
    let pack = match &scene.pack.generate {
        None => pack::unprepared(loaded)?,
        Some(spec) => {
            let what = format!("making {} grains", spec.grains);
            waiting(what, bars, |_| pool.install(|| pack::unprepared(loaded)))?
        }
    };
    let steps = scene.pack.prepare.len();
    if steps == 0 {
        return Ok(Specimen { pack, prepared: Vec::new() });
    }
    let mut prepared: Vec<Reached> = Vec::new();
    let pack = waiting("preparing".into(), bars, |bar| {
        let mut watch = |reached: &Reached| {
            bar.set_message(format!("preparing, {}/{steps} {}", reached.step + 1, now(reached)));
            prepared.retain(|before| before.step < reached.step);
            prepared.push(*reached);
        };
        pool.install(|| prepare(scene, pack, &mut watch)).map_err(PackError::from)
    })?;
    Ok(Specimen { pack, prepared })
}

/// What a step of a preparation has reached.
pub(super) fn now(reached: &Reached) -> String {
    let Reached { strain, confining_stress, sliding_ratio, .. } = *reached;
    let stress = significant(confining_stress * 1e-6, 4);
    match strain {
        None => format!("{stress} MPa confining, without friction"),
        Some(strain) => format!(
            "{stress} MPa confining, strain {}, sliding ratio {sliding_ratio:.4}",
            significant(strain, 4)
        ),
    }
}

/// What the preparation of a pack reached, a line a step.
pub(super) fn preparation(prepared: &[Reached]) -> String {
    prepared.iter().fold(String::new(), |text, reached| {
        format!("{text}step {}          {}\n", reached.step + 1, now(reached))
    })
}

/// What a pack remembers.
pub(super) fn history(history: Option<&History>) -> String {
    let Some(history) = history else { return "history         none\n".into() };
    let (contacts, sliding) = (history.contacts.len(), history.sliding());
    let mut text = format!("history         {contacts} contacts, of which {sliding} slid last\n");
    let [intact, tension, shear] = [Kept::Intact, Kept::Tension, Kept::Shear]
        .map(|kept| history.bonds.iter().filter(|bond| bond.condition == kept).count());
    if intact + tension + shear > 0 {
        text.push_str(&format!(
            "cement          {intact} bonds, beside {tension} that broke by tension and {shear} by \
             shear\n"
        ));
    }
    text
}

/// What of a pack is hydrate, a line when something is.
fn hydrate(pack: &Pack) -> String {
    match pack::hydrate::present(pack) {
        (0, _) => String::new(),
        (grains, saturation) => {
            format!("hydrate         {grains} grains, saturation {}\n", significant(saturation, 5))
        }
    }
}

/// Number, size, density and history of a pack, of discs where the `dimension` is 2.
pub(super) fn describe(pack: &Pack, dimension: u8) -> String {
    let radii = pack.grains.iter().map(|grain| grain.radius);
    let (least, most) = radii.clone().fold((f64::INFINITY, 0.0_f64), |(least, most), radius| {
        (least.min(radius), most.max(radius))
    });
    let depth = pack.bounds.sides()[2];
    let solid = |radius: f64| match dimension {
        2 => PI * radius * radius * depth,
        _ => 4.0 / 3.0 * PI * radius.powi(3),
    };
    let solid: f64 = radii.map(solid).sum();
    let [x, y, z] = pack.bounds.sides().map(|side| significant(side * 1e3, 5));
    format!(
        "grains          {}\nradii           {} to {} mm\nbox             {x} x {y} x {z} mm\n\
         grain volume    {} of the box, overlaps counted twice\n{}{}",
        pack.grains.len(),
        significant(least * 1e3, 4),
        significant(most * 1e3, 4),
        significant(solid / pack.bounds.volume(), 5),
        hydrate(pack),
        history(pack.history.as_ref()),
    )
}
