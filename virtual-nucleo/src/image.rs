//! The flashed image: an ELF file.

use object::elf::{FileHeader32, PT_LOAD};
use object::read::elf::{ElfFile, ElfSymbol32, ProgramHeader};
use object::{Endianness, Object, ObjectSymbol, SymbolKind};
use std::collections::BTreeMap;
use thiserror::Error;

/// Why an image cannot be used.
#[derive(Debug, Error)]
pub enum ImageError {
    /// It is no ELF file of 32 bits, or a damaged one.
    #[error("the image is not an ELF file of a 32-bit processor: {0}")]
    Format(#[from] object::Error),
    /// A part of it does not lie in flash.
    #[error("the image has {length} bytes at {address:#010x}, which is not in the flash memory")]
    Outside {
        /// Where the part begins.
        address: u32,
        /// Its length.
        length: usize,
    },
}

/// What is flashed, and its symbols.
#[derive(Debug)]
pub struct Image {
    /// Contents of the flash memory from its first address on.
    pub flash: Vec<u8>,
    /// Names of its functions.
    pub symbols: Symbols,
}

/// First address of the flash memory (RM0468, 2.4).
pub const FLASH: u32 = 0x0800_0000;
/// Bytes of the flash memory.
pub const FLASH_LENGTH: usize = 1 << 20;

impl Image {
    /// Takes what an ELF file loads, at its load addresses.
    pub fn read(file: &[u8]) -> Result<Self, ImageError> {
        let elf = ElfFile::<FileHeader32<Endianness>>::parse(file)?;
        let endian = elf.endian();
        let mut flash = vec![0xff; FLASH_LENGTH];
        for header in elf.elf_program_headers() {
            if header.p_type(endian) != PT_LOAD {
                continue;
            }
            let (address, data) = (
                header.p_paddr(endian),
                header.data(endian, file).unwrap_or_default(),
            );
            if data.is_empty() {
                continue;
            }
            let outside = ImageError::Outside {
                address,
                length: data.len(),
            };
            let begin = address.checked_sub(FLASH).map(|begin| begin as usize);
            let place = begin.and_then(|begin| flash.get_mut(begin..begin + data.len()));
            place.ok_or(outside)?.copy_from_slice(data);
        }
        let functions = elf.symbols().filter(|symbol| symbol.kind() == SymbolKind::Text);
        let mut symbols = Symbols::of(functions.map(|symbol| {
            let name = symbol.name().unwrap_or("?");
            (symbol.address() as u32 & !1, symbol.size() as u32, name)
        }));
        let marks = elf.symbols().filter(|symbol| symbol.kind() != SymbolKind::Text);
        let named =
            |symbol: ElfSymbol32<'_, '_>| Some((symbol.name().ok()?.to_owned(), symbol.address() as u32));
        symbols.addresses.extend(marks.filter_map(named));
        Ok(Self { flash, symbols })
    }
}

/// Names of functions by address.
#[derive(Debug, Default)]
pub struct Symbols {
    /// Addresses of everything by its name in the source.
    addresses: BTreeMap<String, u32>,
    /// First address, length and name, ordered.
    functions: Vec<(u32, u32, String)>,
}

impl Symbols {
    /// Functions with first address, length and name as the linker gives it.
    pub fn of<'a>(functions: impl IntoIterator<Item = (u32, u32, &'a str)>) -> Self {
        let mut functions: Vec<_> = functions
            .into_iter()
            .map(|(begin, length, name)| (begin, length, format!("{:#}", rustc_demangle::demangle(name))))
            .collect();
        functions.sort();
        let addresses = functions
            .iter()
            .map(|(begin, _, name)| (name.clone(), *begin))
            .collect();
        Self { addresses, functions }
    }

    /// Address of what has this name; of two with the same name, of one of them.
    pub fn address(&self, name: &str) -> Option<u32> {
        self.addresses.get(name).copied()
    }

    /// The function at `pc`, and how far in it that is.
    pub fn name(&self, pc: u32) -> String {
        let next = self.functions.partition_point(|(begin, ..)| *begin <= pc);
        match next.checked_sub(1).map(|at| &self.functions[at]) {
            Some((begin, _, name)) if *begin == pc => name.clone(),
            Some((begin, length, name)) if pc - begin < *length => format!("{name}+{:#x}", pc - begin),
            _ => "no function".to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_named_by_the_function_it_lies_in() {
        let symbols = Symbols::of([
            (0x200, 0x10, "main"),
            (0x100, 0x10, "_ZN4core3fmt5write17h0123456789abcdefE"),
        ]);
        assert_eq!(symbols.name(0x100), "core::fmt::write");
        assert_eq!(symbols.name(0x204), "main+0x4");
        assert_eq!(symbols.name(0x210), "no function");
        assert_eq!(symbols.name(0x10), "no function");
    }

    #[test]
    fn what_is_no_image_is_an_error() {
        assert!(matches!(Image::read(b"\x7fELF"), Err(ImageError::Format(_))));
    }
}
