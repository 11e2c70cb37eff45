//! Keeps the pictures of a camera in a folder, so that they can be measured again.

use crate::folder::{CAPTURES, COLUMNS};
use crate::{CameraError, Picture, write_grey};
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Writes pictures into a folder as [`Folder`](crate::Folder) reads them.
#[derive(Debug)]
pub struct Recorder {
    folder: PathBuf,
    captures: File,
}

impl Recorder {
    /// Makes the folder; one that holds pictures already is refused, so that no two recordings mix.
    pub fn new(folder: &Path) -> Result<Self, CameraError> {
        let list = folder.join(CAPTURES);
        let failed = |source| CameraError::Record {
            file: list.display().to_string(),
            source,
        };
        std::fs::create_dir_all(folder).map_err(failed)?;
        if holds_pictures(folder, &list).map_err(failed)? {
            let folder = folder.display().to_string();
            return Err(CameraError::Holds { folder });
        }
        let mut captures = File::create(&list).map_err(failed)?;
        writeln!(captures, "{}", COLUMNS.join(",")).map_err(failed)?;
        Ok(Self {
            folder: folder.to_owned(),
            captures,
        })
    }

    /// Adds a picture; its row follows once the file is whole. Pictures come in the order of their captures.
    pub fn add(&mut self, picture: &Picture) -> Result<(), CameraError> {
        let name = format!("capture-{:08}.png", picture.capture);
        write_grey(&self.folder.join(&name), picture)?;
        writeln!(self.captures, "{},{},{name}", picture.capture, picture.time_us).map_err(|source| {
            CameraError::Record {
                file: self.folder.join(CAPTURES).display().to_string(),
                source,
            }
        })
    }
}

/// Whether a folder has pictures, or a list of some; an empty list does not count.
fn holds_pictures(folder: &Path, list: &Path) -> std::io::Result<bool> {
    for entry in std::fs::read_dir(folder)? {
        if Path::new(&entry?.file_name()).extension() == Some("png".as_ref()) {
            return Ok(true);
        }
    }
    match std::fs::read_to_string(list) {
        Ok(text) => Ok(text.trim() != COLUMNS.join(",")),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Arrival, Camera, Folder};
    use std::time::Duration;

    fn picture(capture: u32) -> Picture {
        Picture {
            capture,
            time_us: 5_000 * u64::from(capture),
            rows: 50,
            columns: 60,
            pixels: (0..3_000).map(|k| ((k * k + 31 * capture) % 253) as u8).collect(),
        }
    }

    #[test]
    fn what_was_kept_comes_back_to_its_captures_and_what_was_not_is_lost() {
        let scratch = tempfile::tempdir().expect("a folder");
        let path = scratch.path().join("new/deep");
        drop(Recorder::new(&path).expect("a new folder"));
        let mut recorder = Recorder::new(&path).expect("a folder without pictures");
        for capture in [3, 4, 6] {
            recorder.add(&picture(capture)).expect("kept");
        }
        let again = Recorder::new(&path).expect_err("a second recording").to_string();
        assert!(
            again.contains("deep holds pictures already") && again.contains("another folder"),
            "{again}"
        );

        let mut folder = Folder::open(&path).expect("the recording");
        let times: Vec<u64> = folder
            .recorded()
            .iter()
            .map(|recorded| recorded.time_us)
            .collect();
        assert_eq!(times, [15_000, 20_000, 30_000]);
        let mut came = Picture::default();
        assert_eq!(
            folder.next(Duration::ZERO, &mut came).expect("no error"),
            Arrival::Nothing
        );
        for capture in 2..8 {
            folder.strobed(capture, 5_000 * u64::from(capture));
        }
        for capture in 2..8 {
            let arrival = folder.next(Duration::ZERO, &mut came).expect("no error");
            if [3, 4, 6].contains(&capture) {
                assert_eq!((arrival, &came), (Arrival::Picture, &picture(capture)));
            } else {
                assert_eq!(arrival, Arrival::Lost { capture });
            }
        }
        std::fs::remove_file(path.join("capture-00000004.png")).expect("removed");
        folder.strobed(4, 0);
        let gone = folder
            .next(Duration::ZERO, &mut came)
            .expect_err("no file")
            .to_string();
        assert!(
            gone.contains("cannot read picture") && gone.contains("capture-00000004.png"),
            "{gone}"
        );
    }
}
