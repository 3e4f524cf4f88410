//! NMEA 0183, as every satellite receiver speaks it: position and altitude
//! (GGA), speed and course (RMC), accuracies (GST), kind of fix (GSA).
//!
//! A field that is empty is not known, as before the first fix; one that is not
//! what it should be is damaged.
//!
//! By the descriptions in the *u-blox F9 HPG 1.32 interface description*
//! (UBX-22008968), 2.7. Of any satellite system: the two letters after `$` are
//! not looked at.

use core::str;

use fcc_core::flight::Position;
use fcc_device::velocity_over_ground;

use super::{Begin, Protocol};

/// `$`, two letters of the talker, three of the sentence, a comma.
const HEADER: usize = 7;
/// `*` and two digits.
const CHECKSUM: usize = 3;
const MPS_PER_KNOT: f64 = 1_852.0 / 3_600.0;

/// The protocol, as far as it is used.
#[derive(Clone, Copy, Debug)]
pub struct Nmea;

/// A sentence. Times are the UTC time of day of the fix, s.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Sentence {
    /// RMC: the time, and the speed over the ground to true north and east, m/s;
    /// none without a fix.
    Motion(Option<(f64, [f64; 2])>),
    /// GGA: the time, and where the antenna is; none without a three-dimensional
    /// fix.
    Place(Option<(f64, Position)>),
    /// GST: one standard deviation, m; 0 if it is not known.
    Accuracy {
        /// North or east, the larger.
        horizontal_m: f64,
        /// Of the altitude.
        vertical_m: f64,
    },
    /// GSA: whether the fix is three-dimensional.
    Kind {
        /// Otherwise the altitude is an older one.
        has_altitude: bool,
    },
    /// One that is not used.
    Other,
}

impl Protocol for Nmea {
    type Frame = Sentence;

    /// The standard has 82; some receivers give more digits.
    const LONGEST: usize = 120;

    fn begin(bytes: &[u8]) -> Begin<Sentence> {
        if bytes.first() != Some(&b'$') {
            return Begin::Noise;
        }
        let Some((head, rest)) = bytes.split_at_checked(HEADER) else {
            return Begin::Incomplete;
        };
        let Some(parse) = parser(head) else {
            return Begin::Noise;
        };
        let Some(length) = rest.iter().position(|byte| !is_text(*byte)) else {
            return Begin::Incomplete;
        };
        let Some((text, [b'*', digits @ ..])) = rest.split_at_checked(length) else {
            return Begin::Damaged;
        };
        let Some(digits) = digits.get(..CHECKSUM - 1) else {
            return Begin::Incomplete;
        };
        let checked = head.iter().skip(1).chain(text);
        let sum = checked.fold(0, |sum, byte| sum ^ byte);
        let fields = str::from_utf8(text).unwrap_or_default();
        let sentence = parse(&mut fields.split(','));
        match sentence {
            Some(sentence) if hex(digits) == Some(sum) => {
                Begin::Frame(sentence, HEADER + length + CHECKSUM)
            }
            _ => Begin::Damaged,
        }
    }
}

type Parser = fn(&mut str::Split<'_, char>) -> Option<Sentence>;

fn parser(head: &[u8]) -> Option<Parser> {
    match head.get(3..)? {
        b"RMC," => Some(motion),
        b"GGA," => Some(place),
        b"GST," => Some(accuracy),
        b"GSA," => Some(kind),
        [kind @ .., b','] if kind.iter().all(u8::is_ascii_uppercase) => {
            Some(|_| Some(Sentence::Other))
        }
        _ => None,
    }
}

fn is_text(byte: u8) -> bool {
    (b' '..=b'~').contains(&byte) && byte != b'*' && byte != b'$'
}

fn hex(digits: &[u8]) -> Option<u8> {
    let text = str::from_utf8(digits).ok()?;
    let is_hex = text.bytes().all(|digit| digit.is_ascii_hexdigit());
    u8::from_str_radix(text, 16).ok().filter(|_| is_hex)
}

/// Time, status, latitude, N or S, longitude, E or W, knots, course, date,
/// variation and its direction, mode.
fn motion(fields: &mut str::Split<'_, char>) -> Option<Sentence> {
    let time_s = known(fields.next()?, time).ok()?;
    let status = fields.next()?;
    let [knots, course] = [fields.nth(4)?, fields.next()?];
    // Before version 2.3 there is none. E estimated, M manual, S simulated, N none.
    let mode = fields.nth(3).unwrap_or_default();
    let is_fix = status == "A" && !matches!(mode, "E" | "M" | "S" | "N");
    let (speed_kt, course_deg) = (known(knots, number).ok()?, known(course, number).ok()?);
    // Without a speed the receiver has no fix yet, whatever it says.
    let velocity_mps = match speed_kt {
        Some(speed_kt) if is_fix => {
            let velocity_mps = velocity_over_ground(speed_kt * MPS_PER_KNOT, course_deg);
            // What moves may have no course; anything else without a velocity is damaged.
            if velocity_mps.is_none() && (course_deg.is_some() || speed_kt < 0.0) {
                return None;
            }
            velocity_mps
        }
        _ => None,
    };
    Some(Sentence::Motion(time_s.zip(velocity_mps)))
}

/// Time, latitude, N or S, longitude, E or W, quality, satellites, dilution,
/// altitude above mean sea level, M, and more.
fn place(fields: &mut str::Split<'_, char>) -> Option<Sentence> {
    let time_s = known(fields.next()?, time).ok()?;
    let [latitude, north, longitude, east] = [
        fields.next()?,
        fields.next()?,
        fields.next()?,
        fields.next()?,
    ];
    // 0 no fix, 6 estimated, 7 manual, 8 simulated.
    let is_fix = matches!(fields.next()?, "1" | "2" | "3" | "4" | "5");
    let [altitude, unit] = [fields.nth(2)?, fields.next()?];
    let latitude_rad = known(latitude, |text| angle(text, north, ["N", "S"], 90.0)).ok()?;
    let longitude_rad = known(longitude, |text| angle(text, east, ["E", "W"], 180.0)).ok()?;
    // A fix in two dimensions may have none.
    let altitude_m = known(altitude, |text| number(text).filter(|_| unit == "M")).ok()?;
    let position = || {
        Some(Position {
            latitude_rad: latitude_rad?,
            longitude_rad: longitude_rad?,
            altitude_m: altitude_m?,
        })
    };
    let position = position().filter(|_| is_fix);
    Some(Sentence::Place(time_s.zip(position)))
}

/// Time, RMS of the ranges, the ellipse's axes and direction, and the standard
/// deviations of latitude, longitude and altitude.
fn accuracy(fields: &mut str::Split<'_, char>) -> Option<Sentence> {
    let [latitude, longitude, altitude] = [fields.nth(5)?, fields.next()?, fields.next()?];
    let deviation = |text| known(text, number).ok().map(Option::unwrap_or_default);
    Some(Sentence::Accuracy {
        horizontal_m: deviation(latitude)?.max(deviation(longitude)?),
        vertical_m: deviation(altitude)?,
    })
}

/// How the kind is chosen, and the kind: 1 no fix, 2 two-dimensional, 3 three-dimensional.
fn kind(fields: &mut str::Split<'_, char>) -> Option<Sentence> {
    let has_altitude = fields.nth(1)? == "3";
    Some(Sentence::Kind { has_altitude })
}

/// A field that is not what it should be.
struct Damaged;

/// What a field says; none of an empty one.
fn known<T>(text: &str, read: impl FnOnce(&str) -> Option<T>) -> Result<Option<T>, Damaged> {
    if text.is_empty() {
        return Ok(None);
    }
    read(text).map(Some).ok_or(Damaged)
}

/// hhmmss.ss
fn time(text: &str) -> Option<f64> {
    let part = |range: core::ops::Range<usize>| number(text.get(range)?);
    let seconds = number(text.get(4..)?)?;
    let time_s = part(0..2)? * 3_600.0 + part(2..4)? * 60.0 + seconds;
    (0.0..86_401.0).contains(&time_s).then_some(time_s)
}

/// Degrees and minutes, (d)ddmm.mmmm, as rad.
fn angle(text: &str, sense: &str, [plus, minus]: [&str; 2], most_deg: f64) -> Option<f64> {
    let given = number(text)?;
    let degrees = (given / 100.0).trunc();
    let minutes = given - degrees * 100.0;
    let angle_deg = degrees + minutes / 60.0;
    if !(0.0..60.0).contains(&minutes) || !(0.0..=most_deg).contains(&angle_deg) {
        return None;
    }
    match sense {
        sense if sense == plus => Some(angle_deg.to_radians()),
        sense if sense == minus => Some(-angle_deg.to_radians()),
        _ => None,
    }
}

/// Digits, a point, a sign; no exponent, and no name of a number.
fn number(text: &str) -> Option<f64> {
    let is_plain = text
        .bytes()
        .all(|byte| matches!(byte, b'0'..=b'9' | b'.' | b'-'));
    text.parse().ok().filter(|_| is_plain)
}
