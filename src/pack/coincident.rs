//! Two grains with the same centre: their contact would have no direction.

use std::collections::HashMap;

use super::PackRow;

/// Centres closer than this share of the smaller radius count as the same.
const CLOSENESS: f64 = 1e-9;

/// The first two grains with the same centre, in the order of the file.
pub(super) fn pair(grains: &[PackRow]) -> Option<(&PackRow, &PackRow)> {
    let largest = grains.iter().map(|grain| grain.radius).fold(0.0, f64::max);
    let reach = CLOSENESS * largest;
    // Much larger than the reach, so that nearly every grain touches one cell only.
    let edge = 1e-3 * largest;
    // A coordinate beyond the range saturates: cells merge there and the distances decide.
    let cell = |x: f64| (x / edge).floor() as i64;

    let mut cells: HashMap<[i64; 3], Vec<&PackRow>> = HashMap::new();
    for second in grains {
        let low = second.position.map(|x| cell(x - reach));
        let high = second.position.map(|x| cell(x + reach));
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let near = cells.get(&[x, y, z]).into_iter().flatten();
                    if let Some(first) = near.copied().find(|first| same_centre(first, second)) {
                        return Some((first, second));
                    }
                }
            }
        }
        cells.entry(second.position.map(cell)).or_default().push(second);
    }
    None
}

fn same_centre(first: &PackRow, second: &PackRow) -> bool {
    let square = |axis: usize| (first.position[axis] - second.position[axis]).powi(2);
    let distance = (square(0) + square(1) + square(2)).sqrt();
    distance <= CLOSENESS * first.radius.min(second.radius)
}
