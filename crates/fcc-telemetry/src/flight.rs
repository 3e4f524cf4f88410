//! Scores a flight while it is flown.

use fcc_guidance::TimedPatternConfig;

use super::score::{Leg, LegScore, ROUNDING_S, Sample, ScoreError, score};
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
    /// Legs before the present one.
    passed: usize,
    /// Scores of the complete legs.
    flown: Vec<LegScore>,
    /// Why the first leg without a score has none.
    failed: Option<ScoreError>,
}

impl FlightLog {
    /// An empty log of a flight through `pattern`.
    pub(crate) const fn new(pattern: TimedPatternConfig) -> Self {
        Self {
            pattern,
            captured: None,
            step_s: 0.0,
            leg: Vec::new(),
            passed: 0,
            flown: Vec::new(),
            failed: None,
        }
    }

    /// Takes a sample while engaged; the first gives the captured set points.
    pub(crate) fn push(&mut self, sample: Sample) {
        let captured = *self.captured.get_or_insert(sample);
        if self.step_s == 0.0 {
            self.step_s = sample.time_s - captured.time_s;
        }
        let mut leg = leg(&self.pattern, &captured, self.passed);
        if sample.time_s >= leg.end_s - ROUNDING_S {
            self.close(&leg);
            // Legs without a sample are passed at once.
            let whole = (sample.time_s + ROUNDING_S - leg.start_s) / self.pattern.leg_s;
            leg = self.pass((whole as usize).max(1), &captured);
        }
        if sample.time_s >= leg.start_s - ROUNDING_S {
            self.leg.push(sample);
        }
    }

    /// Scores the present leg.
    fn close(&mut self, leg: &Leg) {
        match score(&self.leg, &[*leg]) {
            Ok(scored) => self
                .flown
                .extend(scored.legs.into_iter().map(|scored| LegScore {
                    number: Some(self.passed + 1),
                    ..scored
                })),
            Err(error) => self.failed = self.failed.take().or(Some(error)),
        }
        self.leg.clear();
    }

    /// Goes on by so many legs; what lies between them was not flown.
    fn pass(&mut self, legs: usize, captured: &Sample) -> Leg {
        if legs > 1 {
            let next = leg(&self.pattern, captured, self.passed + 1);
            self.failed = self.failed.take().or_else(|| score(&[], &[next]).err());
        }
        self.passed += legs;
        leg(&self.pattern, captured, self.passed)
    }

    /// Resets: the next sample begins another flight.
    pub(crate) fn clear(&mut self) {
        *self = Self::new(self.pattern);
    }

    /// The scores of all complete legs, and why the first of the others has none.
    pub(crate) fn result(&self) -> (Vec<LegScore>, Option<ScoreError>) {
        let mut all = self.clone();
        if let (Some(captured), Some(last)) = (self.captured, self.leg.last()) {
            let leg = leg(&self.pattern, &captured, self.passed);
            // The last leg may end up to one sample early.
            let flown_s = last.time_s + self.step_s - leg.start_s;
            if flown_s >= self.pattern.leg_s * (1.0 - 1e-3) {
                all.close(&leg);
            }
        }
        (all.flown, all.failed)
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
    use super::super::score::FlightScore;
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
        let (legs, failed) = log.result();
        assert_eq!(failed, None);
        let score = FlightScore::of(legs);
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
        assert_eq!(log.result(), (Vec::new(), None));
    }

    /// Legs with samples throughout have scores whatever is missing from others.
    #[test]
    fn a_gap_costs_the_legs_in_it() {
        let nothing = |from_s, to_s| {
            Some(ScoreError::NotFlown {
                start_s: 20.0,
                end_s: 40.0,
                from_s,
                to_s,
            })
        };
        // Legs of 20 s after 20 s; 101 s are flown.
        for (gap_s, scored, why) in [
            ((0.0, 0.0), &[1, 2, 3, 4][..], None),
            ((30.0, 32.5), &[1, 2, 3, 4], None),
            ((30.0, 33.5), &[2, 3, 4], nothing(30.0, 33.5)),
            ((30.0, 50.0), &[3, 4], nothing(30.0, 40.0)),
            ((30.0, 70.0), &[4], nothing(30.0, 40.0)),
            ((15.0, 61.0), &[3, 4], nothing(20.0, 40.0)),
            ((101.0, 1e9), &[1, 2, 3, 4], None),
        ] {
            let mut log = FlightLog::new(TimedPatternConfig::default());
            let end = (gap_s.1 > 1e6).then_some(gap_s.1);
            for time_s in (0..404).map(|n| f64::from(n) * 0.25).chain(end) {
                if time_s > gap_s.0 && time_s < gap_s.1 {
                    continue;
                }
                log.push(Sample {
                    time_s,
                    heading_deg: 0.0,
                    altitude_ft: 0.0,
                    airspeed_kt: 100.0,
                    lateral_g: 0.0,
                });
            }
            let (legs, failed) = log.result();
            let numbers: Vec<_> = legs.iter().filter_map(|leg| leg.number).collect();
            assert_eq!(numbers, scored, "{gap_s:?}");
            if end.is_none() {
                assert_eq!(failed, why, "{gap_s:?}");
            } else {
                assert!(failed.is_some());
            }
        }
    }
}
