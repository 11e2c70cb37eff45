//! Whether a firmware's image lies where its board has memory.
//!
//! The regions are read from the board's own `regions.x`, so linker and check know the same ones. What the linker
//! scripts assert is checked here again from what came out: a script that is wrong asserts wrongly, too.

mod read;

use crate::firmware::Board;
use anyhow::{Context, Result};
use read::{Image, Part, Region};
use std::fs;
use std::path::Path;

/// Region of each section by its name; of one that is not named here, only that it lies in a single region.
const PLACES: [(&str, &str); 7] = [
    (".vector_table", "FLASH"),
    (".text", "FLASH"),
    (".rodata", "FLASH"),
    (".data", "RAM"),
    (".bss", "RAM"),
    (".uninit", "RAM"),
    (".ethernet", "SRAM_D2"),
];

/// What Reset works through, and the stack: pairs of symbols with one region between them, and the section that
/// lies there and nothing else, where Reset copies or clears it.
const SPANS: [(&str, &str, Option<&str>); 4] = [
    ("__sdata", "__edata", Some(".data")),
    ("__sbss", "__ebss", Some(".bss")),
    ("__suninit", "__euninit", None),
    ("_stack_end", "_stack_start", None),
];

/// What is wrong with the layout of the `image` of a `board`, one sentence each.
pub fn check(image: &Path, board: Board) -> Result<Vec<String>> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .context("xtask lies in the workspace")?
        .join(format!("boards/{board}/regions.x"));
    let text = fs::read_to_string(&script).with_context(|| format!("cannot read {}", script.display()))?;
    let regions = read::regions(&text).with_context(|| format!("{} is not understood", script.display()))?;
    let bytes = fs::read(image).with_context(|| format!("cannot read {}", image.display()))?;
    let image = read::image(&bytes).with_context(|| format!("{} is not a firmware", image.display()))?;
    Ok(findings(&image, &regions))
}

/// The one region that holds `part`.
fn region_of<'a>(regions: &'a [Region], part: &Part) -> Option<&'a Region> {
    regions
        .iter()
        .find(|region| region.begin <= part.begin && part.begin <= part.end && part.end <= region.end)
}

/// What is wrong with the place of `part`, which is to lie in one region, or in the region that is `wanted`.
fn misplaced(part: &Part, wanted: Option<&str>, regions: &[Region]) -> Option<String> {
    let Part { name, begin, end } = part;
    let what = format!("{name} ({begin:#010x} to {end:#010x})");
    match (region_of(regions, part), wanted) {
        (None, _) => Some(format!("{what} lies in no single region of the board's memory")),
        (Some(region), Some(wanted)) if region.name != wanted => {
            Some(format!("{what} lies in {} instead of {wanted}", region.name))
        }
        _ => None,
    }
}

fn findings(image: &Image, regions: &[Region]) -> Vec<String> {
    let mut findings = Vec::new();
    for section in &image.sections {
        let known = PLACES.iter().find(|(name, _)| *name == section.name);
        findings.extend(misplaced(section, known.map(|(_, region)| *region), regions));
    }
    for load in &image.loads {
        findings.extend(misplaced(load, Some("FLASH"), regions));
    }
    for (begin, end, copied) in SPANS {
        let symbols = image.symbols.get(begin).zip(image.symbols.get(end));
        let Some((&from, &to)) = symbols else {
            findings.push(format!("the image has no symbols {begin} and {end}"));
            continue;
        };
        let name = format!("{begin} to {end}");
        let span = Part {
            name,
            begin: from,
            end: to,
        };
        findings.extend(misplaced(&span, None, regions));
        let section = image
            .sections
            .iter()
            .find(|section| Some(section.name.as_str()) == copied);
        if section.is_some_and(|section| (section.begin, section.end) != (from, to)) {
            let section = copied.unwrap_or_default();
            findings.push(format!(
                "{begin} to {end} is not {section}, which Reset copies or clears"
            ));
        }
    }
    overlaps(image, &mut findings);
    guard(image, regions, &mut findings);
    handlers(image, &mut findings);
    findings
}

/// The stack is of memory as a section is, though none holds it.
fn overlaps(image: &Image, findings: &mut Vec<String>) {
    let mut parts = image.sections.clone();
    if let (Some(&begin), Some(&end)) = (image.symbols.get("_stack_end"), image.symbols.get("_stack_start")) {
        let name = "the stack".to_string();
        parts.push(Part { name, begin, end });
    }
    parts.sort_by_key(|part| (part.begin, part.end));
    for pair in parts.windows(2) {
        if pair[1].begin < pair[0].end {
            findings.push(format!("{} and {} overlap", pair[0].name, pair[1].name));
        }
    }
}

/// Entries of the vector table: the stack's top, what Reset enters, and one way for all faults.
const VECTORS: [(usize, &str); 6] = [
    (0, "_stack_start"),
    (1, "Reset"),
    (3, "HardFault"),
    (4, "HardFault"),
    (5, "HardFault"),
    (6, "HardFault"),
];

/// `cpsid i`: how the entry of faults begins that pushes nothing on the stack it may have lost.
const FAULT_ENTRY: u16 = 0xb672;

fn handlers(image: &Image, findings: &mut Vec<String>) {
    for (index, name) in VECTORS {
        let symbol = image.symbols.get(name);
        if symbol.is_none() || image.vectors.get(index) != symbol {
            findings.push(format!("entry {index} of the vector table is not {name}"));
        }
    }
    if image.fault_entry != Some(FAULT_ENTRY) {
        findings.push("HardFault is not the entry that pushes nothing (boards/faults)".to_string());
    }
    // Alike on all boards where there is none.
    let pre_init = image.symbols.get("__pre_init");
    if image.symbols.contains_key("PVD_AVD") && pre_init == image.symbols.get("DefaultPreInit") {
        findings.push("outputs are not switched off before memory is set up: no __pre_init".to_string());
    }
}

/// What lies below the stack is inaccessible while the firmware runs: no memory of the board may.
fn guard(image: &Image, regions: &[Region], findings: &mut Vec<String>) {
    let symbols = image
        .symbols
        .get("_stack_guard")
        .zip(image.symbols.get("_stack_end"));
    let Some((&begin, &end)) = symbols.filter(|(begin, end)| begin < end) else {
        findings.push("there is no guard below the stack".to_string());
        return;
    };
    for region in regions
        .iter()
        .filter(|region| region.begin < end && begin < region.end)
    {
        findings.push(format!("the guard below the stack overlaps {}", region.name));
    }
}

#[cfg(test)]
mod tests {
    use super::read::tests::SCRIPT;
    use super::*;

    fn part(name: &str, begin: u64, end: u64) -> Part {
        let name = name.to_string();
        Part { name, begin, end }
    }

    fn image() -> Image {
        let symbols = [
            ("_stack_start", 0x2002_0000),
            ("_stack_end", 0x2000_0000),
            ("_stack_guard", 0x1ff8_0000),
            ("Reset", 0x0800_02d1),
            ("HardFault", 0x0800_03b5),
            ("PVD_AVD", 0x0801_5691),
            ("__pre_init", 0x0800_0401),
            ("DefaultPreInit", 0x0801_e7e9),
            ("__sdata", 0x2400_0000),
            ("__edata", 0x2404_1df0),
            ("__sbss", 0x2404_1df0),
            ("__ebss", 0x2404_33ac),
            ("__suninit", 0x2404_33b0),
            ("__euninit", 0x2404_4af0),
        ];
        Image {
            sections: vec![
                part(".vector_table", 0x0800_0000, 0x0800_02cc),
                part(".text", 0x0800_02d0, 0x0804_609c),
                part(".data", 0x2400_0000, 0x2404_1df0),
                part(".bss", 0x2404_1df0, 0x2404_33ac),
                part(".uninit", 0x2404_33b0, 0x2404_4af0),
                part(".ethernet", 0x3000_0000, 0x3000_60c0),
            ],
            loads: vec![part("the segment for 0x24000000", 0x0804_be08, 0x0808_dbf8)],
            symbols: symbols.map(|(name, value)| (name.to_string(), value)).into(),
            vectors: [
                [0x2002_0000, 0x0800_02d1, 0x0801_5671].as_slice(),
                &[0x0800_03b5; 4],
            ]
            .concat(),
            fault_entry: Some(FAULT_ENTRY),
        }
    }

    /// What is found in an image after `change`.
    fn found(change: impl FnOnce(&mut Image)) -> Vec<String> {
        let mut image = image();
        change(&mut image);
        findings(&image, &read::regions(SCRIPT).unwrap())
    }

    fn section<'a>(image: &'a mut Image, name: &str) -> &'a mut Part {
        image.sections.iter_mut().find(|part| part.name == name).unwrap()
    }

    #[test]
    fn a_sound_image_has_no_findings() {
        assert_eq!(found(|_| ()), [""; 0]);
    }

    #[test]
    fn zeroing_into_another_memory_is_found() {
        let findings = found(|image| {
            image.symbols.insert("__ebss".to_string(), 0x3000_60c0);
        });
        assert_eq!(
            findings,
            [
                "__sbss to __ebss (0x24041df0 to 0x300060c0) lies in no single region of the board's memory",
                "__sbss to __ebss is not .bss, which Reset copies or clears",
            ]
        );
    }

    #[test]
    fn a_section_in_the_wrong_memory_or_in_none_is_found() {
        let findings =
            found(|image| *section(image, ".ethernet") = part(".ethernet", 0x2404_5000, 0x2404_b0c0));
        assert_eq!(
            findings,
            [".ethernet (0x24045000 to 0x2404b0c0) lies in RAM instead of SRAM_D2"]
        );
        let findings = found(|image| section(image, ".ethernet").end = 0x3000_8001);
        assert_eq!(
            findings,
            [".ethernet (0x30000000 to 0x30008001) lies in no single region of the board's memory"]
        );
        let findings = found(|image| image.loads[0].begin = 0x2400_0000);
        assert!(
            findings[0].starts_with("the segment for 0x24000000"),
            "{findings:?}"
        );
    }

    #[test]
    fn data_in_the_stack_is_found() {
        let findings = found(|image| image.sections.push(part(".fast", 0x2001_0000, 0x2001_0100)));
        assert_eq!(findings, ["the stack and .fast overlap"]);
    }

    #[test]
    fn a_vector_table_that_leads_elsewhere_is_found() {
        let findings = found(|image| image.vectors[0] = 0x2405_0000);
        assert_eq!(findings, ["entry 0 of the vector table is not _stack_start"]);
        let findings = found(|image| image.vectors[4] = 0x0801_55f9);
        assert_eq!(findings, ["entry 4 of the vector table is not HardFault"]);
    }

    #[test]
    fn a_fault_handler_that_pushes_and_a_start_that_leaves_outputs_floating_are_found() {
        // push {r7, lr}
        let findings = found(|image| image.fault_entry = Some(0xb580));
        assert_eq!(
            findings,
            ["HardFault is not the entry that pushes nothing (boards/faults)"]
        );
        let findings = found(|image| {
            image.symbols.insert("__pre_init".to_string(), 0x0801_e7e9);
        });
        assert_eq!(
            findings,
            ["outputs are not switched off before memory is set up: no __pre_init"]
        );
    }

    #[test]
    fn a_guard_over_memory_is_found() {
        let findings = found(|image| {
            image.symbols.insert("_stack_guard".to_string(), 0x2000_0000);
        });
        assert_eq!(findings, ["there is no guard below the stack"]);
        let findings = found(|image| {
            image.symbols.insert("_stack_guard".to_string(), 0x0808_0000);
        });
        assert_eq!(findings, ["the guard below the stack overlaps FLASH"]);
    }
}
