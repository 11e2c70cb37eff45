//! Clocks and memories.
//!
//! The ST-LINK gives 8 MHz; PLL1 makes 520 MHz for the core, 260 MHz for buses and all timers, 57.8 MHz for SPI.
//! 520 MHz is the highest the chip allows as it leaves the factory: 550 MHz needs the option bit CPU_FREQ_BOOST,
//! and gives up the error correction of the tightly coupled memories.
//!
//! The instruction cache is on. The data cache stays off: the stack lies in memory that needs none, and without
//! it the processor and the Ethernet controller cannot disagree about a packet.

use embassy_stm32::interrupt::Priority;
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllDiv, PllMul, PllPreDiv, PllSource, Sysclk, VoltageScale,
};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Config, Peripherals, pac};

/// Core clock \[MHz\].
pub(crate) const CORE_MHZ: u32 = 520;
/// Clock of all timers \[MHz\].
pub(crate) const TIMER_MHZ: u32 = 260;
/// SCLK of the converters: 57.8 MHz / 8 \[Hz\]. They would take four times as much; this leaves 40 ns for
/// isolators and cable on the way back, and nine frames still take but an eighth of a servo tick.
pub(crate) const SPI_HZ: u32 = 7_225_000;

/// Starts clocks, caches and memories, and takes the peripherals.
pub(crate) fn start(core: &mut cortex_m::Peripherals) -> Peripherals {
    let mut config = Config::default();
    let rcc = &mut config.rcc;
    rcc.hse = Some(Hse {
        freq: Hertz(8_000_000),
        mode: HseMode::Bypass,
    });
    // Needed by the compensation of fast outputs.
    rcc.csi = true;
    rcc.pll1 = Some(Pll {
        source: PllSource::HSE,
        prediv: PllPreDiv::DIV4,
        mul: PllMul::MUL260,
        divp: Some(PllDiv::DIV1),
        divq: Some(PllDiv::DIV9),
        divr: None,
    });
    rcc.sys = Sysclk::PLL1_P;
    rcc.voltage_scale = VoltageScale::Scale0;
    rcc.ahb_pre = AHBPrescaler::DIV2;
    rcc.apb1_pre = APBPrescaler::DIV2;
    rcc.apb2_pre = APBPrescaler::DIV2;
    rcc.apb3_pre = APBPrescaler::DIV2;
    rcc.apb4_pre = APBPrescaler::DIV2;
    // No DMA interrupt is used; should one come, it is not to stand above the servo tick.
    config.dma_interrupt_priority = Priority::P15;
    config.bdma_interrupt_priority = Priority::P15;
    config.mdma_interrupt_priority = Priority::P15;
    let peripherals = embassy_stm32::init(config);

    pac::RCC.ahb2enr().modify(|w| {
        w.set_sram1en(true);
        w.set_sram2en(true);
    });
    core.SCB.enable_icache();
    peripherals
}

/// Waits by counting core clocks.
pub(crate) struct Wait;

impl embedded_hal::delay::DelayNs for Wait {
    fn delay_ns(&mut self, ns: u32) {
        cortex_m::asm::delay((ns as u64 * u64::from(CORE_MHZ) / 1000) as u32 + 1);
    }
}
