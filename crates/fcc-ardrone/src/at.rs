//! AT commands: `AT*NAME=SEQUENCE,ARGUMENT,...<CR>`, several in a datagram.

use core::fmt;
use core::str::FromStr;

/// A longer command is refused by the drone, with its line's end.
const LONGEST: usize = 1024;

/// How a stick is held: each -1 to 1, in shares of the configured limits.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Stick {
    /// Right wing down.
    pub roll: f64,
    /// Nose up: a negative one flies forward.
    pub pitch: f64,
    /// Climb.
    pub climb: f64,
    /// Clockwise from above.
    pub yaw: f64,
    /// Of the pilot's device, in half turns clockwise from magnetic north, if roll and pitch are
    /// about its axes and not the drone's.
    pub heading: Option<f64>,
}

/// A command.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Command<'a> {
    /// `REF`: the start button is on or off; the emergency button is pressed.
    Buttons {
        /// Take off or stay in the air; else land.
        flies: bool,
        /// Stop the motors; or, after that, permit them again.
        emergency: bool,
    },
    /// `PCMD`, `PCMD_MAG`: a stick, or none where it is let go.
    Move(Option<Stick>),
    /// `CONFIG`: a value of the configuration.
    Configure {
        /// Section and name, with a colon between.
        key: &'a str,
        /// The value, as text.
        value: &'a str,
    },
    /// `CTRL`: 5 clears the acknowledgement of a configuration.
    Control(i32),
    /// `COMWDG`: the client is there again.
    Watchdog,
    /// `FTRIM`: it stands level.
    FlatTrim,
    /// Known, and without effect here: `CALIB`, `CONFIG_IDS`, `LED`, `ANIM` and others.
    Other,
}

/// A command that cannot be read.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Malformed {
    /// It does not begin with `AT*NAME=NUMBER`, or is no text, or too long.
    Form,
    /// Its arguments are too few, no numbers, or beyond their range.
    Arguments,
}

impl fmt::Display for Malformed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Form => {
                "no AT command: it begins with AT*NAME=NUMBER, and has at most 1,024 bytes"
            }
            Self::Arguments => "an AT command with wrong arguments",
        })
    }
}

/// The commands of a datagram, each with its sequence number.
pub fn commands(datagram: &[u8]) -> impl Iterator<Item = Result<(u32, Command<'_>), Malformed>> {
    datagram
        .split(|byte| *byte == b'\r')
        .filter(|line| !line.is_empty())
        .map(command)
}

fn command(line: &[u8]) -> Result<(u32, Command<'_>), Malformed> {
    let text = core::str::from_utf8(line).map_err(|_| Malformed::Form)?;
    let text = text.strip_prefix("AT*").ok_or(Malformed::Form)?;
    let (name, rest) = text.split_once('=').ok_or(Malformed::Form)?;
    if line.len() > LONGEST || name.is_empty() {
        return Err(Malformed::Form);
    }
    let (sequence, rest) = rest.split_once(',').unwrap_or((rest, ""));
    let sequence = sequence.parse().map_err(|_| Malformed::Form)?;
    let mut arguments = rest.split(',');
    let command = match name {
        "REF" => {
            let bits: u32 = number::<i64>(arguments.next())? as u32;
            Command::Buttons {
                flies: bits & (1 << 9) != 0,
                emergency: bits & (1 << 8) != 0,
            }
        }
        "PCMD" | "PCMD_MAG" => moved(&mut arguments, name == "PCMD_MAG")?,
        "CONFIG" => configured(rest).ok_or(Malformed::Arguments)?,
        "CTRL" => Command::Control(number(arguments.next())?),
        "COMWDG" => Command::Watchdog,
        "FTRIM" => Command::FlatTrim,
        _ => Command::Other,
    };
    Ok((sequence, command))
}

fn number<N: FromStr>(argument: Option<&str>) -> Result<N, Malformed> {
    argument
        .and_then(|text| text.trim().parse().ok())
        .ok_or(Malformed::Arguments)
}

/// A number from -1 to 1: the bits of a 32-bit float, as a decimal number.
fn share(argument: Option<&str>) -> Result<f64, Malformed> {
    let bits: i64 = number(argument)?;
    let value = f64::from(f32::from_bits(bits as u32));
    if value.is_finite() {
        Ok(value.clamp(-1.0, 1.0))
    } else {
        Err(Malformed::Arguments)
    }
}

fn moved<'a>(
    arguments: &mut impl Iterator<Item = &'a str>,
    has_heading: bool,
) -> Result<Command<'a>, Malformed> {
    let flags: i64 = number(arguments.next())?;
    let mut stick = Stick {
        roll: share(arguments.next())?,
        pitch: share(arguments.next())?,
        climb: share(arguments.next())?,
        yaw: share(arguments.next())?,
        heading: None,
    };
    if has_heading && flags & 4 != 0 {
        stick.heading = Some(share(arguments.next())?);
    }
    Ok(Command::Move((flags & 1 != 0).then_some(stick)))
}

/// `"KEY","VALUE"`.
fn configured(arguments: &str) -> Option<Command<'_>> {
    let (key, value) = arguments.strip_prefix('"')?.split_once('"')?;
    let value = value.strip_prefix(',')?.strip_prefix('"')?;
    let value = value.strip_suffix('"')?;
    Some(Command::Configure { key, value })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Vec<Result<(u32, Command<'_>), Malformed>> {
        commands(text.as_bytes()).collect()
    }

    /// The examples of the developer guide, section 6.6.
    #[test]
    fn the_guides_examples_are_read() {
        let stick = |roll, pitch, climb, yaw| {
            Command::Move(Some(Stick {
                roll,
                pitch,
                climb,
                yaw,
                heading: None,
            }))
        };
        // -1085485875 are the bits of -0.8.
        let read = read(
            "AT*PCMD=21625,1,0,0,0,0\rAT*PCMD=1,1,-1085485875,0,0,0\rAT*REF=21626,290718208\rAT*REF=2,290717696\r",
        );
        let f = f64::from(-0.8_f32);
        assert_eq!(
            read,
            [
                Ok((21625, stick(0.0, 0.0, 0.0, 0.0))),
                Ok((1, stick(f, 0.0, 0.0, 0.0))),
                Ok((
                    21626,
                    Command::Buttons {
                        flies: true,
                        emergency: false
                    }
                )),
                Ok((
                    2,
                    Command::Buttons {
                        flies: false,
                        emergency: false
                    }
                )),
            ]
        );
    }

    /// As node-ar-drone 0.3.3 sends them; its REF has the buttons' bits alone.
    #[test]
    fn what_node_ar_drone_sends_is_read() {
        let sent = "AT*CTRL=0,5,0\rAT*CONFIG=1,\"general:navdata_demo\",\"TRUE\"\rAT*REF=2,512\rAT*PCMD=3,0,0,0,0,0\rAT*FTRIM=4\rAT*CONFIG=5,\"leds:leds_anim\",\"9,1073741824,3\"\r";
        assert_eq!(
            read(sent),
            [
                Ok((0, Command::Control(5))),
                Ok((
                    1,
                    Command::Configure {
                        key: "general:navdata_demo",
                        value: "TRUE"
                    }
                )),
                Ok((
                    2,
                    Command::Buttons {
                        flies: true,
                        emergency: false
                    }
                )),
                Ok((3, Command::Move(None))),
                Ok((4, Command::FlatTrim)),
                Ok((
                    5,
                    Command::Configure {
                        key: "leds:leds_anim",
                        value: "9,1073741824,3"
                    }
                )),
            ]
        );
    }

    #[test]
    fn what_is_no_command_is_refused() {
        for text in [
            "AT",
            "AT*=1",
            "AT*REF",
            "AT*REF=",
            "AT*REF=x,512",
            "GET / HTTP/1.1",
            "\u{e9}",
        ] {
            assert_eq!(read(text), [Err(Malformed::Form)], "{text}");
        }
        // A NaN, an infinite number, a missing one, a text without quotes.
        for text in [
            "AT*PCMD=1,1,2143289344,0,0,0",
            "AT*PCMD=1,1,0,2139095040,0,0",
            "AT*PCMD=1,1,0,0,0",
            "AT*PCMD_MAG=1,5,0,0,0,0",
            "AT*REF=1",
            "AT*CONFIG=1,general:navdata_demo,TRUE",
        ] {
            assert_eq!(read(text), [Err(Malformed::Arguments)], "{text}");
        }
        let long = format!("AT*CONFIG=1,\"a\",\"{}\"", "b".repeat(LONGEST));
        assert_eq!(read(&long), [Err(Malformed::Form)]);
    }

    proptest::proptest! {
        #[test]
        fn any_datagram_gives_shares_within_their_range(bytes: Vec<u8>, bits: i32) {
            let pcmd = format!("AT*PCMD_MAG=7,5,{bits},{bits},{bits},{bits},{bits},0\r");
            for (_, command) in commands(&bytes).chain(commands(pcmd.as_bytes())).flatten() {
                if let Command::Move(Some(stick)) = command {
                    for share in [stick.roll, stick.pitch, stick.climb, stick.yaw] {
                        proptest::prop_assert!((-1.0..=1.0).contains(&share));
                    }
                }
            }
        }
    }
}
