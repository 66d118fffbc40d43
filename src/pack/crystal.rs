//! Laying out a crystal (B chapter 5, figure 51).

use rand::SeedableRng;
use rand_pcg::Pcg64;

use super::{Grain, Pack, properties};
use crate::scene::{Crystal, Material};
use crate::wall::Bounds;

/// The crystal of `spec` around the origin, row by row from y_min, each from x_min on; `friction` is
/// given to every grain, `seed` is that of their properties. Grains and box just touch.
#[must_use]
pub fn crystal(spec: &Crystal, material: &Material, friction: f64, seed: u64) -> Pack {
    let mut rng = Pcg64::seed_from_u64(seed);
    let Crystal { rows, columns, radius, .. } = *spec;
    // In radii: the height of a triangle of three that touch, and the sides of the box.
    let rise = 3.0_f64.sqrt();
    let height = 2.0 + rise * rows.saturating_sub(1) as f64;
    let present = &columns[..rows.min(2)];
    let longest = present.iter().copied().max().unwrap_or(0);
    let shifted = present == [longest; 2];
    let width = (2 * longest + usize::from(shifted)) as f64;
    let mut grains = Vec::new();
    for row in 0..rows {
        let odd = row % 2;
        let indent = if shifted { odd } else { longest - columns[odd] };
        for column in 0..columns[odd] {
            let x = (1 + indent + 2 * column) as f64 - 0.5 * width;
            let y = 1.0 + rise * row as f64 - 0.5 * height;
            let (young, poisson) = properties::draw(material, &mut rng);
            let position = [x * radius, y * radius, 0.0];
            let density = material.density;
            grains.push(Grain {
                position,
                radius,
                young,
                poisson,
                density,
                friction,
                hydrate: false,
            });
        }
    }
    let max = [0.5 * width * radius, 0.5 * height * radius, radius];
    Pack { bounds: Bounds { min: max.map(|side| -side), max }, grains, history: None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const QUARTZ: Material = Material { young: 1e9, poisson: 0.16, density: 2650.0, spread: 0.0 };

    fn made(rows: usize, columns: [usize; 2], radius: f64) -> Pack {
        let spec = Crystal { rows, columns, radius, material: "quartz".into() };
        crystal(&spec, &QUARTZ, 0.6, 0)
    }

    /// Other grains whose surface is within a billionth of the radius of that of each grain.
    fn touching(pack: &Pack) -> Vec<usize> {
        let near = |a: &Grain, b: &Grain| {
            let gap = (0..2).map(|axis| (a.position[axis] - b.position[axis]).powi(2)).sum::<f64>();
            let gap = gap.sqrt() / a.radius - 2.0;
            assert!(gap > -1e-11 || std::ptr::eq(a, b), "two overlap by {gap}");
            gap.abs() < 1e-9
        };
        pack.grains.iter().map(|a| pack.grains.iter().filter(|b| near(a, b)).count()).collect()
    }

    /// 15 x 21 + 16 x 20 = 635. Of 3 contacts a grain in an endless lattice the borders lack
    /// some: a pair in a row for all but the last of each row, two a grain to the next row of a
    /// shorter row.
    #[test]
    fn the_crystal_of_figure_51_has_635_grains_and_all_their_contacts() {
        let pack = made(41, [15, 16], 1e-3);
        assert_eq!(pack.grains.len(), 635);
        let contacts = touching(&pack).iter().sum::<usize>() / 2;
        assert_eq!(contacts, 21 * 14 + 20 * 15 + 40 * 15 * 2);
        let inside = touching(&pack).iter().filter(|&&number| number == 6).count();
        assert_eq!(inside, 19 * (15 - 2) + 20 * (16 - 2));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]

        #[test]
        fn grains_touch_up_to_six_others_and_the_box_touches_the_outer_ones(
            rows in 1..7_usize, first in 1..7_usize, more in -1..=1_i32, radius in 1e-6..1.0,
        ) {
            let second = usize::try_from(first as i32 + more).unwrap().max(1);
            let pack = made(rows, [first, second], radius);
            prop_assert_eq!(pack.grains.len(), rows.div_ceil(2) * first + rows / 2 * second);
            prop_assert!(touching(&pack).iter().all(|&number| number <= 6));
            for axis in 0..3 {
                let ends = |sign: f64| pack.grains.iter()
                    .map(|grain| sign * grain.position[axis] + grain.radius)
                    .fold(f64::NEG_INFINITY, f64::max);
                prop_assert!((ends(1.0) - pack.bounds.max[axis]).abs() < 1e-12 * radius);
                prop_assert!((ends(-1.0) + pack.bounds.min[axis]).abs() < 1e-12 * radius);
            }
        }
    }
}
