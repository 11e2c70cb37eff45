//! What both boards start alike.

use crate::ethernet::Parts;
use crate::spi::Bus;
use crate::{Watchdog, clocks, handlers, outputs, supply, timebase};
use cortex_m::peripheral::SYST;
use defmt_rtt as _;
use embassy_stm32::{peripherals, rcc};

/// Starts watchdog, clocks, time and the bus of the converters, and clocks the tick timers; the core's own timer is free. All outputs are off
/// since reset; the network, which may take half a second, is left to be started when nothing else is.
pub(crate) fn start(mut core: cortex_m::Peripherals) -> (Watchdog, Bus, Parts, SYST) {
    outputs::switch_off();
    board_faults::guard_stack(&mut core);
    // Should anything below hang, the board restarts.
    let watchdog = Watchdog::start();
    supply::start();
    let p = clocks::start(&mut core);
    supply::watch(&mut core);
    timebase::start(&mut core);
    handlers::report_last();
    rcc::enable_and_reset::<peripherals::TIM6>();
    rcc::enable_and_reset::<peripherals::TIM7>();
    let bus = Bus::start(p.SPI3, p.PC10, p.PC12, p.PC11);
    let parts = Parts {
        controller: p.ETH,
        management: p.ETH_SMA,
        clock: p.PA1,
        mdio: p.PA2,
        carrier: p.PA7,
        tx1: p.PB13,
        mdc: p.PC1,
        rx0: p.PC4,
        rx1: p.PC5,
        tx_enable: p.PG11,
        tx0: p.PG13,
    };
    (watchdog, bus, parts, core.SYST)
}
