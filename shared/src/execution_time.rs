//! How long tasks take that interrupt each other, by a counter of cycles that wraps.

/// What a task takes that interrupts others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExecutionTime {
    total: u32,
    longest: u32,
}

/// A task that began and may be interrupted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    begin: u32,
    total: u32,
}

impl ExecutionTime {
    /// Of a task that never ran.
    pub const fn new() -> Self {
        Self { total: 0, longest: 0 }
    }

    /// The task ran from cycle `begin` to `end`, and did what a real board does too from cycle `own` on.
    pub fn add(&mut self, begin: u32, own: u32, end: u32) {
        self.total = self.total.wrapping_add(end.wrapping_sub(begin));
        self.longest = self.longest.max(end.wrapping_sub(own));
    }

    /// The task ran for so many cycles, without what interrupted it.
    pub fn add_net(&mut self, took: u32) {
        self.total = self.total.wrapping_add(took);
        self.longest = self.longest.max(took);
    }

    /// Cycles of the task since another began.
    pub fn since(&self, span: Span) -> u32 {
        self.total.wrapping_sub(span.total)
    }

    /// Cycles of the longest run since this was asked last, without what only an emulated board does.
    pub fn take_longest(&mut self) -> u32 {
        core::mem::take(&mut self.longest)
    }

    /// Another task begins at cycle `now`, which this one may interrupt.
    pub fn span(&self, now: u32) -> Span {
        Span {
            begin: now,
            total: self.total,
        }
    }

    /// Cycles of that other task alone, which ends at cycle `now`, less than a wrap after it began.
    pub fn without(&self, span: Span, now: u32) -> u32 {
        now.wrapping_sub(span.begin).wrapping_sub(self.since(span))
    }
}

#[cfg(test)]
mod tests {
    use super::ExecutionTime;

    #[test]
    fn an_interrupted_task_is_counted_without_what_interrupted_it_through_a_wrap() {
        let mut servo = ExecutionTime::new();
        servo.add(100, 100, 150);
        assert_eq!((servo.take_longest(), servo.take_longest()), (50, 0));
        let path = servo.span(u32::MAX - 9);
        servo.add(u32::MAX - 4, u32::MAX - 4, 15);
        servo.add(40, 40, 50);
        assert_eq!(servo.without(path, 90), 100 - 20 - 10);
        assert_eq!(servo.take_longest(), 20);
    }

    #[test]
    fn what_only_an_emulated_board_does_interrupts_others_and_is_not_counted_as_the_task_s() {
        let mut servo = ExecutionTime::new();
        let path = servo.span(0);
        servo.add(10, 40, 50);
        assert_eq!(servo.without(path, 100), 60);
        assert_eq!(servo.take_longest(), 10);
    }
}
