//! The peripherals that are modelled.

use super::ethernet::Ethernet;
use super::exti::{Exti, VOLTAGE_DETECTOR};
use super::map::{Map, RccBit};
use super::rcc::Rcc;
use super::shared::{Peripheral, Reset, Shared};
use super::spi::Spi;
use super::supply::{FlashInterface, Pwr, Syscfg};
use super::timer::Timer;
use super::watchdog::Watchdog;
use crate::time::Time;

/// All of them.
pub struct Models {
    /// The clock controller, which is asked by all others.
    pub rcc: Rcc,
    pwr: Pwr,
    exti: Exti,
    /// The Ethernet controller; taken out while it uses memory.
    pub ethernet: Option<Box<Ethernet>>,
    /// By their place in the map.
    kinds: Vec<Kind>,
    /// Bit of the clock controller that holds each in reset.
    resets: Vec<Option<RccBit>>,
    /// When each has to be looked at.
    due: Vec<Time>,
}

enum Kind {
    /// Not modelled.
    None,
    Rcc,
    Pwr,
    Exti,
    Ethernet,
    /// The ports of pins, by number.
    Port(usize),
    /// The registers of the debug unit read as zero: no debugger is there.
    Debug,
    Other(Box<dyn Peripheral>),
}

fn kind(name: &'static str) -> Kind {
    let other: Box<dyn Peripheral> = match name {
        "RCC" => return Kind::Rcc,
        "PWR" => return Kind::Pwr,
        "EXTI" => return Kind::Exti,
        "ETH" => return Kind::Ethernet,
        "DBGMCU" => return Kind::Debug,
        "FLASH" => Box::new(FlashInterface),
        "SYSCFG" => Box::new(Syscfg::default()),
        "IWDG1" => Box::new(Watchdog::default()),
        "SPI1" | "SPI2" | "SPI3" => Box::new(Spi::new(name)),
        _ => match (name.strip_prefix("GPIO"), name.strip_prefix("TIM")) {
            (Some(letter), _) => {
                return letter
                    .bytes()
                    .next()
                    .map_or(Kind::None, |letter| Kind::Port(usize::from(letter - b'A')));
            }
            (_, Some(_)) => Box::new(Timer::new(name)),
            _ => return Kind::None,
        },
    };
    Kind::Other(other)
}

impl Models {
    /// All as after power-up, or after a reset for this cause.
    pub fn new(map: &Map, cause: Option<Reset>) -> Self {
        Self {
            rcc: Rcc::new(cause),
            pwr: Pwr::new(false),
            exti: Exti::default(),
            ethernet: Some(Box::default()),
            kinds: map.entries().iter().map(|entry| kind(entry.name)).collect(),
            resets: map.entries().iter().map(|entry| entry.reset).collect(),
            due: vec![Time::default(); map.entries().len()],
        }
    }

    /// All as after a reset of the chip.
    pub fn reset(&mut self, map: &Map, cause: Reset) {
        let (chosen, ethernet) = (self.pwr.chosen(), self.ethernet.take());
        *self = Self {
            pwr: Pwr::new(chosen),
            ethernet,
            ..Self::new(map, Some(cause))
        };
        if let Some(ethernet) = &mut self.ethernet {
            ethernet.reset();
        }
    }

    /// Resets what the clock controller holds in reset.
    pub fn apply_resets(&mut self, map: &Map) {
        for (index, entry) in map.entries().iter().enumerate() {
            let held = self.resets[index].is_some_and(|bit| self.rcc.is_set(bit));
            if !held {
                continue;
            }
            self.due[index] = Time::default();
            match &mut self.kinds[index] {
                Kind::Other(_) => self.kinds[index] = kind(entry.name),
                Kind::Ethernet => {
                    if let Some(ethernet) = &mut self.ethernet {
                        ethernet.reset();
                    }
                }
                _ => {}
            }
        }
    }

    /// Whether the peripheral is modelled.
    pub fn has(&self, index: usize) -> bool {
        !matches!(self.kinds[index], Kind::None)
    }

    fn model(&mut self, index: usize) -> Option<&mut dyn Peripheral> {
        match &mut self.kinds[index] {
            Kind::Rcc => Some(&mut self.rcc),
            Kind::Pwr => Some(&mut self.pwr),
            Kind::Exti => Some(&mut self.exti),
            Kind::Ethernet => self
                .ethernet
                .as_mut()
                .map(|ethernet| &mut **ethernet as &mut dyn Peripheral),
            Kind::Other(model) => Some(model.as_mut()),
            Kind::None | Kind::Port(_) | Kind::Debug => None,
        }
    }

    /// Reads a register.
    pub fn read(&mut self, index: usize, offset: u32, shared: &mut Shared) -> u32 {
        if let Kind::Port(port) = self.kinds[index] {
            shared.outside.advance(shared.clock.now());
            return shared.pins.read(port, offset, &shared.outside);
        }
        self.model(index).map_or(0, |model| model.read(offset, shared))
    }

    /// Writes a register.
    pub fn write(&mut self, index: usize, offset: u32, value: u32, size: u32, shared: &mut Shared) {
        if let Kind::Port(port) = self.kinds[index] {
            let now = shared.clock.now();
            shared.findings.now = now;
            shared.pins.write(
                port,
                offset,
                value,
                now,
                &mut shared.outside,
                &mut shared.findings,
            );
            shared.recorder.note(&shared.pins, port, now);
        } else if let Some(model) = self.model(index) {
            model.write(offset, value, size, shared);
        }
    }

    /// Something was done to a peripheral: looks when it is due, and what it asks for.
    pub fn look_at(&mut self, index: usize, shared: &mut Shared) {
        let (mut due, mut asked) = (Time::NEVER, None);
        if let Some(model) = self.model(index) {
            (due, asked) = (model.due(), model.asks_for());
        }
        self.due[index] = due;
        if let Some(number) = asked.filter(|number| !shared.system.nvic.is_active(*number)) {
            shared.system.nvic.pend(number);
        }
    }

    /// Brings all to the present.
    pub fn advance(&mut self, shared: &mut Shared) {
        let low = self.pwr.detects_low(shared.supply_mv);
        self.exti.set_line(VOLTAGE_DETECTOR, low);
        for index in 0..self.kinds.len() {
            if self.due[index] <= shared.now()
                && let Some(model) = self.model(index)
            {
                model.advance(shared);
            }
            self.look_at(index, shared);
        }
    }

    /// When the first of them has to be looked at.
    pub fn due(&self) -> Time {
        self.due.iter().copied().min().unwrap_or(Time::NEVER)
    }
}
