//! What of a long line can be seen.

/// Side of the squares that a line is seen by \[pixels\]: one pixel of a PNG.
const SQUARE: f64 = 0.5;

/// Points of a line that are all drawn.
const ALL: usize = 4000;

/// The squares that a line has passed through.
struct Seen {
    corner: [f64; 2],
    columns: usize,
    rows: usize,
    passed: Vec<bool>,
}

/// What can be seen of a line of several pieces when it is drawn from its beginning: a stretch that
/// passes only through squares already passed is left out. Extremes stay within a square of where
/// they were, and the number of points is bounded by the area and not by the length of the line.
pub(super) fn thinned(pieces: Vec<Vec<[f64; 2]>>) -> Vec<Vec<[f64; 2]>> {
    if pieces.iter().map(Vec::len).sum::<usize>() <= ALL {
        return pieces;
    }
    let mut seen = Seen::over(pieces.iter().flatten());
    let mut shown: Vec<Vec<[f64; 2]>> = Vec::new();
    for piece in &pieces {
        let mut drawn_to_here = false;
        for pair in piece.windows(2) {
            let shows = seen.pass(pair[0], pair[1]);
            match shown.last_mut() {
                Some(last) if shows && drawn_to_here => last.push(pair[1]),
                _ if shows => shown.push(pair.to_vec()),
                _ => {}
            }
            drawn_to_here = shows;
        }
    }
    shown
}

/// The `points` that do not lie in a square with an earlier one.
pub(super) fn apart(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    if points.len() <= ALL {
        return points.to_vec();
    }
    let mut seen = Seen::over(points.iter());
    points.iter().copied().filter(|point| seen.pass(*point, *point)).collect()
}

impl Seen {
    fn over<'a>(points: impl Iterator<Item = &'a [f64; 2]>) -> Self {
        let (mut corner, mut far) = ([f64::INFINITY; 2], [0.0; 2]);
        for point in points {
            for which in 0..2 {
                corner[which] = point[which].min(corner[which]);
                far[which] = point[which].max(far[which]);
            }
        }
        let squares = |which: usize| ((far[which] - corner[which]) / SQUARE) as usize + 1;
        let (columns, rows) = (squares(0), squares(1));
        Self { corner, columns, rows, passed: vec![false; columns * rows] }
    }

    /// Passes through the squares between two places; whether one of them is new.
    fn pass(&mut self, from: [f64; 2], to: [f64; 2]) -> bool {
        let span = (to[0] - from[0]).abs().max((to[1] - from[1]).abs());
        let steps = (span / SQUARE).ceil().max(1.0);
        let mut new = false;
        for step in 0..=steps as usize {
            let share = step as f64 / steps;
            let at = |which: usize| from[which] + share * (to[which] - from[which]);
            let square = self.square([at(0), at(1)]);
            new |= !self.passed[square];
            self.passed[square] = true;
        }
        new
    }

    fn square(&self, [x, y]: [f64; 2]) -> usize {
        let column = ((x - self.corner[0]) / SQUARE) as usize;
        let row = ((y - self.corner[1]) / SQUARE) as usize;
        // A rounding may put the last place beyond the last square.
        row.min(self.rows - 1) * self.columns + column.min(self.columns - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chart's worth of noise, from a generator of its own.
    fn noise(count: usize) -> Vec<[f64; 2]> {
        let mut seed = 7_u64;
        let point = |number: usize| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let y = (seed >> 33) as f64 / (1_u64 << 31) as f64;
            [600.0 * number as f64 / count as f64, 300.0 * y]
        };
        (0..count).map(point).collect()
    }

    #[test]
    fn a_line_that_can_be_drawn_whole_is() {
        let line = noise(ALL);
        let pieces: Vec<_> = line.chunks(7).map(<[_]>::to_vec).collect();
        assert_eq!(thinned(pieces.clone()), pieces);
        assert_eq!(apart(&line), line);
    }

    #[test]
    fn a_loop_gone_a_thousand_times_is_drawn_once() {
        let turn = |step: usize| {
            let angle = std::f64::consts::TAU * (step % 200) as f64 / 200.0;
            [300.0 + 200.0 * angle.cos(), 200.0 + 100.0 * angle.sin()]
        };
        let line: Vec<_> = (0..200_000).map(turn).collect();
        assert_eq!(thinned(vec![line.clone()]), [&line[..=200]]);
        assert_eq!(apart(&line), line[..200]);
    }

    #[test]
    fn a_spike_in_a_million_points_stays() {
        let mut line = noise(1_000_000);
        line[654_321][1] = 900.0;
        line[123_456][1] = -500.0;
        let drawn = thinned(vec![line.clone()]).concat();
        assert!(drawn.contains(&line[654_321]) && drawn.contains(&line[123_456]));
        assert!(drawn.len() < 60_000, "{}", drawn.len());
    }

    #[test]
    fn a_line_of_many_short_pieces_is_thinned_too() {
        let pieces: Vec<_> = noise(1_000_000).chunks(2).map(<[_]>::to_vec).collect();
        let drawn = thinned(pieces);
        assert!(drawn.len() < 60_000, "{}", drawn.len());
    }
}
