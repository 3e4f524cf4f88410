//! How the sensors are turned in the aircraft: level, and with its nose raised.

use core::time::Duration;

use super::readings::Arrived;
use super::rest::{Halves, Rest};
use super::turning::{MOVED_MPS2, STRENGTH_SHARE};
use super::{Collect, Found, Next, Quality, Refusal, Values, norm};
use crate::{Axes, AxesCalibration, Rotation, level_and_nose_up, levelled};
use fcc_core::units::GRAVITY_MPS2;

/// For how long each attitude is held.
const LENGTH: Duration = Duration::from_secs(3);
/// The nose is raised by at least so much, rad: 20°. The errors of the two
/// attitudes count by its sine.
const RAISED_RAD: f64 = 0.349;
/// The largest error of the angles, rad: 1°.
const LARGEST_SIGMA_RAD: f64 = 0.0175;

/// Which attitudes there are.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum MountingWay {
    /// Level, then nose up: everything is found.
    LevelAndNoseUp,
    /// Level only: roll and pitch are corrected, and where the sensor points is
    /// kept.
    LevelOnly,
}

/// Collects the attitudes of a mounting.
#[derive(Clone, Copy, Debug)]
pub(super) struct Attitudes {
    way: MountingWay,
    /// Bias, scale and misalignment.
    shape: AxesCalibration,
    /// The rotation that was known before.
    before: Rotation,
    level: Option<[f64; 3]>,
    nose_up: Option<[f64; 3]>,
    /// The standard deviation of a mean, m/s².
    sigma_mps2: f64,
    present: Halves<3>,
    interruptions: u32,
}

impl Attitudes {
    pub(super) fn new(way: MountingWay, accelerometer: &Axes) -> Self {
        Self {
            way,
            shape: AxesCalibration::new(&Axes {
                mounting: Axes::default().mounting,
                rotation: Rotation::NONE,
                ..*accelerometer
            }),
            before: accelerometer.turn(),
            level: None,
            nose_up: None,
            sigma_mps2: 0.0,
            present: Halves::new(LENGTH),
            interruptions: 0,
        }
    }

    /// By how much a force is turned from the level one, rad.
    fn raised_rad(&self, force: [f64; 3]) -> f64 {
        self.level.map_or(0.0, |level| super::between(level, force))
    }

    const fn needed(&self) -> usize {
        match self.way {
            MountingWay::LevelAndNoseUp => 2,
            MountingWay::LevelOnly => 1,
        }
    }

    fn held(&self) -> usize {
        usize::from(self.level.is_some()) + usize::from(self.nose_up.is_some())
    }
}

impl Collect for Attitudes {
    fn take(&mut self, arrived: &Arrived, rest: &Rest) {
        let Some(given) = arrived.force.filter(|_| !self.is_complete()) else {
            return;
        };
        let force = self.shape.applied(given);
        let is_new = self.level.is_none() || self.raised_rad(force) >= RAISED_RAD;
        if !rest.is_given() || !is_new {
            self.interruptions += u32::from(self.present.has_begun());
            self.present.clear();
            return;
        }
        self.present.take(force, arrived.at);
        if !self.present.is_full() {
            return;
        }
        if self.present.change() > MOVED_MPS2 {
            self.interruptions += 1;
        } else {
            self.sigma_mps2 = self.present.mean_sigma().max(self.sigma_mps2);
            let held = Some(self.present.mean());
            if self.level.is_none() {
                self.level = held;
            } else {
                self.nose_up = held;
            }
        }
        self.present.clear();
    }

    fn progress(&self) -> f64 {
        (self.held() as f64 + self.present.share()) / self.needed() as f64
    }

    fn is_complete(&self) -> bool {
        self.held() >= self.needed()
    }

    fn next(&self) -> Next {
        match (self.is_complete(), self.level) {
            (true, _) => Next::Done,
            (false, None) => Next::Level,
            (false, Some(_)) => Next::RaiseNose,
        }
    }

    fn finish(&self) -> Result<Found, Refusal> {
        let Some(level) = self.level.filter(|_| self.is_complete()) else {
            return Err(Refusal::ended(
                self.interruptions,
                self.held(),
                self.needed(),
            ));
        };
        for force in [Some(level), self.nose_up].into_iter().flatten() {
            let measured = norm(force);
            if (measured / GRAVITY_MPS2 - 1.0).abs() > STRENGTH_SHARE {
                return Err(Refusal::Strength {
                    measured,
                    expected: GRAVITY_MPS2,
                });
            }
        }
        let (rotation, raised_rad) = if let Some(nose_up) = self.nose_up {
            (level_and_nose_up(level, nose_up), self.raised_rad(nose_up))
        } else {
            let correction = levelled(self.before.turned(level));
            let rotation = correction.map(|correction| correction.after(&self.before));
            (rotation, core::f64::consts::FRAC_PI_2)
        };
        let rotation = rotation.ok_or(Refusal::NotRaised)?;
        let sigma = self.sigma_mps2 / GRAVITY_MPS2 / libm::sin(raised_rad);
        let (mounting, rotation) = rotation.mounting();
        Ok(Found {
            values: Values::Mounting { mounting, rotation },
            quality: Quality::within(sigma, LARGEST_SIGMA_RAD)?,
            sigma,
        })
    }
}
