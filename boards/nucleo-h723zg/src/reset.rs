//! Outputs off straight out of reset, before memory is set up: some fifty instructions, two microseconds.
//!
//! Until then the pins float, as in every reset, and the pull-downs outside hold them. Setting up takes half a second
//! from there, most of it for the Ethernet PHY.

use crate::pins::{DAC_CLEAR, OUTPUT_MASK, OUTPUT_PORT, PROCESS_OUTPUTS};

/// Register that clocks the ports, a bit for each.
pub const PORT_CLOCKS: u32 = 0x5802_44e0;
/// Registers of port A, and the distance to the next port's.
const PORT_A: u32 = 0x5802_0000;
const PORT_STRIDE: u32 = 0x400;
/// Mode register of a port: two bits a pin.
pub const MODE: u32 = 0x00;
/// Set/reset register of a port: its upper half resets.
pub const SET_RESET: u32 = 0x18;

/// Registers of `port`, A = 0.
pub const fn port(port: u8) -> u32 {
    PORT_A + PORT_STRIDE * port as u32
}

/// Bits of a mode register to be cleared, and then to be set, so that the pins of `mask` are outputs.
pub const fn outputs(mask: u16) -> (u32, u32) {
    let (mut clear, mut set) = (0, 0);
    let mut pin = 0;
    while pin < 16 {
        if mask & 1 << pin != 0 {
            clear |= 0b11 << (2 * pin);
            set |= 0b01 << (2 * pin);
        }
        pin += 1;
    }
    (clear, set)
}

/// Ports with outputs that are low from reset on, in the order in which they get so: first what must die together, then CLR of the
/// converters and outputs of the process, then the rest of these.
pub const PORTS: [u8; 3] = [OUTPUT_PORT, DAC_CLEAR.port, PROCESS_OUTPUTS[0].port];

/// The pins of `port` that are low from reset on. A board does not know yet which of the two it is, so these are the outputs of
/// either.
pub const fn low(port: u8) -> u16 {
    let mut mask = if port == OUTPUT_PORT { OUTPUT_MASK } else { 0 };
    if port == DAC_CLEAR.port {
        mask |= 1 << DAC_CLEAR.number;
    }
    let mut i = 0;
    while i < PROCESS_OUTPUTS.len() {
        if port == PROCESS_OUTPUTS[i].port {
            mask |= 1 << PROCESS_OUTPUTS[i].number;
        }
        i += 1;
    }
    mask
}

#[cfg(target_os = "none")]
const CLOCKS: u32 = 1 << PORTS[0] | 1 << PORTS[1] | 1 << PORTS[2];

/// What start-up calls before it sets memory up: all lines of the output port low, then CLR of the converters, which
/// sets them to 0 V, and the outputs of the process. It may use registers only.
#[cfg(target_os = "none")]
#[unsafe(naked)]
#[unsafe(no_mangle)]
unsafe extern "C" fn __pre_init() {
    core::arch::naked_asm!(
        // Clock the ports of all outputs, so that switching off works from here on; reading back waits until they are.
        "movw r0, #({clocks} & 0xffff)",
        "movt r0, #({clocks} >> 16)",
        "ldr r1, [r0]",
        "movw r2, #{ports}",
        "orr r1, r1, r2",
        "str r1, [r0]",
        "ldr r1, [r0]",
        "dsb",
        // First the level, then the direction.
        ".macro make_low port, low, clear, set",
        r"movw r0, #(\port & 0xffff)",
        r"movt r0, #(\port >> 16)",
        "movs r1, #0",
        r"movt r1, #\low",
        "str r1, [r0, #{set_reset}]",
        "ldr r1, [r0, #{mode}]",
        r"movw r2, #(\clear & 0xffff)",
        r"movt r2, #(\clear >> 16)",
        "bic r1, r1, r2",
        r"movw r2, #(\set & 0xffff)",
        r"movt r2, #(\set >> 16)",
        "orr r1, r1, r2",
        "str r1, [r0, #{mode}]",
        ".endm",
        "make_low {port_0}, {low_0}, {clear_0}, {set_0}",
        "make_low {port_1}, {low_1}, {clear_1}, {set_1}",
        "make_low {port_2}, {low_2}, {clear_2}, {set_2}",
        ".purgem make_low",
        "bx lr",
        clocks = const PORT_CLOCKS,
        ports = const CLOCKS,
        port_0 = const port(PORTS[0]),
        low_0 = const low(PORTS[0]),
        clear_0 = const outputs(low(PORTS[0])).0,
        set_0 = const outputs(low(PORTS[0])).1,
        port_1 = const port(PORTS[1]),
        low_1 = const low(PORTS[1]),
        clear_1 = const outputs(low(PORTS[1])).0,
        set_1 = const outputs(low(PORTS[1])).1,
        port_2 = const port(PORTS[2]),
        low_2 = const low(PORTS[2]),
        clear_2 = const outputs(low(PORTS[2])).0,
        set_2 = const outputs(low(PORTS[2])).1,
        set_reset = const SET_RESET,
        mode = const MODE,
    )
}
