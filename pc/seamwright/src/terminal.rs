//! The operator at a terminal: a bar on standard error, and lines on standard input.

use crate::console::{errln, shown};
use host_link::events::{Event, Interest, NoEvent, Question, Subscription};
use host_link::{ByHand, Command, Jog, Remote};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::time::Duration;

/// What may be said.
const KEYS: &str = "Enter continues, h holds, b goes back, s switches single block on or off, a number from 0 to 200 is \
                    the feed in %, Ctrl-C stops the job";
/// A jog is held to so often.
const HELD: Duration = Duration::from_millis(50);
/// Samples that wait to be shown.
const SAMPLES: usize = 16;

/// How the operator takes part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Operator {
    /// They look on.
    LooksOn,
    /// They say words, a line each, if standard input is a terminal. In single block the machine waits after every block, and
    /// a program may stop: words are read wherever they come from then.
    SaysWords {
        /// Whether it is single block.
        single_block: bool,
        /// Whether the program stops.
        stops: bool,
    },
    /// They hold to this jog, until the machine stands.
    Jogs(Jog),
    /// They lead a job by lines, if standard input is a terminal; `always` wherever they come from.
    LeadsByLines {
        /// See there.
        always: bool,
    },
}

/// A bar on the terminal; one line for each part of the job if standard error is not a terminal.
#[derive(Debug)]
pub struct Terminal {
    events: Subscription,
    screen: Screen,
}

/// Where the operator reads.
#[derive(Clone, Debug)]
struct Screen(Option<ProgressBar>);

/// What a line means.
#[derive(Clone, Debug, PartialEq)]
enum Said {
    Order(Command),
    SingleBlock,
}

impl Terminal {
    /// Begins to take part in the job of `remote`.
    pub fn new(operator: Operator, remote: &Remote) -> Self {
        let screen = Screen(std::io::stderr().is_terminal().then(ProgressBar::no_length));
        let terminal = Self {
            events: remote.subscribe(Interest::Samples, SAMPLES),
            screen: screen.clone(),
        };
        let is_terminal = std::io::stdin().is_terminal();
        let remote = remote.clone();
        match operator {
            Operator::SaysWords { single_block, stops } if single_block || stops || is_terminal => {
                // A state, which needs no room.
                let _ = remote.send(Command::SingleBlock(single_block));
                screen.print(KEYS);
                std::thread::spawn(move || read_words(&remote, &screen, single_block));
            }
            Operator::LeadsByLines { always } if always || is_terminal => {
                std::thread::spawn(move || read_lines(&remote));
            }
            Operator::Jogs(jog) => {
                let events = remote.subscribe(Interest::Milestones, SAMPLES);
                std::thread::spawn(move || hold_to(&remote, &events, jog));
            }
            // Nobody is waited for.
            Operator::LooksOn | Operator::SaysWords { .. } | Operator::LeadsByLines { .. } => {
                let _ = remote.send(Command::Unattended);
            }
        }
        terminal
    }

    /// Shows what happens, until the job ends.
    pub fn show(self) {
        for received in self.events {
            self.screen.show(&received.event);
        }
        if let Screen(Some(bar)) = &self.screen {
            bar.finish_and_clear();
        }
    }
}

impl Screen {
    fn show(&self, event: &Event) {
        match event {
            Event::Phase(phase) => self.headline(&phase.to_string()),
            Event::Question(question) => self.headline(&asked(question)),
            Event::Message(text) => self.print(text),
            Event::Progress { done_mm, length_mm } => self.travel(*done_mm, *length_mm),
            // Telemetry is not printed; how the job ended is printed after its evaluation.
            _ => {}
        }
    }

    fn headline(&self, text: &str) {
        match &self.0 {
            Some(bar) => {
                // How far it goes is not known before the path moves.
                bar.set_style(style("{msg:24} {spinner}"));
                bar.set_message(text.to_owned());
            }
            None => errln!("{text}"),
        }
    }

    fn travel(&self, done_mm: f64, length_mm: f64) {
        if let Some(bar) = &self.0 {
            bar.set_style(style("{msg:24} {wide_bar} {pos:>5} of {len} mm"));
            bar.set_length(length_mm.round() as u64);
            bar.set_position(done_mm.round() as u64);
        }
    }

    fn print(&self, text: &str) {
        match &self.0 {
            Some(bar) => bar.suspend(|| errln!("{text}")),
            None => errln!("{text}"),
        }
    }
}

/// A question in words.
fn asked(question: &Question) -> String {
    match question {
        Question::GoOn { next } => format!("waiting before {next}: Enter continues"),
        Question::Stop { code, line, text } => {
            let text = said(text.as_deref());
            format!("line {line}: stopped by {code}{text}: Enter continues, Ctrl-C ends the job")
        }
        Question::Tool { tool, line, text } => {
            let what = match tool {
                0 => "take the tool out".to_owned(),
                tool => format!("put tool {tool} in"),
            };
            let text = said(text.as_deref());
            format!("line {line}: {what}{text}, then press Enter; Ctrl-C ends the job")
        }
        Question::FeedTooLow => {
            "held: the feed is too low for the beam; raise it, then press Enter".to_owned()
        }
        Question::Jog => "jog: type a command".to_owned(),
        Question::ByHand => "ready".to_owned(),
    }
}

/// What the program says of a stop.
fn said(text: Option<&str>) -> String {
    text.map_or_else(String::new, |text| format!(" (\"{}\")", shown(text)))
}

/// Reads words from standard input as they come. Ends with the program, or with the input.
fn read_words(remote: &Remote, screen: &Screen, mut single_block: bool) {
    for line in std::io::stdin().lines().map_while(Result::ok) {
        let order = match meaning(&line) {
            Some(Said::Order(order)) => order,
            Some(Said::SingleBlock) => {
                single_block = !single_block;
                screen.print(if single_block {
                    "single block: on, from the next block that was not sent yet"
                } else {
                    "single block: off"
                });
                Command::SingleBlock(single_block)
            }
            None => {
                screen.print(KEYS);
                continue;
            }
        };
        if let Err(error) = remote.send(order) {
            screen.print(&format!("not taken: {error}"));
        }
    }
    // A state, which needs no room.
    let _ = remote.send(Command::Unattended);
}

/// Reads the lines that lead a job.
fn read_lines(remote: &Remote) {
    for line in std::io::stdin().lines().map_while(Result::ok) {
        // Lines that come faster than a lesson takes them wait for their turn.
        while let Err(host_link::CommandError::Full) = remote.send(Command::Answer(line.clone())) {
            std::thread::sleep(std::time::Duration::from_millis(20));
        }
    }
    let _ = remote.send(Command::Unattended);
}

/// Holds to `jog` from when the machine is ready for it until it stands, and ends the job then.
fn hold_to(remote: &Remote, events: &Subscription, jog: Jog) {
    let mut asked = false;
    loop {
        let received = events.receive(HELD);
        match received.as_ref().map(|received| &*received.event) {
            // It is refused, or over.
            Ok(Event::Message(_) | Event::Question(Question::ByHand)) if asked => break,
            Ok(Event::Question(Question::ByHand)) => asked = true,
            Ok(_) => continue,
            Err(NoEvent::Timeout) if asked && jog.step.is_none() => {}
            Err(NoEvent::Timeout) => continue,
            Err(NoEvent::Ended) => return,
        }
        // One that has no room comes too fast, and the next one does as well.
        let _ = remote.send(Command::ByHand(ByHand::Jog(jog.again())));
    }
    let _ = remote.send(Command::ByHand(ByHand::Off));
}

/// What `line` means, if anything.
fn meaning(line: &str) -> Option<Said> {
    Some(match line.trim() {
        "" => Said::Order(Command::Resume),
        "h" => Said::Order(Command::Hold),
        "b" => Said::Order(Command::Back),
        "s" => Said::SingleBlock,
        number => {
            let percent: f64 = number.trim_end_matches('%').trim_end().parse().ok()?;
            let sensible = (0.0..=200.0).contains(&percent);
            sensible.then_some(Said::Order(Command::Override(percent / 100.0)))?
        }
    })
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).expect("the template is valid")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stop_says_where_it_is_and_what_to_do() {
        let stop = Question::Stop {
            code: "M0".into(),
            line: 12,
            text: Some("turn it\u{1b}[2J".to_owned()),
        };
        assert_eq!(
            asked(&stop),
            "line 12: stopped by M0 (\"turn it [2J\"): Enter continues, Ctrl-C ends the job"
        );
        let tool = |tool| Question::Tool {
            tool,
            line: 3,
            text: None,
        };
        assert_eq!(
            asked(&tool(2)),
            "line 3: put tool 2 in, then press Enter; Ctrl-C ends the job"
        );
        assert_eq!(
            asked(&tool(0)),
            "line 3: take the tool out, then press Enter; Ctrl-C ends the job"
        );
    }

    #[test]
    fn lines_are_orders_or_nothing() {
        let order = |command| Some(Said::Order(command));
        assert_eq!(meaning(""), order(Command::Resume));
        assert_eq!(meaning(" h "), order(Command::Hold));
        assert_eq!(meaning("b"), order(Command::Back));
        assert_eq!(meaning("s"), Some(Said::SingleBlock));
        assert_eq!(meaning("50"), order(Command::Override(0.5)));
        assert_eq!(meaning("200 %"), order(Command::Override(2.0)));
        assert_eq!(meaning("0%"), order(Command::Override(0.0)));
        for nothing in ["hold", "-1", "201", "NaN", "%", "1e9"] {
            assert_eq!(meaning(nothing), None, "{nothing}");
        }
    }
}
