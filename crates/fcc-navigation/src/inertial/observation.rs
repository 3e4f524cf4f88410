//! What navigation from raw sensors takes, and what it gives.

use fcc_core::framework::Time;

/// One sample of one sensor, in body axes x forward, y right, z down.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Observation {
    /// Gyroscopes, rad/s.
    Rates([f64; 3]),
    /// Accelerometers, m/s²: at rest and level (0, 0, -9.8).
    SpecificForce([f64; 3]),
    /// Magnetometers, µT.
    MagneticField([f64; 3]),
    /// Static pressure, Pa.
    StaticPressure(f64),
    /// Differential pressure of a pitot tube, Pa.
    DifferentialPressure(f64),
    /// Equivalent airspeed, m/s, as an airspeed sensor shows it.
    Airspeed(f64),
    /// A position of a satellite receiver.
    Position(GeodeticPosition),
    /// Velocity over the ground of a satellite receiver: north, east, down,
    /// m/s; a vertical one that it does not measure is NaN.
    Velocity([f64; 3]),
}

/// A place on WGS-84.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct GeodeticPosition {
    /// Geodetic latitude, -π/2..π/2.
    pub latitude_rad: f64,
    /// Longitude, east positive.
    pub longitude_rad: f64,
    /// Height, m, above whatever the receiver's is above.
    pub altitude_m: f64,
}

impl GeodeticPosition {
    /// Nothing is known.
    pub const UNKNOWN: Self = Self {
        latitude_rad: f64::NAN,
        longitude_rad: f64::NAN,
        altitude_m: f64::NAN,
    };
}

/// Which sensor an observation or an innovation is of.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ObservationKind {
    /// [`Observation::Rates`].
    Rates,
    /// [`Observation::SpecificForce`].
    SpecificForce,
    /// [`Observation::MagneticField`].
    MagneticField,
    /// [`Observation::StaticPressure`].
    StaticPressure,
    /// [`Observation::DifferentialPressure`].
    DifferentialPressure,
    /// [`Observation::Airspeed`].
    Airspeed,
    /// [`Observation::Position`].
    Position,
    /// [`Observation::Velocity`].
    Velocity,
}

impl Observation {
    /// Which sensor it is of.
    pub const fn kind(&self) -> ObservationKind {
        match self {
            Self::Rates(_) => ObservationKind::Rates,
            Self::SpecificForce(_) => ObservationKind::SpecificForce,
            Self::MagneticField(_) => ObservationKind::MagneticField,
            Self::StaticPressure(_) => ObservationKind::StaticPressure,
            Self::DifferentialPressure(_) => ObservationKind::DifferentialPressure,
            Self::Airspeed(_) => ObservationKind::Airspeed,
            Self::Position(_) => ObservationKind::Position,
            Self::Velocity(_) => ObservationKind::Velocity,
        }
    }

    /// Whether all of its numbers are finite, but for a vertical velocity that is not known.
    pub fn is_finite(&self) -> bool {
        match self {
            Self::Rates(v) | Self::SpecificForce(v) | Self::MagneticField(v) => {
                v.iter().all(|part| part.is_finite())
            }
            Self::Velocity([north, east, down]) => {
                north.is_finite() && east.is_finite() && !down.is_infinite()
            }
            Self::StaticPressure(v) | Self::DifferentialPressure(v) | Self::Airspeed(v) => {
                v.is_finite()
            }
            Self::Position(p) => {
                p.latitude_rad.is_finite()
                    && p.longitude_rad.is_finite()
                    && p.altitude_m.is_finite()
            }
        }
    }
}

/// What is estimated, at one instant. NaN is what the method or the sensors do
/// not give.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Solution {
    /// The instant of these values.
    pub time: Time,
    /// `[w, x, y, z]`, from body axes to north, east, down. North is the
    /// magnetic one unless the declination is known.
    pub quaternion: [f64; 4],
    /// Over the ground: north, east, down.
    pub velocity_mps: [f64; 3],
    /// Latitude and longitude are NaN before the first position of a receiver.
    pub position: GeodeticPosition,
    /// North, east, down from where it started, or from the first position of a
    /// receiver.
    pub displacement_m: [f64; 3],
    /// What the gyroscopes show at rest.
    pub gyroscope_bias_radps: [f64; 3],
    /// What the accelerometers show beside the specific force.
    pub accelerometer_bias_mps2: [f64; 3],
    /// Pressure altitude minus altitude.
    pub barometer_bias_m: f64,
    /// The earth's magnetic field, north, east, down.
    pub earth_field_ut: [f64; 3],
    /// The aircraft's own magnetic field, body axes.
    pub body_field_ut: [f64; 3],
    /// The velocity of the air over the ground, north and east.
    pub wind_mps: [f64; 2],
    /// By how much a receiver's fixes are later than they say.
    pub fixes_late_s: f64,
    /// The standard deviation of each.
    pub sigma: Sigma,
}

/// Standard deviations of a [`Solution`]; NaN where there are none.
#[derive(Clone, Copy, PartialEq, Debug)]
#[allow(missing_docs, reason = "each is that of the value of its name")]
pub struct Sigma {
    pub roll_rad: f64,
    pub pitch_rad: f64,
    pub heading_rad: f64,
    pub velocity_mps: [f64; 3],
    pub position_m: [f64; 3],
    pub gyroscope_bias_radps: [f64; 3],
    pub accelerometer_bias_mps2: [f64; 3],
    pub barometer_bias_m: f64,
    pub earth_field_ut: [f64; 3],
    pub body_field_ut: [f64; 3],
    pub wind_mps: [f64; 2],
    pub fixes_late_s: f64,
}

impl Sigma {
    /// Nothing is known.
    pub const UNKNOWN: Self = Self {
        roll_rad: f64::NAN,
        pitch_rad: f64::NAN,
        heading_rad: f64::NAN,
        velocity_mps: [f64::NAN; 3],
        position_m: [f64::NAN; 3],
        gyroscope_bias_radps: [f64::NAN; 3],
        accelerometer_bias_mps2: [f64::NAN; 3],
        barometer_bias_m: f64::NAN,
        earth_field_ut: [f64::NAN; 3],
        body_field_ut: [f64::NAN; 3],
        wind_mps: [f64::NAN; 2],
        fixes_late_s: f64::NAN,
    };
}

impl Solution {
    /// Nothing is known.
    pub const UNKNOWN: Self = Self {
        time: Time::NEVER,
        quaternion: [f64::NAN; 4],
        velocity_mps: [f64::NAN; 3],
        position: GeodeticPosition::UNKNOWN,
        displacement_m: [f64::NAN; 3],
        gyroscope_bias_radps: [f64::NAN; 3],
        accelerometer_bias_mps2: [f64::NAN; 3],
        barometer_bias_m: f64::NAN,
        earth_field_ut: [f64::NAN; 3],
        body_field_ut: [f64::NAN; 3],
        wind_mps: [f64::NAN; 2],
        fixes_late_s: f64::NAN,
        sigma: Sigma::UNKNOWN,
    };
}
