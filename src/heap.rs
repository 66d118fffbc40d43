//! Memory that lists hold.

/// Memory behind `list` \[bytes\].
pub(crate) fn bytes<T>(list: &Vec<T>) -> usize {
    list.capacity() * size_of::<T>()
}
