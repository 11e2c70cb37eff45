//! Named sets of values in a file, one by one: the tools of a machine file, and the sets of weld data.

use crate::machine::MachineFile;
use crate::parameters::{self, EditError, Kind, Parameter, Table, list, list_elements, unit};
use crate::weld_data::WeldData;
use std::error::Error;
use toml::de::DeTable;

/// Table of the tools.
const TOOLS: &str = "tools";
/// What a tool has; 0 where it is left out \[mm\].
pub const OF_TOOL: [&str; 2] = ["length_mm", "diameter_mm"];

/// What weld data can have beside their power, and how it is put in: so that it does as little as can be. `P` is the power of the set.
/// Names of levels are those of the machine, and how deep a pin goes is for nobody to guess: these are added in the file.
const OF_WELD: [(&str, &str); 13] = [
    ("beam", "1"),
    ("outputs", "[]"),
    ("pre_flow_s", "0.0"),
    ("post_flow_s", "0.0"),
    ("ignition", "{ power = P, time_s = 0.1 }"),
    ("ramp_up", "{ power = P, over_mm = 0.0 }"),
    ("ramp_down", "{ power = P, over_mm = 0.0 }"),
    ("crater_fill", "{ power = P, time_s = 0.1 }"),
    ("by_speed", "{ full_mm_s = 1.0, least = 1.0 }"),
    (
        "weave",
        "{ form = \"sine\", amplitude_mm = 0.1, frequency_hz = 1.0, dwell_s = 0.0 }",
    ),
    ("offset_mm", "[0.0, 0.0]"),
    ("tacks", "[{ from_mm = 0.0, to_mm = 1.0, power = P }]"),
    ("changes", "[{ at_mm = 0.0, over_mm = 0.0, power = P }]"),
];

/// What the sets of a file are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sets {
    /// Tools of a machine file, by their numbers.
    Tools,
    /// Weld data, by name.
    WeldData,
}

impl Sets {
    /// What messages call the file.
    pub fn what(self) -> &'static str {
        match self {
            Self::Tools => "machine file",
            Self::WeldData => "weld data",
        }
    }

    /// Has the reader of the file look at `text`; `path` is used in messages only.
    ///
    /// # Errors
    /// What the reader says.
    pub fn check(self, path: &str, text: &str) -> Result<(), Box<dyn Error + Send + Sync>> {
        match self {
            Self::Tools => MachineFile::parse(path, text).map(drop)?,
            Self::WeldData => WeldData::parse(path, text).map(drop)?,
        }
        Ok(())
    }

    /// All sets of `text`, in its order, tools in that of their numbers: as tables with their names, and with the values that are
    /// written there. None of what is no TOML.
    pub fn list(self, text: &str) -> Vec<Table> {
        let (tables, around) = match self {
            Self::Tools => (list(text), format!("{TOOLS}.")),
            Self::WeldData => (list_elements(text), String::new()),
        };
        let values: Vec<Parameter> = tables.into_iter().flat_map(|table| table.parameters).collect();
        let mut sets: Vec<Table> = self.names(text).into_iter().map(named).collect();
        for mut value in values {
            // A name may have points in it: the longest one is meant.
            let within = |set: &Table| {
                let rest = value.key.strip_prefix(&*around)?.strip_prefix(&*set.name)?;
                Some(rest.strip_prefix('.')?.to_owned())
            };
            let of = sets.iter_mut().filter_map(|set| Some((within(set)?, set)));
            if let Some((name, set)) = of.max_by_key(|(_, set)| set.name.len()) {
                (value.unit, value.name) = (unit(&name), name);
                set.parameters.push(value);
            }
        }
        if self == Self::WeldData {
            sets.iter_mut().for_each(powers);
        }
        sets
    }

    fn names(self, text: &str) -> Vec<String> {
        let Ok(document) = DeTable::parse(text) else {
            return Vec::new();
        };
        let sets = match self {
            Self::WeldData => Some(document.get_ref()),
            Self::Tools => document
                .get_ref()
                .get(TOOLS)
                .and_then(|tools| tools.get_ref().as_table()),
        };
        let keys = sets.into_iter().flat_map(|sets| sets.keys());
        let mut names: Vec<_> = keys
            .map(|key| (key.span().start, key.get_ref().to_string()))
            .collect();
        match self {
            Self::Tools => names.sort_by_key(|(_, name)| name.parse::<u32>().ok()),
            Self::WeldData => names.sort(),
        }
        names.into_iter().map(|(_, name)| name).collect()
    }

    /// `text` with what was typed as the value `name` of `set`, one of those that [`Sets::list`] gives, or of [`OF_TOOL`].
    ///
    /// # Errors
    /// [`EditError`]: it is no value of that kind. Whether it may be is for [`Sets::check`] to say.
    pub fn set(self, text: &str, set: &Table, name: &str, typed: &str) -> Result<String, EditError> {
        let Some(parameter) = set.parameters.iter().find(|one| one.name == name) else {
            let number = typed.parse().map_err(|_| EditError::NotANumber)?;
            return Ok(insert(text, &set.name, name, number));
        };
        // Where a number happens to be whole in the file, the reader knows whether it has to be.
        let mut parameter = parameter.clone();
        if parameter.kind == Kind::Integer && typed.parse::<i64>().is_err() {
            parameter.kind = Kind::Float;
        }
        parameters::replace(text, &parameter, typed)
    }

    /// What can be put into `set` that it does not have.
    pub fn missing(self, set: &Table) -> Vec<&'static str> {
        let has = |key: &str| {
            let within = |name: &str| name.strip_prefix(key).is_some_and(|rest| rest.starts_with('.'));
            set.parameters
                .iter()
                .any(|one| one.name == key || within(&one.name))
        };
        let of = match self {
            Self::Tools => &[][..],
            Self::WeldData => &OF_WELD,
        };
        of.iter().map(|(key, _)| *key).filter(|key| !has(key)).collect()
    }

    /// `text` with `key`, one of [`Sets::missing`], in `set`.
    pub fn put_in(self, text: &str, set: &Table, key: &str) -> String {
        let power = set.parameters.iter().find(|one| one.name == "power");
        let power = power.map_or("0.0", |power| &*power.value);
        let written = OF_WELD.iter().find(|(name, _)| *name == key);
        let put_in = written.map(|(_, written)| {
            let written = written.replace('P', power);
            parameters::insert_written(text, &set.name, key, &written)
        });
        put_in.and_then(Result::ok).unwrap_or_else(|| text.to_owned())
    }

    /// `text` without the set called `name`.
    pub fn without(self, text: &str, name: &str) -> String {
        let removed = match self {
            Self::Tools => parameters::remove(text, &[TOOLS, name]),
            Self::WeldData => parameters::remove(text, &[name]),
        };
        // What is no TOML has no sets.
        removed.unwrap_or_else(|_| text.to_owned())
    }
}

/// The machine file `text` with a tool of this number, of no length and diameter.
pub fn with_tool(text: &str, number: u32) -> String {
    let name = number.to_string();
    OF_TOOL
        .iter()
        .fold(text.to_owned(), |text, key| insert(&text, &name, key, 0.0))
}

/// The weld data `text` with a set called `name`, which has what the one called `of` has; of no power where there is none of these.
pub fn with_weld_data(text: &str, name: &str, of: &str) -> String {
    let is_there = Sets::WeldData.names(text).iter().any(|set| set == of);
    let new = match is_there {
        true => parameters::copy(text, of, name),
        false => parameters::insert(text, &[name], "power", 0.0),
    };
    new.unwrap_or_else(|_| text.to_owned())
}

/// Whether a program can call a set of weld data by `name`.
pub fn is_name(name: &str) -> bool {
    let may = |letter: char| letter.is_alphanumeric() || letter == '_' || letter == '-';
    !name.is_empty() && name.chars().all(may)
}

fn insert(text: &str, tool: &str, key: &str, number: f64) -> String {
    parameters::insert(text, &[TOOLS, tool], key, number).unwrap_or_else(|_| text.to_owned())
}

fn named(name: String) -> Table {
    Table {
        name,
        comment: String::new(),
        parameters: Vec::new(),
    }
}

/// Powers are those of a beam, or the speed of the spindle whose pin goes into the work.
fn powers(set: &mut Table) {
    let stirs = set.parameters.iter().any(|one| one.name.starts_with("stir."));
    let powers = set.parameters.iter_mut().filter(|one| {
        let mut parts = one.name.split('.');
        parts.next_back() == Some("power") && parts.next_back() != Some("levels")
    });
    powers.for_each(|one| one.unit = if stirs { "r/min" } else { "W" });
}

#[cfg(test)]
mod tests {
    use super::*;

    const MACHINE: &str = include_str!("../../../machines/pipe-welder.toml");
    const WELDS: &str = include_str!("../../../programs/welddata.toml");

    fn called(sets: Sets, text: &str, name: &str) -> Table {
        let mut all = sets.list(text).into_iter();
        all.find(|set| set.name == name)
            .unwrap_or_else(|| panic!("no {name}"))
    }

    fn value<'a>(set: &'a Table, name: &str) -> (&'a str, &'static str) {
        let one = set.parameters.iter().find(|one| one.name == name);
        let one = one.unwrap_or_else(|| panic!("no {name}"));
        (&one.value, one.unit)
    }

    #[test]
    fn the_values_of_a_weld_are_listed_to_the_elements_of_its_lists_with_their_units() {
        let names: Vec<_> = Sets::WeldData
            .list(WELDS)
            .into_iter()
            .map(|set| set.name)
            .collect();
        assert_eq!(names, ["root", "cap"]);
        let root = called(Sets::WeldData, WELDS, "root");
        for (name, expected) in [
            ("power", ("3200.0", "W")),
            ("outputs", ("[\"gas\", \"wire\"]", "")),
            ("levels.wire_feed", ("6.0", "")),
            ("ignition.power", ("3600.0", "W")),
            ("ignition.time_s", ("0.4", "s")),
            ("ramp_up.over_mm", ("6.0", "mm")),
            ("tacks.1.from_mm", ("60.0", "mm")),
            ("tacks.1.power", ("3900.0", "W")),
        ] {
            assert_eq!(value(&root, name), expected, "{name}");
        }
        let cap = called(Sets::WeldData, WELDS, "cap");
        assert_eq!(value(&cap, "offset_mm.1"), ("3.0", "mm"));
        assert_eq!(value(&cap, "weave.form"), ("\"sine\"", ""));
        // A pin is turned, a name may have points and units in it, and levels are called as the machine file likes.
        let odd = "[\"a.b_mm\"]\npower = 900\nbeam = 1\nlevels = { power = 1.0 }\n[\"a.b_mm\".stir]\ndepth_mm = 1.0\n[a]\npower = 1";
        let set = called(Sets::WeldData, odd, "a.b_mm");
        assert_eq!(value(&set, "power"), ("900", "r/min"));
        assert_eq!(value(&set, "beam"), ("1", ""));
        assert_eq!(value(&set, "levels.power").1, "");
        assert_eq!(value(&set, "stir.depth_mm"), ("1.0", "mm"));
        assert_eq!(called(Sets::WeldData, odd, "a").parameters.len(), 1);
    }

    #[test]
    fn a_value_of_a_list_is_replaced_and_nothing_else_of_the_file_and_the_reader_says_what_it_may_be() {
        let root = called(Sets::WeldData, WELDS, "root");
        let set = |name: &str, typed: &str| Sets::WeldData.set(WELDS, &root, name, typed);
        let longer = set("tacks.0.to_mm", "35.5").unwrap();
        assert_eq!(longer, WELDS.replacen("to_mm = 33.0", "to_mm = 35.5", 1));
        assert!(Sets::WeldData.check("w.toml", &longer).is_ok());
        let error = Sets::WeldData
            .check("w.toml", &set("tacks.0.to_mm", "20").unwrap())
            .unwrap_err();
        let said = "weld data w.toml: root.tacks.to_mm is 20, but must be behind from_mm";
        assert_eq!(error.to_string(), said);
        assert_eq!(set("power", "much"), Err(EditError::NotANumber));
        // What happens to be whole need not stay so, unless the reader wants it whole.
        let whole = "[a]\npower = 900\nbeam = 1\n";
        let a = called(Sets::WeldData, whole, "a");
        let power = Sets::WeldData.set(whole, &a, "power", "900.5").unwrap();
        assert!(Sets::WeldData.check("w.toml", &power).is_ok(), "{power}");
        let beam = Sets::WeldData.set(whole, &a, "beam", "1.5").unwrap();
        let error = Sets::WeldData.check("w.toml", &beam).unwrap_err().to_string();
        assert!(error.contains("line 3: a.beam: invalid type"), "{error}");
    }

    #[test]
    fn tools_come_and_go_and_everything_else_of_the_file_stays_to_the_letter() {
        assert!(Sets::Tools.list(MACHINE).is_empty());
        let with = with_tool(&with_tool(MACHINE, 10), 2);
        let names: Vec<_> = Sets::Tools.list(&with).into_iter().map(|set| set.name).collect();
        assert_eq!(names, ["2", "10"]);
        assert!(Sets::Tools.check("m.toml", &with).is_ok());
        assert!(with.starts_with(MACHINE), "{with}");
        let longer = Sets::Tools
            .set(&with, &called(Sets::Tools, &with, "10"), "length_mm", "12.5")
            .unwrap();
        let ten = called(Sets::Tools, &longer, "10");
        assert_eq!(value(&ten, "length_mm"), ("12.5", "mm"));
        let without = Sets::Tools.without(&Sets::Tools.without(&longer, "10"), "2");
        assert_eq!(without, MACHINE);

        // However they are written; what is left out is put in.
        for text in [
            "a = 1\n[tools.3] # mine\nlength_mm = 5 # long\n\n[b]\nc = 2\n",
            "a = 1\ntools = { 3 = { length_mm = 5 } } # mine\n[b]\nc = 2\n",
            "a = 1\r\n[tools.3] # mine\r\nlength_mm = 5 # long\r\n\r\n[b]\r\nc = 2\r\n",
        ] {
            let three = called(Sets::Tools, text, "3");
            let new = Sets::Tools.set(text, &three, "diameter_mm", "6").unwrap();
            let three = called(Sets::Tools, &new, "3");
            assert_eq!(value(&three, "diameter_mm"), ("6.0", "mm"), "{new}");
            assert_eq!(value(&three, "length_mm"), ("5", "mm"), "{new}");
            assert!(new.contains("# mine") && new.contains("c = 2"), "{new}");
            let one_more = with_tool(text, 4);
            assert_eq!(Sets::Tools.list(&one_more).len(), 2, "{one_more}");
            assert!(Sets::Tools.list(&Sets::Tools.without(&one_more, "4")).len() == 1);
        }
    }

    #[test]
    fn a_new_set_has_what_another_one_has_and_everything_else_of_the_file_stays_to_the_letter() {
        let with = with_weld_data(WELDS, "hot-root", "root");
        assert!(with.starts_with(WELDS), "{with}");
        assert!(Sets::WeldData.check("w.toml", &with).is_ok(), "{with}");
        let values = |name: &str| {
            let set = called(Sets::WeldData, &with, name);
            let values = set.parameters.into_iter();
            values.map(|one| (one.name, one.value)).collect::<Vec<_>>()
        };
        assert_eq!(values("hot-root"), values("root"));
        // The file is as it was but for a line that is empty.
        assert_eq!(
            Sets::WeldData.without(&with, "hot-root").trim_end(),
            WELDS.trim_end()
        );
        // However it is written, and also where it is the last line that is not ended.
        for text in [
            "a = { power = 2.0 }",
            "[a]\npower = 2.0\n[a.ramp_up]\npower = 3.0\nover_mm = 1.0\n[b]\npower = 1.0",
            "[a] # mine\r\npower = 2.0\r\n[[a.tacks]]\r\nfrom_mm = 1.0\r\nto_mm = 2.0\r\n",
        ] {
            let with = with_weld_data(text, "c", "a");
            assert!(with.starts_with(text), "{with}");
            let set = |name: &str| {
                let values = called(Sets::WeldData, &with, name).parameters.into_iter();
                values.map(|one| (one.name, one.value)).collect::<Vec<_>>()
            };
            assert_eq!(set("c"), set("a"), "{with}");
            assert!(Sets::WeldData.check("w.toml", &with).is_ok(), "{with}");
        }
        let first = with_weld_data("", "root", "");
        assert_eq!(first, "[root]\npower = 0.0\n");
        assert!(Sets::WeldData.check("w.toml", &first).is_ok());
        // What is put in the reader takes, all of it at once too, and nothing is put in twice.
        let mut text = "[a]\npower = 2500.0 # mine\n\n[b]\npower = 1.0\n".to_owned();
        assert_eq!(
            Sets::WeldData.missing(&called(Sets::WeldData, &text, "a")).len(),
            OF_WELD.len()
        );
        for (key, _) in OF_WELD {
            let set = called(Sets::WeldData, &text, "a");
            text = Sets::WeldData.put_in(&text, &set, key);
            Sets::WeldData
                .check("w.toml", &text)
                .unwrap_or_else(|error| panic!("{error}\n{text}"));
            let missing = Sets::WeldData.missing(&called(Sets::WeldData, &text, "a"));
            assert!(!missing.contains(&key), "{key}: {missing:?}\n{text}");
        }
        let full = called(Sets::WeldData, &text, "a");
        assert_eq!(value(&full, "ramp_up.power"), ("2500.0", "W"));
        assert!(
            text.contains("# mine") && text.ends_with("[b]\npower = 1.0\n"),
            "{text}"
        );
        assert!(is_name("hot-root_2") && !is_name("") && !is_name("a b") && !is_name("a.b"));
    }
}
