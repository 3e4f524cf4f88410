//! From commands to items.

use std::ops::RangeInclusive;

use super::{Command, frame, id};
use crate::item::{Altitude, AltitudeDatum, Item, Loiter, LoiterEnd, Place, Speed};
use crate::problem::Problem;

/// Latitudes and longitudes in degrees.
const LATITUDE_DEG: RangeInclusive<f64> = -90.0..=90.0;
const LONGITUDE_DEG: RangeInclusive<f64> = -180.0..=180.0;
/// Altitudes in m: from below the Dead Sea to above what the atmosphere's model
/// covers for these aircraft.
pub(crate) const ALTITUDE_M: RangeInclusive<f64> = -1_000.0..=20_000.0;
/// Radii of waypoints and circles in m.
pub(crate) const RADIUS_M: RangeInclusive<f64> = 0.0..=100_000.0;
/// Speeds in m/s, in SI at the edge as the files are.
pub(crate) const SPEED_MPS: RangeInclusive<f64> = 1.0..=350.0;
/// Durations in s: a week.
const SECONDS: RangeInclusive<f64> = 0.0..=604_800.0;

/// An item that was refused: a field and what is wrong with it.
pub(crate) type Refusal = (String, String);

impl Command {
    /// Parameter 1 to 7.
    pub(super) fn parameter(&self, number: usize) -> f64 {
        let index = number.wrapping_sub(1);
        self.parameters.get(index).copied().unwrap_or(f64::NAN)
    }

    /// A parameter within a range; `name` is what it means.
    pub(super) fn within(
        &self,
        number: usize,
        name: &str,
        range: &RangeInclusive<f64>,
    ) -> Result<f64, Refusal> {
        let value = self.parameter(number);
        check(&format!("parameter {number} ({name})"), value, range)
    }

    /// The same, where NaN and 0 leave it to the aircraft.
    fn unless_default(
        &self,
        number: usize,
        name: &str,
        range: &RangeInclusive<f64>,
    ) -> Result<Option<f64>, Refusal> {
        let value = self.parameter(number);
        if value.is_nan() || value == 0.0 {
            return Ok(None);
        }
        self.within(number, name, range).map(Some)
    }

    /// The place in parameters 5 and 6.
    pub(super) fn place(&self) -> Result<Place, Refusal> {
        self.place_or_here()?.ok_or_else(|| {
            let what =
                "latitude and longitude are missing or 0, which means \"here\": give a place";
            ("place".to_owned(), what.to_owned())
        })
    }

    /// The same; MAVLink writes 0 and 0, or NaN, for "here".
    fn place_or_here(&self) -> Result<Option<Place>, Refusal> {
        let (latitude, longitude) = (self.parameter(5), self.parameter(6));
        if [latitude, longitude].map(|x| x == 0.0 || x.is_nan()) == [true, true] {
            return Ok(None);
        }
        self.frame()?;
        place(latitude, longitude).map(Some)
    }

    /// The altitude in parameter 7.
    fn altitude(&self) -> Result<Altitude, Refusal> {
        let above = self.frame()?;
        let m = check("altitude", self.parameter(7), &ALTITUDE_M)?;
        Ok(Altitude { m, above })
    }

    fn frame(&self) -> Result<AltitudeDatum, Refusal> {
        datum(self.frame).ok_or_else(|| {
            let what = format!(
                "{}: give 0 (above sea level), 3 (above home) or 10 (above terrain)",
                self.frame
            );
            ("frame".to_owned(), what)
        })
    }
}

/// A place by its coordinates in degrees.
pub(crate) fn place(latitude: f64, longitude: f64) -> Result<Place, Refusal> {
    Ok(Place {
        latitude_deg: check("latitude", latitude, &LATITUDE_DEG)?,
        longitude_deg: check("longitude", longitude, &LONGITUDE_DEG)?,
    })
}

/// The datum of a frame.
fn datum(frame: u8) -> Option<AltitudeDatum> {
    match frame {
        frame::GLOBAL | frame::GLOBAL_INT => Some(AltitudeDatum::SeaLevel),
        frame::RELATIVE | frame::RELATIVE_INT => Some(AltitudeDatum::Home),
        frame::TERRAIN | frame::TERRAIN_INT => Some(AltitudeDatum::Terrain),
        _ => None,
    }
}

/// A number within a range.
pub(crate) fn check(name: &str, value: f64, range: &RangeInclusive<f64>) -> Result<f64, Refusal> {
    if range.contains(&value) {
        return Ok(value);
    }
    let (least, most) = (range.start(), range.end());
    let given = if value.is_nan() {
        "is missing".to_owned()
    } else {
        format!("{value}")
    };
    Err((name.to_owned(), format!("{given}: give {least} to {most}")))
}

/// A whole number within a range.
pub(super) fn whole(name: &str, value: f64, range: RangeInclusive<f64>) -> Result<u32, Refusal> {
    let number = check(name, value, &range)?;
    if number.fract() != 0.0 {
        return Err((name.to_owned(), format!("{number}: give a whole number")));
    }
    Ok(number as u32)
}

/// The item that a command is. A jump's target is as the file has it.
pub(crate) fn decode(number: usize, command: &Command) -> Result<Item, Problem> {
    item(command).map_err(|(field, message)| Problem::of_item(number, field, message))
}

fn item(command: &Command) -> Result<Item, Refusal> {
    Ok(match command.id {
        id::WAYPOINT => waypoint(command)?,
        id::LOITER_UNLIMITED => loiter(command, LoiterEnd::Never)?,
        id::LOITER_TURNS => {
            let turns = command.within(1, "turns", &(0.0..=1_000.0))?;
            if turns == 0.0 {
                let what = "0: give the number of turns";
                return Err(("parameter 1 (turns)".to_owned(), what.to_owned()));
            }
            loiter(command, LoiterEnd::Turns(turns))?
        }
        id::LOITER_TIME => {
            let seconds = command.within(1, "seconds", &SECONDS)?;
            loiter(command, LoiterEnd::Seconds(seconds))?
        }
        id::LOITER_TO_ALTITUDE => loiter(command, LoiterEnd::Altitude)?,
        id::RETURN => Item::Return,
        id::LAND => Item::Land {
            place: command.place_or_here()?,
            altitude: command.altitude()?,
            abort_altitude_m: command.unless_default(1, "abort altitude", &(0.0..=20_000.0))?,
        },
        id::TAKEOFF => Item::Takeoff {
            place: command.place_or_here()?,
            altitude: command.altitude()?,
            pitch_deg: takeoff_pitch(command)?,
        },
        id::CONDITION_DELAY => Item::Delay {
            seconds: command.within(1, "seconds", &SECONDS)?,
        },
        id::CONDITION_DISTANCE => Item::UntilDistance {
            distance_m: command.within(1, "distance", &(0.0..=1e6))?,
        },
        id::CHANGE_ALTITUDE => change_altitude(command)?,
        id::CHANGE_SPEED => change_speed(command)?,
        id::JUMP => jump(command)?,
        id::LAND_START => Item::LandStart {
            place: command.place_or_here()?,
        },
        camera if id::CAMERA.iter().any(|ids| ids.contains(&camera)) => Item::Camera {
            command: camera,
            frame: command.frame,
            parameters: command.parameters.map(|p| Some(p).filter(|p| !p.is_nan())),
        },
        other => {
            let what = format!(
                "{other} is not supported: use waypoint (16), loiter (17, 18, 19, 31), return (20), \
                 land (21), take-off (22), delay (112), distance (114), jump (177), change of \
                 speed (178) or of altitude (186), landing sequence (189), or those of a camera"
            );
            return Err(("command".to_owned(), what));
        }
    })
}

/// The pitch of a take-off in degrees. With less than two no aircraft lifts off; it may be
/// one in radians.
fn takeoff_pitch(command: &Command) -> Result<Option<f64>, Refusal> {
    let pitch = command.unless_default(1, "pitch", &(0.0..=45.0))?;
    let Some(given) = pitch.filter(|given| *given < 2.0) else {
        return Ok(pitch);
    };
    let in_radians = match given.to_degrees() {
        degrees if degrees <= 45.0 => format!(" ({given} rad are {degrees:.0}°)"),
        _ => String::new(),
    };
    let what = format!("{given}: too little to lift off: give 2 to 45 degrees{in_radians}");
    Err(("parameter 1 (pitch)".to_owned(), what))
}

fn waypoint(command: &Command) -> Result<Item, Refusal> {
    let holds = command.parameter(1);
    // Less than a second counts as none.
    if holds >= 1.0 {
        let what = format!("{holds} s: an aeroplane cannot stop: use a loiter (19)");
        return Err(("parameter 1 (hold)".to_owned(), what));
    }
    if !(command.parameter(3) == 0.0 || command.parameter(3).is_nan()) {
        let what = format!("{}: not supported, give 0", command.parameter(3));
        return Err(("parameter 3 (pass by)".to_owned(), what));
    }
    Ok(Item::Waypoint {
        place: command.place()?,
        altitude: command.altitude()?,
        radius_m: command.unless_default(2, "radius", &RADIUS_M)?,
    })
}

fn loiter(command: &Command, end: LoiterEnd) -> Result<Item, Refusal> {
    let (radius, heading) = match end {
        LoiterEnd::Altitude => (2, 1),
        _ => (3, 2),
    };
    let signed = command.parameter(radius);
    let magnitude = *RADIUS_M.end();
    let signed_m = command.unless_default(radius, "radius", &(-magnitude..=magnitude))?;
    Ok(Item::Loiter(Loiter {
        place: command.place_or_here()?,
        altitude: command.altitude()?,
        radius_m: signed_m.map(f64::abs),
        clockwise: !signed.is_sign_negative() || signed.is_nan(),
        end,
        leave_towards_next: end != LoiterEnd::Never && command.parameter(heading) == 1.0,
    }))
}

fn change_altitude(command: &Command) -> Result<Item, Refusal> {
    let frame = command.within(2, "frame", &(0.0..=11.0))?;
    let above = datum(frame as u8)
        .filter(|_| frame.fract() == 0.0)
        .ok_or_else(|| {
            let what = format!("{frame}: give 0 (above sea level), 3 (home) or 10 (terrain)");
            ("parameter 2 (frame)".to_owned(), what)
        })?;
    Ok(Item::ChangeAltitude {
        altitude: Altitude {
            m: command.within(1, "altitude", &ALTITUDE_M)?,
            above,
        },
    })
}

fn change_speed(command: &Command) -> Result<Item, Refusal> {
    if command.parameter(4) == 1.0 {
        let what = "1: a relative speed is not supported: give 0 and the speed itself";
        return Err(("parameter 4 (relative)".to_owned(), what.to_owned()));
    }
    let kind = whole(
        "parameter 1 (type of speed)",
        command.parameter(1),
        0.0..=1.0,
    )?;
    // -1: no change.
    let given = |value: f64| !(value.is_nan() || value == -1.0);
    let speed = if given(command.parameter(2)) {
        let mps = command.within(2, "speed, m/s", &SPEED_MPS)?;
        Some(match kind {
            0 => Speed::AirspeedMps(mps),
            _ => Speed::GroundSpeedMps(mps),
        })
    } else {
        None
    };
    let throttle_percent = if given(command.parameter(3)) {
        Some(command.within(3, "throttle, %", &(0.0..=100.0))?)
    } else {
        None
    };
    Ok(Item::ChangeSpeed {
        speed,
        throttle_percent,
    })
}

fn jump(command: &Command) -> Result<Item, Refusal> {
    let to = whole("parameter 1 (item)", command.parameter(1), 1.0..=65_535.0)?;
    let times = match command.parameter(2) {
        -1.0 => None,
        times => Some(whole("parameter 2 (times)", times, 0.0..=65_535.0)?),
    };
    Ok(Item::Jump {
        to: to as usize,
        times,
    })
}
