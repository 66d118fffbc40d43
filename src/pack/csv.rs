//! The pack CSV: one grain a row.
//!
//! Numbers are written in the shortest form that reads back to the same bits.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::{Pack, PackError, coincident};
use crate::table::{Row, Table, TableError};
use crate::wall::{self, Bounds};

const GEOMETRY: [&str; 4] = ["x", "y", "z", "radius"];
const MATERIAL: &str = "material";
const CONSTANTS: [&str; 4] = ["young", "poisson", "density", "friction"];
const HYDRATE: &str = "hydrate";

/// What a pack CSV says about the grains' material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Columns {
    /// Nothing: the scene names one material for all.
    Geometry,
    /// A material of the scene for each grain.
    Material,
    /// The constants of each grain.
    Constants,
}

/// A pack CSV as read: right in itself, not yet in a box or of a material.
#[derive(Clone, Debug, PartialEq)]
pub struct PackFile {
    /// The CSV.
    pub file: PathBuf,
    /// Which columns it has besides the geometry.
    pub columns: Columns,
    /// The grains; at least one.
    pub rows: Vec<PackRow>,
}

/// One grain as written.
#[derive(Clone, Debug, PartialEq)]
pub struct PackRow {
    /// Line in the CSV, from 1.
    pub line: u64,
    /// Centre \[m\].
    pub position: [f64; 3],
    /// Radius \[m\], above 0.
    pub radius: f64,
    /// What it is made of.
    pub constants: Constants,
    /// Whether it is gas hydrate; not without the column.
    pub hydrate: bool,
}

/// What one grain is made of.
#[derive(Clone, Debug, PartialEq)]
pub enum Constants {
    /// The file does not say.
    Unknown,
    /// A material of the scene.
    Material(String),
    /// Its constants.
    Given {
        /// Young's modulus \[Pa\], above 0.
        young: f64,
        /// Poisson's ratio, -1 < ν < 0.5.
        poisson: f64,
        /// Density \[kg/m³\], above 0.
        density: f64,
        /// Coefficient of friction, 0 to infinite.
        friction: f64,
    },
}

/// Reads a pack CSV and checks what can be checked without its box and materials.
///
/// # Errors
/// When the file cannot be read or is not UTF-8; on a missing, unknown or double column, a wrong
/// number of fields, a number that is none, not finite or out of range, no grain at all, or two
/// grains with the same centre.
pub fn read(file: &Path) -> Result<PackFile, PackError> {
    rows(&Table::read(file, Some('#'))?, file)
}

/// As [`read`] for a CSV in memory; `file` is what errors name.
pub(super) fn parse(bytes: &[u8], file: &Path) -> Result<PackFile, PackError> {
    rows(&Table::parse(bytes.to_vec(), file, Some('#'))?, file)
}

fn rows(table: &Table, file: &Path) -> Result<PackFile, PackError> {
    let columns = columns(table)?;
    let index = |names: [&str; 4]| -> Result<[usize; 4], TableError> {
        let mut found = [0; 4];
        for (place, name) in found.iter_mut().zip(names) {
            *place = table.require(name)?;
        }
        Ok(found)
    };
    let geometry = index(GEOMETRY)?;
    let material = table.column(MATERIAL);
    let hydrate = table.column(HYDRATE);
    let constants = match columns {
        Columns::Constants => Some(index(CONSTANTS)?),
        Columns::Geometry | Columns::Material => None,
    };

    let mut rows = Vec::new();
    for row in table.rows() {
        let row = row?;
        rows.push(PackRow {
            line: row.line(),
            position: [
                row.number(geometry[0])?,
                row.number(geometry[1])?,
                row.number(geometry[2])?,
            ],
            radius: positive(&row, geometry[3], "radius > 0 m")?,
            constants: match (material, constants) {
                (Some(column), _) => Constants::Material(row.text(column).into()),
                (None, Some(columns)) => given(&row, columns)?,
                (None, None) => Constants::Unknown,
            },
            hydrate: hydrate.map_or(Ok(false), |column| flag(&row, column))?,
        });
    }
    if rows.is_empty() {
        return Err(table.in_header("no grain follows the header; allowed: at least one").into());
    }
    if let Some((first, second)) = coincident::pair(&rows) {
        let text = format!("the grain has the same centre as that of line {}", first.line);
        return Err(table.at(second.line, text).into());
    }
    Ok(PackFile { file: file.into(), columns, rows })
}

fn columns(table: &Table) -> Result<Columns, TableError> {
    let known = |name: &str| {
        [MATERIAL, HYDRATE].contains(&name) || GEOMETRY.contains(&name) || CONSTANTS.contains(&name)
    };
    if let Some(name) = table.header().iter().find(|name| !known(name)) {
        return Err(table.in_header(format!(
            "column `{name}` is unknown; allowed: x, y, z, radius and either material or young, \
             poisson, density, friction; and hydrate"
        )));
    }
    let constants = CONSTANTS.iter().any(|name| table.column(name).is_some());
    match (table.column(MATERIAL), constants) {
        (Some(_), true) => Err(table.in_header(
            "both material and constants; allowed: either material or young, poisson, density, \
             friction",
        )),
        (Some(_), false) => Ok(Columns::Material),
        (None, true) => Ok(Columns::Constants),
        (None, false) => Ok(Columns::Geometry),
    }
}

fn given(row: &Row<'_>, columns: [usize; 4]) -> Result<Constants, TableError> {
    let [young, poisson, density, friction] = columns;
    Ok(Constants::Given {
        young: positive(row, young, "young > 0 Pa")?,
        poisson: within(row, poisson, "-1 < poisson < 0.5", |nu| -1.0 < nu && nu < 0.5)?,
        density: positive(row, density, "density > 0 kg/m³")?,
        friction: coefficient(row, friction)?,
    })
}

/// Whether a grain is hydrate: 1 or 0.
fn flag(row: &Row<'_>, column: usize) -> Result<bool, TableError> {
    match row.text(column) {
        "0" => Ok(false),
        "1" => Ok(true),
        other => Err(row.wrong(column, format!("`{other}` is neither 0 nor 1"))),
    }
}

/// A coefficient of friction; the word `inf` stands for grains that never slide.
fn coefficient(row: &Row<'_>, column: usize) -> Result<f64, TableError> {
    if row.text(column) == "inf" {
        return Ok(f64::INFINITY);
    }
    within(row, column, "friction >= 0, inf included", |mu| mu >= 0.0)
}

fn positive(row: &Row<'_>, column: usize, allowed: &str) -> Result<f64, TableError> {
    within(row, column, allowed, |value| value > 0.0)
}

fn within(
    row: &Row<'_>,
    column: usize,
    allowed: &str,
    inside: impl Fn(f64) -> bool,
) -> Result<f64, TableError> {
    let value = row.number(column)?;
    if inside(value) {
        Ok(value)
    } else {
        Err(row.wrong(column, format!("{value:?} is outside {allowed}")))
    }
}

impl PackFile {
    /// Checks that every grain's centre lies in `bounds`.
    ///
    /// # Errors
    /// When one does not; the first one's line is named.
    pub fn check_inside(&self, bounds: &Bounds) -> Result<(), PackError> {
        let beyond = |row: &PackRow| {
            (0..wall::COUNT).find(|&wall| {
                let depth = row.position[wall::axis(wall)] - bounds.position(wall);
                depth * wall::inward(wall) < 0.0
            })
        };
        let mut outside = self.rows.iter().filter_map(|row| beyond(row).map(|wall| (row, wall)));
        let Some((row, wall)) = outside.next() else { return Ok(()) };
        let [x, y, z] = row.position;
        let text = format!(
            "the grain's centre ({x:?}, {y:?}, {z:?}) lies outside the box, beyond {} = {:?} m; \
             grains outside: {}",
            wall::NAMES[wall],
            bounds.position(wall),
            1 + outside.count(),
        );
        Err(TableError::Line { file: self.file.clone(), line: row.line, text }.into())
    }
}

/// The pack as CSV with the constants of every grain.
pub(super) fn to_csv(pack: &Pack) -> String {
    let mut text = [GEOMETRY, CONSTANTS].concat().join(",");
    let has_hydrate = pack.grains.iter().any(|grain| grain.hydrate);
    if has_hydrate {
        text = [text.as_str(), HYDRATE].join(",");
    }
    text.push('\n');
    for grain in &pack.grains {
        let [x, y, z] = grain.position;
        let (radius, young, poisson) = (grain.radius, grain.young, grain.poisson);
        let (density, friction) = (grain.density, grain.friction);
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "{x:?},{y:?},{z:?},{radius:?},{young:?},{poisson:?},{density:?},{friction:?}"
        );
        if has_hydrate {
            let _ = write!(text, ",{}", u8::from(grain.hydrate));
        }
        text.push('\n');
    }
    text
}
