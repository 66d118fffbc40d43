//! The biaxial test on dense sand, in small: what B 3.2 finds of 1000 grains.

use graintwin::report::ContactState;

use crate::discs::*;

#[test]
fn dense_sand_contracts_dilates_and_fails_as_in_the_thesis() {
    let pack = dense(10, 25, 1, 1e5, 0.6);
    let (mut rig, report) = Rig::new(&sand("0.6"), &pack);
    let start = report.measures.unwrap().state.unwrap();
    // Table 2: a dense sample has 4.0 contacts a grain, 3.3 at failure (fig. 13).
    assert!((3.7..4.2).contains(&start.coordination_number), "{}", start.coordination_number);
    let height = pack.bounds.sides()[1];
    let (mut peak, mut least, mut half) = (0.0_f64, 0.0_f64, None);
    let mut last = start;
    for k in 1..=200 {
        let strain = 1e-4 * f64::from(k);
        let state = rig.biaxial(1e5, 0.5 * strain * height).state.unwrap();
        assert!((state.stress_walls[0] / 1e5 - 1.0).abs() < 1e-6);
        let ratio = state.stress_walls[4] / 1e5;
        peak = peak.max(ratio);
        least = least.max(state.strain[0] + state.strain[1]);
        half = half.or((ratio > 2.0).then(|| 1e5 * (ratio - 1.0) / strain));
        last = state;
    }
    let friction_angle = ((peak - 1.0) / (peak + 1.0)).asin().to_degrees();
    assert!((26.0..36.0).contains(&friction_angle), "{friction_angle}");
    // Table 4: 48 MPa at half the strength.
    let young = half.unwrap() / 1e6;
    assert!((35.0..60.0).contains(&young), "{young}");
    let volume = last.strain[0] + last.strain[1];
    assert!(least > 5e-4 && volume < -5e-3, "{least} {volume}");
    assert!((3.0..3.6).contains(&last.coordination_number), "{}", last.coordination_number);
    assert!(last.slip_energy > 0.0 && last.sliding_ratio > 0.05);
}

#[test]
fn nothing_slides_on_walls_without_friction() {
    let pack = dense(8, 12, 3, 1e5, 0.6);
    let (mut rig, _) = Rig::new(&sand("0.6"), &pack);
    let mut sliding = [0; 2];
    for k in 1..=20 {
        let measures = rig.biaxial(1e5, 1e-4 * f64::from(k) * pack.bounds.sides()[1]);
        let network = measures.network.unwrap();
        for (second, state) in network.second.iter().zip(&network.state) {
            let wall = usize::from(*second as usize >= pack.grains.len());
            sliding[wall] += u32::from(*state == ContactState::Slide as u8);
        }
    }
    let [between_grains, on_walls] = sliding;
    assert!(between_grains > 100 && on_walls == 0, "{sliding:?}");
}
