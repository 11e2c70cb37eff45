//! Packs the viewer in a browser: `seamwright-page WASM OUT` writes into the folder OUT what `seamwright-hmi --web` serves.
//!
//! What is between WebAssembly and JavaScript has to be of one version on both sides: cargo's lock file has both.

use anyhow::{Context, Result, bail};
use flate2::Compression;
use flate2::write::GzEncoder;
use std::io::Write;
use std::path::Path;
use wasm_bindgen_cli_support::Bindgen;

/// Name of the files.
const NAME: &str = "seamwright";
/// Files that are served as they are.
const PAGE: [(&str, &str); 2] = [
    ("index.html", include_str!("../../../pc/browser/page/index.html")),
    ("start.js", include_str!("../../../pc/browser/page/start.js")),
];

fn main() -> Result<()> {
    let arguments: Vec<_> = std::env::args_os().skip(1).collect();
    let [wasm, out] = arguments.as_slice() else {
        bail!("usage: seamwright-page WASM OUT");
    };
    pack(Path::new(wasm), Path::new(out))
}

fn pack(wasm: &Path, out: &Path) -> Result<()> {
    let mut bindgen = Bindgen::new();
    bindgen
        .input_path(wasm)
        .out_name(NAME)
        .typescript(false)
        .remove_name_section(true)
        .remove_producers_section(true)
        .web(true)?;
    let mut output = bindgen
        .generate_output()
        .with_context(|| format!("{} is not what wasm-bindgen takes", wasm.display()))?;
    let modules = output
        .snippets()
        .values()
        .flatten()
        .chain(output.local_modules().keys());
    let modules: Vec<&str> = modules.map(String::as_str).collect();
    if !modules.is_empty() {
        bail!("JavaScript of libraries is not packed: {modules:?}");
    }
    std::fs::create_dir_all(out).with_context(|| format!("cannot make {}", out.display()))?;
    for (name, text) in PAGE {
        write(out, name, text.as_bytes())?;
    }
    write(
        out,
        &format!("{NAME}.js.gz"),
        &compressed(output.js().as_bytes())?,
    )?;
    let wasm = output.wasm_mut().emit_wasm();
    write(out, &format!("{NAME}.wasm.gz"), &compressed(&wasm)?)
}

fn compressed(bytes: &[u8]) -> Result<Vec<u8>> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes)?;
    Ok(encoder.finish()?)
}

fn write(folder: &Path, name: &str, bytes: &[u8]) -> Result<()> {
    let file = folder.join(name);
    std::fs::write(&file, bytes).with_context(|| format!("cannot write {}", file.display()))?;
    println!("{}: {} bytes", file.display(), bytes.len());
    Ok(())
}
