//! Threads that work on parts together, order after order.
//!
//! An iteration of a linear solve is a few hundred microseconds of work between points where all
//! parts must have come: too short to put threads to sleep and to wake them each time. So a crew
//! stays awake for the whole solve. Its members take parts as they come; who is late, or never
//! comes, finds less to do, and nobody waits for him.
//!
//! The ticket alone says who may touch what. The locks tell the compiler so; none of them is ever
//! waited for.

use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};
use std::thread;

use crate::model::MOST_PARTS;

/// Looks for work before a member lets other programs run between two looks.
const PATIENCE: u32 = 1000;

/// The parts and what is to be done with them.
pub(super) struct Crew<'a, P, O, W> {
    parts: [Option<Mutex<&'a mut P>>; MOST_PARTS],
    count: usize,
    work: W,
    order: Mutex<O>,
    /// Number of the order in the upper half, of the next part to be taken in the lower.
    ticket: AtomicU64,
    /// Parts for which the order is carried out.
    done: AtomicUsize,
    dismissed: AtomicBool,
}

/// Calls `lead` with a crew for `parts`, at most [`MOST_PARTS`], of as many threads as there are
/// and as can find a part to do `work` on.
pub(super) fn together<'a, P, O, W, R>(
    parts: &'a mut [P],
    first: O,
    work: W,
    lead: impl FnOnce(&Crew<'a, P, O, W>) -> R + Send,
) -> R
where
    P: Send,
    O: Copy + Send,
    W: Fn(&mut P, O) + Sync + Send,
    R: Send,
{
    let count = parts.len();
    debug_assert!(count <= MOST_PARTS);
    let members = match count {
        1 => 1,
        several => several.min(rayon::current_num_threads()),
    };
    let mut parts = parts.iter_mut().map(Mutex::new);
    let crew = Crew {
        ticket: AtomicU64::new(count as u64),
        parts: std::array::from_fn(|_| parts.next()),
        count,
        work,
        order: Mutex::new(first),
        done: AtomicUsize::new(0),
        dismissed: AtomicBool::new(false),
    };
    if members == 1 {
        return lead(&crew);
    }
    rayon::in_place_scope(|scope| {
        for _ in 1..members {
            scope.spawn(|_| crew.serve());
        }
        // Also when `lead` panics.
        let _end = OnDrop(|| crew.dismissed.store(true, Ordering::Release));
        lead(&crew)
    })
}

impl<'a, P, O: Copy, W: Fn(&mut P, O)> Crew<'a, P, O, W> {
    /// Has every part worked on, and returns when that is done.
    pub(super) fn call(&self, order: O) {
        *lock(&self.order) = order;
        self.done.store(0, Ordering::Relaxed);
        let number = self.ticket.load(Ordering::Relaxed) >> 32;
        self.ticket.store((number + 1) << 32, Ordering::Release);
        while self.work_on_one() {}
        let mut looks = 0;
        while self.done.load(Ordering::Acquire) < self.count {
            look_again(&mut looks);
        }
    }

    /// The parts, between two orders.
    pub(super) fn parts(&self) -> impl Iterator<Item = MutexGuard<'_, &'a mut P>> {
        self.parts.iter().flatten().map(lock)
    }

    /// Carries out orders until there are no more to come.
    fn serve(&self) {
        let mut looks = 0;
        while !self.dismissed.load(Ordering::Acquire) {
            match self.work_on_one() {
                true => looks = 0,
                false => look_again(&mut looks),
            }
        }
    }

    /// Takes a part and works on it, if one is left.
    fn work_on_one(&self) -> bool {
        let ticket = self.ticket.load(Ordering::Acquire);
        let part = (ticket & u64::from(u32::MAX)) as usize;
        let Some(Some(part)) = self.parts.get(part) else { return false };
        // As long as a part is left the order stands. If it went while the order was read, and
        // perhaps another came, the ticket is not the same any more.
        let order = *lock(&self.order);
        let taken =
            self.ticket.compare_exchange(ticket, ticket + 1, Ordering::AcqRel, Ordering::Relaxed);
        if taken.is_ok() {
            // Also when `work` panics, which the scope of the threads passes on.
            let _done = OnDrop(|| {
                self.done.fetch_add(1, Ordering::Release);
            });
            (self.work)(*lock(part), order);
        }
        true
    }
}

/// What was locked; where a thread panicked inside, the panic itself is passed on elsewhere.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What is locked, to look at; see [`lock`].
pub(super) fn read<T>(shared: &RwLock<T>) -> RwLockReadGuard<'_, T> {
    shared.read().unwrap_or_else(PoisonError::into_inner)
}

/// What is locked, to change it; see [`lock`].
pub(super) fn write<T>(shared: &RwLock<T>) -> RwLockWriteGuard<'_, T> {
    shared.write().unwrap_or_else(PoisonError::into_inner)
}

/// Waits a moment.
fn look_again(looks: &mut u32) {
    *looks += 1;
    match *looks < PATIENCE {
        true => std::hint::spin_loop(),
        false => thread::yield_now(),
    }
}

struct OnDrop<F: FnMut()>(F);

impl<F: FnMut()> Drop for OnDrop<F> {
    fn drop(&mut self) {
        (self.0)();
    }
}

#[cfg(test)]
mod tests {
    use std::panic::AssertUnwindSafe;

    use super::*;

    #[test]
    fn every_order_is_carried_out_once_on_every_part_before_the_next() {
        for threads in [1, 2, 7] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let mut parts = vec![Vec::new(); 8];
            pool.expect("threads").install(|| {
                together(&mut parts, 0, Vec::push, |crew| {
                    for order in 1..=2000 {
                        crew.call(order);
                        assert!(crew.parts().all(|part| part.len() == order));
                    }
                });
            });
            let want: Vec<usize> = (1..=2000).collect();
            assert!(parts.iter().all(|part| *part == want), "{threads} threads");
        }
    }

    #[test]
    fn a_panic_of_a_member_is_passed_on() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
        let fails = |part: &mut u32, order: u32| assert_ne!(*part, order);
        let mut parts = [1, 2, 3, 4];
        let result = std::panic::catch_unwind(AssertUnwindSafe(|| {
            pool.install(|| {
                together(&mut parts, 0, fails, |crew| (0..=5).for_each(|k| crew.call(k)));
            });
        }));
        assert!(result.is_err());
    }
}
