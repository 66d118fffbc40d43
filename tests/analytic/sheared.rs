//! Shear tests of the bilinear material, by taking the strains of their curves apart.

use graintwin::analytic::flow;
use graintwin::analytic::hooke::Hooke;
use graintwin::analytic::model::Bilinear;
use graintwin::analytic::shear::{Sheared, simple, true_simple};
use graintwin::analytic::strength::{Mechanism, MohrCoulomb};
use graintwin::analytic::tensor::Tensor;

use crate::{close, near};

fn sand(dilatancy: f64) -> Bilinear {
    Bilinear {
        elastic: Hooke { young: 44e6, poisson: 0.17 },
        strength: MohrCoulomb { friction: 28.6_f64.to_radians(), cohesion: 0.0 },
        dilatancy,
    }
}

/// Plastic strain between two places and the stress halfway.
fn plastic(material: &Bilinear, [one, other]: [&Sheared; 2]) -> (Tensor, Tensor) {
    let total = Tensor {
        xx: other.lateral_strain - one.lateral_strain,
        yy: other.vertical_strain - one.vertical_strain,
        xy: 0.5 * (other.gamma - one.gamma),
    };
    let elastic = material.elastic.strain(&other.stress.since(&one.stress));
    let [a, b] = [one.stress, other.stress];
    let middle = Tensor { xx: 0.5 * (a.xx + b.xx), yy: a.yy, xy: 0.5 * (a.xy + b.xy) };
    (total.since(&elastic), middle)
}

/// Checks A.13, A.15 and A.16 between two places.
fn flows(material: &Bilinear, places: [&Sheared; 2], tolerance: f64) {
    let (strain, stress) = plastic(material, places);
    near(material.strength.excess(&places[1].stress), 0.0, 1e-12 * stress.yy);
    near(strain.direction().unwrap(), stress.direction().unwrap(), tolerance);
    let psi = flow::dilatancy(strain.major(), strain.minor()).unwrap();
    near(psi, material.dilatancy, tolerance);
}

#[test]
fn simple_shear_is_elastic_and_then_flows() {
    for (psi, cohesion) in [(0.3, 0.0), (0.0, 0.0), (0.25, 2e4)] {
        let mut material = sand(psi);
        material.strength.cohesion = cohesion;
        for [xx, yy] in [[1e5, 1e5], [1e5, 2e5], [1.5e5, 1e5]] {
            let at = |gamma: f64| simple(&material, xx, yy, gamma).unwrap();
            let limit = material.strength.shear(xx, yy).unwrap();
            let failing = limit / material.elastic.shear_modulus();
            close(at(0.5 * failing).stress.xy, 0.5 * limit, 1e-14);
            assert_eq!(at(0.5 * failing).vertical_strain, 0.0);
            flows(&material, [&at(2.0 * failing), &at(3.0 * failing)], 1e-10);
        }
        assert!(simple(&material, 1e4, 9e5, 0.01).is_none());
    }
}

#[test]
fn true_simple_shear_flows_at_a_constant_width() {
    // From isotropic, from at rest, and from beyond the end.
    for (psi, xx, cohesion) in
        [(0.2, 1e5, 0.0), (0.3, 0.6e5, 0.0), (0.0, 0.5e5, 0.0), (0.1, 1.4e5, 0.0), (0.2, 1e5, 2e4)]
    {
        let mut material = sand(psi);
        material.strength.cohesion = cohesion;
        let gamma: Vec<f64> = (0..2000).map(|place| 1e-5 * f64::from(place)).collect();
        let curve = true_simple(&material, xx, 1e5, &gamma).unwrap();
        assert_eq!(curve.len(), gamma.len());
        let limit = material.strength.shear(xx, 1e5).unwrap();
        let failing = limit / material.elastic.shear_modulus();
        for pair in curve.windows(2) {
            assert_eq!(pair[1].lateral_strain, 0.0);
            if pair[1].gamma < failing {
                close(1.0 + pair[1].stress.xy, 1.0 + 18.803_418_8e6 * pair[1].gamma, 1e-8);
                assert_eq!(pair[1].stress.xx, xx);
            } else if pair[0].gamma > failing {
                // The stress halfway is known to the square of the step.
                flows(&material, [&pair[0], &pair[1]], 1e-5);
            }
        }
    }
}

#[test]
fn true_simple_shear_ends_where_the_width_wants_to_stay() {
    for psi in [0.0, 0.15, 28.6_f64.to_radians()] {
        let material = sand(psi);
        let end = true_simple(&material, 1e5, 1e5, &[0.1, 0.5, 0.500_01]).unwrap();
        let sines = material.strength.friction.sin() * psi.sin();
        close(end[1].stress.xx, 1e5 * (1.0 + sines) / (1.0 - sines), 1e-8);
        // Davis' strength of the box, and a height that grows by tan ψ.
        let shear = material.strength.friction.sin() * psi.cos() / (1.0 - sines);
        close(end[1].stress.xy, 1e5 * shear, 1e-8);
        let growth = (end[1].vertical_strain - end[2].vertical_strain) / 1e-5;
        near(growth, psi.tan(), 1e-7);
    }
    // Associated flow is horizontal sliding (28).
    let friction = sand(0.0).strength.friction;
    let end = true_simple(&sand(friction), 1e5, 1e5, &[0.5]).unwrap();
    let horizontal = Mechanism::Horizontal.lateral_stress(friction).unwrap();
    close(end[0].stress.xx / 1e5, horizontal, 1e-8);
}

#[test]
fn the_biaxial_test_is_bilinear() {
    let material = sand(0.2);
    let failing = material.failure_strain(1e5);
    let at = |strain: f64| material.biaxial(1e5, strain);
    close(at(failing).major, material.strength.major(1e5), 1e-14);
    assert_eq!(at(2.0 * failing).major, at(failing).major);
    // Elastic: Hooke's strain of the added stress.
    let added = Tensor { xx: 0.0, yy: at(0.5 * failing).major - 1e5, xy: 0.0 };
    let strain = material.elastic.strain(&added);
    close(strain.yy, 0.5 * failing, 1e-14);
    close(at(0.5 * failing).area_strain, 2.0 * strain.mean(), 1e-14);
    // Plastic: ψ of what is added.
    let area = at(2.0 * failing).area_strain - at(failing).area_strain;
    close(flow::dilatancy(failing, area - failing).unwrap(), 0.2, 1e-13);
}
