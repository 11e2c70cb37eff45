//! Blocks of long paths that are not kept are read again as they were.

use super::super::reading::read;
use super::super::source::{CHUNK, Checked, Source};
use super::*;
use std::fmt::Write;
use std::fs::File;
use std::path::Path;
use std::sync::Arc;
use tempfile::NamedTempFile;

/// Every kind of word that lasts from block to block, on three long paths.
fn long() -> String {
    let mut text = "%\nG43.4\nG0 X0 Y0 Z0 A0 B0 C0\n".to_owned();
    for path in 0..3 {
        text += "G94 F600 G61\nM67 E0 Q500\nG1\n";
        for i in 0..50 {
            let x = path * 100 + i;
            match i % 10 {
                0 => writeln!(
                    text,
                    "(comment)\n\nG64 P0.{}\r\nM62 P0\nG1 X{x} Y1 F{}",
                    i + 1,
                    500 + i
                ),
                3 => writeln!(text, "M67 E0 Q{i}\nM63 P0\nG3 X{x} Y2 R50"),
                5 => writeln!(text, "G5.2 P1\nX{x}.25 Y3\nX{x}.5 Y4\nG5.3\nG1 X{x}.75"),
                7 => writeln!(text, "G93 G1 X{x} F20"),
                8 => writeln!(text, "G94 F700\n/G1 X-5\nX{x} Y0"),
                _ => writeln!(text, "G1 X{x} Y{}", i % 2),
            }
            .unwrap();
        }
        text += ["G4 P1\n", "M3 S100\n", "G1 X1000 M5\n"][path];
    }
    text += "M2\n%\n";
    text
}

/// A temporary file with `text`.
fn written(text: &str) -> NamedTempFile {
    let file = NamedTempFile::new().unwrap();
    std::fs::write(&file, text).unwrap();
    file
}

fn in_file(name: &Path) -> Source {
    Source::File(Arc::new(Checked::new(File::open(name).unwrap())))
}

fn all(program: &Program) -> Vec<(Motion, f64, Vec<Move>)> {
    let paths = program.paths.iter();
    paths
        .map(|path| {
            let moves = Arc::new(path.clone()).moves().map(Result::unwrap).collect();
            (path.motion, path.dwell_before_s, moves)
        })
        .collect()
}

#[test]
fn what_is_not_kept_is_read_again_as_it_was() {
    for block_delete in [false, true] {
        let options = Options {
            block_delete,
            ..Options::default()
        };
        let source = Source::Text(long().as_bytes().into());
        let whole = read(&source, options.clone(), usize::MAX).unwrap();
        let wanted = all(&whole);
        assert!(wanted.iter().any(|(_, _, moves)| moves.len() > 50));
        for kept in [1, 2, 3, 5, 6, 7, 20, 53, 54, 55, 56, 57] {
            let program = read(&source, options.clone(), kept).unwrap();
            // One more where the block that makes the path too long ends it.
            assert!(program.paths.iter().all(|path| path.targets.len() <= kept + 1));
            assert_eq!(all(&program), wanted, "{kept} kept");
            for (path, whole) in program.paths.iter().zip(&whole.paths) {
                assert_eq!(&path.whole().unwrap(), whole, "{kept} kept");
            }
        }
    }
}

#[test]
fn a_file_is_read_as_a_text() {
    let source = in_file(written(&long()).path());
    let wanted = all(&interpret(&long(), Options::default()).unwrap());
    let program = read(&source, Options::default(), 10).unwrap();
    assert_eq!(
        program.paths.iter().filter_map(|path| path.rest.as_ref()).count(),
        3
    );
    // Two at once, from one file.
    let paths: Vec<_> = program.paths.iter().cloned().map(Arc::new).collect();
    let mut pair: Vec<_> = paths
        .iter()
        .filter(|path| path.rest.is_some())
        .map(ProgramPath::moves)
        .collect();
    let mut seen = vec![Vec::new(); pair.len()];
    loop {
        let mut more = false;
        for (moves, seen) in pair.iter_mut().zip(&mut seen) {
            let next = moves.next().map(Result::unwrap);
            more |= next.is_some();
            seen.extend(next);
        }
        if !more {
            break;
        }
    }
    let long = wanted.into_iter().filter(|(_, _, moves)| moves.len() > 10);
    assert_eq!(seen, long.map(|(_, _, moves)| moves).collect::<Vec<_>>());
}

#[test]
fn what_is_not_utf_8_is_latin_1_and_a_byte_order_mark_is_nothing() {
    let read = |text: &[u8]| read(&Source::Text(text.into()), Options::default(), 10);
    assert!(read(b"\xef\xbb\xbf(Stra\xdfe)\nG0 X5 (\xb0)\nM2\n").is_ok());
    let error = read(b"G21\n\xdf\n").unwrap_err();
    assert_eq!(
        error.to_string(),
        "line 2, column 1: 'ß' is not understood here: write text that is no program in ( ) or behind ;"
    );
}

#[test]
fn a_file_that_changes_is_an_error_and_gives_no_other_block() {
    let mut text = "G43.4\nG0 X0 Y0 Z0 A0 B0 C0\nF600\n".to_owned();
    for i in 1..=20_000 {
        writeln!(text, "G1 X{:.1}", f64::from(i) / 10.0).unwrap();
    }
    text += "M2\n";
    // The last line, one of the second chunk, and what comes after the end.
    let shorter = text[..text.len() - 20].to_owned();
    let aligned = text[..CHUNK].to_owned();
    let longer = text.clone() + "\n";
    let other = text.replace("X1500.0", "X1500.1");
    for changed in [shorter, aligned, longer, other] {
        let file = written(&text);
        let program = read(&in_file(file.path()), Options::default(), KEPT).unwrap();
        let path = Arc::new(program.paths[1].clone());
        let before: Vec<_> = path.moves().map(Result::unwrap).collect();
        assert_eq!(before.len(), 20_000);
        std::fs::write(&file, changed).unwrap();
        let mut after: Vec<_> = path.moves().collect();
        let error = after.pop().unwrap().unwrap_err();
        assert!(
            error.to_string().contains("the file has changed since"),
            "{error}"
        );
        let after: Vec<_> = after.into_iter().map(Result::unwrap).collect();
        assert!(after.len() < 20_000);
        assert_eq!(after, before[..after.len()]);
        // The block after the last one.
        assert_eq!(error.place.line as usize, 3 + after.len() + 1);
    }
}

#[test]
fn a_short_file_may_change() {
    let text = "G43.4\nG0 X0 Y0 Z0 A0 B0 C0\nF600\n".to_owned() + &"G1 X1\nX2\n".repeat(KEPT) + "M2\n";
    let file = written(&text);
    let program = interpret_file(File::open(&file).unwrap(), Options::default()).unwrap();
    std::fs::write(&file, "M2\n").unwrap();
    assert_eq!(all(&program)[1].2.len(), 2 * KEPT);
}
