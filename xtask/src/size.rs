//! Flash and RAM of the firmwares against declared budgets, and whether each part of an image lies in its memory.
//!
//! A budget has a ceiling, so that growth is seen, and a floor, because a firmware that panics early can be
//! optimised to next to nothing and still link.

use crate::firmware::{self, Board, Firmware};
use crate::layout;
use anyhow::{Context, Result};
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SectionKind, elf};
use std::fs;
use std::path::Path;
use std::process::ExitCode;

/// Allowed sizes \[kB\].
struct Budget {
    flash: [u64; 2],
    ram: [u64; 2],
    /// The controller's part of the RAM; on the motion board nearly all of it is the planner.
    controller: [u64; 2],
}

/// Flash includes the initial values of data; RAM is static data, the stack has the rest.
fn budget(firmware: Firmware, board: Board) -> Budget {
    match (firmware, board) {
        // Most of the motion board's RAM is the planner: its elements, and the nodes at which it plans the speed.
        // Their initial values are in flash, too. The NUCLEO has 1 MB of flash and 320 kB of RAM, and the stack elsewhere.
        (Firmware::Motion, Board::Mps2An500 | Board::NucleoH723zg) => Budget {
            flash: [200, 700],
            ram: [100, 345],
            controller: [100, 240],
        },
        (Firmware::Tracker, Board::Mps2An500 | Board::NucleoH723zg) => Budget {
            flash: [120, 300],
            ram: [120, 260],
            controller: [60, 170],
        },
    }
}

/// What a firmware occupies [bytes].
#[derive(Debug, Default, PartialEq, Eq)]
struct Size {
    flash: u64,
    ram: u64,
    controller: u64,
}

/// What the name of the static contains that holds a firmware's controller: `controller` in its `init`.
const CONTROLLER: &str = "local_init_controller";

/// Addresses of data memory on both boards; below it is code memory.
const RAM_BEGINS: u64 = 0x2000_0000;

/// Builds all firmwares and prints the table; fails when one is outside its budget, or not where its board has memory.
pub fn run() -> Result<ExitCode> {
    let mut rows = Vec::new();
    let mut misplaced = Vec::new();
    for board in Board::ALL {
        let images = firmware::build(Firmware::ALL, board)?;
        for (firmware, image) in Firmware::ALL.into_iter().zip(images) {
            rows.push((firmware, board, measure(&image)?));
            let findings = layout::check(&image, board)?.into_iter();
            misplaced.extend(findings.map(|finding| format!("{} on {board}: {finding}", firmware.package())));
        }
    }
    println!(
        "{:<18} {:<14} {:>9} {:>9}  {:>9} {:>9}  {:>16} {:>9}",
        "firmware", "board", "flash kB", "allowed", "RAM kB", "allowed", "its controller", "allowed"
    );
    let mut inside = true;
    for (firmware, board, size) in rows {
        let budget = budget(firmware, board);
        let parts = [
            (size.flash, budget.flash),
            (size.ram, budget.ram),
            (size.controller, budget.controller),
        ];
        let ok = parts.iter().all(|(bytes, allowed)| fits(*bytes, *allowed));
        let [flash, ram, controller] = parts.map(|(bytes, _)| bytes as f64 / 1024.0);
        let [flash_allowed, ram_allowed, controller_allowed] =
            parts.map(|(_, [floor, ceiling])| format!("{floor}…{ceiling}"));
        println!(
            "{:<18} {:<14} {flash:>9.1} {flash_allowed:>9}  {ram:>9.1} {ram_allowed:>9}  {controller:>16.1} \
             {controller_allowed:>9}  {}",
            firmware.package(),
            board.to_string(),
            if ok { "ok" } else { "OUTSIDE" }
        );
        inside &= ok;
    }
    for finding in &misplaced {
        println!("MISPLACED: {finding}");
    }
    Ok(if inside && misplaced.is_empty() {
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
    let file =
        object::File::parse(&*bytes).with_context(|| format!("{} is not a firmware", image.display()))?;
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
    let statics = file
        .symbols()
        .filter(|symbol| symbol.name().is_ok_and(|name| name.contains(CONTROLLER)));
    size.controller = statics.map(|symbol| symbol.size()).sum();
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
