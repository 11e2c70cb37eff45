//! The 24-bit frame: `R/W 0 REG2..0 A2..0 D15..0`, most significant bit first.

/// Bytes of a frame.
pub const FRAME_BYTES: usize = 3;

const READ: u8 = 1 << 7;

/// One of a chip's four outputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Channel {
    /// VOUTA.
    A = 0,
    /// VOUTB.
    B = 1,
    /// VOUTC.
    C = 2,
    /// VOUTD.
    D = 3,
}

/// What a frame addresses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Register {
    /// Does nothing; clocks the answer of a read out.
    NoOperation,
    /// Outputs and data registers go to 0 V, as a CLR pulse would do.
    Clear,
    /// Outputs take what was shifted in, as an LDAC pulse would do.
    Load,
    /// Input register of a channel: the code to be loaded, two's complement.
    Data(Channel),
    /// Coarse gain of a channel, see [`CoarseGain`].
    CoarseGain(Channel),
    /// Fine gain of a channel, −32…31 steps of the lowest bit at full scale.
    FineGain(Channel),
    /// Offset of a channel, −128…127 steps of an eighth of the lowest bit.
    Offset(Channel),
}

impl Register {
    fn address(self) -> u8 {
        let (register, address) = match self {
            Self::NoOperation => (0b000, 0b000),
            Self::Clear => (0b000, 0b100),
            Self::Load => (0b000, 0b101),
            Self::Data(channel) => (0b010, channel as u8),
            Self::CoarseGain(channel) => (0b011, channel as u8),
            Self::FineGain(channel) => (0b100, channel as u8),
            Self::Offset(channel) => (0b101, channel as u8),
        };
        register << 3 | address
    }

    /// The frame that writes `data` to this register.
    pub fn write_frame(self, data: u16) -> [u8; FRAME_BYTES] {
        let [high, low] = data.to_be_bytes();
        [self.address(), high, low]
    }

    /// The frame that asks for this register; the answer comes with the next frame.
    pub fn read_frame(self) -> [u8; FRAME_BYTES] {
        [READ | self.address(), 0, 0]
    }
}

/// Output range of a channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u16)]
pub enum CoarseGain {
    /// ±10 V, the state after power-up.
    #[default]
    V10 = 0b00,
    /// ±10.2564 V.
    V10_2564 = 0b01,
    /// ±10.5263 V.
    V10_5263 = 0b10,
}
