//! Ctrl-C and orders to end, counted instead of obeyed at once, so that boards are always ended in order.

use anyhow::{Context, Result};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// How often the program was asked to end.
#[derive(Clone, Default)]
pub struct Interrupts(Arc<AtomicU32>);

impl Interrupts {
    /// From now on. Once in a program.
    pub fn watch() -> Result<Self> {
        let interrupts = Self::default();
        let seen = interrupts.clone();
        ctrlc::set_handler(move || {
            seen.0.fetch_add(1, Ordering::Relaxed);
        })
        .context("cannot watch for Ctrl-C")?;
        Ok(interrupts)
    }

    /// Since the program began to watch.
    pub fn count(&self) -> u32 {
        self.0.load(Ordering::Relaxed)
    }
}
