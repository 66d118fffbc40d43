//! What is in a pack.

use std::path::Path;

use graintwin::pack::{self, Columns, PackError};

use crate::cli::{Failure, output::significant, specimen};

/// The box is checked when it is in the JSON beside the CSV.
pub(super) fn describe(file: &Path) -> Result<String, Failure> {
    let pack = pack::read(file)?;
    let place = match pack.read_box() {
        Ok(bounds) => {
            pack.check_inside(&bounds)?;
            let [x, y, z] = bounds.sides().map(|side| significant(side * 1e3, 5));
            format!("{x} x {y} x {z} mm, from {}", pack::box_file(file).display())
        }
        Err(PackError::ReadBox { file, source }) => {
            format!("the scene must tell it, pack.box ({}: {source})", file.display())
        }
        Err(PackError::Box { file, text }) => {
            format!("the scene must tell it, pack.box ({}: {text})", file.display())
        }
        Err(error) => return Err(error.into()),
    };
    let made_of = match pack.columns {
        Columns::Geometry => "not told, so the scene must: pack.material",
        Columns::Material => "column `material`, names of the scene",
        Columns::Constants => "columns `young,poisson,density,friction`",
    };
    let hydrate = match pack.rows.iter().filter(|row| row.hydrate).count() {
        0 => String::new(),
        grains => format!("hydrate         {grains} grains\n"),
    };
    let history = specimen::history(pack.read_history()?.as_ref());
    let radii = pack.rows.iter().map(|row| row.radius);
    let (least, most) = radii.fold((f64::INFINITY, 0.0_f64), |(least, most), radius| {
        (least.min(radius), most.max(radius))
    });
    Ok(format!(
        "pack            {}: right\ngrains          {}\nradii           {} to {} mm\n\
         material        {made_of}\nbox             {place}\n{hydrate}{history}",
        file.display(),
        pack.rows.len(),
        significant(least * 1e3, 4),
        significant(most * 1e3, 4),
    ))
}
