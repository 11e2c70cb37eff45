//! The places in a linker script and in an image.

use anyhow::{Context, Result, bail};
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, elf};
use std::collections::BTreeMap;

/// A stretch of a board's memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Region {
    pub name: String,
    pub begin: u64,
    pub end: u64,
}

/// What is put somewhere: a section at its address, or a segment at the address it is loaded to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    pub name: String,
    pub begin: u64,
    pub end: u64,
}

/// What of an image has a place.
#[derive(Clone, Debug, Default)]
pub struct Image {
    /// Sections that take memory while the firmware runs.
    pub sections: Vec<Part>,
    /// What is flashed, by segments.
    pub loads: Vec<Part>,
    pub symbols: BTreeMap<String, u64>,
    /// The vector table: initial stack pointer, then handlers.
    pub vectors: Vec<u64>,
    /// First instruction of the handler of faults.
    pub fault_entry: Option<u16>,
}

/// The regions of a linker script's `MEMORY`.
pub fn regions(script: &str) -> Result<Vec<Region>> {
    let (_, rest) = script.split_once("MEMORY").context("it has no MEMORY")?;
    let (_, rest) = rest.split_once('{').context("MEMORY has no {")?;
    let (lines, _) = rest.split_once('}').context("MEMORY has no }")?;
    lines
        .lines()
        .map(str::trim)
        .filter(|line| !line.is_empty())
        .map(|line| {
            let understood = || {
                let (name, rest) = line.split_once(':')?;
                let (origin, length) = rest.split_once(',')?;
                let begin = sum(origin.trim().strip_prefix("ORIGIN")?)?;
                let length = sum(length.trim().strip_prefix("LENGTH")?)?;
                Some(Region {
                    name: name.trim().to_string(),
                    begin,
                    end: begin + length,
                })
            };
            understood().with_context(|| format!("`{line}` is not `NAME : ORIGIN = NUMBER, LENGTH = NUMBER`"))
        })
        .collect()
}

/// The value of `= 4M - 128K`.
fn sum(text: &str) -> Option<u64> {
    let mut parts = text.trim().strip_prefix('=')?.split('-').map(number);
    let first = parts.next()??;
    parts.try_fold(first, |left, part| left.checked_sub(part?))
}

/// The value of `0x24000000`, `320K`, `1M` or `12`.
fn number(text: &str) -> Option<u64> {
    let text = text.trim();
    if let Some(digits) = text.strip_prefix("0x") {
        return u64::from_str_radix(digits, 16).ok();
    }
    let (digits, unit) = match text.strip_suffix('K') {
        Some(digits) => (digits, 1024),
        None => match text.strip_suffix('M') {
            Some(digits) => (digits, 1024 * 1024),
            None => (text, 1),
        },
    };
    Some(digits.parse::<u64>().ok()? * unit)
}

/// The places of an ELF file.
pub fn image(bytes: &[u8]) -> Result<Image> {
    let file = object::File::parse(bytes)?;
    let mut image = Image::default();
    for section in file.sections() {
        let SectionFlags::Elf { sh_flags } = section.flags() else {
            bail!("it is not an ELF file");
        };
        if sh_flags & u64::from(elf::SHF_ALLOC) == 0 || section.size() == 0 {
            continue;
        }
        let name = section.name()?.to_string();
        if name == ".vector_table" {
            let words = section.data()?.chunks_exact(4);
            image.vectors = words
                .map(|word| u64::from(u32::from_le_bytes([word[0], word[1], word[2], word[3]])))
                .collect();
        }
        image.sections.push(Part {
            name,
            begin: section.address(),
            end: section.address() + section.size(),
        });
    }
    for symbol in file.symbols() {
        let name = symbol.name().unwrap_or_default();
        if symbol.is_global() && !name.is_empty() {
            image.symbols.insert(name.to_string(), symbol.address());
        }
    }
    image.loads = loads(&file)?;
    if let Some(entry) = image.symbols.get("HardFault") {
        // The lowest bit of a function's address is the instruction set's.
        let text = file.section_by_name(".text").context("there is no .text")?;
        let code = text.data_range(entry & !1, 2)?;
        image.fault_entry = code.map(|code| u16::from_le_bytes([code[0], code[1]]));
    }
    Ok(image)
}

/// What of each segment is flashed, where. The object crate gives addresses in memory only.
fn loads(file: &object::File<'_>) -> Result<Vec<Part>> {
    let object::File::Elf32(elf) = file else {
        bail!("it is not a 32-bit ELF file");
    };
    let endian = elf.endian();
    let headers = elf.elf_program_headers().iter();
    Ok(headers
        .filter(|header| header.p_type.get(endian) == elf::PT_LOAD && header.p_filesz.get(endian) > 0)
        .map(|header| {
            let begin = u64::from(header.p_paddr.get(endian));
            Part {
                name: format!("the segment for {:#010x}", header.p_vaddr.get(endian)),
                begin,
                end: begin + u64::from(header.p_filesz.get(endian)),
            }
        })
        .collect())
}

#[cfg(test)]
pub mod tests {
    use super::*;

    pub const SCRIPT: &str = "/* Memory */
MEMORY
{
    FLASH   : ORIGIN = 0x08000000, LENGTH = 1M
    RAM     : ORIGIN = 0x24000000, LENGTH = 320K
    DTCM    : ORIGIN = 0x20000000, LENGTH = 128K
    SRAM_D2 : ORIGIN = 0x30000000, LENGTH = 32K
}
_stack_end = ORIGIN(DTCM);";

    #[test]
    fn regions_are_those_of_the_linker_script() {
        let found = regions(SCRIPT).unwrap();
        let names: Vec<&str> = found.iter().map(|region| region.name.as_str()).collect();
        assert_eq!(names, ["FLASH", "RAM", "DTCM", "SRAM_D2"]);
        assert_eq!((found[1].begin, found[1].end), (0x2400_0000, 0x2405_0000));
        assert_eq!(sum("= 4M - 128K"), Some(4 * 1024 * 1024 - 128 * 1024));
        let error = regions("MEMORY { RAM : ORIGIN = 1G, LENGTH = 2 }").unwrap_err();
        assert!(error.to_string().contains("`RAM : ORIGIN = 1G, LENGTH = 2`"));
    }
}
