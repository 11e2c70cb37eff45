//! What a file does not have yet, and what it is to have no more.

use toml_edit::{DocumentMut, Item, Table, TableLike, TomlError, Value, value};

/// `text` with `number` as the value called `key` of the table with these names, from outside inwards; tables that are not there
/// are made. The rest of it stays to the letter.
///
/// # Errors
/// It is no TOML.
pub fn insert(text: &str, tables: &[&str], key: &str, number: f64) -> Result<String, TomlError> {
    let mut document: DocumentMut = text.parse()?;
    let mut table: &mut dyn TableLike = document.as_table_mut();
    for (depth, name) in tables.iter().enumerate() {
        if !table.get(name).is_some_and(Item::is_table_like) {
            let mut new = Table::new();
            // Tables of tables have no line of their own.
            new.set_implicit(depth + 1 < tables.len());
            table.insert(name, Item::Table(new));
        }
        let Some(inner) = table.get_mut(name).and_then(Item::as_table_like_mut) else {
            return Ok(text.to_owned());
        };
        table = inner;
    }
    table.insert(key, value(number));
    Ok(document.to_string())
}

/// `text` with `written`, a value as TOML has it, as what is called `key` in the table called `table`; the rest of it stays to the letter.
///
/// # Errors
/// It is no TOML, or `written` is no value.
pub fn insert_written(text: &str, table: &str, key: &str, written: &str) -> Result<String, TomlError> {
    let mut document: DocumentMut = text.parse()?;
    let written: Value = written.parse()?;
    if let Some(table) = document.get_mut(table).and_then(Item::as_table_like_mut) {
        table.insert(key, value(written));
    }
    Ok(document.to_string())
}

/// `text` with another table called `name` at its end, which has what the one called `of` has, and nothing where there is no such
/// table.
///
/// # Errors
/// It is no TOML.
pub fn copy(text: &str, of: &str, name: &str) -> Result<String, TomlError> {
    let document: DocumentMut = text.parse()?;
    let of = document.get(of).cloned();
    let mut table = of.and_then(|of| of.into_table().ok()).unwrap_or_default();
    // The comment over it is that of the other one.
    table.decor_mut().clear();
    let mut end = DocumentMut::new();
    end.insert(name, Item::Table(table));
    let gap = match text {
        "" => "",
        text if text.ends_with('\n') => "\n",
        _ => "\n\n",
    };
    Ok(format!("{text}{gap}{end}"))
}

/// `text` without the table with these names, from outside inwards, and without the comment on it.
///
/// # Errors
/// It is no TOML.
pub fn remove(text: &str, tables: &[&str]) -> Result<String, TomlError> {
    let mut document: DocumentMut = text.parse()?;
    let Some((last, around)) = tables.split_last() else {
        return Ok(text.to_owned());
    };
    let mut table: &mut dyn TableLike = document.as_table_mut();
    for name in around {
        let Some(inner) = table.get_mut(name).and_then(Item::as_table_like_mut) else {
            return Ok(text.to_owned());
        };
        table = inner;
    }
    table.remove(last);
    Ok(document.to_string())
}
