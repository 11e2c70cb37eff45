//! Classes of instructions by their encodings (ARMv7-M A5 and A6).

use super::{Access, Class};

/// What is known of a register's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Value {
    /// Near what this register held at the block's begin.
    First(u8),
    /// Near this address.
    Near(u32),
    /// Nothing.
    Unknown,
}

/// What an instruction makes of a register, if that is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Made {
    /// A value near that of another one.
    Near(u8),
    /// An address whose upper half is this.
    Upper(u16),
}

/// An instruction as far as its cycles go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Instruction {
    /// What it is.
    pub class: Class,
    /// Its access to memory.
    pub access: Option<Access>,
    /// Registers R0 to R15 that it may write, one bit each.
    pub writes: u16,
    /// What it makes of them, if that is known.
    pub made: Option<Made>,
}

impl Instruction {
    /// The instruction with these half-words; the second does not matter where the first is all of it.
    pub fn decode(first: u16, second: u16) -> Self {
        if half_words(first) == 2 {
            wide(first, second)
        } else {
            narrow(first)
        }
    }

    /// Changes what is known of the registers.
    pub fn change(&self, values: &mut [Value; 16]) {
        let value = match self.made {
            Some(Made::Near(register)) => values[usize::from(register & 15)],
            Some(Made::Upper(half)) => Value::Near(u32::from(half) << 16),
            None => Value::Unknown,
        };
        for (register, old) in values.iter_mut().enumerate() {
            // The stack pointer stays in its memory.
            if register != 13 && self.writes >> register & 1 == 1 {
                *old = value;
            }
        }
    }

    fn new(class: Class, writes: u16) -> Self {
        Self {
            class,
            access: None,
            writes,
            made: None,
        }
    }

    /// The sum of this register and a constant, or a copy.
    fn near(register: u16, writes: u16) -> Self {
        Self {
            made: Some(Made::Near((register & 15) as u8)),
            ..Self::new(Class::Integer, writes)
        }
    }

    /// Loads or stores by register `base`.
    fn memory(class: Class, base: u16, writes: u16) -> Self {
        let (stores, transfers) = (class.stores(), class.transfers());
        Self {
            access: Some(Access {
                base: (base & 15) as u8,
                stores,
                transfers,
            }),
            ..Self::new(class, writes)
        }
    }

    /// In one transfer: doubles are aligned.
    fn in_one(self) -> Self {
        let access = self.access.map(|access| Access {
            transfers: 1,
            ..access
        });
        Self { access, ..self }
    }
}

/// Half-words of an instruction that begins so (A5.1).
pub fn half_words(first: u16) -> usize {
    if first >> 11 >= 0b11101 { 2 } else { 1 }
}

/// Instructions that this one makes conditional, if it is IT (A7.7.38).
pub fn instructions_of_it(first: u16) -> Option<u32> {
    let is_it = first & 0xff00 == 0xbf00 && first & 15 != 0;
    is_it.then(|| 4 - first.trailing_zeros())
}

fn bit(register: u16) -> u16 {
    1 << (register & 15)
}

/// Those of 16 bits (A5.2).
fn narrow(first: u16) -> Instruction {
    use Class::*;
    let (low, middle, high) = (first & 7, first >> 3 & 7, first >> 8 & 7);
    let list = first & 0xff;
    match first >> 8 {
        // Compares of several kinds, the stack pointer, hints.
        0x28..=0x2f | 0x45 | 0xb0 | 0xbe | 0xbf => Instruction::new(Integer, 0),
        0x42 if first & 0xc0 != 0x40 => Instruction::new(Integer, 0),
        0x43 if first & 0xc0 == 0x40 => Instruction::new(Multiply, bit(low)),
        0x1c..=0x1f => Instruction::near(middle, bit(low)),
        0x30..=0x3f => Instruction::near(high, bit(high)),
        0x46 => Instruction::near(first >> 3, bit(first >> 4 & 8 | low)),
        0xa0..=0xa7 => Instruction::near(15, bit(high)),
        0xa8..=0xaf => Instruction::near(13, bit(high)),
        0x00..=0x1f | 0x40..=0x43 => Instruction::new(Integer, bit(low)),
        0x20..=0x27 => Instruction::new(Integer, bit(high)),
        0x44 => Instruction::new(Integer, bit(first >> 4 & 8 | low)),
        0x47 => Instruction::new(Branch, bit(14)),
        0x48..=0x4f => Instruction::memory(Load, 15, bit(high)),
        0x50 | 0x51 | 0x60..=0x67 => Instruction::memory(Store, middle, 0),
        0x58 | 0x59 | 0x68..=0x6f => Instruction::memory(Load, middle, bit(low)),
        0x52..=0x55 | 0x70..=0x77 | 0x80..=0x87 => Instruction::memory(StorePart, middle, 0),
        0x56..=0x5f | 0x78..=0x7f | 0x88..=0x8f => Instruction::memory(LoadPart, middle, bit(low)),
        0x90..=0x97 => Instruction::memory(Store, 13, 0),
        0x98..=0x9f => Instruction::memory(Load, 13, bit(high)),
        0xb2 | 0xba => Instruction::new(Shifted, bit(low)),
        0xb4 | 0xb5 => Instruction::memory(StoreMultiple((first & 0x1ff).count_ones()), 13, 0),
        0xb6 => Instruction::new(Special, 0),
        0xbc | 0xbd => Instruction::memory(LoadMultiple((first & 0x1ff).count_ones()), 13, list),
        0xc0..=0xc7 => Instruction::memory(StoreMultiple(list.count_ones()), high, bit(high)),
        0xc8..=0xcf => Instruction::memory(LoadMultiple(list.count_ones()), high, bit(high) | list),
        _ => Instruction::new(Branch, 0),
    }
}

/// Those of 32 bits (A5.3).
fn wide(first: u16, second: u16) -> Instruction {
    match first {
        _ if first & 0xec00 == 0xec00 => float(first, second),
        _ if first & 0xfe40 == 0xe800 => multiple(first, second),
        _ if first & 0xfe40 == 0xe840 => dual(first, second),
        _ if first & 0xfe00 == 0xf800 => single(first, second),
        _ if first & 0xf800 == 0xf000 && second >> 15 == 1 => control(first, second),
        _ => arithmetic(first, second),
    }
}

fn arithmetic(first: u16, second: u16) -> Instruction {
    use Class::*;
    let (upper, lower) = (bit(second >> 12), bit(second >> 8));
    let shifts = match first >> 8 {
        // Of moves, shifts are no more than moves.
        0xea | 0xeb => first & 15 != 15 && second & 0x70f0 != 0,
        // Bit fields and saturation.
        0xf3 => true,
        // Extensions, reversals, SIMD; not shifts by registers.
        0xfa => first & 0x80 != 0 || second & 0x80 != 0,
        _ => false,
    };
    match first {
        // ADD and SUB of constants, of two lengths; MOVT.
        _ if matches!(first & 0xfbe0, 0xf100 | 0xf1a0 | 0xf200 | 0xf2a0) => Instruction::near(first, lower),
        _ if first & 0xfbf0 == 0xf2c0 => {
            let half = first << 12 | (first & 1 << 10) << 1 | second >> 4 & 0x700 | second & 0xff;
            Instruction {
                made: Some(Made::Upper(half)),
                ..Instruction::new(Integer, lower)
            }
        }
        _ if shifts => Instruction::new(Shifted, lower),
        _ if first & 0xffd0 == 0xfb90 && second & 0xf0 == 0xf0 => Instruction::new(Divide, lower),
        _ if first & 0xff00 == 0xfb00 => Instruction::new(Multiply, upper | lower),
        _ => Instruction::new(Integer, lower),
    }
}

/// Several registers (A5.3.5).
fn multiple(first: u16, list: u16) -> Instruction {
    let (base, registers) = (first & 15, list.count_ones());
    let written_back = if first & 1 << 5 != 0 { bit(base) } else { 0 };
    if first & 1 << 4 != 0 {
        Instruction::memory(Class::LoadMultiple(registers), base, written_back | list)
    } else {
        Instruction::memory(Class::StoreMultiple(registers), base, written_back)
    }
}

/// Two registers, exclusive accesses, and tables of branches (A5.3.6).
fn dual(first: u16, second: u16) -> Instruction {
    let base = first & 15;
    let written_back = if first & 1 << 5 != 0 { bit(base) } else { 0 };
    let results = bit(second >> 12) | bit(second >> 8);
    // Neither indexed before nor written back.
    let is_exclusive = first & 0x0120 == 0;
    match (first & 1 << 4 != 0, is_exclusive) {
        (true, true) => Instruction::memory(Class::LoadPart, base, results),
        (false, true) => Instruction::memory(Class::StorePart, base, results | bit(second)),
        (true, false) => Instruction::memory(Class::LoadTwo, base, results | written_back),
        (false, false) => Instruction::memory(Class::StoreTwo, base, written_back),
    }
}

/// One register (A5.3.7 to A5.3.10).
fn single(first: u16, second: u16) -> Instruction {
    let (base, register) = (first & 15, bit(second >> 12));
    // Only the form with 8 bits of offset writes its base back.
    let has_short_offset = first & 1 << 7 == 0 && second & 1 << 11 != 0;
    let written_back = if has_short_offset && second & 1 << 8 != 0 {
        bit(base)
    } else {
        0
    };
    let is_word = first & 0x60 == 0x40;
    match (first & 1 << 4 != 0, is_word) {
        (true, true) => Instruction::memory(Class::Load, base, register | written_back),
        (true, false) => Instruction::memory(Class::LoadPart, base, register | written_back),
        (false, true) => Instruction::memory(Class::Store, base, written_back),
        (false, false) => Instruction::memory(Class::StorePart, base, written_back),
    }
}

/// Branches and control (A5.3.4).
fn control(first: u16, second: u16) -> Instruction {
    let class = match (first, second >> 4 & 15) {
        _ if second & 0x5000 != 0 || first & 0x380 != 0x380 => Class::Branch,
        (0xf3bf, 4 | 5) => Class::Barrier,
        (0xf3bf, 6) => Class::Flush,
        (0xf3af, _) => Class::Integer,
        _ => Class::Special,
    };
    Instruction::new(class, bit(14) | bit(second >> 8))
}

/// Floating point (A6).
fn float(first: u16, second: u16) -> Instruction {
    use Class::*;
    let register = first & 15;
    let by_precision = |single, double| if second & 1 << 8 != 0 { double } else { single };
    let class = match first & 0xb0 {
        _ if first & 1 << 9 == 0 => return float_memory(first, second),
        // Moves from and to the core's registers.
        _ if second & 1 << 4 != 0 => return Instruction::new(Float, bit(second >> 12)),
        // Selections, minima and maxima, roundings.
        _ if first & 1 << 12 != 0 => by_precision(Float, Double),
        0x00 | 0x10 | 0x90 | 0xa0 => by_precision(FloatFused, DoubleFused),
        0x20 => by_precision(Float, DoubleMultiply),
        0x80 => by_precision(FloatDivide, DoubleDivide),
        // Square root.
        0xb0 if register == 1 && second & 0xc0 == 0xc0 => by_precision(FloatDivide, DoubleDivide),
        _ => by_precision(Float, Double),
    };
    Instruction::new(class, 0)
}

/// Loads and stores of floats, and moves of two registers of the core (A6.5, A6.7).
fn float_memory(first: u16, second: u16) -> Instruction {
    use Class::*;
    let base = first & 15;
    if first & 0x0fe0 == 0x0c40 {
        return Instruction::new(Float, bit(second >> 12) | bit(base));
    }
    let is_load = first & 1 << 4 != 0;
    let is_double = second & 1 << 8 != 0;
    // Indexed and not written back: one register.
    if first & 0x0120 == 0x0100 {
        let class = match (is_load, is_double) {
            (true, true) => LoadTwo,
            (true, false) => Load,
            (false, true) => StoreTwo,
            (false, false) => Store,
        };
        return Instruction::memory(class, base, 0).in_one();
    }
    let words = u32::from(second & 0xff);
    let class = if is_load {
        LoadMultiple(words)
    } else {
        StoreMultiple(words)
    };
    let written_back = if first & 1 << 5 != 0 { bit(base) } else { 0 };
    Instruction::memory(class, base, written_back)
}

#[cfg(test)]
mod tests {
    use super::*;
    use Class::*;

    /// Half-words, what a disassembler says, and class.
    const KNOWN: [(u16, u16, &str, Class); 54] = [
        (0x2200, 0, "movs r2, #0", Integer),
        (0x4281, 0, "cmp r1, r0", Integer),
        (0x1840, 0, "adds r0, r0, r1", Integer),
        (0xbf08, 0, "it eq", Integer),
        (0xbf00, 0, "nop", Integer),
        (0xf240, 0x1023, "movw r0, #0x123", Integer),
        (0xea4f, 0x1001, "lsl.w r0, r1, #4", Integer),
        (0xfa00, 0xf001, "lsl.w r0, r0, r1", Integer),
        (0xeb00, 0x1001, "add.w r0, r0, r1, lsl #4", Shifted),
        (0xb2c0, 0, "uxtb r0, r0", Shifted),
        (0xf3c1, 0x1003, "ubfx r0, r1, #4, #4", Shifted),
        (0xfab0, 0xf080, "clz r0, r0", Shifted),
        (0x4348, 0, "muls r0, r1, r0", Multiply),
        (0xfba0, 0x0101, "umull r0, r1, r0, r1", Multiply),
        (0xfb00, 0x2001, "mla r0, r0, r1, r2", Multiply),
        (0xfbb0, 0xf0f1, "udiv r0, r0, r1", Divide),
        (0xfb90, 0xf0f1, "sdiv r0, r0, r1", Divide),
        (0x480e, 0, "ldr r0, [pc, #56]", Load),
        (0x6808, 0, "ldr r0, [r1]", Load),
        (0x9801, 0, "ldr r0, [sp, #4]", Load),
        (0xf8d1, 0x0100, "ldr.w r0, [r1, #256]", Load),
        (0xed91, 0x0a00, "vldr s0, [r1]", Load),
        (0x7808, 0, "ldrb r0, [r1]", LoadPart),
        (0xf9b1, 0x0000, "ldrsh.w r0, [r1]", LoadPart),
        (0xe850, 0x0f00, "ldrex r0, [r0]", LoadPart),
        (0xe8df, 0xf000, "tbb [pc, r0]", LoadPart),
        (0x6008, 0, "str r0, [r1]", Store),
        (0xf841, 0x0b04, "str r0, [r1], #4", Store),
        (0x8008, 0, "strh r0, [r1]", StorePart),
        (0xe841, 0x0200, "strex r2, r0, [r1]", StorePart),
        (0xbd70, 0, "pop {r4, r5, r6, pc}", LoadMultiple(4)),
        (0xc905, 0, "ldm r1!, {r0, r2}", LoadMultiple(2)),
        (0xe9d1, 0x0200, "ldrd r0, r2, [r1]", LoadTwo),
        (0xed91, 0x0b00, "vldr d0, [r1]", LoadTwo),
        (0xecbd, 0x8b04, "vpop {d8, d9}", LoadMultiple(4)),
        (0xe9c1, 0x0200, "strd r0, r2, [r1]", StoreTwo),
        (0xed81, 0x0b00, "vstr d0, [r1]", StoreTwo),
        (0xb5f0, 0, "push {r4, r5, r6, r7, lr}", StoreMultiple(5)),
        (0xe92d, 0x4ff0, "push.w {r4-r11, lr}", StoreMultiple(9)),
        (0xd0fe, 0, "beq", Branch),
        (0x4770, 0, "bx lr", Branch),
        (0xb100, 0, "cbz r0", Branch),
        (0xf000, 0xf898, "bl", Branch),
        (0xf380, 0x8811, "msr basepri, r0", Special),
        (0xb672, 0, "cpsid i", Special),
        (0xf3bf, 0x8f6f, "isb", Flush),
        (0xf3bf, 0x8f5f, "dmb", Barrier),
        (0xee30, 0x0a01, "vadd.f32 s0, s0, s2", Float),
        (0xeea0, 0x0a01, "vfma.f32 s0, s0, s2", FloatFused),
        (0xeeb1, 0x0ac0, "vsqrt.f32 s0, s0", FloatDivide),
        (0xee30, 0x0b01, "vadd.f64 d0, d0, d1", Double),
        (0xee20, 0x0b01, "vmul.f64 d0, d0, d1", DoubleMultiply),
        (0xee00, 0x0b01, "vmla.f64 d0, d0, d1", DoubleFused),
        (0xee80, 0x0b01, "vdiv.f64 d0, d0, d1", DoubleDivide),
    ];

    #[test]
    fn known_encodings_have_their_classes() {
        for (first, second, text, class) in KNOWN {
            assert_eq!(Instruction::decode(first, second).class, class, "{text}");
        }
    }

    #[test]
    fn registers_are_known_to_be_written() {
        for (first, second, text, writes) in [
            (0x4281, 0, "cmp r1, r0", 0),
            (0x46a4, 0, "mov r12, r4", 1 << 12),
            (0xf841, 0x0b04, "str r0, [r1], #4", 1 << 1),
            (0xe9d1, 0x0200, "ldrd r0, r2, [r1]", 0b101),
            (0xc905, 0, "ldm r1!, {r0, r2}", 0b111),
            (0xed91, 0x0b00, "vldr d0, [r1]", 0),
            (0xee10, 0x3a10, "vmov r3, s0", 1 << 3),
        ] {
            assert_eq!(Instruction::decode(first, second).writes, writes, "{text}");
        }
    }

    #[test]
    fn addresses_are_followed_through_a_block() {
        let mut values = [0, 1, 2].map(Value::First).into_iter().collect::<Vec<_>>();
        values.resize(13, Value::Unknown);
        values.resize(16, Value::Near(0x2000_0000));
        let mut values: [Value; 16] = values.try_into().expect("sixteen");
        for (first, second, text, register, value) in [
            (0xf2c2, 0x4300, "movt r3, #0x2400", 3, Value::Near(0x2400_0000)),
            (0xf103, 0x0410, "add.w r4, r3, #16", 4, Value::Near(0x2400_0000)),
            (0xa801, 0, "add r0, sp, #4", 0, Value::Near(0x2000_0000)),
            (0x460d, 0, "mov r5, r1", 5, Value::First(1)),
            (0x3208, 0, "adds r2, #8", 2, Value::First(2)),
            (0x6809, 0, "ldr r1, [r1]", 1, Value::Unknown),
        ] {
            Instruction::decode(first, second).change(&mut values);
            assert_eq!(values[register], value, "{text}");
        }
    }

    #[test]
    fn it_counts_its_instructions() {
        assert_eq!(instructions_of_it(0xbf08), Some(1));
        assert_eq!(instructions_of_it(0xbf01), Some(4));
        assert_eq!(instructions_of_it(0xbf00), None);
    }
}
