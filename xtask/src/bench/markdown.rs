//! Tables in Markdown that are tables to the eye too.

/// The first `texts` columns hold text, the others numbers.
pub fn table<const N: usize>(head: [&str; N], texts: usize, lines: &[[String; N]]) -> String {
    let width: [usize; N] = std::array::from_fn(|column| {
        let cells = lines.iter().map(|line| line[column].chars().count());
        cells
            .chain([head[column].chars().count()])
            .max()
            .unwrap_or_default()
    });
    let mut table = line(&head.map(str::to_owned), &width, texts);
    table += "|";
    for (column, width) in width.iter().enumerate() {
        let end = if column < texts { '-' } else { ':' };
        table += &format!("{}{end}|", "-".repeat(width + 1));
    }
    table += "\n";
    for cells in lines {
        table += &line(cells, &width, texts);
    }
    table
}

fn line<const N: usize>(cells: &[String; N], width: &[usize; N], texts: usize) -> String {
    let mut line = String::from("|");
    for (column, (cell, width)) in cells.iter().zip(width).enumerate() {
        line += &if column < texts {
            format!(" {cell:<width$} |")
        } else {
            format!(" {cell:>width$} |")
        };
    }
    line + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_as_wide_as_their_widest_cell() {
        let lines = [["a", "1"], ["bcd", "23456"]].map(|line| line.map(str::to_owned));
        let expected = "| x   |    µm |\n|-----|------:|\n| a   |     1 |\n| bcd | 23456 |\n";
        assert_eq!(table(["x", "µm"], 1, &lines), expected);
    }
}
