//! The pack of a scene, and what to say of it.

use indicatif::MultiProgress;

use graintwin::pack::{self, History, Pack};
use graintwin::scene::Loaded;

use super::Failure;
use super::output::significant;
use super::progress::waiting;

/// The scene's pack; making one takes a while and says so.
pub(super) fn build(
    loaded: &Loaded,
    threads: usize,
    bars: &MultiProgress,
) -> Result<Pack, Failure> {
    // What is made does not depend on the threads, the time does.
    let pool =
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(Failure::other)?;
    let pack = match &loaded.scene.pack.generate {
        None => pack::build(loaded)?,
        Some(spec) => {
            let what = format!("making {} grains", spec.grains);
            waiting(what, bars, || pool.install(|| pack::build(loaded)))?
        }
    };
    Ok(pack)
}

/// What a pack remembers.
pub(super) fn history(history: Option<&History>) -> String {
    let Some(history) = history else { return "history         none\n".into() };
    let (contacts, sliding) = (history.contacts.len(), history.sliding());
    format!("history         {contacts} contacts, of which {sliding} slide\n")
}

/// Number, size, density and history of a pack.
pub(super) fn describe(pack: &Pack) -> String {
    let radii = pack.grains.iter().map(|grain| grain.radius);
    let (least, most) = radii.clone().fold((f64::INFINITY, 0.0_f64), |(least, most), radius| {
        (least.min(radius), most.max(radius))
    });
    let solid: f64 = radii.map(|radius| 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3)).sum();
    let [x, y, z] = pack.bounds.sides().map(|side| significant(side * 1e3, 5));
    format!(
        "grains          {}\nradii           {} to {} mm\nbox             {x} x {y} x {z} mm\n\
         grain volume    {} of the box, overlaps counted twice\n{}",
        pack.grains.len(),
        significant(least * 1e3, 4),
        significant(most * 1e3, 4),
        significant(solid / pack.bounds.volume(), 5),
        history(pack.history.as_ref()),
    )
}
