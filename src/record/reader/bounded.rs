//! Reading as much as there is, and no more memory for it than has come.

use std::io::{self, Read};

/// Room for what comes first.
const PIECE: usize = 64 << 10;

/// Appends what `from` gives until `into` has `length` bytes. Whether it has; if not, `from` has
/// ended. What came before an error is in `into`.
pub(super) fn fill(from: &mut dyn Read, into: &mut Vec<u8>, length: usize) -> io::Result<bool> {
    while into.len() < length {
        let wanted = (length - into.len()).min(into.len().max(PIECE));
        into.try_reserve_exact(wanted).map_err(|_| io::ErrorKind::OutOfMemory)?;
        if from.take(wanted as u64).read_to_end(into)? < wanted {
            return Ok(false);
        }
    }
    Ok(true)
}
