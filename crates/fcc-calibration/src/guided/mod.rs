//! Guided calibration: a person turns the sensors or leaves them alone, and is
//! told what to do next, until the calibration is found or refused.
//!
//! [`GuidedCalibration`] takes what the sensors give, uncalibrated, tick by tick.
//! It says how far it is, what is to be done [`Next`], and at the end what was
//! [`Found`] or why it was [refused](Refusal). No heap and no clock: the times are
//! those of the readings.

mod accelerometer;
mod airspeed;
mod found;
mod gyroscope;
mod magnetometer;
mod mounting;
mod path;
mod place;
mod readings;
mod refusal;
mod rest;
mod sphere;
mod turning;

use core::time::Duration;

use libm::{acos, sqrt};

use accelerometer::Positions;
use airspeed::Zero;
pub use found::{Found, Quality, Values};
use gyroscope::AtRest;
use magnetometer::Sphere;
use mounting::Attitudes;
pub use mounting::MountingWay;
pub use place::Place;
use readings::{Arrivals, Arrived};
pub use refusal::Refusal;
use rest::Rest;
pub use sphere::{CELLS, CELLS_OF_BANDS};
use turning::Turning;

use super::{Axes, Rotation};
use fcc_core::flight::Measurements;
use fcc_core::framework::Time;

/// By how much the temperature may change meanwhile, K: at 1 mg/K and 0.03°/s/K
/// of a phone's sensors, what a calibration may be wrong by.
const WARMED_K: f64 = 5.0;
/// Without a reading for so long, the sensor is silent.
const SILENT: Duration = Duration::from_secs(3);

/// What is calibrated.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum GuidedKind {
    /// The accelerometer, held still in twelve positions: bias, scale and
    /// misalignment.
    Accelerometer,
    /// The gyroscope, left alone and then turned between positions at rest: bias,
    /// scale and misalignment.
    Gyroscope {
        /// The accelerometer's calibration.
        accelerometer: Axes,
        /// From the gyroscope's axes to the body's, as far as it is known.
        turn: Rotation,
    },
    /// The gyroscope, left alone: its bias.
    GyroscopeBias,
    /// The magnetometer, turned through all directions: hard and soft iron and,
    /// with the calibration of the accelerometer, its mounting.
    Magnetometer {
        /// What is known of the earth's field.
        earth: EarthField,
        /// The accelerometer's; none if there is none.
        accelerometer: Option<Axes>,
    },
    /// The pitot tube, without wind: its zero.
    Airspeed,
    /// How accelerometer and gyroscope are turned in the aircraft.
    Mounting {
        /// By which attitudes of the aircraft.
        way: MountingWay,
        /// The accelerometer's calibration.
        accelerometer: Axes,
    },
}

/// What is known of the earth's magnetic field.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum EarthField {
    /// Its strength, µT.
    Strength(f64),
    /// By the World Magnetic Model of this year with its fraction, where the
    /// receiver of satellite navigation is; nothing without a fix.
    InYear(f64),
    /// Nothing: the scale of the sensor is taken to be right.
    Unknown,
}

/// What the person is to do.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Next {
    /// Nothing: no reading has arrived yet.
    Wait,
    /// Leave it alone.
    LeaveAlone,
    /// Put it with this direction of its axes up.
    Place(Place),
    /// Hold it still, as it is.
    Hold(Place),
    /// Turn it slowly until this direction of its axes has pointed along the
    /// field, too.
    Turn(Place),
    /// Turn it about this one of its axes, 0 for x, which is about horizontal, and
    /// lay it down.
    TurnOver {
        /// x is 0.
        axis: u8,
        /// By half a turn; otherwise by a quarter.
        half: bool,
    },
    /// Shield the tube from wind, and leave it alone.
    CoverTube,
    /// Put the aircraft level.
    Level,
    /// Raise its nose by 20° or more.
    RaiseNose,
    /// Nothing: all is there.
    Done,
}

/// What there is so far, for a picture.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Coverage<'a> {
    /// Which of the places of [`Place::ALL`] were held.
    Places([bool; Place::ALL.len()]),
    /// Which cells of the sphere have samples, band by band
    /// ([`CELLS_OF_BANDS`]), from +z to -z, and in each around from -x by -y,
    /// +x and +y.
    Cells(&'a [bool; CELLS]),
    /// How much of what is needed is known of turns about x, y and z, 0..=1.
    Turns([f64; 3]),
    /// Nothing to draw.
    None,
}

/// A collector of one kind.
trait Collect {
    fn take(&mut self, arrived: &Arrived, rest: &Rest);
    /// 0..=1.
    fn progress(&self) -> f64;
    fn is_complete(&self) -> bool;
    fn next(&self) -> Next;
    fn finish(&self) -> Result<Found, Refusal>;
}

#[derive(Clone, Copy, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one, and no heap")]
enum Collector {
    Accelerometer(Positions),
    Gyroscope(Turning),
    GyroscopeBias(AtRest),
    Magnetometer(Sphere),
    Airspeed(Zero),
    Mounting(Attitudes),
}

impl Collector {
    const fn get(&self) -> &dyn Collect {
        match self {
            Self::Accelerometer(of) => of,
            Self::Gyroscope(of) => of,
            Self::GyroscopeBias(of) => of,
            Self::Magnetometer(of) => of,
            Self::Airspeed(of) => of,
            Self::Mounting(of) => of,
        }
    }

    const fn get_mut(&mut self) -> &mut dyn Collect {
        match self {
            Self::Accelerometer(of) => of,
            Self::Gyroscope(of) => of,
            Self::GyroscopeBias(of) => of,
            Self::Magnetometer(of) => of,
            Self::Airspeed(of) => of,
            Self::Mounting(of) => of,
        }
    }
}

/// A calibration at work.
///
/// ```
/// use fcc_calibration::{GuidedCalibration, GuidedKind, Next, Values};
/// use fcc_core::flight::{BodyRates, Measurements};
/// use fcc_core::framework::{Reading, Time};
///
/// let mut calibration = GuidedCalibration::new(&GuidedKind::GyroscopeBias);
/// assert_eq!(calibration.next(), Next::Wait);
/// for n in 1..=1_100 {
///     // It lies still, and shows 0.02 rad/s of pitch.
///     let rates = BodyRates { pitch_radps: 0.02, ..BodyRates::default() };
///     calibration.take(&Measurements {
///         raw_body_rates: Reading::new(rates, Time::from_nanos(n * 10_000_000)),
///         ..Measurements::default()
///     });
/// }
/// assert!(calibration.is_complete());
/// let found = calibration.finish().unwrap();
/// let Values::GyroscopeBias { bias_radps: [_, pitch, _] } = found.values else { panic!() };
/// assert!((pitch - 0.02).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct GuidedCalibration {
    arrivals: Arrivals,
    rest: Rest,
    collector: Collector,
    /// When the sensor that is calibrated was last heard.
    heard: Time,
    now: Time,
    temperatures_k: Option<(f64, f64)>,
}

impl GuidedCalibration {
    /// Begins.
    pub fn new(kind: &GuidedKind) -> Self {
        Self {
            arrivals: Arrivals::default(),
            rest: Rest::default(),
            collector: match kind {
                GuidedKind::Accelerometer => Collector::Accelerometer(Positions::new()),
                GuidedKind::Gyroscope {
                    accelerometer,
                    turn,
                } => Collector::Gyroscope(Turning::new(accelerometer, turn)),
                GuidedKind::GyroscopeBias => Collector::GyroscopeBias(AtRest::new()),
                GuidedKind::Magnetometer {
                    earth,
                    accelerometer,
                } => Collector::Magnetometer(Sphere::new(*earth, accelerometer.as_ref())),
                GuidedKind::Airspeed => Collector::Airspeed(Zero::new()),
                GuidedKind::Mounting { way, accelerometer } => {
                    Collector::Mounting(Attitudes::new(*way, accelerometer))
                }
            },
            heard: Time::NEVER,
            now: Time::NEVER,
            temperatures_k: None,
        }
    }

    /// Takes the readings of a tick, uncalibrated.
    pub fn take(&mut self, measured: &Measurements) {
        let arrived = self.arrivals.take(measured);
        self.now = arrived.at;
        let is_heard = match &self.collector {
            Collector::Accelerometer(_) | Collector::Mounting(_) => arrived.force.is_some(),
            Collector::Gyroscope(_) | Collector::GyroscopeBias(_) => arrived.rates.is_some(),
            Collector::Magnetometer(_) => arrived.field.is_some(),
            Collector::Airspeed(_) => arrived.differential_pa.is_some(),
        };
        if is_heard {
            self.heard = self.now;
        }
        if let Some(now_k) = arrived.temperature_k {
            let (least, most) = self.temperatures_k.unwrap_or((now_k, now_k));
            self.temperatures_k = Some((least.min(now_k), most.max(now_k)));
        }
        self.rest.take(&arrived);
        self.collector.get_mut().take(&arrived, &self.rest);
    }

    /// How far it is, 0..=1.
    pub fn progress(&self) -> f64 {
        self.collector.get().progress()
    }

    /// Whether all is there: it can be [finished](Self::finish).
    pub fn is_complete(&self) -> bool {
        self.collector.get().is_complete()
    }

    /// Whether nothing arrived from the sensor for some seconds of what others
    /// gave.
    pub fn is_silent(&self) -> bool {
        self.heard.is_never() || self.now.since(self.heard) > SILENT
    }

    /// Whether it lies still.
    pub fn is_at_rest(&self) -> bool {
        self.rest.is_given()
    }

    /// What the person is to do.
    pub fn next(&self) -> Next {
        if self.heard.is_never() {
            return Next::Wait;
        }
        self.collector.get().next()
    }

    /// What there is so far.
    pub fn coverage(&self) -> Coverage<'_> {
        match &self.collector {
            Collector::Accelerometer(positions) => Coverage::Places(positions.held()),
            Collector::Magnetometer(sphere) => Coverage::Cells(sphere.covered()),
            Collector::Gyroscope(turning) => Coverage::Turns(turning.known()),
            Collector::GyroscopeBias(_) | Collector::Airspeed(_) | Collector::Mounting(_) => {
                Coverage::None
            }
        }
    }

    /// The mean temperature meanwhile, K, if a sensor measures it.
    pub fn temperature_k(&self) -> Option<f64> {
        self.temperatures_k
            .map(|(least, most)| 0.5 * (least + most))
    }

    /// The result.
    ///
    /// # Errors
    /// When it is not complete, or would be poor: the reason.
    pub fn finish(&self) -> Result<Found, Refusal> {
        if self.heard.is_never() {
            return Err(Refusal::Silent);
        }
        let warmed_k = self
            .temperatures_k
            .map_or(0.0, |(least, most)| most - least);
        if warmed_k > WARMED_K {
            return Err(Refusal::Warmed { by_k: warmed_k });
        }
        self.collector.get().finish()
    }
}

fn norm([x, y, z]: [f64; 3]) -> f64 {
    sqrt(x * x + y * y + z * z)
}

/// In the same direction, of length 1; nothing of nothing.
fn unit(vector: [f64; 3]) -> [f64; 3] {
    let length = norm(vector);
    vector.map(|part| if length > 0.0 { part / length } else { 0.0 })
}

fn difference([ax, ay, az]: [f64; 3], [bx, by, bz]: [f64; 3]) -> [f64; 3] {
    [ax - bx, ay - by, az - bz]
}

/// The angle between two vectors, rad.
fn between(one: [f64; 3], other: [f64; 3]) -> f64 {
    let parts = unit(one).into_iter().zip(unit(other));
    let cosine: f64 = parts.map(|(one, other)| one * other).sum();
    acos(cosine.clamp(-1.0, 1.0))
}

#[cfg(test)]
mod tests;
