//! What a recording tells of cement.

use crate::msg::Cracks;

/// Bonds and cracks of one run.
#[derive(Debug, Default)]
pub struct Cement {
    /// How many bonds there are, increment by increment.
    pub standing: Vec<Standing>,
    /// Where bonds broke \[m\]: by tension, and by shear.
    pub places: [Vec<[f64; 3]>; 2],
    /// All of them in order.
    pub order: Vec<Broken>,
}

/// A bond that broke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Broken {
    /// The increment.
    pub increment: u64,
    /// Middle of the contact \[m\].
    pub at: [f64; 3],
    /// Unit normal of the contact.
    pub normal: [f64; 3],
}

/// Bonds at the end of an increment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Standing {
    /// The increment.
    pub increment: u64,
    /// Those that hold.
    pub intact: u32,
    /// Those that broke so far: by tension, and by shear.
    pub broken: [u32; 2],
}

impl Cement {
    /// Takes the cracks of an increment, or a chunk of them.
    pub(in crate::view) fn add(&mut self, cracks: &Cracks) {
        let Cracks { increment, intact, broken_by_tension, broken_by_shear, .. } = *cracks;
        if cracks.chunk == 0 {
            let broken = [broken_by_tension, broken_by_shear];
            self.standing.push(Standing { increment, intact, broken });
        }
        for (mode, at) in cracks.mode.iter().zip(cracks.position.as_chunks().0) {
            self.places[usize::from(*mode != Cracks::TENSION)].push(*at);
        }
        let places = cracks.position.as_chunks().0.iter().zip(cracks.normal.as_chunks().0);
        self.order.extend(places.map(|(&at, &normal)| Broken { increment, at, normal }));
    }
}
