//! Outputs off straight out of reset, before memory is set up: a dozen instructions, a microsecond.
//!
//! Until then the pins float, as in every reset, and the pull-downs outside hold them. Setting up takes half a second
//! from there, most of it for the Ethernet PHY.

#[cfg(target_os = "none")]
use crate::pins::{DAC_CLEAR, OUTPUT_MASK, OUTPUT_PORT, PROCESS_OUTPUTS, mask};

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

#[cfg(target_os = "none")]
const OUTPUT_MODES: (u32, u32) = outputs(OUTPUT_MASK);
/// Ports with outputs, a bit for each.
#[cfg(target_os = "none")]
const PORTS: u32 = {
    let mut ports = 1 << OUTPUT_PORT | 1 << DAC_CLEAR.port;
    let mut i = 0;
    while i < PROCESS_OUTPUTS.len() {
        ports |= 1 << PROCESS_OUTPUTS[i].port;
        i += 1;
    }
    ports
};
#[cfg(target_os = "none")]
const CLEAR_MODES: (u32, u32) = outputs(mask(&[DAC_CLEAR]));

/// What start-up calls before it sets memory up: all lines of the output port low, and CLR of the converters, which
/// sets them to 0 V. It may use registers only.
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
        "movw r0, #({outputs} & 0xffff)",
        "movt r0, #({outputs} >> 16)",
        "movs r1, #0",
        "movt r1, #{output_mask}",
        "str r1, [r0, #{set_reset}]",
        "ldr r1, [r0, #{mode}]",
        "movw r2, #({output_clear} & 0xffff)",
        "movt r2, #({output_clear} >> 16)",
        "bic r1, r1, r2",
        "movw r2, #({output_set} & 0xffff)",
        "movt r2, #({output_set} >> 16)",
        "orr r1, r1, r2",
        "str r1, [r0, #{mode}]",
        "movw r0, #({clear} & 0xffff)",
        "movt r0, #({clear} >> 16)",
        "movs r1, #0",
        "movt r1, #{clear_mask}",
        "str r1, [r0, #{set_reset}]",
        "ldr r1, [r0, #{mode}]",
        "movw r2, #({clear_clear} & 0xffff)",
        "movt r2, #({clear_clear} >> 16)",
        "bic r1, r1, r2",
        "movw r2, #({clear_set} & 0xffff)",
        "movt r2, #({clear_set} >> 16)",
        "orr r1, r1, r2",
        "str r1, [r0, #{mode}]",
        "bx lr",
        clocks = const PORT_CLOCKS,
        ports = const PORTS,
        outputs = const port(OUTPUT_PORT),
        output_mask = const OUTPUT_MASK,
        output_clear = const OUTPUT_MODES.0,
        output_set = const OUTPUT_MODES.1,
        clear = const port(DAC_CLEAR.port),
        clear_mask = const mask(&[DAC_CLEAR]),
        clear_clear = const CLEAR_MODES.0,
        clear_set = const CLEAR_MODES.1,
        set_reset = const SET_RESET,
        mode = const MODE,
    )
}
