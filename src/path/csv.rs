//! The command CSV: stamps and cumulative inward displacements of the walls, or their loads.

use std::path::Path;

use super::{Course, PathError};
use crate::table::{Row, Table, TableError};
use crate::wall::{self, WallTarget};

/// Adds the commands of `file`. Columns that are missing leave their wall where it is.
pub(super) fn follow(file: &Path, course: &mut Course) -> Result<(), PathError> {
    let table = Table::read(file, Some('#'))?;
    check_header(&table)?;
    let time = table.require("stamp")?;
    let columns = wall::NAMES.map(|name| columns(&table, name));
    for (name, columns) in wall::NAMES.iter().zip(&columns) {
        if columns.iter().flatten().count() > 1 {
            let text = format!("{name} has more than one column; allowed: one");
            return Err(table.in_header(text).into());
        }
    }

    let mut clock = Clock::new(course.clock);
    let mut empty = true;
    for row in table.rows() {
        let row = row?;
        let nanoseconds = clock.read(&row, time)?;
        let mut targets = [WallTarget::Keep; wall::COUNT];
        for (target, columns) in targets.iter_mut().zip(&columns) {
            for (column, kind) in columns.iter().zip(KINDS) {
                if let Some(column) = *column {
                    let value = row.number(column)?;
                    if !kind.suffix.is_empty() && value <= 0.0 {
                        let text = format!("{value:?} is no load; allowed: above 0");
                        return Err(row.wrong(column, text).into());
                    }
                    *target = (kind.target)(value);
                }
            }
        }
        course.push(nanoseconds, targets)?;
        empty = false;
    }
    if empty {
        return Err(table.in_header("no row follows the header; allowed: at least one").into());
    }
    Ok(())
}

/// What a column says of its wall.
struct Kind {
    /// What follows the wall's name.
    suffix: &'static str,
    target: fn(f64) -> WallTarget,
}

const KINDS: [Kind; 3] = [
    Kind { suffix: "", target: WallTarget::Displacement },
    Kind { suffix: ":force", target: WallTarget::Force },
    Kind { suffix: ":stress", target: WallTarget::Stress },
];

/// The columns of wall `name`, one a kind.
fn columns(table: &Table, name: &str) -> [Option<usize>; 3] {
    KINDS.map(|kind| table.column(&format!("{name}{}", kind.suffix)))
}

fn check_header(table: &Table) -> Result<(), TableError> {
    let known = |column: &str| {
        let of =
            |wall: &&str| KINDS.iter().any(|kind| column.strip_prefix(*wall) == Some(kind.suffix));
        column == "stamp" || wall::NAMES.iter().any(of)
    };
    match table.header().iter().find(|name| !known(name)) {
        None => Ok(()),
        Some(name) => Err(table.in_header(format!(
            "column `{name}` is unknown; allowed: stamp, {}, each also with :stress or :force",
            wall::NAMES.join(", ")
        ))),
    }
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
