//! The scaling of gains with airspeed and with the latency of the outputs.

use fcc_core::blocks::limit;

/// The scaling of gains with airspeed, by the ratio of the reference airspeed
/// to the present, and with the latency from an output to its effect.
///
/// ```
/// use fcc_fixed_wing::control::Schedule;
///
/// // At √2 times the reference airspeed dynamic pressure is twice as high.
/// let schedule = Schedule::at(2.0_f64.sqrt() * 50.0, 50.0);
/// assert!((schedule.moment - 0.5).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Schedule {
    /// For moments: a surface's moment is proportional to dynamic pressure, so
    /// this is (V₀/V)².
    pub moment: f64,
    /// For rates: at a given deflection the turn rate is proportional to
    /// airspeed, so this is V₀/V.
    pub rate: f64,
    /// The bandwidth of the altitude loop, 1 or less: see [`Schedule::slowed`].
    pub pace: f64,
    /// The bandwidth of the lateral loops, 1 or less, likewise.
    pub lateral_pace: f64,
    /// The bandwidth of the pitch loops. The short period's frequency is
    /// proportional to airspeed (Etkin and Reid 1996, section 6.3), so this is
    /// V/V₀, times `pace`.
    pub pitch_pace: f64,
    /// The gain of the flight path: above the reference airspeed the path
    /// follows the pitch faster, by V/V₀, but the pitch does not follow its
    /// command faster, so this is V₀/V there, times `pace`.
    pub path: f64,
    /// The bandwidth of altitude and heading. The path follows the pitch, and the
    /// roll rate the aileron, within times that are proportional to 1/V (`-V/Zα`
    /// and `-1/Lp`: Stevens, Lewis and Johnson 2016, chapter 4), so this is V/V₀
    /// below the reference airspeed, and 1 above it.
    pub outer: f64,
}

/// The limit of the ratio, in both directions: a blocked pitot tube must not
/// make the gains extremely large or small.
const MAX_RATIO: f64 = 1.8;

/// The limit of the pitch loops' bandwidth above the reference airspeed: the
/// latency does not decrease with airspeed.
const MAX_PITCH_PACE: f64 = 1.15;

impl Schedule {
    /// The schedule at an indicated airspeed.
    pub fn at(airspeed_mps: f64, reference_mps: f64) -> Self {
        let ratio = limit(
            reference_mps / airspeed_mps.max(1.0),
            1.0 / MAX_RATIO,
            MAX_RATIO,
        );
        Self {
            moment: ratio * ratio,
            rate: ratio,
            pace: 1.0,
            lateral_pace: 1.0,
            pitch_pace: (1.0 / ratio).min(MAX_PITCH_PACE),
            path: ratio.min(1.0),
            outer: (1.0 / ratio).min(1.0),
        }
    }

    /// The same with the pitch loops as fast as at the reference airspeed: a surface that is
    /// moved (V₀/V)² as far turns the aircraft as fast, and where a gust is to be met at once
    /// the slower short period is not waited for.
    ///
    /// ```
    /// use fcc_fixed_wing::control::Schedule;
    ///
    /// assert_eq!(Schedule::at(30.0, 50.0).brisk().pitch_pace, 1.0);
    /// assert_eq!(Schedule::at(30.0, 50.0).slowed(0.5, 1.0).brisk().pitch_pace, 0.5);
    /// ```
    #[must_use]
    pub fn brisk(self) -> Self {
        Self {
            pitch_pace: self.pitch_pace.max(self.pace),
            ..self
        }
    }

    /// The same with the bandwidth of altitude and pitch multiplied by `pace`,
    /// that of heading, roll and yaw by `lateral`: a loop's phase margin is
    /// kept at more latency if its crossover frequency is proportional to
    /// 1/latency.
    ///
    /// ```
    /// use fcc_fixed_wing::control::Schedule;
    ///
    /// let halved = Schedule::at(50.0, 50.0).slowed(0.5, 1.0);
    /// assert_eq!((halved.pitch_pace, halved.lateral_pace), (0.5, 1.0));
    /// ```
    #[must_use]
    pub fn slowed(self, pace: f64, lateral: f64) -> Self {
        Self {
            pace: self.pace * pace,
            pitch_pace: self.pitch_pace * pace,
            path: self.path * pace,
            lateral_pace: self.lateral_pace * lateral,
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twice_the_dynamic_pressure_halves_the_gain() {
        let schedule = Schedule::at(50.0 * core::f64::consts::SQRT_2, 50.0);
        assert!((schedule.moment - 0.5).abs() < 1e-12);
    }

    #[test]
    fn a_blocked_pitot_tube_is_bounded() {
        assert!(Schedule::at(0.0, 50.0).moment <= 1.8 * 1.8);
        assert!(Schedule::at(500.0, 50.0).moment >= 1.0 / (1.8 * 1.8));
    }

    /// The pitch loops' bandwidth follows the short period's frequency, which
    /// is proportional to airspeed; the path gain is reduced where that stops.
    #[test]
    fn slow_flight_has_a_slower_pitch_loop() {
        let slow = Schedule::at(37.0, 50.0);
        assert!((slow.pitch_pace - 0.74).abs() < 1e-12);
        assert_eq!(slow.path, 1.0);
        assert!((slow.outer - 0.74).abs() < 1e-12);
        let fast = Schedule::at(62.5, 50.0);
        assert_eq!(fast.pitch_pace, 1.15);
        assert!((fast.path - 0.8).abs() < 1e-12);
        assert_eq!(fast.outer, 1.0);
    }
}
