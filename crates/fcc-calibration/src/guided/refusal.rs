//! Why there is no calibration.

use core::fmt;

use crate::FitError;

/// Why a guided calibration gives none.
#[derive(Clone, Copy, PartialEq, Debug)]
#[non_exhaustive]
pub enum Refusal {
    /// The sensor gave nothing.
    Silent,
    /// It was ended early: so many of the needed positions, of the cells of the
    /// sphere, or of the axes to turn about, were there.
    TooFew {
        /// How many there were.
        have: usize,
        /// How many are needed.
        needed: usize,
    },
    /// It was moved again and again while it was to lie still.
    Moved {
        /// How often.
        times: u32,
    },
    /// It was turned slowly while it was to lie still.
    Turned {
        /// By how much, rad.
        turned_rad: f64,
    },
    /// A value is larger than that of any sensor at rest.
    TooLarge {
        /// x is 0.
        axis: usize,
        /// The value, in the unit of the sensor.
        given: f64,
        /// The largest.
        most: f64,
    },
    /// An axis was at the end of its range.
    Saturated {
        /// x is 0.
        axis: usize,
    },
    /// The temperature changed too much meanwhile.
    Warmed {
        /// By how much.
        by_k: f64,
    },
    /// What was measured has another strength than there is.
    Strength {
        /// In the unit of the sensor.
        measured: f64,
        /// In the unit of the sensor.
        expected: f64,
    },
    /// Readings of the gyroscope were missing while it was turned.
    Gaps {
        /// How far apart they may be, s.
        most_s: f64,
    },
    /// No gyroscope of the accelerometer's axes turned so.
    NotTurned,
    /// Both attitudes of the aircraft are the same, or it is upside down.
    NotRaised,
    /// The samples do not fit together at all.
    Fit(FitError),
    /// The error that is left is too large.
    Poor {
        /// In the unit of the sensor, or rad.
        error: f64,
        /// The largest that is accepted.
        limit: f64,
    },
}

impl Refusal {
    /// Of a calibration that was ended before it was complete.
    pub(super) const fn ended(interruptions: u32, have: usize, needed: usize) -> Self {
        match interruptions {
            0 => Self::TooFew { have, needed },
            times => Self::Moved { times },
        }
    }
}

impl From<FitError> for Refusal {
    fn from(error: FitError) -> Self {
        Self::Fit(error)
    }
}

const AXES: [&str; 3] = ["x", "y", "z"];

fn axis_name(axis: usize) -> &'static str {
    AXES.get(axis).copied().unwrap_or_default()
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Silent => f.write_str(
                "no reading arrived: check that the configuration has this sensor, and its wiring",
            ),
            Self::TooFew { have, needed: 1 } => {
                write!(f, "it was ended too early ({have} of 1): let it complete")
            }
            Self::TooFew { have, needed } => {
                write!(f, "it was ended too early: {have} of {needed} are there")
            }
            Self::Moved { times } => write!(
                f,
                "it was moved {times} times while it was to lie still: put it on something firm, \
                 and take your hands off"
            ),
            Self::Turned { turned_rad } => write!(
                f,
                "it was turned by {:.1}° while it was to lie still: take your hands off",
                turned_rad.to_degrees()
            ),
            Self::TooLarge { axis, given, most } => write!(
                f,
                "{given:.3} along {} is more than a sensor at rest gives, {most:.3}: it is moving, \
                 or broken",
                axis_name(*axis)
            ),
            Self::Saturated { axis } => write!(
                f,
                "the {} axis is at the end of its range: remove magnets and steel, or choose a \
                 larger range",
                axis_name(*axis)
            ),
            Self::Warmed { by_k } => write!(
                f,
                "the temperature changed by {by_k:.1} K: let the sensors warm up first"
            ),
            Self::Strength { measured, expected } => write!(
                f,
                "a strength of {measured:.2} is measured, and {expected:.2} is expected here: go \
                 away from steel and magnets, or calibrate the accelerometer first"
            ),
            Self::Gaps { most_s } => write!(
                f,
                "readings of the gyroscope were more than {most_s:.2} s apart in a turn: its rate, or \
                 that of the loop, is too low, or the machine is busy"
            ),
            Self::NotTurned => f.write_str(
                "what the gyroscope gives in turns contradicts gravity: it is at the end of its \
                 range (turn it slower), or mounted in another way than the accelerometer",
            ),
            Self::NotRaised => f.write_str(
                "the attitudes are not those of a level aircraft and one with its nose up: repeat both",
            ),
            Self::Fit(error) => error.fmt(f),
            Self::Poor { error, limit } => write!(
                f,
                "an error of {error:.4} is left, and at most {limit:.4} is accepted: it was moved, \
                 or something nearby disturbed it; do it again, elsewhere"
            ),
        }
    }
}

impl core::error::Error for Refusal {}
