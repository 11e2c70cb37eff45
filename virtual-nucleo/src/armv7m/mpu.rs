//! Memory protection (ARMv7-M B3.5), as far as regions that refuse everything.

/// Regions of the Cortex-M7 of the STM32H7 (PM0253, 4.6).
const REGIONS: usize = 16;
const CONTROL_ENABLE: u32 = 1;
const REGION_ENABLE: u32 = 1;
const PERMISSIONS: u32 = 0b111 << 24;

/// The unit.
#[derive(Clone, Debug, Default)]
pub struct Mpu {
    control: u32,
    selected: usize,
    /// Base address and attributes of each region.
    regions: [(u32, u32); REGIONS],
}

impl Mpu {
    /// A register, by its offset from 0xe000ed90.
    pub fn read(&self, offset: u32) -> u32 {
        let (base, attributes) = self.regions[self.selected];
        match offset {
            0x0 => (REGIONS as u32) << 8,
            0x4 => self.control,
            0x8 => self.selected as u32,
            0xc => base,
            _ => attributes,
        }
    }

    /// Sets a register. The error says what is not modelled.
    pub fn write(&mut self, offset: u32, value: u32) -> Result<(), &'static str> {
        match offset {
            0x4 => self.control = value & 7,
            0x8 => self.selected = value as usize % REGIONS,
            0xc => self.regions[self.selected].0 = value & !0x1f,
            0x10 => {
                self.regions[self.selected].1 = value;
                if value & REGION_ENABLE != 0 && value & PERMISSIONS != 0 {
                    return Err("an MPU region with other permissions than none is not modelled");
                }
            }
            _ => return Err("this register of the MPU is not modelled"),
        }
        Ok(())
    }

    /// Whether it refuses every access to `address`.
    pub fn refuses(&self, address: u32) -> bool {
        self.control & CONTROL_ENABLE != 0
            && self.regions.iter().any(|&(base, attributes)| {
                let length = 2_u64 << (attributes >> 1 & 0x1f);
                let offset = u64::from(address.wrapping_sub(base));
                attributes & REGION_ENABLE != 0 && offset < length
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_region_without_permissions_refuses_what_lies_in_it() {
        let mut mpu = Mpu::default();
        mpu.write(0x8, 0).expect("is modelled");
        mpu.write(0xc, 0x1ff8_0000).expect("is modelled");
        mpu.write(0x10, 1 << 28 | 18 << 1 | 1).expect("is modelled");
        assert!(!mpu.refuses(0x1fff_ffff), "it is off");
        mpu.write(0x4, 5).expect("is modelled");
        assert!(mpu.refuses(0x1ff8_0000) && mpu.refuses(0x1fff_ffff));
        assert!(!mpu.refuses(0x1ff7_ffff) && !mpu.refuses(0x2000_0000));
        assert!(mpu.write(0x10, 3 << 24 | 1).is_err());
    }
}
