//! The image as it was linked before the Ethernet buffers were kept out of what Reset clears: the model names the fault.
//!
//! `INSERT AFTER .bss` put the section `.ethernet`, which lies in the memory of domain 2, before the symbol `__ebss`, so that this was the
//! end of those buffers, and Reset cleared from `__sbss` on until it ran off the end of the main memory: a fault before `main`, on
//! both boards. The linker now refuses such an image, so the defect is made in the shipped one: Reset loads `__ebss` from a
//! word behind its instructions, and in that word the end of `.ethernet` is put, as the old line did. All else stays.

mod common;

use common::{causes, shipped};
use object::elf::FileHeader32;
use object::read::elf::ElfFile;
use object::{Endianness, Object, ObjectSection};
use plant_file::{DEFAULT_MACHINE, PlantFile};
use std::fs;
use std::path::Path;
use virtual_nucleo::board::Board;
use virtual_nucleo::image::{FLASH, Image};
use virtual_nucleo::outside::{Machine, Outside, Role};
use virtual_nucleo::pair::{motion_machine, tracker_machine};
use virtual_nucleo::time::Time;

/// First address behind the main memory (RM0468, table 6: AXI SRAM of 320 KB).
const BEHIND: u32 = 0x2405_0000;
/// More than Reset has, with the words behind it.
const RESET_BYTES: u32 = 0x60;

/// End of `.ethernet`, which lies in another memory than the .bss.
fn end_of_buffers(path: &Path) -> u32 {
    let file = fs::read(path).expect("the image is built");
    let elf = ElfFile::<FileHeader32<Endianness>>::parse(&*file).expect("an ELF file");
    let section = elf.section_by_name(".ethernet").expect("a section");
    (section.address() + section.size()) as u32
}

fn image(path: &Path) -> Image {
    Image::read(&fs::read(path).expect("the image is built")).expect("an image")
}

/// The image with `__ebss` as the old line had it.
fn linked_as_before(path: &Path) -> Image {
    let mut image = image(path);
    let address = |name: &str| {
        let found = image.symbols.address(name);
        found.unwrap_or_else(|| panic!("the image has no {name}"))
    };
    let (reset, right, wrong) = (address("Reset"), address("__ebss"), end_of_buffers(path));
    assert!(wrong > BEHIND && right < BEHIND, "{wrong:#x}, {right:#x}");
    let begin = (reset - FLASH) as usize;
    let words = image.flash[begin..begin + RESET_BYTES as usize].chunks_exact_mut(4);
    let mut loaded: Vec<_> = words.filter(|word| **word == right.to_le_bytes()).collect();
    let [word] = &mut loaded[..] else {
        panic!("Reset has {} words with __ebss", loaded.len())
    };
    word.copy_from_slice(&wrong.to_le_bytes());
    image
}

#[test]
fn clearing_off_the_end_of_the_main_memory_is_named_with_address_and_function() {
    let plant = PlantFile::shipped(DEFAULT_MACHINE).expect("a shipped plant");
    for (name, machine) in [
        ("motion", motion_machine as fn(&PlantFile) -> Machine),
        ("tracker", tracker_machine),
    ] {
        let path = shipped(name);
        let mut board =
            Board::new(linked_as_before(&path), Outside::new(machine(&plant)), 1).expect("a board");
        board.run(Time::ms(50));
        let expected = format!("Write at {BEHIND:#010x}: no memory answers there, or it is read-only");
        let findings = board.findings();
        let found = findings.iter().find(|finding| finding.cause == expected);
        let found = found.unwrap_or_else(|| panic!("{name}: {:#?}", causes(&board)));
        println!("{name}: {found}");
        assert!(found.function.starts_with("Reset+"), "{found}");
        assert_eq!(board.first_wait, None, "{name}: main was reached");
        let outside = &board.chip().shared.outside;
        for line in outside
            .outputs()
            .iter()
            .filter(|line| line.role != Role::Converter)
        {
            assert!(!outside.line(line.pin), "{name}: {line} is high");
        }
        // As it is linked now nothing of that kind is found.
        let mut board = Board::new(image(&path), Outside::new(machine(&plant)), 1).expect("a board");
        board.run(Time::ms(50));
        assert!(board.first_wait.is_some(), "{name}");
        assert!(!causes(&board).contains(&expected), "{name}");
    }
}
