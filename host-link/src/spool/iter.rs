//! Going through a spool.

use super::{Block, Spool, Stored};
use serde::de::DeserializeOwned;
use std::fs::File;
use std::sync::atomic::Ordering;
use std::{io, slice, vec};

/// The records of a [`Spool`], the oldest first.
pub struct Iter<'a, T> {
    spool: &'a Spool<T>,
    /// Blocks that come after `current`, and the records after those.
    blocks: slice::Iter<'a, Block<T>>,
    newest: Option<&'a [T]>,
    current: Current<'a, T>,
}

enum Current<'a, T> {
    Memory(slice::Iter<'a, T>),
    Read(vec::IntoIter<T>),
}

impl<'a, T> Iter<'a, T> {
    pub(super) fn new(spool: &'a Spool<T>) -> Self {
        Self {
            spool,
            blocks: spool.blocks.iter(),
            newest: Some(&spool.newest),
            current: Current::Memory([].iter()),
        }
    }
}

impl<'a, T: DeserializeOwned> Iter<'a, T> {
    /// The records of the next block that can be read.
    fn next_block(&mut self) -> Option<Current<'a, T>> {
        let spool = self.spool;
        for block in self.blocks.by_ref() {
            match block {
                Block::Memory(records) => return Some(Current::Memory(records.iter())),
                Block::File(stored) => match stored.read(spool.file.as_ref()) {
                    Ok(read) => return Some(Current::Read(read.into_iter())),
                    Err(reason) if !stored.lost.swap(true, Ordering::Relaxed) => {
                        spool.lose(stored.records as u64, reason);
                    }
                    Err(_) => {}
                },
            }
        }
        self.newest.take().map(|newest| Current::Memory(newest.iter()))
    }
}

impl Stored {
    fn read<T: DeserializeOwned>(&self, file: Option<&File>) -> io::Result<Vec<T>> {
        let mut encoded = vec![0; self.bytes];
        read_exact_at(file.ok_or(io::ErrorKind::NotFound)?, &mut encoded, self.at)?;
        let mut left = encoded.as_slice();
        let mut read = Vec::with_capacity(self.records);
        while !left.is_empty() {
            let (record, rest) = postcard::take_from_bytes(left).map_err(io::Error::other)?;
            read.push(record);
            left = rest;
        }
        Ok(read)
    }
}

impl<T: DeserializeOwned + Clone> Iterator for Iter<'_, T> {
    type Item = T;

    fn next(&mut self) -> Option<T> {
        loop {
            let next = match &mut self.current {
                Current::Memory(records) => records.next().cloned(),
                Current::Read(records) => records.next(),
            };
            if next.is_some() {
                return next;
            }
            self.current = self.next_block()?;
        }
    }
}

/// Reads at a place of the file, which several readers have in common.
#[cfg(unix)]
fn read_exact_at(file: &File, to: &mut [u8], at: u64) -> io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, to, at)
}

#[cfg(windows)]
fn read_exact_at(file: &File, mut to: &mut [u8], mut at: u64) -> io::Result<()> {
    while !to.is_empty() {
        match std::os::windows::fs::FileExt::seek_read(file, to, at)? {
            0 => return Err(io::ErrorKind::UnexpectedEof.into()),
            read => {
                to = &mut to[read..];
                at += read as u64;
            }
        }
    }
    Ok(())
}

/// Where there are no files, as in a browser.
#[cfg(not(any(unix, windows)))]
fn read_exact_at(_: &File, _: &mut [u8], _: u64) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}
