//! Where two lists of what a program does differ.

use crate::list::{Item, Motion};
use std::fmt;

/// Allowed difference of places and lengths (mm, degrees).
const PLACE: f64 = 1e-6;
/// Allowed difference of feeds, speeds, times and values, of one.
const VALUE: f64 = 1e-6;

/// The first difference of a program.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// In what.
    pub what: &'static str,
    /// How many things both do before.
    pub after: usize,
    /// What ours does there.
    pub ours: Option<Item>,
    /// What the peer does there.
    pub peer: Option<Item>,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(Item::Motion(Motion { line, .. })) = &self.ours {
            write!(f, "line {line}, ")?;
        }
        write!(f, "{} after {} equal:", self.what, self.after)?;
        for (name, item) in [("ours", &self.ours), ("peer", &self.peer)] {
            match item {
                Some(item) => write!(f, "\n    {name} {item:?}")?,
                None => write!(f, "\n    {name} ends")?,
            }
        }
        Ok(())
    }
}

/// The first difference of two lists, if there is one.
pub fn first_difference(ours: &[Item], peer: &[Item]) -> Option<Difference> {
    let longest = ours.len().max(peer.len());
    (0..longest).find_map(|after| {
        let (ours, peer) = (ours.get(after), peer.get(after));
        let what = match (ours, peer) {
            (Some(ours), Some(peer)) => differ(ours, peer)?,
            _ => "number of motions and outputs",
        };
        Some(Difference {
            what,
            after,
            ours: ours.cloned(),
            peer: peer.cloned(),
        })
    })
}

/// In what two things differ.
fn differ(ours: &Item, peer: &Item) -> Option<&'static str> {
    let same = match (ours, peer) {
        (Item::Motion(ours), Item::Motion(peer)) => return motions_differ(ours, peer),
        (Item::Dwell(a), Item::Dwell(b)) => equal(*a, *b),
        (
            Item::Analog { channel, value },
            Item::Analog {
                channel: channel_b,
                value: value_b,
            },
        ) => channel == channel_b && equal(*value, *value_b),
        (
            Item::Spindle { turn, speed },
            Item::Spindle {
                turn: turn_b,
                speed: speed_b,
            },
        ) => turn == turn_b && equal(*speed, *speed_b),
        _ => ours == peer,
    };
    let of_one_kind = std::mem::discriminant(ours) == std::mem::discriminant(peer);
    (!same).then_some(if of_one_kind { "values" } else { "order" })
}

fn motions_differ(ours: &Motion, peer: &Motion) -> Option<&'static str> {
    if ours.kind != peer.kind {
        return Some("kind of motion");
    }
    if far(ours.to, peer.to) {
        return Some("end point");
    }
    if far(ours.middle, peer.middle) {
        return Some("middle of the arc");
    }
    if far(ours.length.map(|l| [l]), peer.length.map(|l| [l])) {
        return Some("length");
    }
    let feeds = ours.feed.zip(peer.feed);
    feeds.is_some_and(|(a, b)| !equal(a, b)).then_some("feed")
}

/// Whether both are known and differ.
fn far<const N: usize>(a: Option<[f64; N]>, b: Option<[f64; N]>) -> bool {
    a.zip(b).is_some_and(|(a, b)| {
        // Not a number is far from everything.
        !a.iter().zip(b).all(|(a, b)| (a - b).abs() <= PLACE)
    })
}

fn equal(a: f64, b: f64) -> bool {
    (a - b).abs() <= VALUE * a.abs().max(b.abs()).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::list::Kind;

    fn line(x: f64) -> Motion {
        Motion {
            kind: Kind::Line,
            to: Some([x, 0.0, 0.0, 0.0, 0.0, 0.0]),
            length: Some(x),
            middle: None,
            feed: Some(600.0),
            line: 7,
        }
    }

    fn what(ours: &[Item], peer: &[Item]) -> Option<&'static str> {
        first_difference(ours, peer).map(|difference| difference.what)
    }

    #[test]
    fn a_micrometre_in_a_thousand_is_the_limit() {
        let ours = [Item::Motion(line(1.0))];
        assert_eq!(what(&ours, &[Item::Motion(line(1.000_000_9))]), None);
        assert_eq!(what(&ours, &[Item::Motion(line(1.000_001_1))]), Some("end point"));
        assert_eq!(what(&ours, &[Item::Motion(line(f64::NAN))]), Some("end point"));
    }

    #[test]
    fn what_differs_is_named() {
        let motion = |change: fn(&mut Motion)| {
            let mut motion = line(1.0);
            change(&mut motion);
            [Item::Motion(motion)]
        };
        let ours = motion(|_| {});
        let cases: [(&[Item], &str); 8] = [
            (&motion(|m| m.feed = Some(600.1)), "feed"),
            (&motion(|m| m.length = Some(1.1)), "length"),
            (&motion(|m| m.kind = Kind::Rapid), "kind of motion"),
            (
                &[Item::Motion(line(1.0)), Item::Pause],
                "number of motions and outputs",
            ),
            (&[], "number of motions and outputs"),
            (&[Item::Pause], "order"),
            (&[Item::Dwell(1.0)], "order"),
            (&motion(|m| m.to = Some([0.0; 6])), "end point"),
        ];
        for (peer, expected) in cases {
            assert_eq!(what(&ours, peer), Some(expected), "{peer:?}");
        }
        assert_eq!(what(&[Item::Dwell(1.0)], &[Item::Dwell(1.1)]), Some("values"));
        assert_eq!(
            what(&ours, &motion(|m| (m.to, m.length, m.feed) = (None, None, None))),
            None
        );
    }

    #[test]
    fn the_first_difference_says_where_it_is() {
        let ours = [Item::Pause, Item::Motion(line(1.0))];
        let difference = first_difference(&ours, &[Item::Pause, Item::Tool(3)]).expect("different");
        let text = difference.to_string();
        assert!(text.starts_with("line 7, order after 1 equal:"), "{text}");
        assert!(text.ends_with("peer Tool(3)"), "{text}");
    }
}
