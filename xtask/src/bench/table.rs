//! The table of what was counted.

use super::{Row, markdown};
use anyhow::{Result, ensure};

const HEAD: [&str; 6] = [
    "machine",
    "function",
    "x86-64 mean",
    "worst",
    "Cortex-M7 mean",
    "worst",
];

/// What was counted on the PC and on the board, side by side, as Markdown.
pub fn of(pc: Vec<Row>, board: Vec<Row>) -> Result<String> {
    let names = |rows: &[Row]| -> Vec<_> {
        let name = |row: &Row| (row.subject.clone(), row.function.clone(), row.tally.calls);
        rows.iter().map(name).collect()
    };
    ensure!(
        names(&pc) == names(&board),
        "PC and board have counted different things"
    );
    let lines: Vec<[String; 6]> = pc
        .into_iter()
        .zip(board)
        .map(|(pc, board)| {
            [
                pc.subject,
                pc.function,
                format!("{:.0}", pc.tally.mean()),
                pc.tally.worst.to_string(),
                format!("{:.0}", board.tally.mean()),
                board.tally.worst.to_string(),
            ]
        })
        .collect();
    Ok(markdown::table(HEAD, 2, &lines))
}

#[cfg(test)]
mod tests {
    use super::*;
    use benchmarks::record::Tally;

    fn row(function: &str, worst: u32) -> Row {
        Row {
            subject: "pipe-welder".into(),
            function: function.into(),
            tally: Tally {
                calls: 2,
                total: 2 * u64::from(worst) - 3,
                worst,
            },
        }
    }

    #[test]
    fn both_targets_stand_side_by_side() {
        let table = of(vec![row("inverse", 120)], vec![row("inverse", 220)]).expect("the same");
        let lines: Vec<&str> = table.lines().collect();
        assert_eq!(lines.len(), 3);
        assert_eq!(
            lines[2],
            "| pipe-welder | inverse  |         118 |   120 |            218 |   220 |"
        );
        assert!(lines.iter().all(|line| line.len() == lines[0].len()), "{table}");
    }

    #[test]
    fn different_things_do_not_stand_side_by_side() {
        assert!(of(vec![row("inverse", 9)], vec![row("rates", 9)]).is_err());
    }
}
