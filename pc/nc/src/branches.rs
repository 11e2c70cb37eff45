//! Loops and conditions: which line an O word makes the next one.

use super::error::{NcError, Problem, SourcePosition};
use super::flow::{self, Keyword, OWord};
use super::levels::Called;
use super::reader::{Reader, no_end};
use super::scanner::Scanner;
use super::siemens::structures::Structure;
use super::subroutines::head;

/// A loop or condition that is open.
#[derive(Clone, Debug)]
pub(super) enum Open {
    /// A part of it runs.
    If(String),
    /// Where its `while` stands: bytes and lines before. What conditions depended on there.
    While(String, u64, u32, u64),
    /// Where what follows `do` begins; the same.
    Do(String, u64, u32, u64),
    /// The same of `repeat`, and how many times more.
    Repeat(String, u64, u32, u64),
    /// Of a Siemens program.
    Structure(Structure),
}

impl Open {
    /// Number or name of its O words.
    fn label(&self) -> &str {
        match self {
            Self::If(label) | Self::While(label, ..) | Self::Do(label, ..) | Self::Repeat(label, ..) => label,
            Self::Structure(_) => "",
        }
    }

    pub(super) fn loops(&self) -> bool {
        match self {
            Self::Structure(structure) => structure.loops(),
            open => !matches!(open, Self::If(_)),
        }
    }

    /// It does not end before `place`, where the text does.
    pub(super) fn no_end(&self, place: SourcePosition) -> NcError {
        let (keyword, wanted) = match self {
            Self::If(_) => ("if", "endif"),
            Self::While(..) => ("while", "endwhile"),
            Self::Do(..) => ("do", "while"),
            Self::Repeat(..) => ("repeat", "endrepeat"),
            Self::Structure(structure) => return structure.no_end(place),
        };
        no_end(self.label().to_owned(), keyword, wanted, place)
    }
}

impl Reader {
    /// What an O word does.
    pub(super) fn flow(&mut self, word: &OWord) -> Result<(), NcError> {
        if word.keyword != Keyword::Number {
            self.interpreter.branches = true;
        }
        let label = word.label.clone();
        let (offset, line) = (self.level().offset, self.level().line);
        match word.keyword {
            Keyword::Number => {
                // Its own number is at its start.
                self.position.in_subroutine |= self.interpreter.placed && self.position.depth() == 0;
                Ok(())
            }
            Keyword::Sub => self
                .skip_to(word, "sub", &[Keyword::EndSub], "endsub")
                .map(|_| ()),
            Keyword::Call => {
                self.enter(&label, Called::OWord(label.clone()), 1, word.place)?;
                self.interpreter.parameters.enter(&word.arguments);
                Ok(())
            }
            Keyword::Return | Keyword::EndSub => {
                let value = word.arguments.first().copied();
                self.leave(value, word)
            }
            Keyword::If => {
                if self.condition(word, "if")? {
                    self.level().open.push(Open::If(label));
                    return Ok(());
                }
                loop {
                    let wanted = [Keyword::ElseIf, Keyword::Else, Keyword::EndIf];
                    let next = self.skip_to(word, "if", &wanted, "endif")?;
                    match next.keyword {
                        Keyword::ElseIf if !self.condition(&next, "elseif")? => {}
                        Keyword::ElseIf | Keyword::Else => {
                            self.level().open.push(Open::If(label));
                            return Ok(());
                        }
                        _ => return Ok(()),
                    }
                }
            }
            Keyword::ElseIf | Keyword::Else => {
                self.close(word, "else", "if", |open| matches!(open, Open::If(_)))?;
                self.skip_to(word, "else", &[Keyword::EndIf], "endif").map(|_| ())
            }
            Keyword::EndIf => self
                .close(word, "endif", "if", |open| matches!(open, Open::If(_)))
                .map(|_| ()),
            Keyword::While => {
                let done = matches!(self.level().open.last(), Some(Open::Do(own, ..)) if *own == label);
                let goes_on = self.condition(word, "while")?;
                if done {
                    if !goes_on {
                        self.level().open.pop();
                    } else if let Some(Open::Do(label, offset, line, conditions)) = self.level().open.pop() {
                        self.check_ends(conditions, word)?;
                        let conditions = self.interpreter.conditions();
                        self.level().open.push(Open::Do(label, offset, line, conditions));
                        self.jump(offset, line);
                    }
                    return Ok(());
                }
                if goes_on {
                    let (start, conditions) = (self.start_of_line(), self.conditions_before);
                    self.level()
                        .open
                        .push(Open::While(label, start, line - 1, conditions));
                    return Ok(());
                }
                self.skip_to(word, "while", &[Keyword::EndWhile], "endwhile")
                    .map(|_| ())
            }
            Keyword::EndWhile => {
                let open = self.close(word, "endwhile", "while", |open| matches!(open, Open::While(..)))?;
                if let Open::While(_, offset, line, conditions) = open {
                    self.check_ends(conditions, word)?;
                    self.jump(offset, line);
                }
                Ok(())
            }
            Keyword::Do => {
                let conditions = self.interpreter.conditions();
                self.level().open.push(Open::Do(label, offset, line, conditions));
                Ok(())
            }
            Keyword::Repeat => {
                let count = self.number(word, "repeat")?.round();
                if count < 1.0 {
                    let end = [Keyword::EndRepeat];
                    return self.skip_to(word, "repeat", &end, "endrepeat").map(|_| ());
                }
                let more = count as u64 - 1;
                self.level().open.push(Open::Repeat(label, offset, line, more));
                Ok(())
            }
            Keyword::EndRepeat => {
                let open = self.close(word, "endrepeat", "repeat", |open| {
                    matches!(open, Open::Repeat(..))
                })?;
                if let Open::Repeat(label, offset, line, more) = open
                    && more > 0
                {
                    self.level()
                        .open
                        .push(Open::Repeat(label, offset, line, more - 1));
                    self.jump(offset, line);
                }
                Ok(())
            }
            Keyword::Break => {
                self.leave_inner(word, "break")?;
                self.level().open.pop();
                let ends = [Keyword::EndWhile, Keyword::EndRepeat, Keyword::While];
                self.skip_to(word, "break", &ends, "end of its loop").map(|_| ())
            }
            Keyword::Continue => {
                self.leave_inner(word, "continue")?;
                let ends = [Keyword::EndWhile, Keyword::EndRepeat, Keyword::While];
                let end = self.skip_to(word, "continue", &ends, "end of its loop")?;
                self.flow(&end)
            }
        }
    }

    /// Refuses a loop whose next pass goes the same way as the last one, and so without end: nothing was set in it, and it has
    /// not looked at where the machine is.
    fn check_ends(&self, before: u64, word: &OWord) -> Result<(), NcError> {
        match self.interpreter.conditions() == before {
            true => Err(Problem::SameAgain(format!("o{}", word.label)).at(word.place)),
            false => Ok(()),
        }
    }

    /// Leaves what is open inside the loop that `word` names.
    fn leave_inner(&mut self, word: &OWord, keyword: &'static str) -> Result<(), NcError> {
        let open = &mut self.level().open;
        let found = open
            .iter()
            .rposition(|open| open.loops() && open.label() == word.label);
        let Some(index) = found else {
            let (label, wanted) = (word.label.clone(), "loop around it");
            return Err(no_end(label, keyword, wanted, word.place));
        };
        open.truncate(index + 1);
        Ok(())
    }

    /// Takes the innermost open loop or condition, which must be `word`'s.
    fn close(
        &mut self,
        word: &OWord,
        keyword: &'static str,
        wanted: &'static str,
        fits: impl Fn(&Open) -> bool,
    ) -> Result<Open, NcError> {
        let open = self.level().open.pop();
        let own = open.filter(|open| fits(open) && open.label() == word.label);
        own.ok_or_else(|| {
            let label = word.label.clone();
            no_end(label, keyword, wanted, word.place)
        })
    }

    fn number(&self, word: &OWord, keyword: &'static str) -> Result<f64, NcError> {
        match word.arguments[..] {
            [value] => Ok(value),
            _ => Err(Problem::FlowValue(keyword).at(word.place)),
        }
    }

    fn condition(&self, word: &OWord, keyword: &'static str) -> Result<bool, NcError> {
        Ok(self.number(word, keyword)? != 0.0)
    }

    /// Goes over lines to one with the label of `word` and a keyword that is wanted, behind it.
    fn skip_to(
        &mut self,
        word: &OWord,
        keyword: &'static str,
        ends: &[Keyword],
        wanted: &'static str,
    ) -> Result<OWord, NcError> {
        while let Some(text) = self.next_line()? {
            let line = self.position.here().line;
            if let Some(found) = head(&text, line, &mut self.interpreter)
                && found.label == word.label
                && ends.contains(&found.keyword)
            {
                if !matches!(found.keyword, Keyword::ElseIf | Keyword::While) {
                    return Ok(found);
                }
                // Now with its condition.
                let mut scanner = Scanner::new(&text, line);
                let whole = flow::o_word(&mut scanner, &mut self.interpreter, true)?;
                return Ok(whole.unwrap_or(found));
            }
        }
        let label = word.label.clone();
        Err(no_end(label, keyword, wanted, word.place))
    }
}
