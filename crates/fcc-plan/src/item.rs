//! The items of a plan.

use core::fmt;

use fcc_core::units::KNOT_MPS;
use serde::{Deserialize, Serialize};

/// A place on the WGS-84 ellipsoid.
#[derive(Clone, Copy, PartialEq, Debug, Deserialize, Serialize)]
pub struct Place {
    /// Geodetic latitude in degrees, -90 to 90.
    pub latitude_deg: f64,
    /// Longitude in degrees, -180 to 180, positive to the east.
    pub longitude_deg: f64,
}

/// What an altitude is measured from.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum AltitudeDatum {
    /// Mean sea level.
    SeaLevel,
    /// The home position.
    Home,
    /// The terrain below.
    Terrain,
}

/// An altitude.
#[derive(Clone, Copy, PartialEq, Debug, Deserialize, Serialize)]
pub struct Altitude {
    /// In m, -1,000 to 20,000.
    pub m: f64,
    /// Above what.
    pub above: AltitudeDatum,
}

/// A demanded speed.
#[derive(Clone, Copy, PartialEq, Debug, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Speed {
    /// Calibrated airspeed in m/s.
    AirspeedMps(f64),
    /// Speed over the ground in m/s.
    GroundSpeedMps(f64),
}

/// When a loiter ends.
#[derive(Clone, Copy, PartialEq, Debug, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LoiterEnd {
    /// Never, but by a command.
    Never,
    /// After so many turns; positive.
    Turns(f64),
    /// After so many seconds on the circle.
    Seconds(f64),
    /// When its altitude has been reached.
    Altitude,
}

/// A circle around a place.
#[derive(Clone, Copy, PartialEq, Debug, Deserialize, Serialize)]
pub struct Loiter {
    /// The centre; none: where the previous item ends.
    pub place: Option<Place>,
    /// On the circle.
    pub altitude: Altitude,
    /// In m; none: the aircraft's usual one.
    pub radius_m: Option<f64>,
    /// Which way around, from above.
    pub clockwise: bool,
    /// When it ends.
    pub end: LoiterEnd,
    /// Leave it only in the direction of the next item.
    pub leave_towards_next: bool,
}

/// One item of a plan. Items are flown in order; those without a place take
/// effect when the one before them is done.
#[derive(Clone, Copy, PartialEq, Debug, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum Item {
    /// Fly to a place (`MAV_CMD_NAV_WAYPOINT`, 16).
    Waypoint {
        /// Where.
        place: Place,
        /// Reached there.
        altitude: Altitude,
        /// It counts as passed within this distance in m; none: when the turn to
        /// the next leg begins, or at its abeam.
        radius_m: Option<f64>,
    },
    /// Circle (17, 18, 19, 31).
    Loiter(Loiter),
    /// Fly home, or to a nearer rally point (20). Ends the plan.
    Return,
    /// Land (21).
    Land {
        /// Where to touch down; none: where the aircraft took off, in that direction.
        place: Option<Place>,
        /// Of the ground at the place.
        altitude: Altitude,
        /// Climb to this altitude in m above home when the landing is given up;
        /// none: the aircraft's usual one.
        abort_altitude_m: Option<f64>,
    },
    /// Take off (22).
    Takeoff {
        /// Where to; none: straight ahead.
        place: Option<Place>,
        /// It is done when this altitude has been reached.
        altitude: Altitude,
        /// Pitch in degrees, 0 to 45; none: the aircraft's usual one.
        pitch_deg: Option<f64>,
    },
    /// Wait before the next item that takes effect (112).
    Delay {
        /// In s.
        seconds: f64,
    },
    /// Wait until the next place is at most so far away (114).
    UntilDistance {
        /// In m.
        distance_m: f64,
    },
    /// Another altitude from now on, to the next item that has one (186).
    ChangeAltitude {
        /// The altitude.
        altitude: Altitude,
    },
    /// Another speed from now on (178).
    ChangeSpeed {
        /// The speed; none: it remains.
        speed: Option<Speed>,
        /// Throttle in percent, 0 to 100; none: it remains.
        throttle_percent: Option<f64>,
    },
    /// Continue at another item (177).
    Jump {
        /// Its number, from 1.
        to: usize,
        /// How often; none: for ever.
        times: Option<u32>,
    },
    /// The landing sequence begins here (189): an aircraft that has to land
    /// continues at the nearest one.
    LandStart {
        /// Where, for finding the nearest; none: at the next item with a place.
        place: Option<Place>,
    },
    /// A command of a camera or its gimbal, which is not carried out.
    Camera {
        /// `MAV_CMD`.
        command: u16,
        /// `MAV_FRAME`.
        frame: u8,
        /// Its parameters; none: left to the camera.
        parameters: [Option<f64>; 7],
    },
}

impl Item {
    /// Its name in tables.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Waypoint { .. } => "waypoint",
            Self::Loiter(_) => "loiter",
            Self::Return => "return",
            Self::Land { .. } => "land",
            Self::Takeoff { .. } => "take-off",
            Self::Delay { .. } => "delay",
            Self::UntilDistance { .. } => "until distance",
            Self::ChangeAltitude { .. } => "change altitude",
            Self::ChangeSpeed { .. } => "change speed",
            Self::Jump { .. } => "jump",
            Self::LandStart { .. } => "land start",
            Self::Camera { .. } => "camera",
        }
    }

    /// Its place, if it has one.
    pub const fn place(&self) -> Option<Place> {
        match *self {
            Self::Waypoint { place, .. } => Some(place),
            Self::Loiter(Loiter { place, .. })
            | Self::Land { place, .. }
            | Self::Takeoff { place, .. }
            | Self::LandStart { place } => place,
            _ => None,
        }
    }

    /// Its altitude, if it has one.
    pub const fn altitude(&self) -> Option<Altitude> {
        match *self {
            Self::Waypoint { altitude, .. }
            | Self::Loiter(Loiter { altitude, .. })
            | Self::Land { altitude, .. }
            | Self::Takeoff { altitude, .. }
            | Self::ChangeAltitude { altitude } => Some(altitude),
            _ => None,
        }
    }

    pub(crate) const fn altitude_mut(&mut self) -> Option<&mut Altitude> {
        match self {
            Self::Waypoint { altitude, .. }
            | Self::Loiter(Loiter { altitude, .. })
            | Self::Land { altitude, .. }
            | Self::Takeoff { altitude, .. }
            | Self::ChangeAltitude { altitude } => Some(altitude),
            _ => None,
        }
    }
}

/// Its name, and what it says besides place and altitude.
impl fmt::Display for Item {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.name();
        match *self {
            Self::ChangeSpeed {
                speed: Some(Speed::AirspeedMps(mps)),
                ..
            } => write!(f, "{name}: {mps:.1} m/s ({:.0} kt)", mps / KNOT_MPS),
            Self::ChangeSpeed {
                speed: Some(Speed::GroundSpeedMps(mps)),
                ..
            } => write!(f, "{name}: {mps:.1} m/s over the ground"),
            Self::Loiter(Loiter { radius_m, end, .. }) => {
                f.write_str(name)?;
                match end {
                    LoiterEnd::Never => f.write_str(": without an end")?,
                    LoiterEnd::Turns(turns) => write!(f, ": turns {turns}")?,
                    LoiterEnd::Seconds(seconds) => write!(f, ": {seconds:.0} s")?,
                    LoiterEnd::Altitude => f.write_str(": to its altitude")?,
                }
                radius_m.map_or(Ok(()), |radius_m| write!(f, ", radius {radius_m:.0} m"))
            }
            Self::Delay { seconds } => write!(f, "{name}: {seconds:.0} s"),
            Self::Camera { command, .. } => write!(f, "{name}: command {command}"),
            Self::UntilDistance { distance_m } => write!(f, "{name}: {distance_m:.0} m"),
            Self::Jump {
                to,
                times: Some(times),
            } => write!(f, "{name}: to {to}, times {times}"),
            Self::Jump { to, times: None } => write!(f, "{name}: to {to}, for ever"),
            _ => f.write_str(name),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Item, Speed};

    /// 1 kt is 1,852 m an hour.
    #[test]
    fn an_item_says_what_it_has() {
        let speed = Item::ChangeSpeed {
            speed: Some(Speed::AirspeedMps(100.0 * 1_852.0 / 3_600.0)),
            throttle_percent: None,
        };
        assert_eq!(speed.to_string(), "change speed: 51.4 m/s (100 kt)");
        let jump = Item::Jump {
            to: 2,
            times: Some(3),
        };
        assert_eq!(jump.to_string(), "jump: to 2, times 3");
    }
}
