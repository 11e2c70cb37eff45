//! Alive supervision of tasks: one of them feeds the watchdog, and only while all the others ran lately.

/// Tasks `0..N` that must be seen every so many ticks of the one that counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AliveSupervision<const N: usize> {
    patience: u16,
    left: [u16; N],
}

impl<const N: usize> AliveSupervision<N> {
    /// A task that was not seen for `patience` ticks is dead; everyone has a first chance.
    pub const fn new(patience: u16) -> Self {
        Self {
            patience,
            left: [patience; N],
        }
    }

    /// Task number `task` ran; panics if there is no such task.
    pub fn seen(&mut self, task: usize) {
        self.left[task] = self.patience;
    }

    /// A tick of the task that counts; true if all the others live: feed the watchdog.
    pub fn tick(&mut self) -> bool {
        for left in &mut self.left {
            *left = left.saturating_sub(1);
        }
        self.left.iter().all(|left| *left > 0)
    }
}

#[cfg(test)]
mod tests {
    use super::AliveSupervision;

    #[test]
    fn one_dead_task_is_enough_and_a_late_one_is_forgiven() {
        let mut supervision = AliveSupervision::<2>::new(4);
        for _ in 0..10 {
            assert!(supervision.tick());
            assert!(supervision.tick());
            supervision.seen(0);
            supervision.seen(1);
        }
        let mut alive = 0;
        for _ in 0..10 {
            supervision.seen(0);
            alive += u32::from(supervision.tick());
        }
        assert_eq!(alive, 3, "the fourth tick without task 1 is the last");
        supervision.seen(1);
        assert!(supervision.tick());
    }
}
