//! Flash and RAM of the firmwares against declared budgets.
//!
//! A budget has a ceiling, so that growth is seen, and a floor, because a firmware that panics early can be
//! optimised to next to nothing and still link.

use crate::firmware::{self, Board, Firmware};
use anyhow::{Context, Result};
use object::{Object, ObjectSection, SectionFlags, SectionKind, elf};
use std::fs;
use std::path::Path;
use std::process::ExitCode;

/// Allowed sizes \[kB\].
struct Budget {
    flash: [u64; 2],
    ram: [u64; 2],
}

/// Flash includes the initial values of data; RAM is static data, the stack has the rest.
fn budget(firmware: Firmware, board: Board) -> Budget {
    match (firmware, board) {
        // Most of the motion board's RAM is the planner: its elements, and the nodes at which it plans the speed.
        // Their initial values are in flash, too.
        (Firmware::Motion, Board::Mps2An500) => Budget {
            flash: [200, 600],
            ram: [100, 300],
        },
        (Firmware::Tracker, Board::Mps2An500) => Budget {
            flash: [120, 300],
            ram: [120, 260],
        },
        (Firmware::Motion, Board::NucleoH723zg) => Budget {
            flash: [200, 600],
            ram: [100, 300],
        },
        (Firmware::Tracker, Board::NucleoH723zg) => Budget {
            flash: [120, 300],
            ram: [120, 260],
        },
    }
}

/// What a firmware occupies [bytes].
#[derive(Debug, Default, PartialEq, Eq)]
struct Size {
    flash: u64,
    ram: u64,
}

/// Addresses of data memory on both boards; below it is code memory.
const RAM_BEGINS: u64 = 0x2000_0000;

/// Builds all firmwares and prints the table; fails when one is outside its budget.
pub fn run() -> Result<ExitCode> {
    let mut rows = Vec::new();
    for (firmware, board) in firmware::ALL {
        rows.push((firmware, board, measure(&firmware::build(firmware, board)?)?));
    }
    println!(
        "{:<18} {:<14} {:>9} {:>13}  {:>9} {:>13}",
        "firmware", "board", "flash kB", "allowed", "RAM kB", "allowed"
    );
    let mut inside = true;
    for (firmware, board, size) in rows {
        let Budget { flash, ram } = budget(firmware, board);
        let flash_ok = fits(size.flash, flash);
        let ram_ok = fits(size.ram, ram);
        println!(
            "{:<18} {:<14} {:>9.1} {:>13}  {:>9.1} {:>13}  {}",
            firmware.package(),
            board.to_string(),
            size.flash as f64 / 1024.0,
            format!("{}…{}", flash[0], flash[1]),
            size.ram as f64 / 1024.0,
            format!("{}…{}", ram[0], ram[1]),
            if flash_ok && ram_ok { "ok" } else { "OUTSIDE" }
        );
        inside &= flash_ok && ram_ok;
    }
    Ok(if inside {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}

fn fits(bytes: u64, [floor, ceiling]: [u64; 2]) -> bool {
    (floor * 1024..=ceiling * 1024).contains(&bytes)
}

fn measure(image: &Path) -> Result<Size> {
    let bytes = fs::read(image).with_context(|| format!("cannot read {}", image.display()))?;
    let file = object::File::parse(&*bytes).with_context(|| format!("{} is no firmware", image.display()))?;
    let mut size = Size::default();
    for section in file.sections() {
        let SectionFlags::Elf { sh_flags } = section.flags() else {
            continue;
        };
        if sh_flags & u64::from(elf::SHF_ALLOC) == 0 {
            continue;
        }
        if section.kind() != SectionKind::UninitializedData {
            size.flash += section.size();
        }
        if section.address() >= RAM_BEGINS {
            size.ram += section.size();
        }
    }
    Ok(size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn budgets_bound_from_both_sides() {
        assert!(!fits(1023, [1, 2]) && fits(1024, [1, 2]));
        assert!(fits(2048, [1, 2]) && !fits(2049, [1, 2]));
    }
}
