//! Scores a flight while it is flown.

use fcc_core::flight::guidance::TimedPatternConfig;

use super::score::{FlightScore, Leg, LegScore, ROUNDING_S, Sample, ScoreError, score};
use super::units::M_FT;

/// Scores a flight through the timed pattern, from engagement on. It keeps the
/// samples of one leg and the scores of the legs before: its size does not grow
/// with the flight.
#[derive(Clone, Debug)]
pub(crate) struct FlightLog {
    pattern: TimedPatternConfig,
    captured: Option<Sample>,
    /// The interval between samples, from the first two.
    step_s: f64,
    /// Samples of the present leg.
    leg: Vec<Sample>,
    /// Scores of the complete legs, or why one of them has no score.
    flown: Result<Vec<LegScore>, ScoreError>,
}

impl FlightLog {
    /// An empty log of a flight through `pattern`.
    pub(crate) const fn new(pattern: TimedPatternConfig) -> Self {
        Self {
            pattern,
            captured: None,
            step_s: 0.0,
            leg: Vec::new(),
            flown: Ok(Vec::new()),
        }
    }

    /// Takes a sample while engaged; the first gives the captured set points.
    pub(crate) fn push(&mut self, sample: Sample) {
        let captured = *self.captured.get_or_insert(sample);
        if self.step_s == 0.0 {
            self.step_s = sample.time_s - captured.time_s;
        }
        while let Ok(flown) = &mut self.flown {
            let leg = leg(&self.pattern, &captured, flown.len());
            if sample.time_s < leg.end_s - ROUNDING_S {
                if sample.time_s >= leg.start_s - ROUNDING_S {
                    self.leg.push(sample);
                }
                break;
            }
            match score(&self.leg, &[leg]) {
                Ok(scored) => flown.extend(scored.legs),
                Err(error) => self.flown = Err(error),
            }
            self.leg.clear();
        }
    }

    /// Resets: the next sample begins another flight.
    pub(crate) fn clear(&mut self) {
        *self = Self::new(self.pattern);
    }

    /// The score over all complete legs.
    ///
    /// # Errors
    /// When samples are missing from a leg.
    pub(crate) fn score(&self) -> Result<FlightScore, ScoreError> {
        let mut legs = self.flown.clone()?;
        if let (Some(captured), Some(last)) = (self.captured, self.leg.last()) {
            let leg = leg(&self.pattern, &captured, legs.len());
            // The last leg may end up to one sample early.
            let flown_s = last.time_s + self.step_s - leg.start_s;
            if flown_s >= self.pattern.leg_s * (1.0 - 1e-3) {
                legs.extend(score(&self.leg, &[leg])?.legs);
            }
        }
        Ok(FlightScore::of(legs))
    }
}

/// Leg `number`, from 0, relative to the captured set points.
fn leg(pattern: &TimedPatternConfig, captured: &Sample, number: usize) -> Leg {
    let climb_ft = |leg: usize| {
        if leg % 2 == 1 {
            pattern.climb_m * M_FT
        } else {
            0.0
        }
    };
    let start_s = captured.time_s + pattern.hold_s + number as f64 * pattern.leg_s;
    let turn_deg = pattern.turn_rad.to_degrees();
    Leg {
        start_s,
        end_s: start_s + pattern.leg_s,
        heading_from_deg: captured.heading_deg + number as f64 * turn_deg,
        heading_deg: captured.heading_deg + (number + 1) as f64 * turn_deg,
        altitude_from_ft: captured.altitude_ft + climb_ft(number),
        altitude_ft: captured.altitude_ft + climb_ft(number + 1),
        airspeed_kt: captured.airspeed_kt,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A flight that jumps to each set point after a known time.
    #[test]
    fn scores_complete_legs_against_the_captured_set_points() {
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
        assert_eq!(settled.len(), 2, "the third leg is not complete");
        assert!((settled[0].unwrap() - 4.0).abs() < 1e-9);
        assert!((settled[1].unwrap() - 3.0).abs() < 1e-9);
        let worst = score.worst.unwrap();
        assert!((worst.altitude_settle_s.unwrap() - 4.0).abs() < 1e-9);
        assert!(worst.altitude_rms_ft < 1e-9);
    }

    #[test]
    fn without_a_complete_leg_there_is_no_score() {
        let log = FlightLog::new(TimedPatternConfig::default());
        assert_eq!(log.score().unwrap().worst, None);
    }

    /// A leg without samples has no score, and the flight has none.
    #[test]
    fn a_gap_in_a_flight_is_an_error() {
        let mut log = FlightLog::new(TimedPatternConfig::default());
        for time_s in [0.0, 0.025, 1e9] {
            log.push(Sample {
                time_s,
                heading_deg: 0.0,
                altitude_ft: 0.0,
                airspeed_kt: 100.0,
                lateral_g: 0.0,
            });
        }
        assert_eq!(
            log.score(),
            Err(ScoreError::NotFlown {
                start_s: 20.0,
                end_s: 40.0
            })
        );
    }
}
