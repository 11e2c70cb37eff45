//! The page for browsers: its files, as `cargo xtask browser` makes them.

use super::token::Token;
use anyhow::{Context, Result};
use std::path::{Path, PathBuf};

/// Path that a browser asks for, file, and what it is served as.
const FILES: [(&str, &str, &str); 4] = [
    ("/", "index.html", "Content-Type: text/html; charset=utf-8\r\n"),
    (
        "/start.js",
        "start.js",
        "Content-Type: text/javascript; charset=utf-8\r\n",
    ),
    (
        "/seamwright.js",
        "seamwright.js.gz",
        "Content-Type: text/javascript; charset=utf-8\r\nContent-Encoding: gzip\r\n",
    ),
    (
        "/seamwright.wasm",
        "seamwright.wasm.gz",
        "Content-Type: application/wasm\r\nContent-Encoding: gzip\r\n",
    ),
];

/// Of every answer with a file: the page loads from here alone, and no one keeps or is told its address, which has the token.
const GUARDS: &str = "Cache-Control: no-store\r\nReferrer-Policy: no-referrer\r\nX-Content-Type-Options: nosniff\r\n\
    Content-Security-Policy: default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; connect-src 'self'; \
    style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n";

/// What stands for the token in the first of the files.
const PLACE: &[u8] = b"{token}";

/// See the module.
#[derive(Debug)]
pub struct Page([Vec<u8>; FILES.len()]);

impl Page {
    /// The page in `folder`, for who has `token`.
    ///
    /// # Errors
    /// A file that is missing or cannot be read.
    pub fn read(folder: &Path, token: &Token) -> Result<Self> {
        let mut files = <[Vec<u8>; FILES.len()]>::default();
        for (bytes, (_, name, _)) in files.iter_mut().zip(FILES) {
            let file = folder.join(name);
            *bytes = std::fs::read(&file).with_context(|| {
                format!(
                    "cannot read {}; `cargo xtask browser` makes this folder",
                    file.display()
                )
            })?;
        }
        files[0] = with_token(&files[0], token);
        Ok(Self(files))
    }

    /// Where it is if nothing else is told: in the folder `browser` beside this program.
    pub fn usual_folder() -> Option<PathBuf> {
        let folder = std::env::current_exe().ok()?.with_file_name("browser");
        folder.is_dir().then_some(folder)
    }

    /// Headers and content of what is asked for by `path`.
    pub(super) fn file(&self, path: &str) -> Option<(String, &[u8])> {
        let mut all = FILES.iter().zip(&self.0);
        let ((_, _, header), bytes) = all.find(|((at, _, _), _)| *at == path)?;
        Some((format!("{header}{GUARDS}"), bytes))
    }
}

fn with_token(html: &[u8], token: &Token) -> Vec<u8> {
    let Some(at) = html.windows(PLACE.len()).position(|some| some == PLACE) else {
        return html.to_vec();
    };
    [&html[..at], token.text().as_bytes(), &html[at + PLACE.len()..]].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_without_a_file_of_the_page_is_told_with_that_file() {
        let (folder, token) = (tempfile::tempdir().unwrap(), Token::random().unwrap());
        for (_, name, _) in FILES {
            let told = format!("{:#}", Page::read(folder.path(), &token).unwrap_err());
            assert!(
                told.contains(name) && told.contains("cargo xtask browser"),
                "{told}"
            );
            std::fs::write(folder.path().join(name), b"a{token}b").unwrap();
        }
        let page = Page::read(folder.path(), &token).unwrap();
        let content = |path| page.file(path).map(|(_, bytes)| bytes.to_vec());
        assert_eq!(content("/"), Some(format!("a{}b", token.text()).into_bytes()));
        assert_eq!(content("/start.js"), Some(b"a{token}b".to_vec()));
        assert_eq!(content("/index.html"), None);
    }
}
