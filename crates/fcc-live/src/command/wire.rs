//! Commands and answers in shared memory.

use super::super::Text;
use super::{COMMANDS_VERSION, Command, InvalidCommand, OutsideLimits, Verdict};

/// Set points in one command.
const MOST_SETPOINTS: usize = 8;
/// The longest name of one, in bytes.
const NAME_BYTES: usize = 32;
/// The longest reason, in bytes: all engage inhibits together are shorter, and of a
/// plan it has the first problems.
const REASON_BYTES: usize = 8_120;
/// The longest name of a file, in bytes.
const FILE_BYTES: usize = 1_024;
/// The longest name of a sender, in bytes.
const SENDER_BYTES: usize = 64;

/// A command in shared memory.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct CommandRequest {
    /// [`COMMANDS_VERSION`].
    pub(crate) version: u32,
    /// 0 engage, 1 disengage, 2 stop, 3 set, 4 another plan.
    pub(crate) code: u32,
    /// The names of set points; empty after the last.
    pub(crate) names: [Text<NAME_BYTES>; MOST_SETPOINTS],
    /// Their values, in the units at the ends of their names; of another plan the first is
    /// the item that is flown first.
    pub(crate) values: [f64; MOST_SETPOINTS],
    /// The plan's file, with its whole path.
    pub(crate) file: Text<FILE_BYTES>,
    /// Who sends it, in words.
    pub(crate) sender: Text<SENDER_BYTES>,
}

/// An answer in shared memory.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Answer {
    /// 0 carried out, 1 refused, 2 refused because of a set point's limits.
    pub(crate) code: u32,
    /// [`COMMANDS_VERSION`].
    pub(crate) version: u32,
    /// The tick that read the command; 0 if none did.
    pub(crate) tick: u64,
    /// The value that is out of its limits; with code 2 only.
    pub(crate) value: f64,
    /// The smallest permitted value.
    pub(crate) least: f64,
    /// The largest permitted value.
    pub(crate) most: f64,
    /// The name of the set point.
    pub(crate) name: Text<NAME_BYTES>,
    /// The reason for refusing it.
    pub(crate) text: Text<REASON_BYTES>,
}

const ENGAGE: u32 = 0;
const DISENGAGE: u32 = 1;
const STOP: u32 = 2;
const SET: u32 = 3;
const REPLACE_PLAN: u32 = 4;

const CARRIED_OUT: u32 = 0;
const REFUSED: u32 = 1;
const OUTSIDE: u32 = 2;

impl TryFrom<&Command> for CommandRequest {
    type Error = InvalidCommand;

    fn try_from(command: &Command) -> Result<Self, InvalidCommand> {
        let (code, set, file) = match command {
            Command::Engage => (ENGAGE, &[][..], ""),
            Command::Disengage => (DISENGAGE, &[][..], ""),
            Command::Stop => (STOP, &[][..], ""),
            Command::Set(set) => (SET, &set[..], ""),
            Command::ReplacePlan { file, .. } => (REPLACE_PLAN, &[][..], file.as_str()),
        };
        if file.len() > FILE_BYTES {
            return Err(InvalidCommand::LongFileName(file.len(), FILE_BYTES));
        }
        if set.len() > MOST_SETPOINTS {
            return Err(InvalidCommand::TooManySetpoints(MOST_SETPOINTS));
        }
        let mut request = Self {
            version: COMMANDS_VERSION,
            code,
            names: [Text::default(); MOST_SETPOINTS],
            values: [0.0; MOST_SETPOINTS],
            file: Text::new(file),
            sender: Text::default(),
        };
        if let (Command::ReplacePlan { item, .. }, [first, ..]) = (command, &mut request.values) {
            *first = f64::from(*item);
        }
        let places = request.names.iter_mut().zip(&mut request.values);
        for ((name, value), (given, number)) in places.zip(set) {
            (*name, *value) = (Text::new(given), *number);
        }
        Ok(request)
    }
}

impl CommandRequest {
    /// Another program may have written anything.
    ///
    /// # Errors
    /// Why it is not a command, as text.
    pub(super) fn command(&self) -> Result<Command, String> {
        if self.version != COMMANDS_VERSION {
            return Err(format!(
                "the command has version {}, and this daemon accepts version {COMMANDS_VERSION}: use \
                 the fccd that belongs to it",
                self.version
            ));
        }
        let given = self.names.iter().map(Text::as_str).zip(self.values);
        let [first, ..] = self.values;
        Ok(match self.code {
            ENGAGE => Command::Engage,
            DISENGAGE => Command::Disengage,
            STOP => Command::Stop,
            SET => Command::set(given.take_while(|(name, _)| !name.is_empty())),
            REPLACE_PLAN if first.fract() == 0.0 && (1.0..=1_000.0).contains(&first) => {
                Command::ReplacePlan {
                    file: self.file.as_str().to_owned(),
                    item: first as u16,
                }
            }
            REPLACE_PLAN => return Err("a plan is flown from an item, 1 to 1000".to_owned()),
            other => return Err(format!("there is no command with the number {other}")),
        })
    }
}

impl From<&Verdict> for Answer {
    fn from(verdict: &Verdict) -> Self {
        let answer = Self {
            code: CARRIED_OUT,
            version: COMMANDS_VERSION,
            tick: 0,
            value: 0.0,
            least: 0.0,
            most: 0.0,
            name: Text::default(),
            text: Text::default(),
        };
        match verdict {
            Verdict::CarriedOut { tick } => Self {
                tick: *tick,
                ..answer
            },
            Verdict::Refused(words) => Self {
                code: REFUSED,
                text: Text::new(words),
                ..answer
            },
            Verdict::Outside(outside) => Self {
                code: OUTSIDE,
                value: outside.value,
                least: outside.least,
                most: outside.most,
                name: Text::new(&outside.name),
                text: Text::new(&outside.to_string()),
                ..answer
            },
        }
    }
}

impl Answer {
    /// The result of the command.
    pub(super) fn verdict(&self) -> Verdict {
        match self.code {
            CARRIED_OUT => Verdict::CarriedOut { tick: self.tick },
            OUTSIDE => Verdict::Outside(OutsideLimits {
                name: self.name.as_str().to_owned(),
                value: self.value,
                least: self.least,
                most: self.most,
            }),
            _ => Verdict::Refused(self.text.as_str().to_owned()),
        }
    }
}

/// The command in shared memory with these bytes; those that are missing are
/// zero.
///
/// # Errors
/// Why it is not a command.
#[cfg(fuzzing)]
pub fn read_request(bytes: &[u8]) -> Result<Command, String> {
    let mut bytes = bytes.iter().copied().chain(std::iter::repeat(0));
    let request = CommandRequest {
        version: u32::from_ne_bytes(next(&mut bytes)),
        code: u32::from_ne_bytes(next(&mut bytes)),
        names: std::array::from_fn(|_| Text::of_bytes(next(&mut bytes))),
        values: std::array::from_fn(|_| f64::from_ne_bytes(next(&mut bytes))),
        file: Text::of_bytes(next(&mut bytes)),
        sender: Text::of_bytes(next(&mut bytes)),
    };
    request.command()
}

/// The answer in shared memory with these bytes, as [`read_request`].
#[cfg(fuzzing)]
pub fn read_answer(bytes: &[u8]) -> Verdict {
    let mut bytes = bytes.iter().copied().chain(std::iter::repeat(0));
    let answer = Answer {
        code: u32::from_ne_bytes(next(&mut bytes)),
        version: u32::from_ne_bytes(next(&mut bytes)),
        tick: u64::from_ne_bytes(next(&mut bytes)),
        value: f64::from_ne_bytes(next(&mut bytes)),
        least: f64::from_ne_bytes(next(&mut bytes)),
        most: f64::from_ne_bytes(next(&mut bytes)),
        name: Text::of_bytes(next(&mut bytes)),
        text: Text::of_bytes(next(&mut bytes)),
    };
    answer.verdict()
}

#[cfg(fuzzing)]
fn next<const N: usize>(bytes: &mut impl Iterator<Item = u8>) -> [u8; N] {
    std::array::from_fn(|_| bytes.next().unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use proptest::prelude::*;

    use super::*;

    /// The part of `proto/layout.md` about commands: programs in other languages rely on it.
    fn documented() -> &'static str {
        let document = include_str!("../../../../proto/layout.md");
        document.split_once("## Commands").unwrap().1
    }

    #[test]
    fn the_layouts_are_as_documented() {
        assert!(documented().contains(&format!("command/v{COMMANDS_VERSION}`")));
        macro_rules! rows {
            ($of:ty; $($field:ident: $kind:literal)+) => {
                [
                    $(format!(
                        "\n| {} | `{}` | {} | ", offset_of!($of, $field), stringify!($field), $kind
                    ),)+
                    format!("\n| {} | | | end |", size_of::<$of>()),
                ]
            };
        }
        let request = rows!(CommandRequest;
            version: "u32" code: "u32" names: "char[32][8]" values: "f64[8]" file: "char[1024]"
            sender: "char[64]");
        let answer = rows!(Answer;
            code: "u32" version: "u32" tick: "u64" value: "f64" least: "f64" most: "f64"
            name: "char[32]" text: "char[8120]");
        for row in request.iter().chain(&answer) {
            assert!(documented().contains(row), "proto/layout.md lacks {row}");
        }
    }

    #[test]
    fn commands_and_results_are_read_back() {
        for command in [
            Command::Engage,
            Command::Disengage,
            Command::Stop,
            Command::set([("heading_rad", 1.5), ("room_c", 21.0)]),
            Command::ReplacePlan {
                file: "/home/me/survey 2.plan".to_owned(),
                item: 7,
            },
        ] {
            let request = CommandRequest::try_from(&command).unwrap();
            assert_eq!(request.command(), Ok(command));
        }
        let many = Command::set([("heading_rad", 1.5); 9]);
        assert!(CommandRequest::try_from(&many).is_err());
        // A shorter name might be that of another file.
        let file = "é".repeat(513);
        let long = Command::ReplacePlan { file, item: 1 };
        assert!(CommandRequest::try_from(&long).is_err());
        for verdict in [
            Verdict::CarriedOut { tick: 9 },
            Verdict::Refused("why".to_owned()),
            Verdict::Outside(OutsideLimits {
                name: "airspeed_mps".to_owned(),
                value: 90.0,
                least: 40.0,
                most: 60.0,
            }),
        ] {
            assert_eq!(Answer::from(&verdict).verdict(), verdict);
        }
    }

    #[test]
    fn another_version_is_refused() {
        let mut request = CommandRequest::try_from(&Command::Engage).unwrap();
        request.version = 1;
        let words = request.command().unwrap_err();
        assert!(
            words.contains("version 5") && words.contains("version 1"),
            "{words}"
        );
    }

    proptest! {
        /// Invalid bytes in shared memory never give an invalid name.
        #[test]
        fn any_bytes_are_a_command_or_refused(version in 0..4_u32, code in 0..6_u32, bits: [u64; 8]) {
            let values = bits.map(f64::from_bits);
            let name = Text::new(&String::from_utf8_lossy(&bits[0].to_le_bytes()));
            let file = Text::new(&String::from_utf8_lossy(&bits[1].to_le_bytes()));
            let sender = Text::default();
            let request = CommandRequest { version, code, names: [name; 8], values, file, sender };
            if let Ok(Command::Set(set)) = request.command() {
                prop_assert!(set.len() <= 8 && set.iter().all(|(name, _)| !name.is_empty()));
            }
        }
    }
}
