//! What theory predicts of a pack of discs, and what is read off its tests.
//!
//! B is van Baars' thesis (see README), numbers in brackets its equations; where its print is wrong
//! the formula here is derived anew and `docs/analytic.md` says what differs. All of it are functions
//! of numbers and slices that know nothing of the solver.
//!
//! | symbol | meaning | unit |
//! | --- | --- | --- |
//! | σ1, σ3 | major and minor principal stress, compression positive | Pa |
//! | φ', c', ψ | angle of internal friction, cohesion, angle of dilatancy | rad, Pa, rad |
//! | β | angle from the x-axis to the major principal direction | rad |
//! | n_c/v = n_c d̄³/V | contacts in the volume of a cube as wide as the mean grain | 1 |
//! | κ = ks/kn | stiffness of a contact along its plane over that across it | 1 |
//!
//! Shear strains are the tensor's own, half of γ, unless the name says `gamma`.

pub mod bend;
pub mod cemented;
pub mod contact;
pub mod crystal;
pub mod cylinder;
pub mod fit;
pub mod flow;
pub mod forces;
pub mod hooke;
pub mod model;
pub mod sand;
pub mod shear;
pub mod sliding;
pub mod strength;
pub mod tensor;
