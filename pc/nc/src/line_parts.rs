//! Lines of Fanuc programs with several statements: `WHILE [#1 LT 5] DO1 #1=#1+1`, `X#1 END1`, `#1=#1+1 IF [#1 GT 5] GOTO 10`, and
//! `O8000 T4`. Each is carried out as if it stood in a line of its own, in this order.

/// A part that is being looked for.
#[derive(Default)]
struct Part {
    /// First character besides a block number.
    first: Option<char>,
    /// A loop begins with it.
    is_while: bool,
    /// What follows is where a jump leads.
    is_jump: bool,
}

/// The parts of a line, each with blanks in place of those before it; none of a line that is one statement.
pub(super) fn of(text: &str) -> Option<Vec<String>> {
    let cuts = match behind_number(text) {
        Some(cut) => vec![cut],
        None if may_have_several(text) => cuts(text),
        None => return None,
    };
    if cuts.is_empty() {
        return None;
    }
    let ends = cuts.iter().copied().chain([text.len()]);
    let starts = [0].into_iter().chain(cuts.iter().copied());
    let parts = starts.zip(ends).map(|(start, end)| {
        let blanks = text[..start].chars().map(|_| ' ');
        blanks.chain(text[start..end].chars()).collect()
    });
    Some(parts.collect())
}

/// Where words begin behind the number of a program, if they do: `O8000 T4`.
fn behind_number(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    let skip = |from: usize, wanted: fn(&u8) -> bool| {
        let rest = bytes.get(from..).unwrap_or_default();
        from + rest.iter().take_while(|byte| wanted(byte)).count()
    };
    let blank = u8::is_ascii_whitespace;
    let start = skip(0, blank);
    let number = match bytes.get(start..)? {
        [b':', b'O' | b'o', ..] => start + 2,
        [b':' | b'O' | b'o', ..] => start + 1,
        _ => return None,
    };
    let end = skip(number, u8::is_ascii_digit);
    let words = skip(end, blank);
    let letters = skip(words, u8::is_ascii_alphabetic) - words;
    // More than one letter is a word of LinuxCNC: o100 sub.
    let word = letters == 1 || letters == 0 && bytes.get(words) == Some(&b'#');
    (end > number && word).then_some(words)
}

/// Whether `DO` or `END` with a digit, or a setting with `IF` or `GOTO` stand in the line; that of most is no.
fn may_have_several(text: &str) -> bool {
    let bytes = text.as_bytes();
    let has = |word: &[u8]| {
        bytes
            .windows(word.len())
            .any(|own| own.eq_ignore_ascii_case(word))
    };
    let start = text.trim_ascii_start();
    // Of O words DO and IF are their own.
    if start.starts_with(['O', 'o', ':']) {
        return false;
    }
    has(b"DO") || has(b"END") || bytes.contains(&b'#') && (has(b"IF") || has(b"GOTO"))
}

/// Where parts but the first begin, in bytes.
fn cuts(text: &str) -> Vec<usize> {
    let bytes = text.as_bytes();
    let mut cuts = Vec::new();
    let mut part = Part::default();
    let (mut at, mut depth) = (0, 0);
    let mut quoted = false;
    while let Some(&byte) = bytes.get(at) {
        match byte {
            b'"' => quoted = !quoted,
            _ if quoted => {}
            b';' => break,
            b'/' if bytes[at..].starts_with(b"//") => break,
            b'(' => {
                at = behind_comment(bytes, at);
                continue;
            }
            b'[' => depth += 1,
            b']' => depth -= 1,
            byte if depth == 0 && byte.is_ascii_alphabetic() => {
                let letters = bytes[at..].iter().take_while(|byte| byte.is_ascii_alphabetic());
                let end = at + letters.count();
                let word = text[at..end].to_ascii_uppercase();
                let number = loop_number(bytes, end);
                match (word.as_str(), number) {
                    ("N", _) if part.first.is_none() => {
                        let digits = bytes[end..].iter().take_while(|byte| byte.is_ascii_digit());
                        at = end + digits.count();
                        continue;
                    }
                    ("WHILE" | "WH", _) if part.first.is_none() => part.is_while = true,
                    ("DO", Some(behind)) if part.is_while => {
                        if says_more(bytes, behind) {
                            cuts.push(behind);
                        }
                        part = Part::default();
                        at = behind;
                        continue;
                    }
                    ("END", Some(behind)) if part.first.is_some() && !part.is_while && !part.is_jump => {
                        cuts.push(at);
                        part = Part::default();
                        at = behind;
                        continue;
                    }
                    ("IF" | "GOTO", _) if part.first == Some('#') => {
                        cuts.push(at);
                        part = Part::default();
                    }
                    _ => {}
                }
                part.is_jump |= word.starts_with("GOTO");
                part.first.get_or_insert(char::from(byte));
                at = end;
                continue;
            }
            _ => {}
        }
        if !byte.is_ascii_whitespace() && byte != b'/' {
            part.first.get_or_insert(char::from(byte));
        }
        at += 1;
    }
    cuts
}

/// Behind the number of a loop, 1 to 3, that stands at `at`.
fn loop_number(bytes: &[u8], at: usize) -> Option<usize> {
    let rest = bytes.get(at..)?;
    let blanks = rest.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
    let digits = rest[blanks..]
        .iter()
        .take_while(|byte| byte.is_ascii_digit())
        .count();
    (digits == 1 && matches!(rest[blanks], b'1'..=b'3')).then_some(at + blanks + 1)
}

/// Whether more than comments stands there.
fn says_more(bytes: &[u8], mut at: usize) -> bool {
    loop {
        match bytes.get(at) {
            None | Some(b';') => return false,
            Some(b'(') => at = behind_comment(bytes, at),
            Some(byte) if byte.is_ascii_whitespace() => at += 1,
            Some(_) => return true,
        }
    }
}

/// Behind the comment that begins at `at`, with those inside it.
fn behind_comment(bytes: &[u8], at: usize) -> usize {
    let mut depth = 0;
    let inside = bytes[at..].iter().position(|byte| {
        match byte {
            b'(' => depth += 1,
            b')' => depth -= 1,
            _ => {}
        }
        depth == 0
    });
    inside.map_or(bytes.len(), |length| at + length + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_several_statements_is_cut_before_each_of_them() {
        let parts = |text: &str| -> Vec<String> {
            let parts = of(text).unwrap_or_else(|| vec![text.to_owned()]);
            parts.iter().map(|part| part.trim().to_owned()).collect()
        };
        for (text, expected) in [
            (
                "WHILE [#1 GT #2] DO1 #1=#1-#3 IF [#1 LT #2] THEN #1=#2",
                vec!["WHILE [#1 GT #2] DO1", "#1=#1-#3", "IF [#1 LT #2] THEN #1=#2"],
            ),
            ("N5 WH[#1LT5]DO2#1=#1+1", vec!["N5 WH[#1LT5]DO2", "#1=#1+1"]),
            ("WHILE[#1LT5]DO1(G0 X1)", vec!["WHILE[#1LT5]DO1(G0 X1)"]),
            ("N10 G1X#1END1", vec!["N10 G1X#1", "END1"]),
            ("N10 END1 (back)", vec!["N10 END1 (back)"]),
            ("#1=#1+1 GOTO 10", vec!["#1=#1+1", "GOTO 10"]),
            ("N30 IF [#1 EQ 5] GOTO 10", vec!["N30 IF [#1 EQ 5] GOTO 10"]),
            ("O8000 T4 M6", vec!["O8000", "T4 M6"]),
            (":O1001(A)", vec![":O1001(A)"]),
            ("O8000#1=5", vec!["O8000", "#1=5"]),
            // Of other languages.
            ("o100 while [#1 LT 5]", vec!["o100 while [#1 LT 5]"]),
            ("o100 do", vec!["o100 do"]),
            ("END_OF: IF R6<R3 GOTOF END1", vec!["END_OF: IF R6<R3 GOTOF END1"]),
            (
                "MSG(\"#1 IF\") MSG(\"END1\")",
                vec!["MSG(\"#1 IF\") MSG(\"END1\")"],
            ),
        ] {
            assert_eq!(parts(text), expected);
        }
        let columns = of("X#1 END1").expect("two parts");
        assert_eq!(columns, ["X#1 ", "    END1"]);
    }
}
