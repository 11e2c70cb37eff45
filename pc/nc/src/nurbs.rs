//! NURBS blocks: control points and knots, word by word, until the curve is complete.
//!
//! G5.2 … G5.3 is LinuxCNC's: X Y, weights P and order L, the knots even. G6.2 is the one that LinuxCNC has
//! from other controllers: X Y Z, weights R, order P, and a knot K in every block; as many blocks as the order
//! have nothing but a knot, and the last of them ends the curve.

use super::block::{Block, Word};
use super::claims::Claims;
use super::codes::{Code, Group};
use super::error::{NcError, Problem, SourcePosition};
use super::program::{ControlPoint, FeedRate, NurbsWay, Words};
use shared::geometry::nurbs::MAX_DEGREE;

/// Order of a G5.2 without L.
const UNIFORM_ORDER: usize = 3;
/// Order of a G6.2 without P.
const KNOT_ORDER: usize = 4;

/// A curve that is not complete yet.
#[derive(Clone, Debug)]
pub(super) struct OpenNurbs {
    /// G5.2 or G6.2.
    code: Code,
    pub(super) place: SourcePosition,
    pub(super) feed: FeedRate,
    order: usize,
    points: Vec<ControlPoint>,
    knots: Vec<(f64, SourcePosition)>,
    /// What the last control point says of the end.
    words: Words,
    /// Where a word of an axis or slide beyond X Y Z was said.
    other_word: Option<(String, SourcePosition)>,
}

/// What a block did to an open curve.
pub(super) enum Progress {
    /// More is to come.
    Open,
    /// It is complete: its shape and the words of its end.
    Complete(NurbsWay, Words),
}

/// Axes that a control point has.
const POSITION_WORDS: [&str; 3] = ["X", "Y", "Z"];
/// Axes and slides of which it only has the end.
const OTHER_WORDS: [&str; 5] = ["A", "B", "C", "V1", "V2"];

impl OpenNurbs {
    /// The curve that `block` opens with `code` at `place`.
    pub(super) fn begin(
        block: &Block,
        claims: &Claims,
        code: Code,
        place: SourcePosition,
        feed: FeedRate,
    ) -> Result<Self, NcError> {
        let (word, default) = match code {
            Code::UniformNurbs => ("L", UNIFORM_ORDER),
            _ => ("P", KNOT_ORDER),
        };
        let order = match claims.word(code, word) {
            Some(order) => order
                .number_below(MAX_DEGREE as u8 + 2)
                .filter(|order| *order >= 2)
                .ok_or_else(|| order.value_error("the order of a NURBS is 2, 3, 4, 5 or 6"))?
                .into(),
            None => default,
        };
        let mut open = Self {
            code,
            place,
            feed,
            order,
            points: Vec::new(),
            knots: Vec::new(),
            words: Words::default(),
            other_word: None,
        };
        match code {
            Code::UniformNurbs => open.first_uniform(block, claims.word(code, "P"))?,
            _ => {
                let weight = weight(block.word("R"))?;
                open.knot(block)?;
                open.point(block, weight, place)?;
            }
        }
        Ok(open)
    }

    /// G5.2 with P alone weighs the first control point; with X Y it has the second one, too.
    fn first_uniform(&mut self, block: &Block, p: Option<&Word>) -> Result<(), NcError> {
        let second = block.words.iter().any(is_axis);
        let weight = if second { 1.0 } else { weight(p)? };
        self.points.push(ControlPoint {
            position: [None; 3],
            weight,
            place: self.place,
        });
        if second {
            self.uniform_point(block, p)
        } else {
            Ok(())
        }
    }

    /// Takes up the next block while the curve is open.
    pub(super) fn block(&mut self, block: &Block) -> Result<Progress, NcError> {
        let (open, close) = (self.code.name(), self.close().name());
        let motion = block.code(Group::Motion).map(|code| code.code);
        let foreign = block.codes.iter().find(|code| {
            let own = code.code == self.code || code.code == self.close();
            !own
        });
        if let Some(code) = foreign {
            let line = self.place.line;
            return Err(Problem::NurbsOpen { open, line, close }.at(code.place));
        }
        let allowed: &[&str] = match (motion == Some(self.close()), self.code) {
            (true, _) => &[],
            (false, Code::UniformNurbs) => &["X", "Y", "Z", "P", "A", "B", "C", "V1", "V2"],
            (false, _) => &["X", "Y", "Z", "K", "R", "A", "B", "C", "V1", "V2"],
        };
        if let Some(word) = block
            .words
            .iter()
            .find(|w| !allowed.contains(&w.address.as_str()))
        {
            let code = if allowed.is_empty() { close } else { open };
            let word_label = word.label();
            return Err(Problem::NotInNurbs {
                word: word_label,
                code,
            }
            .at(word.place));
        }
        match (motion == Some(self.close()), self.code) {
            (true, Code::UniformNurbs) => self.end_uniform(block),
            (true, _) => Err(self.incomplete().at(place_of(block))),
            (false, Code::UniformNurbs) => {
                self.uniform_point(block, block.word("P"))?;
                Ok(Progress::Open)
            }
            (false, _) => self.knot_block(block),
        }
    }

    fn close(&self) -> Code {
        match self.code {
            Code::UniformNurbs => Code::UniformNurbsEnd,
            _ => Code::KnotNurbsEnd,
        }
    }

    /// The program ends at `place` before the curve does.
    pub(super) fn left_open(&self, place: SourcePosition) -> NcError {
        let (open, close, line) = (self.code.name(), self.close().name(), self.place.line);
        Problem::NurbsOpen { open, line, close }.at(place)
    }

    fn uniform_point(&mut self, block: &Block, p: Option<&Word>) -> Result<(), NcError> {
        for word in ["X", "Y"] {
            let code = "a control point of G5.2";
            if block.word(word).is_none() {
                return Err(Problem::Missing { code, word }.at(place_of(block)));
            }
        }
        if let Some(z) = block.word("Z") {
            return Err(Problem::FlatNurbs.at(z.place));
        }
        let weight = weight(p)?;
        self.point(block, weight, place_of(block))
    }

    fn end_uniform(&mut self, block: &Block) -> Result<Progress, NcError> {
        let (count, order) = (self.points.len(), self.order);
        if count < order {
            let points = count;
            return Err(Problem::FewPoints { points, order }.at(place_of(block)));
        }
        let spans = count - order + 1;
        let knots = (0..count + order)
            .map(|i| (i + 1).saturating_sub(order).min(spans) as f64)
            .collect();
        Ok(self.complete(knots))
    }

    /// A block of G6.2 after the first.
    fn knot_block(&mut self, block: &Block) -> Result<Progress, NcError> {
        self.knot(block)?;
        if block.words.iter().any(is_position) {
            if self.knots.len() > self.points.len() + 1 {
                return Err(Problem::PointAfterKnots.at(place_of(block)));
            }
            let weight = weight(block.word("R"))?;
            self.point(block, weight, place_of(block))?;
        } else if let Some(word) = block.words.iter().find(|word| word.address != "K") {
            let (word_label, code) = (word.label(), "a knot on its own");
            return Err(Problem::NotInNurbs {
                word: word_label,
                code,
            }
            .at(word.place));
        } else if self.points.len() < self.order {
            let (points, order) = (self.points.len(), self.order);
            return Err(Problem::FewPoints { points, order }.at(place_of(block)));
        }
        if self.knots.len() < self.points.len() + self.order {
            return Ok(Progress::Open);
        }
        self.check_knots()?;
        let knots = self.knots.iter().map(|(knot, _)| *knot).collect();
        Ok(self.complete(knots))
    }

    /// Takes up K of `block`.
    fn knot(&mut self, block: &Block) -> Result<(), NcError> {
        let missing = Problem::Missing {
            code: "every block of a G6.2",
            word: "K",
        };
        let k = block.word("K").ok_or(missing.at(place_of(block)))?;
        if self.knots.last().is_some_and(|(before, _)| k.value < *before) {
            return Err(k.value_error("knots must not decrease"));
        }
        self.knots.push((k.value, k.place));
        Ok(())
    }

    /// As many equal knots as the order at both ends, so that the curve has its ends at control points, and fewer in
    /// between, so that it holds together.
    fn check_knots(&self) -> Result<(), NcError> {
        let order = self.order;
        let error = |index: usize, reason| {
            let (value, place) = self.knots[index];
            let word = "K".to_owned();
            Err(Problem::Value { word, value, reason }.at(place))
        };
        let equal = |a: usize, b: usize| self.knots[a].0 == self.knots[b].0;
        let last = self.knots.len() - 1;
        if let Some(i) = (1..order).find(|i| !equal(0, *i)) {
            return error(i, "as many knots as the order are equal at the start");
        }
        if let Some(i) = (last + 1 - order..last).find(|i| !equal(*i, last)) {
            return error(i, "as many knots as the order are equal at the end");
        }
        // A run of that many anywhere else tears the curve, or leaves nothing of it.
        let inner = 1..=last - order;
        if let Some(i) = inner.clone().find(|i| equal(*i, i + order - 1)) {
            return error(i, "fewer knots than the order may be equal inside");
        }
        Ok(())
    }

    fn point(&mut self, block: &Block, weight: f64, place: SourcePosition) -> Result<(), NcError> {
        if let Some((word, place)) = &self.other_word {
            let word = word.clone();
            return Err(Problem::TurnInside { word }.at(*place));
        }
        let position = POSITION_WORDS.map(|name| block.word(name).map(|word| word.value));
        for (said, now) in self.words.axes.iter_mut().zip(position) {
            *said = now.or(*said);
        }
        let own = Words::of(block);
        self.words.axes[3..].copy_from_slice(&own.axes[3..]);
        self.words.extension = own.extension;
        let other = block.words.iter().find(|w| is_axis(w) && !is_position(w));
        self.other_word = other.map(|word| (word.label(), word.place));
        self.points.push(ControlPoint {
            position,
            weight,
            place,
        });
        Ok(())
    }

    fn incomplete(&self) -> Problem {
        let (points, order) = (self.points.len(), self.order);
        if points < order {
            return Problem::FewPoints { points, order };
        }
        Problem::FewKnots {
            knots: self.knots.len(),
            points,
            order,
        }
    }

    fn complete(&mut self, knots: Vec<f64>) -> Progress {
        let way = NurbsWay {
            order: self.order,
            points: std::mem::take(&mut self.points),
            knots,
        };
        Progress::Complete(way, self.words)
    }
}

fn is_position(word: &Word) -> bool {
    POSITION_WORDS.contains(&word.address.as_str())
}

fn is_axis(word: &Word) -> bool {
    is_position(word) || OTHER_WORDS.contains(&word.address.as_str())
}

fn weight(word: Option<&Word>) -> Result<f64, NcError> {
    match word {
        Some(word) if word.value <= 0.0 => Err(word.value_error("the weight must be above 0")),
        Some(word) => Ok(word.value),
        None => Ok(1.0),
    }
}

/// Where the words of a block begin.
fn place_of(block: &Block) -> SourcePosition {
    let words = block.words.iter().map(|word| word.place);
    let codes = block.codes.iter().map(|code| code.place);
    let first = words.chain(codes).min_by_key(|place| place.column);
    first.unwrap_or(SourcePosition {
        line: block.line,
        column: 1,
    })
}
