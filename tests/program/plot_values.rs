//! The charts of `graintwin plot`, read by the numbers at their axes, hold what the bag says.
#![cfg(feature = "mcap")]

use std::sync::Arc;

use graintwin::report::Measures;
use graintwin::sink::Served;

use crate::answers::answers;
use crate::plotted::{drawn, read};

/// The initial equilibrium and `count` commands, of which `change` makes what the test wants.
fn changed(count: u64, change: impl Fn(&mut Measures)) -> Vec<Arc<Served>> {
    let mut answers = answers(count, 40);
    answers.retain(|answer| answer.report.measures.is_some());
    for answer in &mut answers {
        change(Arc::get_mut(answer).unwrap().report.measures.as_mut().unwrap());
    }
    answers
}

fn near(got: &[[f64; 2]], want: &[[f64; 2]]) {
    assert_eq!(got.len(), want.len(), "{got:?} {want:?}");
    let span = |which: usize| want.iter().map(|at| at[which].abs()).fold(1e-9, f64::max);
    for (got, want) in got.iter().zip(want) {
        // A place is written to a hundredth of a pixel of some hundred.
        let off = |which: usize| (got[which] - want[which]).abs() / span(which);
        assert!(off(0) < 1e-3 && off(1) < 1e-3, "{got:?} {want:?}");
    }
}

#[test]
fn volume_change_is_the_loss_of_volume_in_percent() {
    // A unit cube: first itself, then 1.5 by 1 by 0.5, then 1 by 1 by 0.4.
    let sides = [[1.0, 1.0, 1.0], [1.5, 1.0, 0.5], [1.0, 1.0, 0.4]];
    let answers = changed(2, |measures| {
        let sides: [f64; 3] = sides[measures.increment as usize];
        measures.state.as_mut().unwrap().strain = sides.map(|side| 1.0 - side);
    });
    let chart = read(&drawn(&answers, "volume_change"), 0);
    near(&chart.lines[0], &[[0.0, 0.0], [50.0, 25.0], [60.0, 60.0]]);
    assert!(chart.texts.iter().any(|text| text == "volumetric strain [%]"), "{:?}", chart.texts);
}

#[test]
fn the_stress_path_goes_from_its_start_through_q_and_p() {
    let path = [[4e6, 0.0], [5e6, 3e6], [4.5e6, 1.5e6]];
    let answers = changed(2, |measures| {
        let state = measures.state.as_mut().unwrap();
        [state.confining_stress, state.deviatoric_stress] = path[measures.increment as usize];
    });
    let chart = read(&drawn(&answers, "stress_path"), 0);
    near(&chart.lines[0], &path.map(|at| at.map(|stress| stress / 1e6)));
    near(&chart.lines[1], &[[4.0, 0.0]]);
    for axis in ["mean stress p [MPa]", "deviatoric stress q [MPa]"] {
        assert!(chart.texts.iter().any(|text| text == axis), "{:?}", chart.texts);
    }
}

#[test]
fn energies_of_a_path_that_turns_are_drawn_over_the_increments() {
    let answers = changed(4, |measures| {
        let increment = measures.increment as f64;
        let state = measures.state.as_mut().unwrap();
        state.strain[2] = [0.0, 1e-3, 0.0, 1e-3, 2e-3][measures.increment as usize];
        state.stored_energy = 3e-6 + 1e-6 * increment;
        state.dissipated_energy = 5e-7 * increment;
        measures.walls.normal_force = [0.0, 0.0, 0.0, 0.0, 2.0, 0.0];
        measures.walls.displacement = [0.0, 0.0, 0.0, 0.0, 7.5e-7 * increment, 0.0];
    });
    let chart = read(&drawn(&answers, "energy"), 0);
    let line = |slope: f64| (0..5).map(f64::from).map(|at| [at, slope * at]).collect();
    let lines: [Vec<[f64; 2]>; 3] = [1.5, 1.0, 0.5].map(line);
    chart.lines.iter().zip(&lines).for_each(|(got, want)| near(got, want));
    assert!(chart.texts.iter().any(|text| text.contains("Stored at the start: 3.000 µJ")));
}

#[test]
fn moduli_far_from_all_others_are_told_of_and_do_not_set_the_axis() {
    let answers = changed(30, |measures| {
        let moduli = measures.moduli.as_mut().unwrap();
        let usual = 80e6 + 1e5 * measures.increment as f64;
        moduli.bulk = if measures.increment == 11 { 4.2e12 } else { usual };
        (moduli.young, moduli.p_wave) = (f64::NAN, f64::NAN);
    });
    let chart = read(&drawn(&answers, "moduli"), 0);
    assert!((80.0..100.0).contains(&chart.top), "{}", chart.top);
    let told = chart.texts.join(" ");
    assert!(told.contains("secant modulus [MPa]"), "{told}");
    assert!(told.contains("1 value (4.200 TPa)"), "{told}");
    // 24 of 30 commands were served; the spike is out.
    assert_eq!(chart.lines[0].len(), 23);
}

#[test]
fn tangential_forces_have_a_distribution_of_their_own() {
    let answers = changed(1, |measures| {
        let network = measures.network.as_mut().unwrap();
        for (contact, force) in network.tangential_force.chunks_exact_mut(3).enumerate() {
            // Half of them 1 N and half 3 N: 0.5 and 1.5 of the mean.
            force.copy_from_slice(&[0.0, if contact < 20 { 1.0 } else { -3.0 }, 0.0]);
        }
    });
    let svg = drawn(&answers, "forces");
    let chart = read(&svg, 1);
    let told = chart.texts.join(" ");
    assert!(told.contains("tangential force f over its mean"), "{told}");
    assert!(told.contains("2.000 N at increment 0"), "{told}");
    // The middles of the bins of width 0.25 that hold 0.5 and 1.5.
    let middles: Vec<f64> = chart.lines[0].iter().map(|at| at[0]).collect();
    assert!((middles[0] - 0.625).abs() < 1e-3 && (middles[1] - 1.625).abs() < 1e-3, "{middles:?}");
}

#[test]
fn the_motion_is_drawn_from_increment_1_on_and_its_last_distribution_of_grains_that_carry() {
    let answers = changed(3, |measures| {
        let increment = measures.increment as f64;
        let state = measures.state.as_mut().unwrap();
        state.strain[2] = 1e-2 * increment;
        let motion = measures.motion.as_mut().unwrap();
        motion.localisation.non_affine_ratio = 10f64.powf(increment - 1.0);
        motion.localisation.participation = 0.1 * increment;
        motion.localisation.d2min_top_10 = 0.2 * increment;
        motion.localisation.band.spread = [0.25 * increment, 1.0, 2.0];
        // Of 13 grains the even ones carry load: four of them go 3 m, three 1 m.
        for (grain, way) in motion.non_affine.iter_mut().enumerate() {
            *way = [0.0, if grain < 8 { 3.0 } else { -1.0 }, 0.0];
        }
    });
    let svg = drawn(&answers, "motion");
    near(&read(&svg, 1).lines[0], &[[1.0, 0.1], [2.0, 0.2], [3.0, 0.3]]);
    near(&read(&svg, 1).lines[1], &[[1.0, 0.2], [2.0, 0.4], [3.0, 0.6]]);
    near(&read(&svg, 2).lines[0], &[[1.0, 0.25], [2.0, 0.5], [3.0, 0.75]]);
    near(&read(&svg, 2).lines[2], &[[1.0, 2.0], [2.0, 2.0], [3.0, 2.0]]);
    let strains: Vec<f64> = read(&svg, 0).lines[0].iter().map(|at| at[0]).collect();
    assert_eq!(strains.len(), 3);
    let distribution = read(&svg, 3);
    // Over their mean 15/7 m: 7/15 and 7/5, in the bins about 0.375 and 1.375.
    let middles: Vec<f64> = distribution.lines[0].iter().map(|at| at[0]).collect();
    assert!((middles[0] - 0.375).abs() < 1e-3 && (middles[1] - 1.375).abs() < 1e-3, "{middles:?}");
    let told = distribution.texts.join(" ");
    assert!(told.contains("Increment 3, 7 grains") && told.contains("2.143 m"), "{told}");
}

#[test]
fn a_run_in_which_nothing_moves_is_drawn_over_the_increments() {
    let still = changed(6, |measures| {
        let state = measures.state.as_mut().unwrap();
        state.strain = [0.0; 3];
        (state.confining_stress, state.deviatoric_stress) = (5e6, 0.0);
        measures.walls.displacement = [0.0; 6];
    });
    let svg = drawn(&still, "stress_strain");
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    let chart = read(&svg, 0);
    near(&chart.lines[0], &(0..6).map(|at| [f64::from(at), 5.0]).collect::<Vec<_>>());
    assert!(chart.texts.iter().any(|text| text == "increment"), "{:?}", chart.texts);
    // And the start alone.
    let chart = read(&drawn(&still[..1], "stress_strain"), 0);
    assert_eq!(chart.lines[0].len(), 1);
}

#[test]
fn of_a_bag_with_a_reset_the_longest_run_is_drawn_and_the_others_are_told_of() {
    let twice: Vec<_> = changed(3, |_| {}).into_iter().chain(changed(9, |_| {})).collect();
    let svg = drawn(&twice, "stress_strain");
    assert!(svg.contains("Run 2 of 2, the longest"), "{svg}");
    // The start and the eight of nine commands that were served.
    assert_eq!(read(&svg, 0).lines[0].len(), 9);
}
