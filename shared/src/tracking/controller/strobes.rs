//! When the cameras are triggered, and how late they were.

/// When the cameras are triggered.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strobes {
    /// At the last tick it was known where on the path the machine is, and where the slides are.
    pub(super) armed: bool,
    /// How long before the present tick the strobe was due, because ticks were lost \[µs\].
    pub(super) overdue_us: u64,
    any: bool,
    /// How late they were \[µs\].
    pub(super) least_late_us: u32,
    pub(super) most_late_us: u32,
}

impl Strobes {
    pub(super) const fn new() -> Self {
        Self {
            armed: false,
            overdue_us: 0,
            any: false,
            least_late_us: 0,
            most_late_us: 0,
        }
    }

    /// A strobe was `late_us` late.
    pub(super) fn was(&mut self, late_us: u32) {
        self.least_late_us = if self.any {
            self.least_late_us.min(late_us)
        } else {
            late_us
        };
        self.most_late_us = self.most_late_us.max(late_us);
        self.any = true;
    }
}
