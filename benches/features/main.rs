//! What each feature costs, off and on: `cargo bench --bench features`.
//!
//! The benchmark job (ten uniaxial increments of 1e-4 on 2740 glass beads at 10 MPa, one thread) in
//! variants that differ in one feature. A feature that is off costs nothing when evaluations,
//! products, instructions and allocations are those of the first row and forces and positions have
//! the same bits. Times are CPU times of the whole process, the shortest of [`ROUNDS`] of each
//! increment; variants take turns. Instructions are counted by callgrind when valgrind is
//! installed, over the first increments, apart for the solver and for the thread that serves:
//! command gate, measures and handing over.
//!
//! The subscriber and the node meet over loopback. Words as arguments choose the features that have
//! one of them in their name: `-- motion network`.
#![allow(clippy::print_stdout, clippy::expect_used)] // A bench prints, and ends when its input is not there.

#[path = "../common/callgrind.rs"]
mod callgrind;
mod heap;
mod linked;
mod listen;
mod variant;
mod walk;

use callgrind::instructions;
use variant::{Variant, variants};
use walk::{COUNTED, Walk, count, walk};

/// Walks of each variant.
const ROUNDS: usize = 5;

fn main() {
    if let Some(order) = callgrind::order() {
        let (number, part) = order.split_once(' ').expect("a number and a part");
        let number: usize = number.parse().expect("a number");
        return count(&variants()[number], part);
    }
    // Cargo adds an argument of its own.
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    let chosen = |(number, variant): &(usize, Variant)| {
        *number == 0 || words.is_empty() || words.iter().any(|word| variant.feature.contains(word))
    };
    let variants: Vec<(usize, Variant)> =
        variants().into_iter().enumerate().filter(chosen).collect();
    let mut walks: Vec<Walk> = variants.iter().map(|(_, variant)| walk(variant)).collect();
    for _ in 1..ROUNDS {
        for ((_, variant), best) in variants.iter().zip(&mut walks) {
            best.shorten(&walk(variant));
        }
    }
    println!(
        "| feature | | CPU ms an increment, mean | evaluations | products | instructions of the solver, 10⁶ | of the serving thread, 10⁶ | allocations | bits |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for ((number, variant), walk) in variants.iter().zip(&walks) {
        let millions = |part: &str| {
            let counted = variant.listens.is_deterministic();
            let all = counted.then(|| instructions(&format!("{number} {part}"))).flatten();
            let one = all.map(|all| 1e-6 * all / COUNTED as f64);
            one.map_or("-".into(), |one| format!("{one:.2}"))
        };
        println!(
            "| {} | {} | {:.1} | {} | {} | {} | {} | {} | {} |",
            variant.feature,
            variant.setting,
            1e3 * walk.seconds.iter().sum::<f64>() / walk.seconds.len() as f64,
            median(&walk.gradients),
            median(&walk.products),
            millions("solver"),
            millions("serving"),
            median(&walk.allocations),
            if walk.bits == walks[0].bits { "same" } else { "other" },
        );
    }
}

fn median(of: &[f64]) -> f64 {
    let mut sorted = of.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}
