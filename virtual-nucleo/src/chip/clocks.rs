//! The clock tree as the registers set it, and what it may not be.

/// The 8 MHz that the ST-LINK gives (UM2407, 6.8.1).
const HSE_HZ: u64 = 8_000_000;
/// Internal oscillators (RM0468, 8.5.2).
const HSI_HZ: u64 = 64_000_000;
const CSI_HZ: u64 = 4_000_000;
/// Of the watchdog (DS13313, 6.3.11).
pub const LSI_HZ: u64 = 32_000;

/// Registers that make the tree.
#[derive(Clone, Copy, Debug, Default)]
pub struct Settings {
    /// RCC_CFGR.
    pub cfgr: u32,
    /// RCC_D1CFGR, RCC_D2CFGR, RCC_D3CFGR.
    pub domains: [u32; 3],
    /// RCC_PLLCKSELR.
    pub pll_source: u32,
    /// RCC_PLLCFGR.
    pub pll_config: u32,
    /// RCC_PLL1DIVR.
    pub pll1_dividers: u32,
    /// Voltage scaling, 0 is the highest.
    pub scale: u8,
    /// FLASH_ACR.
    pub flash_access: u32,
}

/// Frequencies \[Hz\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Clocks {
    /// Input of PLL1.
    pub pll1_input: u64,
    /// Oscillator of PLL1.
    pub pll1_vco: u64,
    /// Output Q of PLL1, which clocks SPI1 to SPI3 after a reset.
    pub pll1_q: u64,
    /// The core.
    pub core: u64,
    /// AXI and AHB.
    pub bus: u64,
    /// APB1 to APB4.
    pub apb: [u64; 4],
    /// Timers of APB1 and of APB2.
    pub timers: [u64; 2],
}

/// Highest frequencies for each voltage scaling: core, bus, APB (DS13313, table 24). 550 MHz need CPU_FREQ_BOOST.
const HIGHEST: [[u64; 3]; 4] = [
    [520_000_000, 275_000_000, 137_500_000],
    [400_000_000, 200_000_000, 100_000_000],
    [300_000_000, 150_000_000, 75_000_000],
    [170_000_000, 85_000_000, 42_500_000],
];
/// Highest bus frequency for 0, 1, 2 and 3 wait states of the flash memory, for each voltage scaling (RM0468, table 16).
const FLASH_WAITS: [[u64; 4]; 4] = [
    [70_000_000, 140_000_000, 210_000_000, 275_000_000],
    [67_000_000, 133_000_000, 200_000_000, 200_000_000],
    [50_000_000, 100_000_000, 150_000_000, 150_000_000],
    [35_000_000, 70_000_000, 85_000_000, 85_000_000],
];
/// Input ranges of a PLL by PLLRGE (RM0468, 8.7.11).
const PLL_INPUT: [(u64, u64); 4] = [
    (1_000_000, 2_000_000),
    (2_000_000, 4_000_000),
    (4_000_000, 8_000_000),
    (8_000_000, 16_000_000),
];
/// Ranges of its oscillator: wide, medium (DS13313, tables 54 and 55).
const PLL_VCO: [(u64, u64); 2] = [(192_000_000, 836_000_000), (150_000_000, 420_000_000)];

impl Clocks {
    /// What the registers say.
    pub fn of(settings: &Settings) -> Self {
        let source = match settings.pll_source & 3 {
            0 => HSI_HZ,
            1 => CSI_HZ,
            2 => HSE_HZ,
            _ => 0,
        };
        let divider = u64::from(settings.pll_source >> 4 & 63);
        let pll1_input = source.checked_div(divider).unwrap_or(0);
        let dividers = settings.pll1_dividers;
        let pll1_vco = pll1_input * (u64::from(dividers & 0x1ff) + 1);
        let output = |shift: u32| pll1_vco / (u64::from(dividers >> shift & 0x7f) + 1);
        let system = match settings.cfgr >> 3 & 7 {
            0 => HSI_HZ,
            1 => CSI_HZ,
            2 => HSE_HZ,
            _ => output(9),
        };
        let [d1, d2, d3] = settings.domains;
        let core = system / by_four_bits(d1 >> 8);
        let bus = core / by_four_bits(d1);
        let prescalers = [d2 >> 4, d2 >> 8, d1 >> 4, d3 >> 4].map(by_three_bits);
        let timer = |prescaler: u64| {
            let doubled = settings.cfgr & 1 << 15 != 0;
            // RM0468, table 57.
            match (doubled, prescaler) {
                (false, 1 | 2) | (true, 1 | 2 | 4) => bus,
                (false, prescaler) => 2 * bus / prescaler,
                (true, prescaler) => 4 * bus / prescaler,
            }
        };
        Self {
            pll1_input,
            pll1_vco,
            pll1_q: output(16),
            core,
            bus,
            apb: prescalers.map(|prescaler| bus / prescaler),
            timers: [timer(prescalers[0]), timer(prescalers[1])],
        }
    }

    /// Each limit that is broken, as a sentence.
    pub fn violations(&self, settings: &Settings) -> Vec<String> {
        let scale = usize::from(settings.scale).min(3);
        let mut violations = Vec::new();
        let highest = HIGHEST[scale];
        let apb = self.apb.into_iter().max().unwrap_or(0);
        for (what, hz, most) in [
            ("the core", self.core, highest[0]),
            ("AXI and AHB", self.bus, highest[1]),
            ("an APB", apb, highest[2]),
        ] {
            if hz > most {
                violations.push(format!(
                    "{what} would run at {hz} Hz: at voltage scaling VOS{scale} {most} Hz are the most"
                ));
            }
        }
        let waits = FLASH_WAITS[scale].iter().position(|most| self.bus <= *most);
        let set = settings.flash_access & 0xf;
        if let Some(waits) = waits.filter(|waits| set < *waits as u32) {
            violations.push(format!(
                "the flash memory has {set} wait states: at {} Hz and VOS{scale} it needs {waits}",
                self.bus
            ));
        }
        violations
    }

    /// What is wrong with PLL1 as it is switched on.
    pub fn pll1_violations(&self, settings: &Settings) -> Vec<String> {
        let mut violations = Vec::new();
        let (least, most) = PLL_INPUT[(settings.pll_config >> 2 & 3) as usize];
        let hz = self.pll1_input;
        if !(least..=most).contains(&hz) {
            violations.push(format!(
                "PLL1 gets {hz} Hz: PLL1RGE is set for {least} to {most} Hz"
            ));
        }
        let (least, most) = PLL_VCO[(settings.pll_config >> 1 & 1) as usize];
        let hz = self.pll1_vco;
        if !(least..=most).contains(&hz) {
            violations.push(format!(
                "the oscillator of PLL1 would run at {hz} Hz: PLL1VCOSEL is set for {least} to {most} Hz"
            ));
        }
        violations
    }
}

/// Divider of the core and of the bus.
fn by_four_bits(bits: u32) -> u64 {
    match bits & 0xf {
        0..8 => 1,
        8 => 2,
        9 => 4,
        10 => 8,
        11 => 16,
        12 => 64,
        13 => 128,
        14 => 256,
        _ => 512,
    }
}

/// Divider of an APB.
fn by_three_bits(bits: u32) -> u64 {
    match bits & 7 {
        0..4 => 1,
        more => 2 << (more - 4),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The board's setting: 8 MHz / 4 × 260, buses at half, APBs at a quarter.
    const BOARD: Settings = Settings {
        cfgr: 3 << 3,
        domains: [8 | 4 << 4, 4 << 4 | 4 << 8, 4 << 4],
        pll_source: 4 << 4 | 2,
        pll_config: 1 << 2,
        pll1_dividers: 259 | 8 << 16,
        scale: 0,
        flash_access: 3,
    };

    #[test]
    fn the_boards_setting_is_520_mhz_within_all_limits() {
        let clocks = Clocks::of(&BOARD);
        assert_eq!(
            (clocks.core, clocks.bus, clocks.apb[0]),
            (520_000_000, 260_000_000, 130_000_000)
        );
        assert_eq!((clocks.timers, clocks.pll1_q), ([260_000_000; 2], 57_777_777));
        assert_eq!(clocks.violations(&BOARD), Vec::<String>::new());
        assert_eq!(clocks.pll1_violations(&BOARD), Vec::<String>::new());
    }

    #[test]
    fn every_limit_that_is_broken_is_named() {
        let broken = |change: fn(&mut Settings)| {
            let mut settings = BOARD;
            change(&mut settings);
            let clocks = Clocks::of(&settings);
            [clocks.violations(&settings), clocks.pll1_violations(&settings)]
                .concat()
                .join("; ")
        };
        for (text, change) in [
            ("VOS1 400000000 Hz", (|s| s.scale = 1) as fn(&mut Settings)),
            ("AXI and AHB would run at 520000000 Hz", |s| s.domains[0] &= !0xf),
            ("2 wait states: at 260000000 Hz and VOS0 it needs 3", |s| {
                s.flash_access = 2
            }),
            ("PLL1 gets 2000000 Hz: PLL1RGE", |s| s.pll_config |= 2 << 2),
            ("the oscillator of PLL1 would run at 520000000 Hz", |s| {
                s.pll_config |= 2
            }),
            ("PLL1 gets 0 Hz", |s| s.pll_source &= 3),
        ] {
            let found = broken(change);
            assert!(found.contains(text), "{text:?} is not in {found:?}");
        }
    }
}
