//! The source of a program's text, which can be read line by line any number of times.

use std::fs::File;
use std::hash::{DefaultHasher, Hasher};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::string::FromUtf8Error;
use std::sync::{Arc, Mutex, PoisonError};

/// Bytes of a file that are compared at once.
pub(super) const CHUNK: usize = 1 << 16;
/// Bytes of the largest file that is kept in memory, where nothing changes it.
const KEPT: u64 = 1 << 20;

/// Some editors begin a file with it.
const BYTE_ORDER_MARK: &str = "\u{feff}";

/// The text of a program.
#[derive(Clone, Debug)]
pub(super) enum Source {
    /// In memory.
    Text(Arc<[u8]>),
    /// In a file, which stays open: another file of its name is another program.
    File(Arc<Checked>),
}

impl Source {
    /// The text in `file`, left there if it is long and can be read more than once.
    pub(super) fn of(mut file: File) -> io::Result<Self> {
        let about = file.metadata()?;
        if about.is_file() && about.len() > KEPT {
            return Ok(Self::File(Arc::new(Checked::new(file))));
        }
        let mut text = Vec::new();
        file.read_to_end(&mut text)?;
        Ok(Self::Text(text.into()))
    }

    /// The lines after `offset` bytes.
    pub(super) fn lines(&self, offset: u64) -> Lines {
        let text: Box<dyn BufRead + Send> = match self {
            Self::Text(text) => {
                let mut cursor = io::Cursor::new(text.clone());
                cursor.set_position(offset);
                Box::new(cursor)
            }
            Self::File(file) => {
                let (file, at) = (file.clone(), offset);
                Box::new(BufReader::with_capacity(CHUNK, ReadAt { file, at }))
            }
        };
        Lines {
            text,
            offset,
            line_start: offset,
        }
    }
}

/// Lines one after the other.
pub(super) struct Lines {
    text: Box<dyn BufRead + Send>,
    /// Bytes before the next line.
    pub(super) offset: u64,
    /// Bytes before the line that was read last.
    pub(super) line_start: u64,
}

impl Lines {
    /// The next line without its end; nothing after the last one. What is not UTF-8 is Latin-1. A byte order mark is left
    /// out.
    pub(super) fn next(&mut self) -> io::Result<Option<String>> {
        let mut line = Vec::new();
        let count = self.text.read_until(b'\n', &mut line)?;
        if count == 0 {
            return Ok(None);
        }
        self.line_start = self.offset;
        self.offset += count as u64;
        if line.ends_with(b"\n") {
            line.pop();
            if line.ends_with(b"\r") {
                line.pop();
            }
        }
        if self.line_start == 0 && line.starts_with(BYTE_ORDER_MARK.as_bytes()) {
            line.drain(..BYTE_ORDER_MARK.len());
        }
        let text = String::from_utf8(line);
        let latin_1 = |other: FromUtf8Error| other.into_bytes().into_iter().map(char::from).collect();
        Ok(Some(text.unwrap_or_else(latin_1)))
    }
}

/// A file that gives the same text every time, or an error: what runs is what was checked.
#[derive(Debug)]
pub(super) struct Checked {
    file: File,
    /// Of every chunk that has been read. The reader holds the lock, since there is one file position.
    digests: Mutex<Vec<u64>>,
}

impl Checked {
    /// A file that nothing has been read of.
    pub(super) fn new(file: File) -> Self {
        let digests = Mutex::default();
        Self { file, digests }
    }

    /// The bytes of a chunk, fewer at the end of the file. The first time through they are read in order.
    fn chunk(&self, index: usize) -> io::Result<Vec<u8>> {
        let mut digests = self.digests.lock().unwrap_or_else(PoisonError::into_inner);
        let mut file = &self.file;
        file.seek(SeekFrom::Start((index * CHUNK) as u64))?;
        let mut chunk = Vec::with_capacity(CHUNK);
        file.take(CHUNK as u64).read_to_end(&mut chunk)?;
        let mut hasher = DefaultHasher::new();
        hasher.write(&chunk);
        let digest = hasher.finish();
        match digests.get(index) {
            Some(before) if *before != digest => Err(io::Error::other(
                "the file has changed since it was checked; start again with the new one",
            )),
            Some(_) => Ok(chunk),
            None => {
                digests.push(digest);
                Ok(chunk)
            }
        }
    }
}

/// A file from a place of its own.
struct ReadAt {
    file: Arc<Checked>,
    at: u64,
}

impl Read for ReadAt {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let chunk = self.file.chunk((self.at / CHUNK as u64) as usize)?;
        let mut rest = chunk.get((self.at % CHUNK as u64) as usize..).unwrap_or_default();
        let count = rest.read(buffer)?;
        self.at += count as u64;
        Ok(count)
    }
}
