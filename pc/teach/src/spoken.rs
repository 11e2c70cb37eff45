//! Commands of an operator who leads a machine: a word, and a number with most of them.

/// Largest move and turn at once \[mm\], \[deg\].
const FARTHEST: f64 = 100.0;
const WIDEST: f64 = 15.0;

/// A line of the operator.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spoken<'l> {
    pub word: &'l str,
    pub value: Option<&'l str>,
}

impl<'l> Spoken<'l> {
    /// `line`, if there is anything in it; what is wrong with it otherwise.
    pub fn of(line: &'l str) -> Result<Option<Self>, String> {
        let mut words = line.split_whitespace();
        let Some(word) = words.next() else {
            return Ok(None);
        };
        let value = words.next();
        match words.next() {
            Some(rest) => Err(format!("{rest} is too much: type a command and one number")),
            None => Ok(Some(Self { word, value })),
        }
    }

    /// Which of `names` the word is.
    pub fn place(&self, names: &[&str]) -> Option<usize> {
        names.iter().position(|name| *name == self.word)
    }

    /// The number of a move.
    pub fn mm(&self) -> Result<f64, String> {
        self.number(FARTHEST, "mm")
    }

    /// The number of a turn.
    pub fn deg(&self) -> Result<f64, String> {
        self.number(WIDEST, "deg")
    }

    /// The word, which has no number.
    pub fn alone(&self) -> Result<&'l str, String> {
        match self.value {
            Some(value) => Err(format!("{} takes no number, not {value}", self.word)),
            None => Ok(self.word),
        }
    }

    fn number(&self, most: f64, unit: &str) -> Result<f64, String> {
        let text = self
            .value
            .ok_or_else(|| format!("{} needs a number [{unit}]", self.word))?;
        let number: f64 = text.parse().map_err(|_| format!("{text} is not a number"))?;
        if number.abs() <= most {
            Ok(number)
        } else {
            Err(format!("{number} {unit} is more than {most} {unit} at once"))
        }
    }
}
