//! Evaluation of a path at a path length.

use super::{Blocks, Leg};
use crate::path::{CAPACITY, PathError};
use shared::trajectory::{Element, Path, PathPoint};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::fmt;

/// Elements that are kept behind the farthest place looked at.
const KEPT: usize = 64;

/// A path by its length. Looking at places one after the other is cheap; going far back starts again.
#[derive(Debug)]
pub enum Course {
    /// By its knots.
    Knots(Box<Path<CAPACITY>>),
    /// By its elements.
    Blocks(Box<RefCell<Window>>),
}

impl Course {
    /// Of blocks that are followed exactly.
    pub(in crate::path) fn of(blocks: &Blocks) -> Self {
        Self::Blocks(Box::new(RefCell::new(Window::new(blocks))))
    }

    /// Path length where it begins \[mm\].
    pub fn start_s(&self) -> Option<f64> {
        match self {
            Self::Knots(path) => path.start_s(),
            Self::Blocks(_) => Some(0.0),
        }
    }

    /// Path length where it ends \[mm\].
    pub fn end_s(&self) -> Option<f64> {
        match self {
            Self::Knots(path) => path.end_s(),
            Self::Blocks(window) => Some(window.borrow().blocks.summary().length_mm),
        }
    }

    /// All channels at path length `s` \[mm\], as programmed: before corners are rounded. None once the program cannot be
    /// read again.
    pub fn at(&self, s: f64) -> Option<PathPoint> {
        match self {
            Self::Knots(path) => path.at(s),
            Self::Blocks(window) => window.borrow_mut().at(s),
        }
    }
}

/// Elements around the place looked at last.
pub struct Window {
    blocks: Blocks,
    legs: Box<dyn Iterator<Item = Result<Leg, PathError>>>,
    /// With the place where each begins \[mm\].
    elements: VecDeque<(f64, Element)>,
    /// Where the next one begins \[mm\].
    end_s: f64,
    /// The program could not be read again.
    lost: bool,
}

impl fmt::Debug for Window {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Window")
            .field("end_s", &self.end_s)
            .finish_non_exhaustive()
    }
}

impl Window {
    fn new(blocks: &Blocks) -> Self {
        Self {
            legs: Box::new(blocks.legs()),
            blocks: blocks.clone(),
            elements: VecDeque::new(),
            end_s: 0.0,
            lost: false,
        }
    }

    fn at(&mut self, s: f64) -> Option<PathPoint> {
        if self.lost {
            return None;
        }
        let s = s.clamp(0.0, self.blocks.summary().length_mm);
        if self.elements.front().is_some_and(|(start, _)| s < *start) {
            *self = Self::new(&self.blocks);
        }
        while s >= self.end_s
            && let Some(leg) = self.legs.next()
        {
            let Ok(leg) = leg else {
                self.lost = true;
                return None;
            };
            if self.elements.len() > KEPT {
                self.elements.pop_front();
            }
            let start = self.end_s;
            self.end_s += leg.element.length;
            self.elements.push_back((start, leg.element));
        }
        let after = self.elements.partition_point(|(start, _)| *start <= s);
        let (start, element) = self.elements.get(after.checked_sub(1)?)?;
        Some(element.at((s - start).min(element.length)))
    }
}
