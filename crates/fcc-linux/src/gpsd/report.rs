//! What a line of gpsd says.

use fcc_core::flight::{GnssFix, Position, Velocity};
use fcc_device::{NO_FIX, velocity_over_ground};
use serde::Deserialize;

/// What a line says, as far as it is used.
#[derive(Clone, PartialEq, Debug)]
pub enum Report {
    /// Time, position and velocity (`TPV`).
    Fix {
        /// The receiver's path, such as `/dev/ttyACM0`.
        device: Option<String>,
        /// Its time of day, UTC, s; none if the receiver has not said it.
        time_s: Option<f64>,
        /// Its fix, if it has a three-dimensional one that it measured, and gives
        /// position and speed; otherwise what is missing, and what to do.
        fix: Result<GnssFix, &'static str>,
        /// Whether the fix has a vertical speed; otherwise it is 0.
        has_vertical_speed: bool,
    },
    /// A measured fix that is nowhere on the earth: a latitude beyond 90°, or a
    /// longitude beyond 180°.
    Impossible {
        /// The receiver's path.
        device: Option<String>,
    },
    /// What gpsd says it is (`VERSION`).
    Version {
        /// The protocol's, 3.
        protocol: u32,
    },
    /// The receivers that it has, by their paths (`DEVICES`).
    Devices(Vec<String>),
    /// It refuses what it was asked (`ERROR`).
    Error(String),
    /// Something else, such as satellites.
    Other,
}

/// A line that gpsd does not write.
#[derive(thiserror::Error, Clone, Copy, PartialEq, Eq, Debug)]
#[error("this is no line of gpsd's JSON")]
pub struct NotGpsd;

/// The classes and members that are used, by their names in `gpsd_json(5)`.
#[derive(Deserialize)]
#[serde(tag = "class")]
enum Object {
    #[serde(rename = "TPV")]
    Tpv(Box<Tpv>),
    #[serde(rename = "VERSION")]
    Version { proto_major: u32 },
    #[serde(rename = "DEVICES")]
    Devices { devices: Vec<Device> },
    #[serde(rename = "ERROR")]
    Error { message: String },
    #[serde(other)]
    Other,
}

#[derive(Deserialize)]
struct Device {
    path: Option<String>,
}

/// Degrees, metres, m/s. What is not known is missing.
#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
#[derive(Default)]
struct Tpv {
    device: Option<String>,
    time: Option<String>,
    /// 0 and 1 none, 2 two-dimensional, 3 three-dimensional.
    mode: u8,
    /// 5 dead reckoning, 8 simulated; missing for a usual fix.
    status: Option<u8>,
    lat: Option<f64>,
    lon: Option<f64>,
    /// Above mean sea level.
    #[serde(rename = "altMSL")]
    alt_msl: Option<f64>,
    /// The same before gpsd 3.20.
    alt: Option<f64>,
    vel_n: Option<f64>,
    vel_e: Option<f64>,
    vel_d: Option<f64>,
    /// Over the ground, with the direction from true north.
    speed: Option<f64>,
    track: Option<f64>,
    climb: Option<f64>,
    /// Estimated errors: horizontal, of longitude and latitude, vertical, of the
    /// speed.
    eph: Option<f64>,
    epx: Option<f64>,
    epy: Option<f64>,
    epv: Option<f64>,
    eps: Option<f64>,
}

const THREE_DIMENSIONAL: u8 = 3;
const DEAD_RECKONING: u8 = 5;
const SIMULATED: u8 = 8;

impl Report {
    /// Reads a line.
    ///
    /// # Errors
    /// When it is not JSON, has no class, or a member of another type.
    pub fn read(line: &[u8]) -> Result<Self, NotGpsd> {
        Ok(match serde_json::from_slice(line).map_err(|_| NotGpsd)? {
            Object::Tpv(tpv) if tpv.is_impossible() => Self::Impossible { device: tpv.device },
            Object::Tpv(tpv) => Self::Fix {
                fix: tpv.fix(),
                has_vertical_speed: tpv.has_velocity() || tpv.climb.is_some(),
                time_s: tpv.time.as_deref().and_then(time_of_day_s),
                device: tpv.device,
            },
            Object::Version { proto_major } => Self::Version {
                protocol: proto_major,
            },
            Object::Devices { devices } => {
                Self::Devices(devices.into_iter().filter_map(|one| one.path).collect())
            }
            Object::Error { message } => Self::Error(message),
            Object::Other => Self::Other,
        })
    }
}

impl Tpv {
    fn is_measured(&self) -> bool {
        self.mode == THREE_DIMENSIONAL && !matches!(self.status, Some(DEAD_RECKONING | SIMULATED))
    }

    fn is_impossible(&self) -> bool {
        let beyond = |angle: Option<f64>, most: f64| angle.is_some_and(|angle| angle.abs() > most);
        self.is_measured() && (beyond(self.lat, 90.0) || beyond(self.lon, 180.0))
    }

    /// Of a report that is not impossible.
    fn fix(&self) -> Result<GnssFix, &'static str> {
        let measured = |angle: Option<f64>| angle.filter(|_| self.is_measured()).ok_or(NO_FIX);
        let position = Position {
            latitude_rad: measured(self.lat)?.to_radians(),
            longitude_rad: measured(self.lon)?.to_radians(),
            altitude_m: self.alt_msl.or(self.alt).ok_or(NO_ALTITUDE)?,
        };
        let across = self.epx.zip(self.epy).map(|(x, y)| x.max(y));
        Ok(GnssFix {
            position,
            velocity: self.velocity().ok_or(NO_SPEED)?,
            horizontal_accuracy_m: error(self.eph.or(across)),
            vertical_accuracy_m: error(self.epv),
            speed_accuracy_mps: error(self.eps),
        })
    }

    const fn has_velocity(&self) -> bool {
        self.vel_n.is_some() && self.vel_e.is_some() && self.vel_d.is_some()
    }

    fn velocity(&self) -> Option<Velocity> {
        if let (Some(north_mps), Some(east_mps), Some(down_mps)) =
            (self.vel_n, self.vel_e, self.vel_d)
        {
            return Some(Velocity {
                north_mps,
                east_mps,
                down_mps,
            });
        }
        let [north_mps, east_mps] = velocity_over_ground(self.speed?, self.track)?;
        Some(Velocity {
            north_mps,
            east_mps,
            down_mps: -self.climb.unwrap_or_default(),
        })
    }
}

const NO_ALTITUDE: &str = "its fix has no altitude above mean sea level: switch GGA on at the \
                           receiver, or its binary protocol";
const NO_SPEED: &str = "its fix has no speed, or no course: switch RMC on at the receiver, or its \
                        binary protocol";

/// Of a time by ISO 8601, such as 2026-11-26T10:11:11.200Z.
fn time_of_day_s(time: &str) -> Option<f64> {
    let (_, of_day) = time.strip_suffix('Z')?.split_once('T')?;
    let mut parts = of_day.splitn(3, ':').map(str::parse::<f64>);
    let [hours, minutes, seconds] = [(); 3].map(|()| parts.next().and_then(Result::ok));
    Some(3_600.0 * hours? + 60.0 * minutes? + seconds?).filter(|time_s| time_s.is_finite())
}

/// 0 if it is not known.
fn error(estimated: Option<f64>) -> f64 {
    estimated.filter(|error| *error >= 0.0).unwrap_or(0.0)
}
