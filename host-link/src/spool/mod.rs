//! Long sequences of records, of which memory holds a bounded part.
//!
//! What is beyond that lies in a temporary file without a name: it is gone with the spool, or with this program, however that
//! ends.

mod iter;
#[cfg(test)]
mod tests;
mod writer;

pub use iter::Iter;
pub use writer::Writer;

use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt;
use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, MutexGuard, PoisonError};
use thiserror::Error;

/// Records that are written and read at once: 200 kB of the largest that there are.
const BLOCK: usize = 1024;

/// How spools keep their records.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Spooling {
    /// Folder of their files; `None`: that of the system for temporary files, which may lie in memory, too.
    pub folder: Option<PathBuf>,
    /// Records of a spool that memory holds at most.
    pub in_memory: usize,
    /// Whether any are kept.
    pub keeps: bool,
    /// Whether a job waits for the disk, and loses nothing: its boards wait meanwhile.
    pub waits: bool,
}

impl Default for Spooling {
    /// About a minute of what a board tells every ms: 15 MB of the largest records. A short job needs no file.
    fn default() -> Self {
        Self {
            folder: None,
            in_memory: 1 << 16,
            keeps: true,
            waits: false,
        }
    }
}

impl Spooling {
    /// Nothing is kept, for a job of any length that nobody evaluates.
    pub fn nothing() -> Self {
        Self {
            keeps: false,
            ..Self::default()
        }
    }

    /// With the files in `folder`, which has to be there when the first one is needed.
    pub fn in_folder(folder: impl Into<PathBuf>) -> Self {
        Self {
            folder: Some(folder.into()),
            ..Self::default()
        }
    }
}

/// Records that a spool could not keep, or not give back.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{records} records are lost: {reason}")]
pub struct SpoolError {
    /// How many.
    pub records: u64,
    /// What went wrong first.
    pub reason: String,
}

/// Records in the order in which they came.
///
/// Nothing fails where records are put in or taken out: those of a block that the disk does not take or give are left out, and
/// [`check`](Spool::check) tells of it.
pub struct Spool<T> {
    spooling: Spooling,
    /// Full blocks, the oldest first.
    blocks: Vec<Block<T>>,
    newest: Vec<T>,
    /// Records in memory, `newest` left out.
    in_memory: usize,
    len: u64,
    file: Option<File>,
    /// Where the next block goes.
    end: u64,
    /// Readers find errors, too.
    error: Mutex<Option<SpoolError>>,
}

enum Block<T> {
    Memory(Vec<T>),
    File(Stored),
}

/// A block in the file.
struct Stored {
    at: u64,
    bytes: usize,
    records: usize,
    /// A reader could not read it, and has told of it.
    lost: AtomicBool,
}

impl<T> Spool<T> {
    /// An empty one.
    pub fn new(spooling: Spooling) -> Self {
        Self {
            spooling,
            blocks: Vec::new(),
            newest: Vec::new(),
            in_memory: 0,
            len: 0,
            file: None,
            end: 0,
            error: Mutex::new(None),
        }
    }

    /// Number of records that were kept.
    pub fn len(&self) -> u64 {
        self.len
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Whether everything is there that was put in, and was read that lies here.
    ///
    /// # Errors
    /// What is missing by now, and why.
    pub fn check(&self) -> Result<(), SpoolError> {
        self.error().clone().map_or(Ok(()), Err)
    }

    /// Notes that so many records are lost.
    pub(crate) fn lose(&self, records: u64, reason: impl fmt::Display) {
        let mut error = self.error();
        let error = error.get_or_insert_with(|| SpoolError {
            records: 0,
            reason: reason.to_string(),
        });
        error.records += records;
    }

    fn error(&self) -> MutexGuard<'_, Option<SpoolError>> {
        self.error.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<T: Serialize + DeserializeOwned + Clone> Spool<T> {
    /// Puts a record at the end.
    pub fn push(&mut self, record: T) {
        if !self.spooling.keeps {
            return;
        }
        self.newest.push(record);
        self.len += 1;
        if self.newest.len() >= BLOCK.min(self.spooling.in_memory.max(1)) {
            let room = Vec::with_capacity(self.newest.len());
            let block = std::mem::replace(&mut self.newest, room);
            self.store(block);
        }
    }

    /// All records from the first one on; there may be any number of such iterators at a time.
    pub fn iter(&self) -> Iter<'_, T> {
        Iter::new(self)
    }

    fn store(&mut self, block: Vec<T>) {
        if self.in_memory + 2 * block.len() <= self.spooling.in_memory {
            self.in_memory += block.len();
            self.blocks.push(Block::Memory(block));
            return;
        }
        match self.write(&block) {
            Ok(stored) => self.blocks.push(stored),
            Err(reason) => {
                self.len -= block.len() as u64;
                self.lose(block.len() as u64, reason);
            }
        }
    }

    fn write(&mut self, block: &[T]) -> io::Result<Block<T>> {
        let mut encoded = Vec::new();
        for record in block {
            encoded = postcard::to_extend(record, encoded).map_err(io::Error::other)?;
        }
        let file = match &mut self.file {
            Some(file) => file,
            none => none.insert(match &self.spooling.folder {
                Some(folder) => tempfile::tempfile_in(folder)?,
                None => tempfile::tempfile()?,
            }),
        };
        // Readers may have moved the place of writing, and a block may have been written in part.
        file.seek(SeekFrom::Start(self.end))?;
        file.write_all(&encoded)?;
        let at = self.end;
        self.end += encoded.len() as u64;
        Ok(Block::File(Stored {
            at,
            bytes: encoded.len(),
            records: block.len(),
            lost: AtomicBool::new(false),
        }))
    }
}

impl<T> Default for Spool<T> {
    fn default() -> Self {
        Self::new(Spooling::default())
    }
}

impl<T: Serialize + DeserializeOwned + Clone> FromIterator<T> for Spool<T> {
    fn from_iter<I: IntoIterator<Item = T>>(records: I) -> Self {
        let mut spool = Self::default();
        records.into_iter().for_each(|record| spool.push(record));
        spool
    }
}

impl<'a, T: Serialize + DeserializeOwned + Clone> IntoIterator for &'a Spool<T> {
    type Item = T;
    type IntoIter = Iter<'a, T>;

    fn into_iter(self) -> Iter<'a, T> {
        self.iter()
    }
}

impl<T: Serialize + DeserializeOwned + Clone + PartialEq> PartialEq for Spool<T> {
    /// Whether the records are the same, wherever they lie.
    fn eq(&self, other: &Self) -> bool {
        self.len == other.len && self.iter().eq(other.iter())
    }
}

impl<T> fmt::Debug for Spool<T> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("Spool")
            .field("len", &self.len)
            .field("error", &*self.error())
            .finish_non_exhaustive()
    }
}
