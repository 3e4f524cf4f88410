//! What a release helper is told through its pipe: one line for each takeover,
//! for each release that the plant has confirmed, for each change of where the
//! plant's answers come from, and at the end of a flight whose release the plant
//! has not confirmed.
//!
//! ```text
//! held NUMBER PLANT | free NUMBER | answers FROM PLANT | over
//! ```

use std::fmt;

use fcc_core::framework::PlantId;

const HELD: &str = "held ";
const FREE: &str = "free ";
const ANSWERS: &str = "answers ";
const OVER: &str = "over";

/// A line, without its end.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum Line {
    /// The number of a takeover, and the plant.
    Held(u64, PlantId),
    /// The number of a takeover whose release is confirmed.
    Free(u64),
    /// By what the answers of a plant are known
    /// ([`answers_from`](fcc_core::framework::ControlAuthority::answers_from)).
    Answers(u16, PlantId),
    /// The daemon neither takes nor releases control again.
    Over,
}

impl fmt::Display for Line {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Held(number, plant) => write!(f, "{HELD}{number} {plant}"),
            Self::Free(number) => write!(f, "{FREE}{number}"),
            Self::Answers(from, plant) => write!(f, "{ANSWERS}{from} {plant}"),
            Self::Over => f.write_str(OVER),
        }
    }
}

impl Line {
    /// None if it is none of these.
    fn read(line: &str) -> Option<Self> {
        if line == OVER {
            return Some(Self::Over);
        }
        if let Some(number) = line.strip_prefix(FREE) {
            return Some(Self::Free(number.parse().ok()?));
        }
        let plant = |given: &str| PlantId::new(format_args!("{given}"));
        if let Some(answers) = line.strip_prefix(ANSWERS) {
            let (from, of) = answers.split_once(' ')?;
            return Some(Self::Answers(from.parse().ok()?, plant(of)?));
        }
        let (number, of) = line.strip_prefix(HELD)?.split_once(' ')?;
        Some(Self::Held(number.parse().ok()?, plant(of)?))
    }
}

/// What the lines up to now mean.
#[derive(Default, Debug)]
pub struct Told {
    held: Option<(u64, PlantId)>,
    answers: Option<(u16, PlantId)>,
    is_over: bool,
}

impl Told {
    /// Takes the next line; one that is not understood changes nothing.
    pub fn line(&mut self, line: &str) {
        match Line::read(line) {
            Some(Line::Held(number, plant)) => self.held = Some((number, plant)),
            // A release that is told late does not cover the next takeover.
            Some(Line::Free(freed)) => self.held = self.held.filter(|(number, _)| *number > freed),
            Some(Line::Answers(from, plant)) => self.answers = Some((from, plant)),
            Some(Line::Over) => self.is_over = true,
            None => {}
        }
    }

    /// The takeover, by its number, after which the plant is held.
    pub const fn held(&self) -> Option<(u64, PlantId)> {
        self.held
    }

    /// Whether the flight is over.
    pub const fn is_over(&self) -> bool {
        self.is_over
    }

    /// By what the answers of the plant that is held are known.
    pub fn answers_from(&self) -> Option<u16> {
        let (_, held) = self.held?;
        let (from, plant) = self.answers?;
        (plant == held).then_some(from)
    }
}

/// Reads lines as a release helper does: the takeover after which a plant is
/// held, and the plant.
#[cfg(fuzzing)]
pub fn held_after<'a>(lines: impl Iterator<Item = &'a str>) -> Option<(u64, PlantId)> {
    let mut told = Told::default();
    for line in lines {
        if let Some(read) = Line::read(line) {
            assert_eq!(Line::read(&read.to_string()), Some(read));
        }
        told.line(line);
    }
    told.held()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plant(which: &str) -> PlantId {
        PlantId::new(format_args!("{which}")).unwrap()
    }

    #[test]
    fn the_last_takeover_is_held_until_its_own_release() {
        let mut told = Told::default();
        let mut after = |line: &str| {
            told.line(line);
            told.held()
        };
        assert_eq!(after("free 7"), None);
        let first = Some((3, plant("X-Plane at 127.0.0.1:49000")));
        assert_eq!(after("held 3 X-Plane at 127.0.0.1:49000"), first);
        for other in [
            "", "held", "held 4", "held x y", "free", "free -1", "free 2",
        ] {
            assert_eq!(after(other), first, "{other}");
        }
        assert_eq!(after("held 4 b"), Some((4, plant("b"))));
        assert_eq!(after("free 3"), Some((4, plant("b"))));
        assert_eq!(after("free 4"), None);
    }

    #[test]
    fn where_the_answers_of_what_is_held_come_from_is_the_last_that_was_told() {
        let mut told = Told::default();
        let mut after = |line: &str| {
            told.line(line);
            told.answers_from()
        };
        assert_eq!(after("answers 49005 a b"), None);
        assert_eq!(after("held 1 a b"), Some(49_005));
        for other in ["answers 65536 a b", "answers -1 a b", "answers 7", "free 0"] {
            assert_eq!(after(other), Some(49_005), "{other}");
        }
        assert_eq!(after("answers 49007 a b"), Some(49_007));
        // Of another plant.
        assert_eq!(after("answers 49005 c"), None);
        assert_eq!(after("held 2 c"), Some(49_005));
    }
}
