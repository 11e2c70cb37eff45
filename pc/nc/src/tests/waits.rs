//! Waits: where the machine rests, until when, and with which words.

use super::*;
use crate::explain::explain;

/// What a program with optional stops on waits for, with the number of the path after the header, the line in the body, and
/// the text.
fn waits(body: &str) -> Vec<(usize, i64, Until, Option<String>)> {
    let options = Options {
        optional_stop: true,
        ..Options::default()
    };
    let header = HEADER.lines().count() as i64;
    let program = interpret(&format!("{HEADER}{body}"), options).unwrap();
    let mut waits = Vec::new();
    for (index, path) in program.paths[2..].iter().enumerate() {
        for wait in &path.waits_before {
            let line = i64::from(wait.place.line) - header;
            waits.push((index, line, wait.until, wait.text.clone()));
        }
    }
    waits
}

#[test]
fn stops_are_between_two_paths_and_have_the_last_words_before_them() {
    let body = "F600\n(first)\nG1 X10\n(MSG, turn it over)\nM0\nX20 (second)\nM60\nX30\nM1 (look at it)\nX40\n(now)\nM0\nM2";
    let text = |text: &str| Some(text.to_owned());
    assert_eq!(
        waits(body),
        [
            (1, 5, Until::Continued, text("turn it over")),
            (2, 7, Until::Continued, None),
            (3, 9, Until::Continued, text("look at it")),
            (4, 12, Until::Continued, text("now")),
        ]
    );
    // The last of them needs a path of its own, and an optional one is the operator's choice.
    let program = run(body).unwrap();
    assert_eq!(program.paths.last().unwrap().motion, Motion::Stand);
    let lines: Vec<_> = program.waits().map(|wait| wait.code).collect();
    assert_eq!(lines, ["M0", "M60", "M0"]);
}

#[test]
fn what_is_before_a_stop_happens_before_it_and_what_is_behind_after_it() {
    let body = "F600 S100\nM3\nG1 X10\nM5\nG4 P2\nM0\nG4 P1\nM3\nM0\nX20\nM62 P0\nM0\nX30\nM2";
    let program = run(body).unwrap();
    let seen: Vec<_> = program.paths[2..]
        .iter()
        .map(|path| {
            let codes: Vec<_> = path.events.iter().map(|event| event.code).collect();
            (path.waits_before.len(), path.dwell_before_s, path.motion, codes)
        })
        .collect();
    let (stand, feed) = (Motion::Stand, Motion::Feed);
    assert_eq!(
        seen,
        [
            (0, 0.0, feed, vec!["M3", "M3"]),
            (0, 0.0, stand, vec!["M5"]),
            (0, 2.0, stand, vec![]),
            (1, 1.0, stand, vec!["M3", "M3"]),
            (1, 0.0, feed, vec![]),
            // It waits for its motion.
            (1, 0.0, feed, vec!["M62"]),
            (0, 0.0, stand, vec!["M2"]),
        ]
    );
}

#[test]
fn the_first_tool_is_there_and_another_one_is_waited_for_with_the_spindle_off() {
    let body =
        "F600 S100\nT1 M6\nM3\nG1 X10\nT1 M6\nX20\nM3\nX30\nT2\nX40\nM6 (the chamfer)\nX50\nT0 M6\nX60\nM2";
    let chamfer = Some("the chamfer".to_owned());
    assert_eq!(
        waits(body)
            .iter()
            .map(|wait| (wait.1, wait.2, wait.3.clone()))
            .collect::<Vec<_>>(),
        [(11, Until::ToolIn(2), chamfer), (13, Until::ToolIn(0), None)]
    );
    let program = run(body).unwrap();
    let index = program
        .paths
        .iter()
        .position(|path| !path.waits_before.is_empty());
    let before = &program.paths[index.unwrap() - 1];
    let actions: Vec<_> = before.events.iter().map(|event| event.action).collect();
    assert_eq!(actions, [ProgramAction::SpindleOff]);
    let header = HEADER.lines().count() as u32;
    let tools = [11, 12, 14].map(|line| program.changed_tool_at(header + line));
    assert_eq!(tools, [None, Some(2), Some(0)]);
    assert_eq!(waits("M61 Q3\nT3 M6\nG0 X1\nT4 M6\nG0 X2\nM2").len(), 1);
}

#[test]
fn inputs_are_waited_for_at_rest() {
    let body = "F600\nG1 X10\nM66 P0 L3 Q5\nX20\nM66 P3 L1 Q0.5\nM66 P1 L2 Q86400\nX30\nM66 P2 L4 Q1\nM2";
    let until = |input, event, within_s| Until::Input {
        input,
        event,
        within_s,
    };
    let found: Vec<_> = waits(body).iter().map(|wait| (wait.0, wait.2)).collect();
    assert_eq!(
        found,
        [
            (1, until(0, InputEvent::High, 5.0)),
            (2, until(3, InputEvent::Rises, 0.5)),
            (2, until(1, InputEvent::Falls, 86400.0)),
            (3, until(2, InputEvent::Low, 1.0)),
        ]
    );
    for (body, told) in [
        ("M66 L3 Q1", "M66 needs P"),
        ("M66 P4 L3 Q1", "P0 to P3 are the inputs 1 to 4"),
        ("M66 P0 L5 Q1", "L1 waits for a rise"),
        ("M66 P0 L3", "M66 needs Q"),
        ("M66 P0 L3 Q0", "above 0 and up to 86400 s"),
        ("M66 E0 L0", "the boards have no analog inputs"),
    ] {
        let error = run(body).unwrap_err().to_string();
        assert!(error.contains(told), "{error}");
    }
}

#[test]
fn what_an_input_was_is_known_when_the_machine_has_been_there() {
    let body = "F600\n#1 = #5399\nG1 X10\nM66 P0 L3 Q1\no1 if [#5399 EQ -1]\nG0 Z50\nM0\nM2\no1 endif\nX20\nM66 P1 L0\n\
                G0 X[100 + #5399]\nM66 P2 L2 Q1\nX30\nM2";
    let program = run(body).unwrap();
    let end = |program: &Program| program.paths.last().unwrap().targets[0].words.axes[0];
    let questions = |program: &Program| -> Vec<_> {
        let waits = program.waits();
        waits.map(|wait| (wait.number, wait.question)).collect()
    };
    // What is waited for comes, what is read is off.
    let all = [(0, Some(0)), (1, Some(1)), (2, Some(2))];
    assert_eq!((end(&program), questions(&program)), (Some(30.0), all.to_vec()));
    assert_eq!(
        [0, 1, 2].map(|question| program.looks_at(question)),
        [true, true, false]
    );
    assert!(program.branches);
    let [came, on] = [1, 1].map(Answer::Input);
    let program = program.answered(&[came, on]).unwrap();
    let read: Vec<_> = program
        .paths
        .iter()
        .filter_map(|path| path.targets.first()?.words.axes[0])
        .collect();
    assert!(read.contains(&101.0), "{read:?}");
    // In vain: the program ends in its own way.
    let program = program.answered(&[Answer::Input(-1)]).unwrap();
    assert_eq!(questions(&program), [(0, Some(0)), (1, None)]);
    assert_eq!(program.paths[3].targets[0].words.axes[2], Some(50.0));
    // Nothing depends on it.
    let program = run("F600\nG1 X10\nM66 P0 L0\nX20\nM2").unwrap();
    assert_eq!(
        program.waits().map(|wait| wait.until).collect::<Vec<_>>(),
        [Until::Read { input: 0 }]
    );
    assert!(!program.looks_at(0) && !program.branches && program.notices.is_empty());
    assert_eq!(program.paths[2..].len(), 2);
}

#[test]
fn waits_are_explained_with_their_blocks() {
    let mut told = Vec::new();
    let text = "G1 X1 F60\nM0 (turn it)\nX2\nT1 M6\nT2 M6\nX3\nM66 P1 L3 Q2\nM2";
    explain(text, Options::default(), |block| told.push(block)).unwrap();
    let facts: Vec<&str> = told
        .iter()
        .map(|block| block.facts[block.facts.len() - 1].as_str())
        .collect();
    assert_eq!(
        facts[1],
        "waits at rest until the operator continues: \"turn it\""
    );
    assert_eq!(facts[4], "waits at rest until the operator has put tool 2 in");
    assert_eq!(facts[6], "waits at rest until input 2 is high, 2 s at most");
    // And with no other one.
    let all = told.iter().flat_map(|block| &block.facts);
    assert_eq!(all.filter(|fact| fact.starts_with("waits")).count(), 3);
}
