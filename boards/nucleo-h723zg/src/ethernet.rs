//! The Ethernet port as a `smoltcp` device, over the HAL's driver.
//!
//! Nothing here waits for the outside: without cable there are no frames and no room to send; without the PHY,
//! whose clock the controller needs even to be reset, the controller is left alone and the port stays silent.

use crate::gpio;
use crate::phy::Lan8742;
use crate::pins::{ETHERNET, ETHERNET_FUNCTION};
use crate::timebase::now_us;
use core::mem::MaybeUninit;
use core::task::{Context, Waker};
use embassy_net_driver::{Driver, RxToken as _, TxToken as _};
use embassy_stm32::eth::{Ethernet, InterruptHandler, PacketQueue, Sma};
use embassy_stm32::interrupt::typelevel::{Binding, ETH, Handler};
use embassy_stm32::pac::gpio::vals::Ospeedr;
use embassy_stm32::pac::syscfg::vals::EthSelPhy;
use embassy_stm32::peripherals::{ETH as Controller, ETH_SMA};
use embassy_stm32::{Peri, pac};
use smoltcp::phy::{self, Device, DeviceCapabilities, Medium};
use smoltcp::time::Instant;

/// Frames that may wait to be sent, and to be taken.
const SENDING: usize = 4;
const RECEIVING: usize = 12;
/// Longest frame without checksum.
const MAX_FRAME: usize = 1514;
/// Longest time the reset of the controller may take \[µs\].
const RESET_US: u64 = 10_000;

type Queue = PacketQueue<SENDING, RECEIVING>;
type Port = Ethernet<'static, Controller, Lan8742<Sma<'static, ETH_SMA>>>;

/// In memory that the controller reaches; not initialised at start.
#[unsafe(link_section = ".ethernet")]
static mut QUEUE: MaybeUninit<Queue> = MaybeUninit::uninit();

/// The firmware's Ethernet task calls [`Network::acknowledge`].
#[derive(Clone, Copy)]
struct Bound;

// SAFETY: the task bound to ETHERNET calls the handler through `Network::acknowledge`.
unsafe impl Binding<ETH, InterruptHandler> for Bound {}

/// The Ethernet port.
pub struct Network {
    /// `None` if the PHY gives no clock.
    port: Option<Port>,
    mac: [u8; 6],
    last_arrival_us: u64,
}

/// What the port is made of; the pins are those of [`ETHERNET`].
pub(crate) struct Parts {
    pub(crate) controller: Peri<'static, Controller>,
    pub(crate) management: Peri<'static, ETH_SMA>,
    pub(crate) clock: Peri<'static, embassy_stm32::peripherals::PA1>,
    pub(crate) mdio: Peri<'static, embassy_stm32::peripherals::PA2>,
    pub(crate) carrier: Peri<'static, embassy_stm32::peripherals::PA7>,
    pub(crate) tx1: Peri<'static, embassy_stm32::peripherals::PB13>,
    pub(crate) mdc: Peri<'static, embassy_stm32::peripherals::PC1>,
    pub(crate) rx0: Peri<'static, embassy_stm32::peripherals::PC4>,
    pub(crate) rx1: Peri<'static, embassy_stm32::peripherals::PC5>,
    pub(crate) tx_enable: Peri<'static, embassy_stm32::peripherals::PG11>,
    pub(crate) tx0: Peri<'static, embassy_stm32::peripherals::PG13>,
}

impl Network {
    /// Starts the port. To be called once.
    pub(crate) fn start(parts: Parts) -> Self {
        let mac = mac_of_chip();
        let mut network = Self {
            port: None,
            mac,
            last_arrival_us: 0,
        };
        if !clock_runs() {
            defmt::error!("the Ethernet PHY gives no clock; the board runs without network");
            return network;
        }
        // SAFETY: this function runs once, and nothing else names the queue.
        let queue = unsafe { &mut *core::ptr::addr_of_mut!(QUEUE) };
        Queue::init(queue);
        // SAFETY: `init` has made it.
        let queue = unsafe { queue.assume_init_mut() };
        let phy = Lan8742(Sma::new(parts.management, parts.mdio, parts.mdc));
        network.port = Some(Ethernet::new_with_phy(
            queue,
            parts.controller,
            Bound,
            parts.clock,
            parts.carrier,
            parts.rx0,
            parts.rx1,
            parts.tx0,
            parts.tx1,
            parts.tx_enable,
            mac,
            phy,
        ));
        network
    }

    /// Clears the interrupt; afterwards the received frames are to be taken.
    pub fn acknowledge(&mut self) {
        // SAFETY: it does no more than clear flags and wake the waker, which does nothing.
        unsafe { <InterruptHandler as Handler<ETH>>::on_interrupt() }
    }

    /// Ethernet address of the port, made of the chip's serial number.
    pub fn mac(&self) -> [u8; 6] {
        self.mac
    }

    /// Time at which the last received frame was taken from the controller \[µs\].
    pub fn last_arrival_us(&self) -> u64 {
        self.last_arrival_us
    }
}

/// Whether the controller, which needs the PHY's clock for it, comes out of a reset. The HAL waits for that
/// without end, so it is tried here first.
fn clock_runs() -> bool {
    for pin in ETHERNET {
        gpio::alternate(pin, ETHERNET_FUNCTION, Ospeedr::VERY_HIGH_SPEED);
    }
    pac::RCC.ahb1enr().modify(|w| {
        w.set_ethen(true);
        w.set_ethtxen(true);
        w.set_ethrxen(true);
    });
    pac::SYSCFG.pmcr().modify(|w| w.set_eth_sel_phy(EthSelPhy::RMII));
    let mode = pac::ETH.ethernet_dma().dmamr();
    mode.modify(|w| w.set_swr(true));
    let give_up = now_us() + RESET_US;
    while mode.read().swr() {
        if now_us() > give_up {
            return false;
        }
    }
    true
}

/// A locally administered address from the chip's serial number of 96 bits (FNV-1a).
fn mac_of_chip() -> [u8; 6] {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for byte in (0..3).flat_map(|word| pac::UID.uid(word).read().to_le_bytes()) {
        hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    }
    let [a, b, c, d, e, ..] = hash.to_le_bytes();
    [0x02, a, b, c, d, e]
}

/// A received frame.
pub struct RxToken<'a>(embassy_stm32::eth::RxToken<'a, 'static>);

/// The right to send a frame.
pub struct TxToken<'a>(embassy_stm32::eth::TxToken<'a, 'static>);

impl phy::RxToken for RxToken<'_> {
    fn consume<R, F: FnOnce(&[u8]) -> R>(self, f: F) -> R {
        self.0.consume(|frame| f(frame))
    }
}

impl phy::TxToken for TxToken<'_> {
    fn consume<R, F: FnOnce(&mut [u8]) -> R>(self, length: usize, f: F) -> R {
        self.0.consume(length, f)
    }
}

impl Device for Network {
    type RxToken<'a> = RxToken<'a>;
    type TxToken<'a> = TxToken<'a>;

    fn receive(&mut self, _: Instant) -> Option<(RxToken<'_>, TxToken<'_>)> {
        let (rx, tx) = self
            .port
            .as_mut()?
            .receive(&mut Context::from_waker(Waker::noop()))?;
        self.last_arrival_us = now_us();
        Some((RxToken(rx), TxToken(tx)))
    }

    fn transmit(&mut self, _: Instant) -> Option<TxToken<'_>> {
        let tx = self
            .port
            .as_mut()?
            .transmit(&mut Context::from_waker(Waker::noop()))?;
        Some(TxToken(tx))
    }

    fn capabilities(&self) -> DeviceCapabilities {
        let mut capabilities = DeviceCapabilities::default();
        capabilities.medium = Medium::Ethernet;
        capabilities.max_transmission_unit = MAX_FRAME;
        capabilities
    }
}
