//! The timed pattern of the thesis, which needs no navigation.

use core::f64::consts::FRAC_PI_2;

use super::{Guidance, Mode, Progress, Targets};
use fcc_core::framework::ROUNDING_S;
use fcc_navigation::Estimate;

/// The timed pattern: hold, then legs that turn by a fixed angle and
/// alternately climb and descend (thesis, section 6.3).
///
/// ```
/// use fcc_guidance::TimedPatternConfig;
///
/// // The thesis climbs 150 ft in a leg.
/// let thesis = TimedPatternConfig::default();
/// assert!((thesis.climb_m / 0.304_8 - 150.0).abs() < 1e-9);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct TimedPatternConfig {
    /// How long to hold the captured values, s.
    pub hold_s: f64,
    /// How long each leg takes, s; positive.
    pub leg_s: f64,
    /// Turn at the beginning of each leg, rad, to the right if positive.
    pub turn_rad: f64,
    /// Climb of every odd leg, taken back in every even one, m.
    pub climb_m: f64,
}

impl Default for TimedPatternConfig {
    /// The thesis': 20 s, 20 s, 90° right, 150 ft.
    fn default() -> Self {
        Self {
            hold_s: 20.0,
            leg_s: 20.0,
            turn_rad: FRAC_PI_2,
            climb_m: 45.72,
        }
    }
}

/// The pattern in flight.
///
/// ```
/// use fcc_guidance::{Guidance, Targets, TimedPattern, TimedPatternConfig};
/// use fcc_navigation::Estimate;
///
/// let mut pattern = TimedPattern::enter(TimedPatternConfig::default(), Targets::default());
/// assert_eq!(pattern.leg(), 0);
/// pattern.advance(&Estimate::default(), 65.0);
/// assert_eq!(pattern.leg(), 3);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct TimedPattern {
    config: TimedPatternConfig,
    captured: Targets,
    elapsed_s: f64,
}

impl TimedPattern {
    /// The present leg: 0 while holding, then 1, 2, ...
    pub fn leg(&self) -> u32 {
        let into_legs = self.elapsed_s + ROUNDING_S - self.config.hold_s;
        if into_legs < 0.0 {
            0
        } else {
            // Saturates after 4 billion legs.
            ((into_legs / self.config.leg_s) as u32).saturating_add(1)
        }
    }
}

impl Guidance for TimedPattern {
    type Config = TimedPatternConfig;

    const MODE: Mode = Mode::TimedPattern;

    fn resume(config: TimedPatternConfig, progress: &Progress) -> Self {
        Self {
            config,
            captured: progress.captured,
            elapsed_s: progress.elapsed_s,
        }
    }

    fn targets(&self) -> Targets {
        let leg = self.leg();
        Targets {
            airspeed_mps: self.captured.airspeed_mps,
            heading_rad: self.captured.heading_rad + f64::from(leg) * self.config.turn_rad,
            altitude_m: self.captured.altitude_m
                + if leg % 2 == 1 {
                    self.config.climb_m
                } else {
                    0.0
                },
        }
    }

    fn advance(&mut self, _estimate: &Estimate, dt_s: f64) {
        self.elapsed_s += dt_s;
    }

    fn progress(&self) -> Progress {
        Progress {
            mode: Self::MODE,
            item: self.leg(),
            elapsed_s: self.elapsed_s,
            captured: self.captured,
        }
    }

    fn shift_altitude(&mut self, by_m: f64) {
        self.captured.altitude_m += by_m;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Thesis, section 6.3, in its own units: (from s, heading change °,
    /// altitude change ft).
    const THESIS: [(f64, f64, f64); 5] = [
        (0.0, 0.0, 0.0),
        (20.0, 90.0, 150.0),
        (40.0, 180.0, 0.0),
        (60.0, 270.0, 150.0),
        (80.0, 360.0, 0.0),
    ];

    #[test]
    fn flies_the_thesis_pattern_to_the_tick() {
        let captured = Targets {
            airspeed_mps: 51.4,
            heading_rad: 1.0,
            altitude_m: 914.4,
        };
        let mut pattern = TimedPattern::enter(TimedPatternConfig::default(), captured);
        for n in 0..4_000 {
            let t = f64::from(n) * 0.025;
            let targets = pattern.targets();
            pattern.advance(&Estimate::default(), 0.025);
            let (_, turn_deg, climb_ft) = THESIS
                .into_iter()
                .rfind(|(from, ..)| t >= *from - 1e-9)
                .unwrap();
            let turned = (targets.heading_rad - 1.0).to_degrees();
            let climbed = (targets.altitude_m - 914.4) / 0.304_8;
            assert!((turned - turn_deg).abs() < 1e-9, "at {t} s: {turned}°");
            assert!((climbed - climb_ft).abs() < 1e-9, "at {t} s: {climbed} ft");
            assert!((targets.airspeed_mps - 51.4).abs() < 1e-12);
        }
    }
}
