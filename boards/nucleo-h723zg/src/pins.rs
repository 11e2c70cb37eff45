//! What is wired where, as data. `docs/wiring.md` shows the same tables with what each line needs outside.

use crate::counting::Width;

/// A pin of the microcontroller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Pin {
    /// Port, A = 0.
    pub port: u8,
    /// Number in the port, 0…15.
    pub number: u8,
}

/// The pin with this name, `"PA5"`; an unknown name does not compile where the result is a constant.
pub const fn pin(name: &str) -> Pin {
    let name = name.as_bytes();
    assert!(name[0] == b'P' && name[1] >= b'A' && name[1] <= b'H');
    let mut number = 0;
    let mut at = 2;
    while at < name.len() {
        assert!(name[at].is_ascii_digit());
        number = number * 10 + name[at] - b'0';
        at += 1;
    }
    assert!(at > 2 && number < 16);
    Pin {
        port: name[1] - b'A',
        number,
    }
}

const fn pins<const N: usize>(names: [&str; N]) -> [Pin; N] {
    let mut pins = [pin("PA0"); N];
    let mut at = 0;
    while at < N {
        pins[at] = pin(names[at]);
        at += 1;
    }
    pins
}

/// A timer that counts an encoder's edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Timer {
    Tim1,
    Tim2,
    Tim3,
    Tim4,
    Tim8,
    Tim23,
    Tim24,
}

impl Timer {
    /// Bits of its counter.
    pub const fn width(self) -> Width {
        match self {
            Self::Tim2 | Self::Tim23 | Self::Tim24 => Width::Bits32,
            Self::Tim1 | Self::Tim3 | Self::Tim4 | Self::Tim8 => Width::Bits16,
        }
    }
}

/// A grating or encoder: A and B on channels 1 and 2, the reference mark on a capture channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncoderPins {
    /// Counts A and B.
    pub timer: Timer,
    /// Alternate function of the three pins.
    pub function: u8,
    /// Track A, channel 1.
    pub a: Pin,
    /// Track B, channel 2.
    pub b: Pin,
    /// Reference mark Z.
    pub z: Pin,
    /// Channel that latches the count at Z: 3 or 4.
    pub z_channel: u8,
}

const fn encoder(timer: Timer, function: u8, a: &str, b: &str, z: &str, z_channel: u8) -> EncoderPins {
    EncoderPins {
        timer,
        function,
        a: pin(a),
        b: pin(b),
        z: pin(z),
        z_channel,
    }
}

const ON_TIM1: EncoderPins = encoder(Timer::Tim1, 1, "PE9", "PE11", "PE13", 3);
const ON_TIM2: EncoderPins = encoder(Timer::Tim2, 1, "PA5", "PB3", "PA3", 4);
const ON_TIM3: EncoderPins = encoder(Timer::Tim3, 2, "PA6", "PB5", "PB1", 4);
const ON_TIM4: EncoderPins = encoder(Timer::Tim4, 2, "PD12", "PD13", "PD14", 3);
const ON_TIM8: EncoderPins = encoder(Timer::Tim8, 3, "PC6", "PC7", "PC8", 3);
const ON_TIM23: EncoderPins = encoder(Timer::Tim23, 13, "PF0", "PF1", "PF2", 3);
const ON_TIM24: EncoderPins = encoder(Timer::Tim24, 14, "PF11", "PF12", "PF13", 3);

/// What a board's `N` drives are wired to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Drives<const N: usize> {
    /// Gratings or encoders.
    pub encoders: [EncoderPins; N],
    /// Drive enables, high enables. All on [`OUTPUT_PORT`].
    pub enable: [Pin; N],
    /// Limit switch at the positive end: a closed loop holds it high.
    pub limit_plus: [Pin; N],
    /// Limit switch at the negative end: a closed loop holds it high.
    pub limit_minus: [Pin; N],
    /// Drive ready: high; low is a fault or a broken wire.
    pub ready: [Pin; N],
}

/// Drives of the motion board: X1, X2, Y, Z, A, B, C.
pub const MOTION: Drives<7> = Drives {
    encoders: [ON_TIM2, ON_TIM23, ON_TIM24, ON_TIM4, ON_TIM1, ON_TIM8, ON_TIM3],
    enable: pins(["PF3", "PF4", "PF5", "PF6", "PF7", "PF8", "PF9"]),
    limit_plus: pins(["PG0", "PG1", "PG2", "PG3", "PG4", "PG5", "PG6"]),
    limit_minus: pins(["PD3", "PD4", "PD5", "PD6", "PD7", "PG8", "PG9"]),
    ready: pins(["PE2", "PE3", "PE4", "PE5", "PE6", "PE7", "PE8"]),
};

/// Drives of the tracker board: U1, V1, U2, V2.
pub const TRACKER: Drives<4> = Drives {
    encoders: [ON_TIM2, ON_TIM8, ON_TIM1, ON_TIM4],
    enable: pins(["PF3", "PF4", "PF5", "PF6"]),
    limit_plus: pins(["PG0", "PG1", "PG2", "PG3"]),
    limit_minus: pins(["PD3", "PD4", "PD5", "PD6"]),
    ready: pins(["PE2", "PE3", "PE4", "PE5"]),
};

/// Beam gates of the motion board, high opens. On [`OUTPUT_PORT`].
pub const BEAM_GATES: [Pin; 2] = pins(["PF10", "PF14"]);
/// Permits of the tracker board, high lets the beam of the side burn: for a gate outside that needs both boards' word.
/// On [`OUTPUT_PORT`].
pub const PERMITS: [Pin; 2] = pins(["PF10", "PF14"]);
/// Laser sources ready, motion board: high; low is a fault or a broken wire.
pub const LASERS_READY: [Pin; 2] = pins(["PA4", "PB12"]);
/// Digital outputs of the process, motion board, high is on. Not on [`OUTPUT_PORT`], which is full.
pub const PROCESS_OUTPUTS: [Pin; 8] = pins(["PE0", "PE10", "PE12", "PE14", "PE15", "PG10", "PG12", "PG14"]);
/// Inputs by which the process answers, motion board: high is on.
pub const PROCESS_INPUTS: [Pin; 4] = pins(["PB8", "PB9", "PB10", "PB11"]);
/// Camera triggers of the tracker board, rising edge exposes. On [`OUTPUT_PORT`].
pub const CAMERA_TRIGGERS: [Pin; 2] = pins(["PF7", "PF8"]);
/// Alternates at every tick that set its outputs, both boards: feeds the charge pump that lets enables and
/// gates through. On [`OUTPUT_PORT`].
pub const HEARTBEAT: Pin = pin("PF15");
/// Emergency stop, two channels, both boards: a closed loop holds each high.
pub const EMERGENCY_STOP: [Pin; 2] = pins(["PC0", "PB2"]);

/// Port of all that must die together: one store to its set/reset register switches all of it off.
pub const OUTPUT_PORT: u8 = pin("PF0").port;
/// The pins of [`OUTPUT_PORT`] that are outputs on either board.
pub const OUTPUT_MASK: u16 =
    mask(&MOTION.enable) | mask(&BEAM_GATES) | mask(&PERMITS) | mask(&CAMERA_TRIGGERS) | mask(&[HEARTBEAT]);

/// Bits of `pins` in their port.
pub const fn mask(pins: &[Pin]) -> u16 {
    let mut mask = 0;
    let mut at = 0;
    while at < pins.len() {
        mask |= 1 << pins[at].number;
        at += 1;
    }
    mask
}

/// SPI3 to the converters: SCK, MISO, MOSI.
pub const SPI: [Pin; 3] = pins(["PC10", "PC11", "PC12"]);
/// Alternate function of [`SPI`].
pub const SPI_FUNCTION: u8 = 6;
/// SYNC of each converter; the tracker board has the first only.
pub const DAC_SYNC: [Pin; 3] = pins(["PD0", "PD1", "PD2"]);
/// LDAC of all converters.
pub const DAC_LOAD: Pin = pin("PB15");
/// CLR of all converters.
pub const DAC_CLEAR: Pin = pin("PG15");

/// RMII of the Ethernet port: REF_CLK, MDIO, CRS_DV, TXD1, MDC, RXD0, RXD1, TX_EN, TXD0.
pub const ETHERNET: [Pin; 9] = pins(["PA1", "PA2", "PA7", "PB13", "PC1", "PC4", "PC5", "PG11", "PG13"]);
/// Alternate function of [`ETHERNET`].
pub const ETHERNET_FUNCTION: u8 = 11;

/// Taken by the NUCLEO board itself, or not to be had on its connectors: serial port and debugger of the
/// ST-LINK, clocks, USB, LEDs, button, PA0, and the analog pair PC2/PC3.
pub const RESERVED: [Pin; 22] = pins([
    "PD8", "PD9", "PA13", "PA14", "PH0", "PH1", "PC14", "PC15", "PA8", "PA9", "PA10", "PA11", "PA12", "PD10",
    "PG7", "PB0", "PE1", "PB14", "PC13", "PA0", "PC2", "PC3",
]);
