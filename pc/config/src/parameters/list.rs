//! Every value of a TOML file, with its comment and place.

use super::unit;
use crate::toml_file::line_at;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// A table of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Its dotted name; empty for what stands above all tables.
    pub name: String,
    /// The comment on it.
    pub comment: String,
    /// Its values, in the order of the file.
    pub parameters: Vec<Parameter>,
}

/// A value of a file. Those of inline tables are values of their own; an array is one.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Dotted name of its key, with those of the tables around it.
    pub key: String,
    /// The part of the name behind that of its table.
    pub name: String,
    /// The value as it is written.
    pub value: String,
    /// What it is.
    pub kind: Kind,
    /// Its unit, by its name; empty if it has none.
    pub unit: &'static str,
    /// The comment on it.
    pub comment: String,
    /// Its line; the first is 1.
    pub line: usize,
    /// Where the value is in the text.
    pub(super) span: Range<usize>,
}

/// What a value is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A number.
    Float,
    /// A whole number.
    Integer,
    /// A text.
    Text,
    /// Anything else, written as in the file.
    Other,
}

impl Kind {
    pub(super) fn of(value: &DeValue) -> Self {
        match value {
            DeValue::Float(_) => Self::Float,
            DeValue::Integer(_) => Self::Integer,
            DeValue::String(_) => Self::Text,
            _ => Self::Other,
        }
    }
}

/// All tables of `text` that have values, in its order; none of what is no TOML.
pub fn list(text: &str) -> Vec<Table> {
    listed(text, false)
}

/// The same, with each element of an array of numbers or of tables as a value of its own, called by its number from 0.
pub fn list_elements(text: &str) -> Vec<Table> {
    listed(text, true)
}

fn listed(text: &str, elements: bool) -> Vec<Table> {
    let Ok(document) = DeTable::parse(text) else {
        return Vec::new();
    };
    let mut walk = Walk {
        text,
        elements,
        tables: Vec::new(),
    };
    walk.table("", document.get_ref(), String::new());
    let mut tables = walk.tables;
    tables.retain(|table| !table.parameters.is_empty());
    for table in &mut tables {
        table.parameters.sort_by_key(|parameter| parameter.span.start);
        unit::of_spindle(&mut table.parameters);
    }
    tables.sort_by_key(|table| table.parameters.first().map(|first| first.span.start));
    tables
}

struct Walk<'a> {
    text: &'a str,
    /// Elements of arrays are listed, too.
    elements: bool,
    tables: Vec<Table>,
}

/// The statement that a value stands in.
struct Statement {
    comment: String,
    /// The table that has it, as an index.
    table: usize,
}

impl Walk<'_> {
    fn table(&mut self, key: &str, table: &DeTable, comment: String) {
        let index = self.tables.len();
        self.tables.push(Table {
            name: key.to_owned(),
            comment,
            parameters: Vec::new(),
        });
        for (name, value) in table {
            let key = joined(key, name.get_ref());
            match value.get_ref() {
                DeValue::Table(inner) if !self.is_inline(&value.span()) => {
                    let comment = self.comment(value.span().start, value.span().end);
                    self.table(&key, inner, comment);
                }
                DeValue::Array(elements)
                    if self.text[value.span()].starts_with("[[") && all_tables(elements) =>
                {
                    for (number, element) in elements.iter().enumerate() {
                        if let DeValue::Table(inner) = element.get_ref() {
                            let comment = self.comment(element.span().start, element.span().end);
                            self.table(&format!("{key}.{number}"), inner, comment);
                        }
                    }
                }
                inner => {
                    let statement = Statement {
                        comment: self.comment(name.span().start, value.span().end),
                        table: index,
                    };
                    self.value(&key, inner, name.span().start, value.span(), &statement);
                }
            }
        }
    }

    fn value(&mut self, key: &str, value: &DeValue, start: usize, span: Range<usize>, of: &Statement) {
        if let DeValue::Table(inner) = value {
            for (name, value) in inner {
                let key = joined(key, name.get_ref());
                self.value(&key, value.get_ref(), name.span().start, value.span(), of);
            }
            return;
        }
        if let DeValue::Array(inner) = value
            && self.elements
            && !inner.is_empty()
            && (all_tables(inner) || all_numbers(inner))
        {
            for (number, element) in inner.iter().enumerate() {
                let (key, span) = (joined(key, &number.to_string()), element.span());
                self.value(&key, element.get_ref(), span.start, span, of);
            }
            return;
        }
        let table = &mut self.tables[of.table];
        table.parameters.push(Parameter {
            name: key[table.name.len()..].trim_start_matches('.').to_owned(),
            value: self.text[span.clone()].to_owned(),
            kind: Kind::of(value),
            unit: unit::unit(key),
            comment: of.comment.clone(),
            line: line_at(self.text, start),
            key: key.to_owned(),
            span,
        });
    }

    fn is_inline(&self, span: &Range<usize>) -> bool {
        self.text[span.clone()].starts_with('{')
    }

    /// The comment on what stands from `start` to `end`: the lines above, up to a blank one, and what is behind. Between a table and
    /// its comment there may be blank lines.
    fn comment(&self, start: usize, end: usize) -> String {
        let (above, rest) = self.text.split_at(start);
        let above = above.rfind('\n').map_or("", |line| &above[..line]);
        let is_table = rest.starts_with('[');
        let mut lines: Vec<&str> = above
            .split('\n')
            .rev()
            .map(str::trim)
            .skip_while(|line| is_table && line.is_empty())
            .map_while(|line| line.strip_prefix('#'))
            .map(str::trim)
            .collect();
        lines.reverse();
        let behind = self.text[end..].lines().next().unwrap_or_default().trim();
        lines.extend(behind.strip_prefix('#').map(str::trim));
        lines.join(" ")
    }
}

fn all_tables(elements: &toml::de::DeArray) -> bool {
    elements.iter().all(|element| element.get_ref().is_table())
}

fn all_numbers(elements: &toml::de::DeArray) -> bool {
    let is_number = |value: &DeValue| matches!(value, DeValue::Integer(_) | DeValue::Float(_));
    elements.iter().all(|element| is_number(element.get_ref()))
}

fn joined(table: &str, name: &str) -> String {
    match table {
        "" => name.to_owned(),
        table => format!("{table}.{name}"),
    }
}
