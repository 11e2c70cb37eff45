//! Codes of other controllers that are accepted and do little or nothing here, which is told once.

use super::block::{Block, LENGTHS};
use super::codes::{Code, Group};
use super::error::SourcePosition;
use super::explain::{system, system_name};
use super::interpreter::Interpreter;
use super::offsets::CoordinateSystem;

/// From here on a whole number of seconds may be one of milliseconds \[s\].
const LONG_DWELL_S: f64 = 100.0;

impl Interpreter {
    /// What of `block` should be known to a person who expects what another controller does.
    pub(super) fn hints(&mut self, block: &Block) {
        for code in block.codes.iter().filter(|code| code.group() == Group::Hint) {
            if code.name == "G69" && (self.end_rotation() || self.end_fanuc_tilt()) {
                continue;
            }
            let why = match code.name {
                "G11" | "G50" | "G69" | "G255" => "what it ends is not known here, and does not hold",
                "G22" | "G23" => "the travel of the axes is always checked",
                "G62" | "G187" => "how closely the path is followed is said by G61 and G64 P",
                "G103" => "as many blocks are read ahead as are needed",
                "ORIAXES" => "between the ends of a block the tool turns as docs/nc.md says under Turns",
                _ => "the speed is planned ahead as far as it is needed anyway",
            };
            self.tell_once(format!("{} changes nothing: {why}", code.name), code.place);
        }
        if let Some(code) = block.code(Group::ToolLength)
            && code.name == "H0"
        {
            let text = "H0 without G43 is taken as G49: no length of a tool";
            self.tell_once(text.to_owned(), code.place);
        }
        if let Some(code) = block.code(Group::Units)
            && code.name.starts_with("G7")
        {
            let (name, own) = (code.name, code.code.name());
            self.tell_once(
                format!("{name} is taken as {own}: F is in the same units"),
                code.place,
            );
        }
        if let Some(edge) = block
            .word("D")
            .filter(|_| block.code(Group::ToolLength).is_none() && block.code(Group::Compensation).is_none())
        {
            let text =
                "D changes nothing here: a tool has one length, that of G43 H, and the radius of G41 and G42";
            self.tell_once(text.to_owned(), edge.place);
        }
        let of_lathes = ["I", "J", "Q"].iter().find_map(|name| block.word(name));
        if let Some(word) = of_lathes.filter(|_| block.has(Code::SetOffsets)) {
            let text = "I, J and Q of G10 change nothing: they are angles and place of tools of lathes";
            self.tell_once(text.to_owned(), word.place);
        }
        if let Some(code) = block.code(Group::PathControl)
            && code.code == Code::WithinTolerance
        {
            let name = code.name;
            let text = format!(
                "{name} is taken as G64 with CTOL or the default tolerance: distances and tolerances of single axes are not known here"
            );
            self.tell_once(text, code.place);
        }
    }

    /// Lengths without G20 and G21 before them; 0 is the same in all units.
    pub(super) fn unit_hint(&mut self, block: &Block) {
        if self.unit_clear {
            return;
        }
        if block.code(Group::Units).is_some() {
            self.unit_clear = true;
            return;
        }
        let takes = block.codes.iter().find(|code| code.code.takes_axes());
        let moves = match takes {
            Some(code) => matches!(code.code, Code::Home | Code::SecondHome),
            None => self.modal.motion.is_some(),
        };
        let mut words = block.words.iter();
        let length = words.find(|word| word.value != 0.0 && LENGTHS.contains(&word.address.as_str()));
        if let Some(word) = length.filter(|_| moves) {
            let unit = if self.modal.inches {
                "inches, as the machine file says"
            } else {
                "mm"
            };
            let text = format!("neither G20 nor G21 before the first motion: lengths are {unit}");
            self.tell_once(text, word.place);
            self.unit_clear = true;
        }
    }

    /// A dwell that may be meant in milliseconds.
    pub(super) fn tell_seconds(&mut self, code: &str, time: f64, place: SourcePosition) {
        if time >= LONG_DWELL_S && time.fract() == 0.0 {
            let text = format!(
                "P of {code} is in seconds: P{time} is {time} s, where controllers that count milliseconds dwell {} s",
                time / 1000.0
            );
            self.tell_once(text, place);
        }
    }

    /// That the coordinate system which holds is elsewhere than the program says, where it is.
    pub(super) fn tell_system(&mut self, place: SourcePosition) {
        let index = self.offsets.active;
        if self.offsets.told.replace(index) == Some(index) {
            return;
        }
        let set = self.setup.systems.get(index);
        if set.is_some_and(|set| *set != CoordinateSystem::default() && set == self.offsets.system()) {
            let text = format!(
                "{} as it was set at the machine: {}",
                system_name(index),
                system(self.offsets.system(), self)
            );
            self.tell_once(text, place);
        }
    }

    pub(super) fn tell_once(&mut self, text: String, place: SourcePosition) {
        if self.notices.iter().all(|notice| notice.text != text) {
            self.notice(text, place);
        }
    }
}
