//! From a surface's deflection to a servo's pulse.

use fcc_core::flight::Surfaces;
use serde::{Deserialize, Serialize};

/// Which of the autopilot's outputs a servo follows.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Drives {
    /// -1 to 1, positive raises the nose.
    Elevator,
    /// -1 to 1, positive rolls right.
    Aileron,
    /// -1 to 1, positive yaws right.
    Rudder,
    /// 0 to 1, of a servo or of a motor's controller.
    Throttle,
    /// 0 up to 1 fully extended.
    Flaps,
    /// 0 released to 1 full.
    LeftBrake,
    /// 0 released to 1 full.
    RightBrake,
    /// -1 to 1, positive to the right.
    NoseWheel,
    /// 0 up to 1 down.
    Gear,
}

impl Drives {
    /// The least and the most of this output.
    pub const fn range(self) -> (f64, f64) {
        if self.has_centre() {
            (-1.0, 1.0)
        } else {
            (0.0, 1.0)
        }
    }

    /// Whether it goes to both sides of a middle.
    const fn has_centre(self) -> bool {
        match self {
            Self::Elevator | Self::Aileron | Self::Rudder | Self::NoseWheel => true,
            Self::Throttle | Self::Flaps | Self::LeftBrake | Self::RightBrake | Self::Gear => false,
        }
    }

    /// Where it goes without the loop, unless another position is given: what may have to
    /// land, lands on its wheels.
    pub const fn usual_failsafe(self) -> f64 {
        match self {
            Self::Gear => 1.0,
            _ => 0.0,
        }
    }

    /// None leaves it as it is.
    fn of(self, surfaces: &Surfaces) -> Option<f64> {
        match self {
            Self::Elevator => Some(surfaces.elevator),
            Self::Aileron => Some(surfaces.aileron),
            Self::Rudder => Some(surfaces.rudder),
            Self::Throttle => Some(surfaces.throttle),
            Self::Flaps => surfaces.flaps,
            Self::LeftBrake => surfaces.left_brake,
            Self::RightBrake => surfaces.right_brake,
            Self::Gear => surfaces.gear,
            // Straight off the ground, and so at the touch-down: at the lift-off it
            // may have been deflected.
            Self::NoseWheel => Some(surfaces.nose_wheel.unwrap_or(0.0)),
        }
    }
}

/// A servo: what it follows, and by which pulses.
///
/// ```
/// use fcc_linux::servo::{Drives, ServoChannel};
///
/// let elevator = ServoChannel { is_reversed: true, ..ServoChannel::new(Drives::Elevator) };
/// assert_eq!(elevator.pulse_us(0.5), 1_250.0);
/// assert_eq!(ServoChannel::new(Drives::Throttle).pulse_us(0.0), 1_000.0);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ServoChannel {
    /// What it follows.
    pub drives: Drives,
    /// The pulse at -1, of what is 0 to 1 at 0; µs.
    pub min_us: f64,
    /// The pulse at 0; what is 0 to 1 has none.
    pub centre_us: f64,
    /// The pulse at 1.
    pub max_us: f64,
    /// Whether a positive deflection is a shorter pulse.
    pub is_reversed: bool,
    /// What is added to a deflection to either side; what is 0 to 1 has none.
    pub trim: f64,
    /// The fastest change in flight, of full deflection in a second.
    pub slew_per_s: Option<f64>,
    /// Where it goes without the loop, before its trim.
    pub failsafe: f64,
}

/// Why a channel is impossible.
#[derive(thiserror::Error, Clone, PartialEq, Debug)]
#[non_exhaustive]
pub enum ServoError {
    /// The pulses are not in order.
    #[error(
        "min_us is {min_us}, centre_us is {centre_us} and max_us is {max_us}: give the shortest \
         pulse as min_us, the longest as max_us"
    )]
    Pulses {
        /// The shortest.
        min_us: f64,
        /// That of the middle.
        centre_us: f64,
        /// The longest.
        max_us: f64,
    },
    /// The failsafe position is none.
    #[error("a failsafe position of {failsafe} is out of range: choose {least} to {most}")]
    Failsafe {
        /// The position.
        failsafe: f64,
        /// The least of what is driven.
        least: f64,
        /// The most.
        most: f64,
    },
    /// What has no middle has no trim.
    #[error("what is 0 to 1, as a throttle, has no trim: set min_us and max_us")]
    Trim,
}

impl ServoChannel {
    /// Most servos': 1,000 to 2,000 µs, 1,500 in the middle. Failsafe is centred,
    /// a throttle idle, flaps up, brakes released and the gear down.
    pub const fn new(drives: Drives) -> Self {
        Self {
            drives,
            min_us: 1_000.0,
            centre_us: 1_500.0,
            max_us: 2_000.0,
            is_reversed: false,
            trim: 0.0,
            slew_per_s: None,
            failsafe: drives.usual_failsafe(),
        }
    }

    /// Whether it is possible.
    ///
    /// # Errors
    /// When it is not.
    pub fn validate(&self) -> Result<(), ServoError> {
        let (least, most) = self.drives.range();
        let centre_us = if self.drives.has_centre() {
            self.centre_us
        } else {
            0.5 * (self.min_us + self.max_us)
        };
        // False for NaN.
        if !(self.min_us < centre_us && centre_us < self.max_us) {
            return Err(ServoError::Pulses {
                min_us: self.min_us,
                centre_us,
                max_us: self.max_us,
            });
        }
        if !(least..=most).contains(&self.failsafe) {
            return Err(ServoError::Failsafe {
                failsafe: self.failsafe,
                least,
                most,
            });
        }
        if !self.drives.has_centre() && self.trim != 0.0 {
            return Err(ServoError::Trim);
        }
        Ok(())
    }

    /// The pulse for a position, µs: within its ends, whatever is given; failsafe
    /// for what is no number.
    pub fn pulse_us(&self, position: f64) -> f64 {
        let (least, most) = self.drives.range();
        let position = if position.is_nan() {
            self.failsafe
        } else {
            position
        };
        let position = (position + self.trim).clamp(least, most);
        match (self.drives.has_centre(), self.is_reversed) {
            (false, false) => between(self.min_us, self.max_us, position),
            (false, true) => between(self.max_us, self.min_us, position),
            (true, false) => self.deflected(position),
            (true, true) => self.deflected(-position),
        }
    }

    fn deflected(&self, position: f64) -> f64 {
        let end = if position < 0.0 {
            self.min_us
        } else {
            self.max_us
        };
        between(self.centre_us, end, position.abs())
    }

    /// The position after `passed_s`, on its way from one to what the surfaces are.
    pub(super) fn towards(&self, from: f64, surfaces: &Surfaces, passed_s: f64) -> f64 {
        let Some(target) = self.drives.of(surfaces) else {
            return from;
        };
        self.slew_per_s.map_or(target, |slew| {
            let most = slew * passed_s;
            target.clamp(from - most, from + most)
        })
    }
}

fn between(from: f64, to: f64, share: f64) -> f64 {
    from + (to - from) * share
}
