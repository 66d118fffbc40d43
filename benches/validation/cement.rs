//! T 4.8, figures 4.7 to 4.12: Young's modulus of cemented quartz under uniaxial stress, by the law
//! of the cement and its constants.

mod course;
mod figures;
mod runs;
mod sample;
mod tables;

pub(crate) use figures::sheets;
pub(crate) use runs::Samples;
pub(crate) use tables::print;

/// The runs of `seeds`.
pub(crate) fn run(seeds: &[u64]) -> Samples {
    Samples { seeds: seeds.iter().map(|&seed| runs::Sample::run(seed)).collect() }
}
