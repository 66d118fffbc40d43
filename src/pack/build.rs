//! From a scene to its pack: read or made, given its properties, cut, and prepared.

use std::path::Path;

use rand::SeedableRng;
use rand_pcg::Pcg64;

use super::generate::{GenerateError, generate};
use super::prepare::prepare;
use super::{
    Constants, Grain, History, Pack, PackError, PackFile, PackRow, Texts, beside, crystal, csv,
    discs, history, hydrate, properties, read, rescale,
};
use crate::scene::{self, Crystal, Friction, Generate, Loaded, Material, Scene};
use crate::table::TableError;
use crate::wall::Bounds;

/// The pack of a scene: made or read, cut, and prepared.
///
/// # Errors
/// As [`unprepared`], and when the preparation fails.
pub fn build(loaded: &Loaded) -> Result<Pack, PackError> {
    let pack = unprepared(loaded)?;
    Ok(prepare(&loaded.scene, pack, &mut |_| ())?)
}

/// The pack of a scene before its preparation.
///
/// # Errors
/// When a file of the pack is wrong or cannot be read, the pack cannot be made, or the cut leaves
/// nothing.
pub fn unprepared(loaded: &Loaded) -> Result<Pack, PackError> {
    let source = &loaded.scene.pack;
    let pack = match (&source.generate, &source.crystal, &source.file) {
        (Some(spec), ..) => made(&rescale::before(&loaded.scene, &source.prepare), spec)?,
        (None, Some(spec), _) => laid_out(&loaded.scene, spec)?,
        (None, None, Some(file)) => from_file(loaded, file)?,
        (None, None, None) => return Err(PackError::NoSource),
    };
    let Some(cut) = &source.cut else { return filled(loaded, pack) };
    if pack.history.is_some() {
        tracing::warn!("pack.cut drops the history of the pack: another specimen begins anew");
    }
    let dimension = loaded.scene.dimension;
    let specimen = match loaded.scene.walls.cell.inner() {
        None => pack.cut(cut, dimension),
        Some(inner) => pack.cut_round(cut, inner, dimension),
    };
    if specimen.grains.is_empty() {
        return Err(PackError::EmptyCut { grains: pack.grains.len() });
    }
    filled(loaded, specimen)
}

/// A pack with the hydrate that the scene puts into it; one that was made under a stress has it.
fn filled(loaded: &Loaded, pack: Pack) -> Result<Pack, PackError> {
    let source = &loaded.scene.pack;
    if source.generate.is_some() {
        return Ok(pack);
    }
    let Some(filling) = filling(&loaded.scene)? else { return Ok(pack) };
    match &source.file {
        Some(file) if pack.grains.iter().any(|grain| grain.hydrate) => {
            Err(PackError::TwiceHydrate { file: loaded.resolve(file) })
        }
        _ => Ok(hydrate::fill(&pack, &filling)),
    }
}

/// The hydrate of a scene.
fn filling(scene: &Scene) -> Result<Option<hydrate::Filling<'_>>, PackError> {
    let Some(scene::Hydrate { saturation, material: name }) = &scene.pack.hydrate else {
        return Ok(None);
    };
    let field = "pack.hydrate.material";
    let material = material(scene, name)
        .ok_or_else(|| PackError::UnknownMaterial { field, name: name.clone() })?;
    let (saturation, seed) = (*saturation, scene.pack.seed());
    Ok(Some(hydrate::Filling { saturation, material, seed }))
}

fn made(scene: &Scene, spec: &Generate) -> Result<Pack, PackError> {
    let field = "pack.generate.material";
    let material = material(scene, &spec.material)
        .ok_or_else(|| PackError::UnknownMaterial { field, name: spec.material.clone() })?;
    if scene.dimension == 2 {
        return Ok(discs::make(scene, spec, material).map_err(GenerateError::from)?);
    }
    let friction = scene.contact.friction.coefficient();
    let pack = generate(spec, material, &scene.walls, friction, scene.solver)?;
    let Some(filling) = filling(scene)? else { return Ok(pack) };
    Ok(hydrate::fill_at(&pack, &filling, spec.confining_stress, &scene.walls, scene.solver)?)
}

fn laid_out(scene: &Scene, spec: &Crystal) -> Result<Pack, PackError> {
    let field = "pack.crystal.material";
    let material = material(scene, &spec.material)
        .ok_or_else(|| PackError::UnknownMaterial { field, name: spec.material.clone() })?;
    Ok(crystal(spec, material, scene.contact.friction.coefficient(), scene.pack.seed))
}

fn from_file(loaded: &Loaded, file: &Path) -> Result<Pack, PackError> {
    let Loaded { scene, .. } = loaded;
    let file = read(&loaded.resolve(file))?;
    let bounds = match scene.pack.bounds {
        Some(bounds) => bounds,
        None => file.read_box()?,
    };
    let history = file.read_history()?;
    if history.is_some() && scene.contact.friction == Friction::None {
        tracing::warn!(
            "{}: the history of the pack is not used: `contact.friction` is none",
            file.file.display()
        );
    }
    boxed(scene, &file, bounds, history)
}

/// The pack in `texts`, which [`texts`](super::texts) made of one under `scene`; `name` is what
/// errors name for the CSV. It is the same pack to the bit.
///
/// # Errors
/// When a text is wrong.
pub fn from_texts(scene: &Scene, texts: &Texts, name: &Path) -> Result<Pack, PackError> {
    let file = csv::parse(texts.csv.as_bytes(), name)?;
    let bounds = beside::bounds_in(&texts.json, &super::box_file(name))?;
    let beside = super::history_file(name);
    let history = texts.history.as_ref();
    let history = history.map(|json| history::parse(json.as_bytes(), &beside, file.rows.len()));
    boxed(scene, &file, bounds, history.transpose()?)
}

fn boxed(
    scene: &Scene,
    file: &PackFile,
    bounds: Bounds,
    history: Option<History>,
) -> Result<Pack, PackError> {
    file.check_inside(&bounds)?;
    let mut rng = Pcg64::seed_from_u64(scene.pack.seed);
    let grain = |row: &PackRow| grain(file, row, scene, &mut rng);
    let grains = file.rows.iter().map(grain).collect::<Result<_, _>>()?;
    Ok(Pack { bounds, grains, history })
}

fn grain(
    file: &PackFile,
    row: &PackRow,
    scene: &Scene,
    rng: &mut Pcg64,
) -> Result<Grain, PackError> {
    let (position, radius, hydrate) = (row.position, row.radius, row.hydrate);
    let name = match &row.constants {
        Constants::Given { young, poisson, density, friction } => {
            let (young, poisson, density, friction) = (*young, *poisson, *density, *friction);
            return Ok(Grain { position, radius, young, poisson, density, friction, hydrate });
        }
        Constants::Material(name) => name,
        Constants::Unknown => scene
            .pack
            .material
            .as_ref()
            .ok_or_else(|| PackError::NoMaterial { file: file.file.clone() })?,
    };
    let material = material(scene, name).ok_or_else(|| {
        let known = scene.materials.keys().map(String::as_str).collect::<Vec<_>>().join(", ");
        let text = format!("column `material`: no material is named `{name}`; known: {known}");
        TableError::Line { file: file.file.clone(), line: row.line, text }
    })?;
    let (young, poisson) = properties::draw(material, rng);
    let (density, friction) = (material.density, scene.contact.friction.coefficient());
    Ok(Grain { position, radius, young, poisson, density, friction, hydrate })
}

fn material<'scene>(scene: &'scene Scene, name: &str) -> Option<&'scene Material> {
    scene.materials.get(name)
}
