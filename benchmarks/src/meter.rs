//! Counting the instructions of one call.

use core::hint::black_box;

/// What counts, on the target the program runs on.
pub trait Meter {
    /// Makes the call by [`measured`]; the instructions that took, as far as the program itself can know.
    fn count(&mut self, call: &mut dyn FnMut()) -> u32;
}

/// Makes the call. Callgrind counts from where this function begins to where it ends, hence one that stays
/// whole, is called for nothing else, and does not leave its end to the call by jumping there.
#[inline(never)]
pub fn measured(call: &mut dyn FnMut()) {
    call();
    black_box(());
}
