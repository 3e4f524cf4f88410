//! Altitude and climb rate from the barometer and the accelerometers.

use libm::{cos, sin};

use super::attitude::Orientation;
use super::{Arrival, News, is_current};
use crate::blocks::limit_abs;
use crate::flight::Measurements;
use crate::flight::atmosphere::GRAVITY_MPS2;
use crate::framework::Time;

/// Altitude and climb rate.
#[derive(Clone, Copy, Debug, Default)]
pub struct VerticalState {
    /// Barometric altitude, m.
    pub altitude_m: f64,
    /// Up, m/s.
    pub climb_rate_mps: f64,
}

/// Third-order complementary filter: vertical acceleration integrated twice,
/// corrected by barometric altitude, the accelerometer's bias estimated along
/// (the barometric-inertial loop of Blanchard 1971; all three poles at the
/// bandwidth).
#[derive(Clone, Debug)]
pub struct VerticalChannel {
    bandwidth_radps: f64,
    state: VerticalState,
    bias_mps2: f64,
    /// Seconds since the first altitude.
    age_s: f64,
    news: Arrival,
}

/// While the filter is young it begins fast, not knowing the climb rate, and
/// slows down as it learns: with bandwidth `YOUTH / age`, half as fast again as
/// a straight line fitted to what was seen so far.
const YOUTH: f64 = 3.0;
/// The fastest it is, rad/s.
const MAX_BANDWIDTH_RADPS: f64 = 4.0;

/// An accelerometer whose bias is larger than this is broken, m/s².
const MAX_BIAS_MPS2: f64 = 2.0;

impl VerticalChannel {
    /// A filter that knows nothing yet; `bandwidth_radps` in rad/s.
    pub const fn new(bandwidth_radps: f64) -> Self {
        Self {
            bandwidth_radps,
            state: VerticalState {
                altitude_m: 0.0,
                climb_rate_mps: 0.0,
            },
            bias_mps2: 0.0,
            age_s: 0.0,
            news: Arrival::new(),
        }
    }

    /// Takes the measurements; altitude and climb rate.
    pub fn step(
        &mut self,
        now: Time,
        measurements: &Measurements,
        orientation: &Orientation,
        dt_s: f64,
    ) -> VerticalState {
        let measured = if is_current(&measurements.specific_force, now) {
            let force = measurements.specific_force.value;
            let (sin_roll, cos_roll) = (sin(orientation.roll_rad), cos(orientation.roll_rad));
            let (sin_pitch, cos_pitch) = (sin(orientation.pitch_rad), cos(orientation.pitch_rad));
            force.x_mps2 * sin_pitch
                - cos_pitch * (force.y_mps2 * sin_roll + force.z_mps2 * cos_roll)
                - GRAVITY_MPS2
        } else {
            self.bias_mps2
        };
        let acceleration = measured - self.bias_mps2;
        self.age_s += dt_s;
        self.state.altitude_m +=
            self.state.climb_rate_mps * dt_s + 0.5 * acceleration * dt_s * dt_s;
        self.state.climb_rate_mps += acceleration * dt_s;

        match self.news.of(&measurements.altitude_m, dt_s) {
            News::None => {}
            News::First => {
                self.state = VerticalState {
                    altitude_m: measurements.altitude_m.value,
                    climb_rate_mps: 0.0,
                };
                self.bias_mps2 = 0.0;
                self.age_s = 0.0;
            }
            News::Next(since_s) => {
                let error = measurements.altitude_m.value - self.state.altitude_m;
                let (w, young) = (self.bandwidth_radps, YOUTH / self.age_s.max(0.1));
                if young > w {
                    // Two poles and no bias: it cannot be told from a climb yet.
                    let w = young.min(MAX_BANDWIDTH_RADPS);
                    self.state.altitude_m += 2.0 * w * since_s * error;
                    self.state.climb_rate_mps += w * w * since_s * error;
                } else {
                    self.state.altitude_m += 3.0 * w * since_s * error;
                    self.state.climb_rate_mps += 3.0 * w * w * since_s * error;
                    self.bias_mps2 =
                        limit_abs(self.bias_mps2 - w * w * w * since_s * error, MAX_BIAS_MPS2);
                }
            }
        }
        self.state
    }
}
