//! The shear band that explains the motion of the grains best: angle, thickness, slip.
//!
//! Every grain moves with an affine field, and besides with a share of one jump that grows evenly
//! across a strip (figure 26): u(x) = u₀ + A x + g(n·x) Δ with the ramp g from -½ to ½ over the
//! thickness. For given strip u₀, A and Δ follow from least squares in closed form; the strip is the
//! one that leaves least, of a grid and then by steps that halve. Unlike the moments of the most
//! sheared grains ([`crate::measure::motion::band`]) that needs no local strain and no choice of how
//! many grains lie in the band.

use std::f64::consts::{FRAC_PI_2, PI};

/// Fewer grains do not tell a strip from an affine field.
const LEAST: usize = 12;

/// Of the grid: directions, offsets, thicknesses.
const GRID: [u32; 3] = [45, 31, 5];

/// Steps of the search end at this share of the grid's.
const FINEST: f64 = 1e-5;

/// A search that gains less, relatively, goes on with finer steps.
const GAIN: f64 = 1e-9;

/// Part of the ramp that is not affine itself, over the number of grains, below which it tells
/// nothing: a strip at a corner, or as wide as the pack.
const TELLING: f64 = 1e-3;

/// A shear band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShearBand {
    /// Angle \[rad\] of the band to the x-axis, from -π/2 to π/2; see
    /// [`crate::analytic::flow::band`].
    pub angle: f64,
    /// \[m\].
    pub thickness: f64,
    /// A point in the middle of it \[m\].
    pub center: [f64; 2],
    /// By how much its sides slide past each other \[m\].
    pub slip: f64,
    /// By how much its sides move apart \[m\].
    pub opening: f64,
    /// Share of the non-affine motion that it explains, by its square.
    pub explained: f64,
}

/// The band of grains at `position` \[m\] that move by `displacement` \[m\], in the plane; nothing of too
/// few grains, or when their motion is affine.
#[must_use]
pub fn shear_band(position: &[[f64; 2]], displacement: &[[f64; 2]]) -> Option<ShearBand> {
    let field = Field::of(position, displacement)?;
    let (reach, spacing) = (field.reach, field.spacing);
    let [directions, offsets, widths] = GRID.map(f64::from);
    let mut best = (0.0, Strip { direction: 0.0, offset: 0.0, width: 0.0 });
    for direction in 0..GRID[0] {
        for offset in 0..GRID[1] {
            for width in 0..GRID[2] {
                let strip = Strip {
                    direction: PI * f64::from(direction) / directions,
                    offset: reach * (2.0 * (f64::from(offset) + 0.5) / offsets - 1.0),
                    width: spacing * (reach / spacing).powf(f64::from(width) / widths),
                };
                best = field.better(best, strip);
            }
        }
    }
    let mut step = 1.0;
    while step > FINEST {
        let (before, Strip { direction, offset, width }) = best;
        for by in [-step, step] {
            let turned = Strip { direction: direction + by * PI / directions, ..best.1 };
            best = field.better(best, turned);
            best = field.better(best, Strip { offset: offset + by * reach / offsets, ..best.1 });
            best = field.better(best, Strip { width: width * (0.5 * by).exp(), ..best.1 });
        }
        if best.0 <= before * (1.0 + GAIN) {
            step *= 0.5;
        }
    }
    field.band(&best.1)
}

/// Where the jump lies.
#[derive(Clone, Copy)]
struct Strip {
    /// Of its normal to the x-axis \[rad\].
    direction: f64,
    /// Of its middle from the centre of the grains along the normal \[m\].
    offset: f64,
    /// \[m\].
    width: f64,
}

/// A grain.
struct Place {
    /// From the centre of all \[m\].
    at: [f64; 2],
    /// The same in coordinates whose second moments are those of the unit.
    even: [f64; 2],
    /// Motion beside the affine one \[m\].
    moved: [f64; 2],
}

struct Field {
    center: [f64; 2],
    places: Vec<Place>,
    /// Sum of the squares of the motion beside the affine one \[m²\].
    total: f64,
    /// The farthest grain from the centre \[m\].
    reach: f64,
    /// About the distance of neighbours \[m\].
    spacing: f64,
}

impl Field {
    fn of(position: &[[f64; 2]], displacement: &[[f64; 2]]) -> Option<Self> {
        let count = position.len();
        if count < LEAST || displacement.len() != count {
            return None;
        }
        let share = 1.0 / count as f64;
        let mean = |all: &[[f64; 2]]| [0, 1].map(|k| all.iter().map(|v| v[k] * share).sum::<f64>());
        let (center, drift) = (mean(position), mean(displacement));
        let from = |v: &[f64; 2], mean: [f64; 2]| [v[0] - mean[0], v[1] - mean[1]];
        let at: Vec<[f64; 2]> = position.iter().map(|x| from(x, center)).collect();
        let moment = |i: usize, j: usize| at.iter().map(|x| x[i] * x[j] * share).sum::<f64>();
        // Cholesky's factor of the second moments makes the coordinates even.
        let first = moment(0, 0).sqrt();
        let mixed = moment(0, 1) / first;
        let second = (moment(1, 1) - mixed * mixed).sqrt();
        let even = |x: &[f64; 2]| [x[0] / first, (x[1] - mixed * x[0] / first) / second];
        let even: Vec<[f64; 2]> = at.iter().map(even).collect();
        let moved: Vec<[f64; 2]> = displacement.iter().map(|u| from(u, drift)).collect();
        let gradient = [0, 1].map(|k| {
            [0, 1].map(|i| even.iter().zip(&moved).map(|(e, u)| e[i] * u[k] * share).sum::<f64>())
        });
        let affine = |e: &[f64; 2]| gradient.map(|row| row[0] * e[0] + row[1] * e[1]);
        let places: Vec<Place> = (at.iter().zip(&even).zip(&moved))
            .map(|((&at, &even), u)| Place { at, even, moved: from(u, affine(&even)) })
            .collect();
        let square = |v: &[f64; 2]| v[0] * v[0] + v[1] * v[1];
        let total: f64 = places.iter().map(|place| square(&place.moved)).sum();
        let all: f64 = displacement.iter().map(square).sum();
        let reach = at.iter().map(square).fold(0.0, f64::max).sqrt();
        // The area of a box with these second moments.
        let spacing = (12.0 * first * second * share).sqrt();
        // What rounding leaves of an affine motion is no band.
        let telling = spacing > 0.0 && spacing < reach && total > 1e-20 * all;
        telling.then_some(Self { center, places, total, reach, spacing })
    }

    /// Δ \[m\] of a strip and the squares \[m²\] that it explains.
    fn jump(&self, strip: &Strip) -> Option<([f64; 2], f64)> {
        let (sine, cosine) = strip.direction.sin_cos();
        let [mut g, mut gg] = [0.0; 2];
        let [mut even, mut moved] = [[0.0; 2]; 2];
        for place in &self.places {
            let along = place.at[0] * cosine + place.at[1] * sine - strip.offset;
            let ramp = (along / strip.width).clamp(-0.5, 0.5);
            g += ramp;
            gg += ramp * ramp;
            for k in 0..2 {
                even[k] += ramp * place.even[k];
                moved[k] += ramp * place.moved[k];
            }
        }
        let count = self.places.len() as f64;
        let own = gg - (g * g + even[0] * even[0] + even[1] * even[1]) / count;
        let explained = (moved[0] * moved[0] + moved[1] * moved[1]) / own;
        (own > TELLING * count).then(|| (moved.map(|sum| sum / own), explained))
    }

    /// The better one of two strips with what it explains.
    fn better(&self, best: (f64, Strip), strip: Strip) -> (f64, Strip) {
        match self.jump(&strip) {
            Some((_, explained)) if explained > best.0 => (explained, strip),
            _ => best,
        }
    }

    fn band(&self, strip: &Strip) -> Option<ShearBand> {
        let ([x, y], explained) = self.jump(strip)?;
        let (sine, cosine) = strip.direction.sin_cos();
        let angle = (strip.direction + FRAC_PI_2).rem_euclid(PI);
        Some(ShearBand {
            angle: if angle > FRAC_PI_2 { angle - PI } else { angle },
            thickness: strip.width,
            center: [self.center[0] + strip.offset * cosine, self.center[1] + strip.offset * sine],
            slip: (y * cosine - x * sine).abs(),
            opening: x * cosine + y * sine,
            explained: explained / self.total,
        })
    }
}
