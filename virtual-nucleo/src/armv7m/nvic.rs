//! Which exceptions are pending, active and due (ARMv7-M B1.5, B3.4).

use crate::cpu::Masks;

/// Numbers of the core's own exceptions.
pub const NMI: u16 = 2;
/// Hard fault.
pub const HARD_FAULT: u16 = 3;
/// Memory management fault.
pub const MEMORY_MANAGEMENT: u16 = 4;
/// Bus fault.
pub const BUS_FAULT: u16 = 5;
/// Usage fault.
pub const USAGE_FAULT: u16 = 6;
/// Supervisor call.
pub const SVCALL: u16 = 11;
/// Pended by software.
pub const PENDSV: u16 = 14;
/// System timer.
pub const SYSTICK: u16 = 15;
/// The first interrupt of the chip.
pub const FIRST_INTERRUPT: u16 = 16;

/// Interrupts of the STM32H723 (RM0468, 19.1.2), and the exceptions before them.
const EXCEPTIONS: usize = FIRST_INTERRUPT as usize + 163;
/// Bits of a priority that the chip has.
const PRIORITY_BITS: u8 = 0xf0;
/// Priority of code that is no handler.
const THREAD: i16 = 256;

#[derive(Clone, Copy, Debug, Default)]
struct Exception {
    enabled: bool,
    pending: bool,
    active: bool,
    priority: u8,
}

/// The interrupt controller.
#[derive(Clone, Debug)]
pub struct Nvic {
    exceptions: [Exception; EXCEPTIONS],
    /// AIRCR.PRIGROUP: priorities that differ only below bit `group` + 1 do not preempt each other.
    group: u8,
    /// The pending exception that comes first.
    first: Option<u16>,
    /// Active exceptions, the running one last.
    active: Vec<u16>,
}

impl Default for Nvic {
    fn default() -> Self {
        let mut exceptions = [Exception::default(); EXCEPTIONS];
        for exception in &mut exceptions[..usize::from(FIRST_INTERRUPT)] {
            exception.enabled = true;
        }
        Self {
            exceptions,
            group: 0,
            first: None,
            active: Vec::new(),
        }
    }
}

impl Nvic {
    /// The pending exception that comes first, whatever holds it back.
    pub fn first(&self) -> Option<u16> {
        self.first
    }

    /// Exception that runs; 0 is none.
    pub fn running(&self) -> u16 {
        self.active.last().copied().unwrap_or(0)
    }

    /// How many exceptions are active.
    pub fn nested(&self) -> usize {
        self.active.len()
    }

    /// The exception that is to be taken now.
    pub fn due(&self, masks: Masks) -> Option<u16> {
        self.first
            .filter(|&number| self.group_priority(number) < self.execution_priority(masks))
    }

    /// Whether a fault of this number would be taken where execution stands.
    pub fn can_take(&self, number: u16, masks: Masks) -> bool {
        self.group_priority(number) < self.execution_priority(masks)
    }

    /// Priority of what runs, with what is masked (ARMv7-M B1.5.4).
    pub fn execution_priority(&self, masks: Masks) -> i16 {
        let mut priority = THREAD;
        for &number in &self.active {
            priority = priority.min(self.group_priority(number));
        }
        if masks.basepri != 0 {
            priority = priority.min(self.grouped(masks.basepri & PRIORITY_BITS));
        }
        if masks.primask {
            priority = priority.min(0);
        }
        if masks.faultmask {
            priority = priority.min(-1);
        }
        priority
    }

    /// Makes an exception pending.
    pub fn pend(&mut self, number: u16) {
        self.change(number, |exception| exception.pending = true);
    }

    /// Takes that back.
    pub fn unpend(&mut self, number: u16) {
        self.change(number, |exception| exception.pending = false);
    }

    /// Enables an interrupt or disables it.
    pub fn enable(&mut self, number: u16, enabled: bool) {
        self.change(number, |exception| exception.enabled = enabled);
    }

    /// Sets a priority; the bits that the chip does not have are dropped.
    pub fn set_priority(&mut self, number: u16, priority: u8) {
        self.change(number, |exception| exception.priority = priority & PRIORITY_BITS);
    }

    /// Sets AIRCR.PRIGROUP.
    pub fn set_group(&mut self, group: u8) {
        self.group = group & 7;
        self.look();
    }

    /// Priority as it was set.
    pub fn priority(&self, number: u16) -> u8 {
        self.of(number).priority
    }

    /// Whether an exception is pending.
    pub fn is_pending(&self, number: u16) -> bool {
        self.of(number).pending
    }

    /// Whether an interrupt is enabled.
    pub fn is_enabled(&self, number: u16) -> bool {
        self.of(number).enabled
    }

    /// Whether an exception is active.
    pub fn is_active(&self, number: u16) -> bool {
        self.of(number).active
    }

    /// The handler of `number` begins.
    pub fn activate(&mut self, number: u16) {
        self.active.push(number);
        self.change(number, |exception| {
            exception.pending = false;
            exception.active = true;
        });
    }

    /// The running handler ends.
    pub fn deactivate(&mut self) {
        if let Some(number) = self.active.pop() {
            self.change(number, |exception| exception.active = false);
        }
    }

    fn of(&self, number: u16) -> Exception {
        self.exceptions
            .get(usize::from(number))
            .copied()
            .unwrap_or_default()
    }

    /// Numbers that the chip does not have are left alone, as their bits in the registers are.
    fn change(&mut self, number: u16, change: impl FnOnce(&mut Exception)) {
        if let Some(exception) = self.exceptions.get_mut(usize::from(number)) {
            change(exception);
            self.look();
        }
    }

    fn look(&mut self) {
        let waiting = |number: &u16| {
            let exception = self.of(*number);
            exception.pending && exception.enabled
        };
        self.first = (NMI..EXCEPTIONS as u16)
            .filter(waiting)
            .min_by_key(|&number| (self.full_priority(number), number));
    }

    fn full_priority(&self, number: u16) -> i16 {
        match number {
            NMI => -2,
            HARD_FAULT => -1,
            _ => i16::from(self.of(number).priority),
        }
    }

    fn group_priority(&self, number: u16) -> i16 {
        match self.full_priority(number) {
            fixed if fixed < 0 => fixed,
            priority => self.grouped(priority as u8),
        }
    }

    fn grouped(&self, priority: u8) -> i16 {
        i16::from(priority) & !((2 << self.group) - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPEN: Masks = Masks {
        primask: false,
        faultmask: false,
        basepri: 0,
    };

    fn with(priorities: &[(u16, u8)]) -> Nvic {
        let mut nvic = Nvic::default();
        for &(number, priority) in priorities {
            nvic.set_priority(number, priority);
            nvic.enable(number, true);
            nvic.pend(number);
        }
        nvic
    }

    #[test]
    fn the_lower_value_comes_first_and_of_equals_the_lower_number() {
        let mut nvic = with(&[(40, 0x20), (30, 0x20), (50, 0x30)]);
        for expected in [30, 40, 50] {
            assert_eq!(nvic.due(OPEN), Some(expected));
            nvic.activate(expected);
            nvic.deactivate();
        }
        assert_eq!(nvic.due(OPEN), None);
    }

    #[test]
    fn only_a_higher_priority_preempts() {
        let mut nvic = with(&[(40, 0x20)]);
        nvic.activate(40);
        for (number, priority) in [(41, 0x20), (42, 0x30)] {
            nvic.set_priority(number, priority);
            nvic.enable(number, true);
            nvic.pend(number);
            assert_eq!(nvic.due(OPEN), None, "{number}");
        }
        nvic.set_priority(42, 0x10);
        assert_eq!(nvic.due(OPEN), Some(42));
    }

    #[test]
    fn masks_hold_back_what_they_are_made_for() {
        let nvic = with(&[(40, 0x20)]);
        let basepri = |basepri| Masks { basepri, ..OPEN };
        assert_eq!(nvic.due(basepri(0x20)), None);
        assert_eq!(nvic.due(basepri(0x30)), Some(40));
        let primask = Masks {
            primask: true,
            ..OPEN
        };
        assert_eq!(nvic.due(primask), None);
        let mut nvic = nvic;
        nvic.pend(HARD_FAULT);
        assert_eq!(nvic.due(primask), Some(HARD_FAULT));
        let faultmask = Masks {
            faultmask: true,
            ..OPEN
        };
        assert_eq!(nvic.due(faultmask), None);
        nvic.pend(NMI);
        assert_eq!(nvic.due(faultmask), Some(NMI));
    }

    #[test]
    fn priorities_of_one_group_do_not_preempt_each_other() {
        let mut nvic = with(&[(40, 0x20), (41, 0x10)]);
        nvic.activate(40);
        assert_eq!(nvic.due(OPEN), Some(41));
        // Two bits of group, two of sub-priority.
        nvic.set_group(5);
        assert_eq!(nvic.due(OPEN), None);
    }

    #[test]
    fn an_interrupt_that_is_not_enabled_waits() {
        let mut nvic = Nvic::default();
        nvic.pend(60);
        assert_eq!(nvic.due(OPEN), None);
        nvic.enable(60, true);
        assert_eq!(nvic.due(OPEN), Some(60));
    }
}
