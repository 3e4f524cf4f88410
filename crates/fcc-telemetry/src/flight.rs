//! Gathers a flight for its score.

use fcc_core::flight::guidance::TimedPatternConfig;

use super::score::{FlightScore, Leg, Sample, ScoreError, score};

/// Gathers the samples of a flight through the timed pattern, from engagement
/// on.
#[derive(Debug)]
pub struct FlightLog {
    pattern: TimedPatternConfig,
    samples: Vec<Sample>,
}

/// Feet in a metre.
const M_FT: f64 = 1.0 / 0.304_8;

impl FlightLog {
    /// An empty log of a flight through `pattern`.
    pub const fn new(pattern: TimedPatternConfig) -> Self {
        Self {
            pattern,
            samples: Vec::new(),
        }
    }

    /// Takes a sample while engaged; the first is what was captured.
    pub fn push(&mut self, sample: Sample) {
        self.samples.push(sample);
    }

    /// Forgets the flight: the next sample begins another.
    pub fn clear(&mut self) {
        self.samples.clear();
    }

    /// The score over all whole legs flown.
    ///
    /// # Errors
    /// When samples are missing from a leg.
    pub fn score(&self) -> Result<FlightScore, ScoreError> {
        score(&self.samples, &self.legs())
    }

    /// The whole legs flown, around the state at the first sample.
    fn legs(&self) -> Vec<Leg> {
        let (Some(captured), Some(last)) = (self.samples.first(), self.samples.last()) else {
            return Vec::new();
        };
        let pattern = &self.pattern;
        // One sample's time may be missing at the end of the last leg.
        let step_s = match self.samples.as_slice() {
            [first, second, ..] => second.time_s - first.time_s,
            _ => 0.0,
        };
        let flown_s = last.time_s + step_s - captured.time_s - pattern.hold_s;
        let count = (flown_s / pattern.leg_s + 1e-3).floor().max(0.0) as u32;
        let climb_ft = |leg: u32| {
            if leg % 2 == 1 {
                pattern.climb_m * M_FT
            } else {
                0.0
            }
        };
        (0..count)
            .map(|leg| {
                let start_s = captured.time_s + pattern.hold_s + f64::from(leg) * pattern.leg_s;
                let turn_deg = pattern.turn_rad.to_degrees();
                Leg {
                    start_s,
                    end_s: start_s + pattern.leg_s,
                    heading_from_deg: captured.heading_deg + f64::from(leg) * turn_deg,
                    heading_deg: captured.heading_deg + f64::from(leg + 1) * turn_deg,
                    altitude_from_ft: captured.altitude_ft + climb_ft(leg),
                    altitude_ft: captured.altitude_ft + climb_ft(leg + 1),
                    airspeed_kt: captured.airspeed_kt,
                }
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A flight that jumps to each set point after a known time.
    #[test]
    fn scores_whole_legs_against_what_was_captured() {
        let mut log = FlightLog::new(TimedPatternConfig::default());
        for n in 0..(40 * 65) {
            let time_s = f64::from(n) * 0.025;
            let (heading_deg, altitude_ft) = match time_s {
                t if t < 24.0 - 1e-9 => (350.0, 3_000.0),
                t if t < 43.0 - 1e-9 => (80.0, 3_150.0),
                _ => (170.0, 3_000.0),
            };
            log.push(Sample {
                time_s: 7.0 + time_s,
                heading_deg,
                altitude_ft,
                airspeed_kt: 100.0,
                lateral_g: 0.0,
            });
        }
        let score = log.score().unwrap();
        let settled: Vec<_> = score.legs.iter().map(|leg| leg.heading_settle_s).collect();
        assert_eq!(settled.len(), 2, "the third leg is not whole");
        assert!((settled[0].unwrap() - 4.0).abs() < 1e-9);
        assert!((settled[1].unwrap() - 3.0).abs() < 1e-9);
        let worst = score.worst.unwrap();
        assert!((worst.altitude_settle_s.unwrap() - 4.0).abs() < 1e-9);
        assert!(worst.altitude_rms_ft < 1e-9);
    }

    #[test]
    fn no_whole_leg_no_score() {
        let log = FlightLog::new(TimedPatternConfig::default());
        assert_eq!(log.score().unwrap().worst, None);
    }
}
