//! Scales one set of gains to many aircraft.

use super::AutopilotConfig;

/// How an aircraft differs from the one for which the gains were tuned. 1 means
/// no difference; each factor multiplies a group of gains.
///
/// ```
/// use fcc_fixed_wing::{AutopilotConfig, Scale};
///
/// // An airliner with half the response rate: rates are halved.
/// let scale = Scale { pace: 0.5, ..Scale::default() };
/// let tuned = AutopilotConfig::default();
/// let scaled = tuned.scaled(&scale);
/// assert_eq!(scaled.heading.roll_gain_per_s, 0.5 * tuned.heading.roll_gain_per_s);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Scale {
    /// Elevator: larger where the elevator is less effective.
    pub elevator: f64,
    /// Aileron.
    pub aileron: f64,
    /// Rudder.
    pub rudder: f64,
    /// Throttle: larger where the engine has less power for the aircraft's
    /// weight.
    pub throttle: f64,
    /// The pace of the response, as a scale of time: rates are multiplied by
    /// this, accelerations by its square. Less than 1 for an aircraft that
    /// responds slowly.
    pub pace: f64,
}

impl Default for Scale {
    /// The same aircraft.
    fn default() -> Self {
        Self {
            elevator: 1.0,
            aileron: 1.0,
            rudder: 1.0,
            throttle: 1.0,
            pace: 1.0,
        }
    }
}

impl AutopilotConfig {
    /// The same gains for an aircraft that differs by `scale`.
    ///
    /// Pace is a change of the unit of time: of the loops' own rates and
    /// accelerations, of the gains that are per second, and of the lags. The
    /// limits of the climb rate are scaled by the rate only, since an aircraft
    /// does not climb faster because it responds faster.
    #[must_use]
    pub fn scaled(mut self, scale: &Scale) -> Self {
        let pace = scale.pace;
        self.pace *= pace;

        let heading = &mut self.heading;
        heading.heading_gain_per_s *= pace;
        heading.rollout_rate_radps *= pace;
        heading.lead_s /= pace;
        heading.roll_gain_per_s *= pace;
        heading.max_roll_rate_radps *= pace;
        heading.max_roll_acceleration_radps2 *= pace * pace;
        heading.aileron_per_roll_rate *= scale.aileron;
        heading.roll_rate_gain *= scale.aileron;
        heading.roll_rate_integral_gain *= scale.aileron * pace;
        heading.rudder_per_aileron *= scale.rudder;
        heading.rudder_washout_s /= pace;
        heading.side_force_gain *= scale.rudder;
        heading.side_force_integral_gain *= scale.rudder * pace;
        heading.yaw_damping *= scale.rudder;

        let altitude = &mut self.altitude;
        altitude.altitude_gain_per_s *= pace;
        altitude.capture_mps2 *= pace;
        altitude.climb_acceleration_mps2 *= pace;
        altitude.climb_rate_integral_gain_per_s *= pace;
        altitude.flight_path_lag_s /= pace;
        altitude.pitch_gain_per_s *= pace;
        altitude.max_pitch_rate_radps *= pace;
        altitude.pitch_rate_gain *= scale.elevator;
        altitude.pitch_rate_integral_gain *= scale.elevator * pace;
        altitude.elevator_per_g *= scale.elevator;

        let airspeed = &mut self.airspeed;
        airspeed.airspeed_gain_per_s *= pace;
        airspeed.airspeed_integral_gain_per_s2 *= pace * pace;
        airspeed.throttle_per_mps2 *= scale.throttle;
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_aircraft_has_the_same_gains() {
        let config = AutopilotConfig::default();
        assert_eq!(config.scaled(&Scale::default()), config);
    }

    /// In a loop of gain k per second, pace p divides every time by p: values
    /// per second are multiplied by it, values in seconds divided.
    #[test]
    fn half_the_pace_takes_twice_the_time() {
        let config = AutopilotConfig::default();
        let slow = config.scaled(&Scale {
            pace: 0.5,
            ..Scale::default()
        });
        let time_s = |gain_per_s: f64| 1.0 / gain_per_s;
        let twice = |slow: f64, fast: f64| assert!((slow / fast - 2.0).abs() < 1e-12);
        twice(
            time_s(slow.heading.roll_gain_per_s),
            time_s(config.heading.roll_gain_per_s),
        );
        twice(slow.heading.lead_s, config.heading.lead_s);
        // Time to the largest roll rate: rate over acceleration.
        twice(
            slow.heading.max_roll_rate_radps / slow.heading.max_roll_acceleration_radps2,
            config.heading.max_roll_rate_radps / config.heading.max_roll_acceleration_radps2,
        );
        // The integral's time constant, kp/ki.
        twice(
            slow.altitude.pitch_rate_gain / slow.altitude.pitch_rate_integral_gain,
            config.altitude.pitch_rate_gain / config.altitude.pitch_rate_integral_gain,
        );
        twice(
            slow.airspeed.airspeed_gain_per_s / slow.airspeed.airspeed_integral_gain_per_s2,
            config.airspeed.airspeed_gain_per_s / config.airspeed.airspeed_integral_gain_per_s2,
        );
    }

    #[test]
    fn a_half_as_effective_surface_is_moved_twice_as_far() {
        let config = AutopilotConfig::default();
        let weak = config.scaled(&Scale {
            aileron: 2.0,
            ..Scale::default()
        });
        assert!((weak.heading.roll_rate_gain / config.heading.roll_rate_gain - 2.0).abs() < 1e-12);
        assert_eq!(weak.altitude, config.altitude);
    }
}
