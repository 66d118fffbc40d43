//! The command CSV: stamps and cumulative inward displacements of the walls.

use std::path::Path;

use super::{Course, PathError};
use crate::table::{Row, Table, TableError};
use crate::wall;

/// Adds the commands of `file`. Columns that are missing leave their wall where it is.
pub(super) fn follow(file: &Path, course: &mut Course) -> Result<(), PathError> {
    let table = Table::read(file, Some('#'))?;
    check_header(&table)?;
    let time = table.require("stamp")?;
    let walls: Vec<_> = wall::NAMES.iter().map(|name| table.column(name)).collect();

    let mut clock = Clock::new(course.clock);
    let mut empty = true;
    for row in table.rows() {
        let row = row?;
        let nanoseconds = clock.read(&row, time)?;
        let mut displacement = course.displacement;
        for (target, column) in displacement.iter_mut().zip(&walls) {
            if let Some(column) = *column {
                *target = row.number(column)?;
            }
        }
        course.push(nanoseconds, displacement)?;
        empty = false;
    }
    if empty {
        return Err(table.in_header("no row follows the header; allowed: at least one").into());
    }
    Ok(())
}

fn check_header(table: &Table) -> Result<(), TableError> {
    for name in table.header() {
        if name == "stamp" || wall::NAMES.contains(&name.as_str()) {
            continue;
        }
        let stress = name.strip_suffix(":stress").is_some_and(|wall| wall::NAMES.contains(&wall));
        let text = if stress {
            format!("column `{name}`: this version has no stress-controlled walls")
        } else {
            format!("column `{name}` is unknown")
        };
        let allowed = wall::NAMES.join(", ");
        return Err(table.in_header(format!("{text}; allowed: stamp, {allowed}")));
    }
    Ok(())
}

/// Stamps of a file, shifted to the end of the step before it.
pub(super) struct Clock {
    start: i64,
    last: f64,
}

impl Clock {
    pub(super) fn new(start: i64) -> Self {
        Self { start, last: 0.0 }
    }

    /// The stamp of a row in nanoseconds since the start of the run.
    pub(super) fn read(&mut self, row: &Row<'_>, column: usize) -> Result<i64, TableError> {
        let seconds = row.number(column)?;
        if !(0.0..=f64::from(i32::MAX)).contains(&seconds) {
            let text = format!("{seconds:?} is outside 0 to 2147483647 s");
            return Err(row.wrong(column, text));
        }
        if seconds < self.last {
            let text = format!(
                "{seconds:?} is before {:?}, the row above; allowed: the same or later",
                self.last
            );
            return Err(row.wrong(column, text));
        }
        self.last = seconds;
        // Both terms are below 2^62 ns: the first by `stamp`, the second by its range.
        Ok(self.start + (seconds * 1e9).round() as i64)
    }
}
