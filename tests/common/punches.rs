//! A contact of many rigid punches on a line, moved a little at a time: an independent reader of
//! the law of Mindlin and Deresiewicz.

use graintwin::contact::partial_slip::Contact;

/// Punches of equal width in overlap; each may be displaced by ±`width` in units of μ/η.
pub(crate) struct Punches {
    contact: Contact,
    width: f64,
    /// Hertz' slope \[N/m\] of each punch that touched so far.
    slope: Vec<f64>,
    taken: Vec<f64>,
}

impl Punches {
    /// No punch touches yet; each adds `width` \[m\] to the overlap.
    pub(crate) fn new(contact: Contact, width: f64) -> Self {
        Self { contact, width, slope: Vec::new(), taken: Vec::new() }
    }

    /// Brings `punches` more into contact, or fewer, and displaces by `u` \[m\] along the force,
    /// in small equal parts. Returns the work \[J\].
    pub(crate) fn drive(&mut self, punches: i64, u: f64) -> f64 {
        let parts = punches.abs().max(200);
        let unit = self.contact.friction / self.contact.ratio;
        let mut work = 0.0;
        for part in 0..parts {
            let before = self.force();
            let mut rest = u / unit / parts as f64;
            // `parts` is at least |punches|, so this is -1, 0 or 1.
            match punches * (part + 1) / parts - punches * part / parts {
                1 => self.touch(),
                -1 => rest += self.taken.pop().unwrap_or(0.0),
                _ => {}
            }
            for punch in self.taken.iter_mut().rev() {
                let moved = (*punch + rest).clamp(-self.width, self.width);
                rest -= moved - *punch;
                *punch = moved;
                if rest == 0.0 {
                    break;
                }
            }
            work += 0.5 * (before + self.force()) * u / parts as f64;
        }
        work
    }

    pub(crate) fn overlap(&self) -> f64 {
        self.taken.len() as f64 * self.width
    }

    fn touch(&mut self) {
        let normal = |k: usize| self.contact.modulus * (k as f64 * self.width).powf(1.5);
        let k = self.taken.len();
        if k == self.slope.len() {
            self.slope.push((normal(k + 1) - normal(k)) / self.width);
        }
        self.taken.push(0.0);
    }

    /// Tangential force \[N\].
    pub(crate) fn force(&self) -> f64 {
        let sum: f64 = self.taken.iter().zip(&self.slope).map(|(taken, slope)| taken * slope).sum();
        self.contact.friction * sum
    }

    /// Energy \[J\] of the punches: each moves against its own force and lifts those inside it.
    pub(crate) fn stored(&self) -> f64 {
        let (mut inside, mut sum) = (0.0, 0.0);
        for (taken, slope) in self.taken.iter().zip(&self.slope) {
            sum += (inside + 0.5 * taken * slope) * taken;
            inside += taken * slope;
        }
        self.contact.friction.powi(2) / self.contact.ratio * sum
    }
}
