//! What both boards start alike.

use crate::ethernet::Parts;
use crate::outputs::{self, Bus};
use crate::{Network, Watchdog, clocks, handlers, timebase};
use defmt_rtt as _;
use embassy_stm32::spi::Spi;
use embassy_stm32::{peripherals, rcc};

/// Starts watchdog, clocks, time, network and the bus of the converters, and clocks the tick timers.
pub(crate) fn start(mut core: cortex_m::Peripherals) -> (Watchdog, Network, Bus) {
    // First of all: should anything below hang, the board starts anew.
    let watchdog = Watchdog::start();
    let p = clocks::start(&mut core);
    timebase::start(&mut core);
    handlers::report_last();
    rcc::enable_and_reset::<peripherals::TIM6>();
    rcc::enable_and_reset::<peripherals::TIM7>();
    let network = Network::start(Parts {
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
    });
    let bus = Spi::new_blocking(p.SPI3, p.PC10, p.PC12, p.PC11, outputs::bus_config());
    (watchdog, network, bus)
}
