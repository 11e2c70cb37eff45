//! What both say of many programs, for people.

use crate::quirks;
use crate::run::{Judgement, Pair};
use std::cmp::Reverse;
use std::fmt::Write;

/// So many sentences are shown of those that differ in numbers only.
const SENTENCES: usize = 8;

/// A program, as it is told.
pub struct Told {
    pub name: String,
    pub lathe: bool,
}

/// Whether nothing is that must not be: differences without a known reason, panics, hangs.
pub fn is_good(programs: &[Told], pairs: &[Pair]) -> bool {
    let excused = |pair: &Pair| !pair.broken && quirks::reason(&programs[pair.index].name).is_some();
    pairs.iter().all(|pair| !pair.fails() || excused(pair))
}

/// The tables.
pub fn of(programs: &[Told], pairs: &[Pair]) -> String {
    let by = |wanted: &dyn Fn(&Pair) -> bool| pairs.iter().filter(|pair| wanted(pair)).count();
    let ours = by(&|pair| pair.ours.accepted());
    let peer = by(&|pair| pair.peer.accepted());
    let counts = |pair: &Pair| pair.peer.accepted() && !programs[pair.index].lathe;
    let all = by(&|pair| counts(pair));
    let both = by(&|pair| counts(pair) && pair.ours.accepted());
    let name = |pair: &Pair| &programs[pair.index].name;
    let excused = |pair: &Pair| quirks::reason(name(pair));
    let different = pairs.iter().filter(|pair| pair.difference.is_some());
    let (known, unknown): (Vec<_>, Vec<_>) = different.partition(|pair| excused(pair).is_some());

    let mut text = format!(
        "programs {}, the peer accepts {peer}, we accept {ours}, of those the peer accepts (lathe and threading aside) \
         {both} of {all} = {:.1} %; differences {}\n",
        programs.len(),
        100.0 * both as f64 / all.max(1) as f64,
        unknown.len(),
    );
    text.push_str(&reasons(
        "refused by us, of those that the peer accepts, lathe and threading aside",
        pairs
            .iter()
            .filter(|pair| counts(pair))
            .map(|pair| (name(pair), &pair.ours)),
    ));
    text.push_str(&reasons(
        "refused by the peer",
        pairs.iter().map(|pair| (name(pair), &pair.peer)),
    ));
    text.push_str(&reasons(
        "refused by both, as we say it",
        pairs
            .iter()
            .filter(|pair| !pair.peer.accepted())
            .map(|pair| (name(pair), &pair.ours)),
    ));
    let only_ours = by(&|pair| pair.ours.accepted() && !pair.peer.accepted());
    if only_ours > 0 {
        writeln!(text, "\naccepted by us only: {only_ours}").ok();
        for pair in pairs {
            if let (true, Judgement::Refused { problem, .. }) = (pair.ours.accepted(), &pair.peer) {
                writeln!(text, "  {}: {problem}", name(pair)).ok();
            }
        }
    }
    for (title, pairs) in [
        ("differences", unknown),
        ("differences with a known reason", known),
    ] {
        if !pairs.is_empty() {
            writeln!(text, "\n{title}: {}", pairs.len()).ok();
        }
        for pair in pairs {
            let why = excused(pair)
                .map(|reason| format!(" ({reason})"))
                .unwrap_or_default();
            if let Some(difference) = &pair.difference {
                writeln!(text, "  {}{why}: {difference}", name(pair)).ok();
            }
        }
    }
    text
}

/// Refusals by their reason, the most frequent first.
fn reasons<'a>(title: &str, of: impl Iterator<Item = (&'a String, &'a Judgement)>) -> String {
    let mut table: Vec<Reason> = Vec::new();
    for (name, judgement) in of {
        let Judgement::Refused { problem, place } = judgement else {
            continue;
        };
        let reason = without_numbers(problem);
        let known = table.iter().position(|known| known.reason == reason);
        let known = known.unwrap_or_else(|| {
            table.push(Reason {
                reason,
                count: 0,
                first: format!("{name}: {place}"),
                sentences: Vec::new(),
            });
            table.len() - 1
        });
        let known = &mut table[known];
        known.count += 1;
        if !known.sentences.contains(problem) {
            known.sentences.push(problem.clone());
        }
    }
    table.sort_by_key(|reason| Reverse(reason.count));
    let total: usize = table.iter().map(|reason| reason.count).sum();
    let mut text = format!("\n{title}: {total}\n");
    for Reason {
        reason,
        count,
        first,
        sentences,
    } in table
    {
        writeln!(text, "{count:6} {reason} ({first})").ok();
        if sentences.len() > 1 {
            for sentence in sentences.iter().take(SENTENCES) {
                writeln!(text, "         {sentence}").ok();
            }
        }
    }
    text
}

/// Refusals of one reason.
struct Reason {
    reason: String,
    count: usize,
    /// The first program, and where in it.
    first: String,
    /// With their numbers.
    sentences: Vec<String>,
}

/// A sentence in which numbers, names and characters of one program are left out.
fn without_numbers(sentence: &str) -> String {
    let mut text = String::new();
    let mut characters = sentence.chars().peekable();
    while let Some(c) = characters.next() {
        let more = |c: &char| c.is_ascii_digit() || *c == '.';
        if c.is_ascii_digit() {
            while characters.next_if(more).is_some() {}
            text.push('…');
        } else if c == '<' {
            while characters.next_if(|c| *c != '>').is_some() {}
            text.push_str("<…");
        } else {
            text.push(c);
        }
    }
    // Of the peer: what it calculates with, and the file.
    for end in [": start=", " file:"] {
        if let Some(at) = text.find(end) {
            text.truncate(at);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::first_difference;
    use crate::list::Item;

    #[test]
    fn refusals_are_counted_by_reason_and_lathes_are_left_aside() {
        let refused = |problem: &str| Judgement::Refused {
            problem: problem.into(),
            place: "line 3".into(),
        };
        let pair = |index, ours, peer| Pair {
            index,
            ours,
            peer,
            difference: None,
            broken: false,
        };
        let mut pairs = vec![
            pair(0, refused("G12.3 is unknown"), Judgement::Accepted),
            pair(1, refused("G4 is unknown"), Judgement::Accepted),
            pair(2, Judgement::Accepted, Judgement::Accepted),
            pair(3, refused("lathe"), Judgement::Accepted),
        ];
        pairs[2].difference = first_difference(&[Item::Pause], &[]);
        let told = |name: &str, lathe| Told {
            name: name.into(),
            lathe,
        };
        let programs = [
            told("a", false),
            told("b", false),
            told("c", false),
            told("d", true),
        ];
        let text = of(&programs, &pairs);
        assert!(text.contains("1 of 3 = 33.3 %; differences 1"), "{text}");
        assert!(text.contains("     2 G… is unknown (a: line 3)"), "{text}");
        assert!(text.contains("  c: number of motions"), "{text}");
    }
}
