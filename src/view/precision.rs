//! The work-precision diagram.

use super::{Axis, Chart, Kind, Series, Sheet, Unit};
use crate::bench::{Ended, Row};
use crate::scene::Method;

/// Charts of `rows`: time against the error of wall forces, moduli and positions, and evaluations
/// and products against that of the wall forces; one line a method, medians over the increments.
/// Notes say which rows hold fewer increments than the others.
#[must_use]
pub fn work_precision(rows: &[Row], title: &str, subtitle: &str) -> Sheet {
    let time = || Axis { label: "CPU time per increment".into(), ..log(Unit::Si("s")) };
    let seconds = |row: &Row| row.cpu_seconds_median;
    let forces = || Axis::log("error of wall forces");
    let mut charts = vec![
        chart("Wall forces", [forces(), time()], rows, &|row| row.force_error.median, &seconds),
        chart(
            "Secant moduli",
            [Axis::log("error of bulk and shear modulus"), time()],
            rows,
            &|row| row.modulus_error.median,
            &seconds,
        ),
        chart(
            "Positions",
            [Axis::log("error of positions over the mean radius"), time()],
            rows,
            &|row| row.position_error.median,
            &seconds,
        ),
        chart(
            "Work, on any machine",
            [forces(), Axis::log("gradients and products per increment")],
            rows,
            &|row| row.force_error.median,
            &|row| row.gradients + row.products,
        ),
    ];
    let short = rows.iter().filter(|row| matches!(row.ended, Ended::Limit | Ended::Failed));
    charts[0].notes = short
        .map(|row| format!("{} at {:.0e}: {}.", row.method.name(), row.tolerance, row.text))
        .collect();
    Sheet { title: title.into(), subtitle: subtitle.into(), charts }
}

fn log(unit: Unit) -> Axis {
    Axis { label: String::new(), unit, kind: Kind::Log }
}

fn chart(
    title: &str,
    [x, y]: [Axis; 2],
    rows: &[Row],
    error: &dyn Fn(&Row) -> f64,
    cost: &dyn Fn(&Row) -> f64,
) -> Chart {
    let line = |(number, method): (usize, Method)| {
        let of_method = rows.iter().filter(|row| row.method == method);
        let points = of_method.map(|row| [error(row), cost(row)]);
        Series::new(number, method.name(), points)
    };
    let series = Method::ALL.into_iter().enumerate().map(line).collect();
    Chart { title: title.into(), x, y, series, notes: Vec::new() }
}
