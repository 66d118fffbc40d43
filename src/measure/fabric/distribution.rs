//! Histograms of forces.

use crate::measure::contacts::Contact;

/// Width of a bin of [`forces`], over the mean force.
pub const FORCE_BIN: f64 = 0.25;

/// Bins of [`forces`]: up to 12.5 times the mean, the last with all that is beyond.
pub const FORCE_BINS: usize = 50;

/// Width of a bin of [`mobilised`].
pub const MOBILISED_BIN: f64 = 0.05;

/// Bins of [`mobilised`]: up to the limit, the last with all that is beyond.
pub const MOBILISED_BINS: usize = 20;

/// Contacts by magnitude of the normal force over the `mean`.
#[must_use]
pub fn forces(contacts: &[&Contact], mean: f64) -> Vec<u32> {
    let values = contacts.iter().map(|contact| contact.force.abs() / mean);
    histogram(values, FORCE_BIN, FORCE_BINS)
}

/// Contacts by tangential force over its `limit` μP, those without a limit left out. A limit that
/// was frozen may be exceeded where the normal force has fallen since.
#[must_use]
pub fn mobilised(contacts: &[&Contact], limit: impl Fn(&Contact) -> f64) -> Vec<u32> {
    let rubbing = contacts.iter().map(|contact| (contact.shear.norm(), limit(contact)));
    let values = rubbing.filter(|(_, limit)| *limit > 0.0).map(|(shear, limit)| shear / limit);
    histogram(values, MOBILISED_BIN, MOBILISED_BINS)
}

/// How many `values`, none negative, are in each of `bins` bins from 0 on.
fn histogram(values: impl Iterator<Item = f64>, width: f64, bins: usize) -> Vec<u32> {
    let mut counts = vec![0; bins];
    for value in values {
        // The cast takes what is too large to the largest number there is.
        counts[((value / width) as usize).min(bins - 1)] += 1;
    }
    counts
}
