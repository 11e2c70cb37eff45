//! Reading programs of canonical segments, one a line:
//!
//! - `L x y z a b c feed`: straight (mm, degrees, mm/s; degrees/s where only rotary axes move);
//! - `C x y z cx cy cz nx ny nz turn feed`: to x y z about the axis n through c, see [`Spiral::new`].
//!
//! The first segment begins where all axes are 0. Lines that lead nowhere are left out.

use super::spiral::{Spiral, SpiralError};
use super::way::{Move, ROTARY, Way};
use curves::nurbs::length;
use nalgebra::Vector3;
use shared::geometry::Line;
use thiserror::Error;

/// Ways shorter than this (mm, rad) lead nowhere.
const NOWHERE: f64 = 1e-9;

/// A line that is no segment, and where.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{file}:{line}: {why}")]
pub struct SegError {
    /// Name of the file.
    pub file: String,
    /// Number of the line, from 1.
    pub line: u32,
    /// What is wrong.
    pub why: Why,
}

/// What is wrong with a line.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Why {
    /// Neither L nor C.
    #[error("'{0}' is no segment; L is a line, C an arc")]
    Kind(String),
    /// Too few numbers, or too many.
    #[error("{seen} numbers after '{kind}', which takes {wanted}")]
    Numbers {
        /// L or C.
        kind: char,
        /// How many there are.
        seen: usize,
        /// How many there must be.
        wanted: usize,
    },
    /// Not a number, or one that is not finite.
    #[error("'{0}' is not a finite number")]
    Number(String),
    /// Not above zero.
    #[error("the feed is {0}; it must be above zero")]
    Feed(f64),
    /// Not a whole number that a program would hold.
    #[error("the turn is {0}; it must be a whole number within ±1000000")]
    Turn(f64),
    /// The arc is not valid.
    #[error(transparent)]
    Arc(#[from] SpiralError),
}

/// Reads a program; `file` names it in errors.
pub fn read(text: &str, file: &str) -> Result<Vec<Move>, SegError> {
    let mut moves = Vec::new();
    let mut at = AxesPosition::default();
    for (number, text) in (1..).zip(text.lines()) {
        let error = |why| SegError {
            file: file.to_owned(),
            line: number,
            why,
        };
        moves.extend(at.segment(number, text).map_err(error)?);
    }
    Ok(moves)
}

/// Where the axes stand.
#[derive(Default)]
struct AxesPosition {
    position: Vector3<f64>,
    rotary: [f64; ROTARY],
}

impl AxesPosition {
    fn segment(&mut self, line: u32, text: &str) -> Result<Option<Move>, Why> {
        let mut words = text.split_whitespace();
        match words.next() {
            None => Ok(None),
            Some("L") => {
                let [x, y, z, a, b, c, feed] = numbers('L', words)?;
                self.line(line, Vector3::new(x, y, z), [a, b, c].map(f64::to_radians), feed)
            }
            Some("C") => {
                let [x, y, z, cx, cy, cz, nx, ny, nz, turn, feed] = numbers('C', words)?;
                let [to, centre, normal] = [[x, y, z], [cx, cy, cz], [nx, ny, nz]].map(Vector3::from);
                self.arc(line, to, centre, normal, turn, feed).map(Some)
            }
            Some(other) => Err(Why::Kind(other.to_owned())),
        }
    }

    fn line(
        &mut self,
        line: u32,
        to: Vector3<f64>,
        rotary: [f64; ROTARY],
        feed: f64,
    ) -> Result<Option<Move>, Why> {
        let feed = checked(feed)?;
        let from = std::mem::replace(self, Self { position: to, rotary });
        let turned = (0..ROTARY).map(|i| (rotary[i] - from.rotary[i]).abs());
        let turned = turned.fold(0.0, f64::max);
        let (way, length, feed) = match Line::new(from.position, to) {
            Ok(line) => (Way::Line(line), line.length(), feed),
            Err(_) => (Way::Stand(from.position), turned, feed.to_radians()),
        };
        if length <= NOWHERE {
            // The next one begins where this one did.
            *self = from;
            return Ok(None);
        }
        Ok(Some(Move {
            line,
            way,
            rotary: [from.rotary, rotary],
            length,
            feed,
        }))
    }

    fn arc(
        &mut self,
        line: u32,
        to: Vector3<f64>,
        centre: Vector3<f64>,
        normal: Vector3<f64>,
        turn: f64,
        feed: f64,
    ) -> Result<Move, Why> {
        let feed = checked(feed)?;
        if turn.fract() != 0.0 || turn.abs() > 1e6 {
            return Err(Why::Turn(turn));
        }
        let spiral = Spiral::new(self.position, to, centre, normal, turn as i32)?;
        self.position = to;
        Ok(Move {
            line,
            way: Way::Spiral(spiral),
            rotary: [self.rotary; 2],
            length: length(&spiral),
            feed,
        })
    }
}

/// Feeds above this \[mm/s\] mean "as fast as it can", and are no element's.
const FASTEST: f64 = 1e6;

fn checked(feed: f64) -> Result<f64, Why> {
    if feed > 0.0 {
        Ok(feed.min(FASTEST))
    } else {
        Err(Why::Feed(feed))
    }
}

fn numbers<'a, const N: usize>(
    kind: char,
    words: impl Iterator<Item = &'a str> + Clone,
) -> Result<[f64; N], Why> {
    let seen = words.clone().count();
    if seen != N {
        return Err(Why::Numbers {
            kind,
            seen,
            wanted: N,
        });
    }
    let mut numbers = [0.0; N];
    for (number, word) in numbers.iter_mut().zip(words) {
        *number = word
            .parse()
            .ok()
            .filter(|x: &f64| x.is_finite())
            .ok_or_else(|| Why::Number(word.to_owned()))?;
    }
    Ok(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn segments_follow_one_another() {
        let text = "L 3 4 0 0 90 0 10\n\nL 3 4 0 0 90 0 7\nC 3 -4 1 3 0 5 0 0 2 -1 20\nL 3 -4 1 0 0 180 45\n";
        let moves = read(text, "x").expect("a program");
        assert_eq!(
            moves.iter().map(|m| m.line).collect::<Vec<_>>(),
            [1, 4, 5],
            "one leads nowhere"
        );
        assert_eq!((moves[0].length, moves[0].feed), (5.0, 10.0));
        assert_eq!(moves[0].rotary, [[0.0; 3], [0.0, PI / 2.0, 0.0]]);
        assert!((moves[1].length - (4.0 * PI).hypot(1.0)).abs() < 1e-9);
        assert!((moves[2].length - PI).abs() < 1e-12);
        assert!((moves[2].feed - PI / 4.0).abs() < 1e-12);
        assert!(matches!(moves[2].way, Way::Stand(_)));
        for pair in moves.windows(2) {
            assert!((pair[0].way.end() - pair[1].way.start()).norm() < 1e-12);
            assert_eq!(pair[0].rotary[1], pair[1].rotary[0]);
        }
    }

    #[test]
    fn a_malformed_line_is_told_with_its_place() {
        for (line, why) in [
            ("G1 X1", "'G1' is no segment; L is a line, C an arc"),
            ("L 1 2 3", "3 numbers after 'L', which takes 7"),
            ("C 1 2 3 0 0 0 1", "7 numbers after 'C', which takes 11"),
            ("L 1 2 x 0 0 0 1", "'x' is not a finite number"),
            ("L 1 2 inf 0 0 0 1", "'inf' is not a finite number"),
            ("L 1 2 3 0 0 0 0", "the feed is 0; it must be above zero"),
            ("L 1 2 3 0 0 0 NaN", "'NaN' is not a finite number"),
            (
                "C 1 2 3 0 0 0 0 0 1 0.5 1",
                "the turn is 0.5; it must be a whole number within ±1000000",
            ),
            ("C 1 2 3 0 0 0 0 0 0 0 1", "the axis of the arc is zero"),
            (
                "C 1 2 3 9 0 0 0 0 1 0 1",
                "the arc begins 0 mm and ends 8.246211251235321 mm from its axis; both must be above zero",
            ),
        ] {
            let text = format!("L 9 0 0 0 0 0 1\n{line}\n");
            let error = read(&text, "bad.seg").expect_err(line).to_string();
            assert_eq!(error, format!("bad.seg:2: {why}"));
        }
    }
}
