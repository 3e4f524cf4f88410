//! Scores the timed patterns of a flight, by the mode of guidance in its records.

use fcc_core::framework::State;
use fcc_guidance::{Mode, Progress, TimedPatternConfig};

use super::flight::FlightLog;
use super::score::{FlightScore, LegScore, Sample, ScoreError};

/// The longest time in a pattern of its first record: one that begins with more
/// was resumed, and its first legs were not flown.
const BEGINS_WITHIN_S: f64 = 0.5;

/// Scores every timed pattern that is flown from its beginning, until another
/// mode or another pattern follows.
#[derive(Clone, Debug)]
pub struct PatternScorer {
    log: FlightLog,
    /// The progress of the pattern that is scored now, in the last tick.
    scored: Option<Progress>,
    legs: Vec<LegScore>,
    failed: Option<ScoreError>,
}

impl PatternScorer {
    /// A scorer of this pattern.
    pub const fn new(pattern: TimedPatternConfig) -> Self {
        Self {
            log: FlightLog::new(pattern),
            scored: None,
            legs: Vec::new(),
            failed: None,
        }
    }

    /// Takes a tick: the loop's state, guidance's progress, and a sample, if
    /// there is one; the legs of a pattern that begins in this tick lie around
    /// `captured`.
    pub fn take(
        &mut self,
        state: State,
        guidance: &Progress,
        captured: Option<Sample>,
        sample: Option<Sample>,
    ) {
        let is_flown = state == State::Engaged && guidance.mode == Mode::TimedPattern;
        let sample = match &self.scored {
            Some(before) if is_flown && continues(before, guidance) => sample,
            _ => {
                self.close();
                if !is_flown || guidance.elapsed_s > BEGINS_WITHIN_S {
                    return;
                }
                captured
            }
        };
        self.scored = Some(*guidance);
        if let Some(sample) = sample {
            self.log.push(sample);
        }
    }

    fn close(&mut self) {
        if self.scored.take().is_some() {
            let (legs, failed) = self.log.result();
            let before = self.legs.last().and_then(|leg| leg.number).unwrap_or(0);
            self.legs.extend(legs.into_iter().map(|leg| LegScore {
                number: leg.number.map(|number| before + number),
                ..leg
            }));
            self.failed = self.failed.take().or(failed);
            self.log.clear();
        }
    }

    /// The complete legs of all patterns, and why the first of the others could not be
    /// scored.
    pub fn result(&self) -> (FlightScore, Option<ScoreError>) {
        let mut all = self.clone();
        all.close();
        (FlightScore::of(all.legs), all.failed)
    }
}

/// Whether this is the same pattern as before: the altitude that it captured
/// may have been corrected.
fn continues(before: &Progress, now: &Progress) -> bool {
    let (was, is) = (&before.captured, &now.captured);
    now.elapsed_s >= before.elapsed_s
        && was.heading_rad == is.heading_rad
        && was.airspeed_mps == is.airspeed_mps
}

#[cfg(test)]
mod tests {
    use fcc_guidance::Targets;

    use super::*;

    const DT_S: f64 = 0.025;

    /// How long is flown, in which state, and what is changed in the progress.
    type Part = (f64, State, fn(&mut Progress));

    /// Flies without an error for so many seconds, with the progress of
    /// guidance changed by `change`; the number of complete legs, 20 s each
    /// after 20 s.
    fn legs(flight: &[Part]) -> usize {
        let mut scorer = PatternScorer::new(TimedPatternConfig::default());
        let mut tick = 0_u32;
        for (seconds, state, change) in flight {
            for n in 1..=(seconds / DT_S).round() as u32 {
                tick += 1;
                let mut progress = Progress {
                    mode: Mode::TimedPattern,
                    elapsed_s: f64::from(n) * DT_S,
                    captured: Targets {
                        airspeed_mps: 50.0,
                        heading_rad: 1.0,
                        altitude_m: 900.0,
                    },
                    ..Progress::default()
                };
                change(&mut progress);
                let sample = Some(Sample {
                    time_s: f64::from(tick) * DT_S,
                    heading_deg: 0.0,
                    altitude_ft: 0.0,
                    airspeed_kt: 100.0,
                    lateral_g: 0.0,
                });
                scorer.take(*state, &progress, sample, sample);
            }
        }
        let (score, failed) = scorer.result();
        assert_eq!(failed, None);
        score.legs.len()
    }

    const UNCHANGED: fn(&mut Progress) = |_| {};

    #[test]
    fn every_pattern_of_a_flight_is_scored() {
        use State::{Engaged, Standby};
        assert_eq!(legs(&[(61.0, Engaged, UNCHANGED)]), 2);
        let again = [
            (61.0, Engaged, UNCHANGED),
            (1.0, Standby, UNCHANGED),
            (41.0, Engaged, UNCHANGED),
        ];
        assert_eq!(legs(&again), 3);
        // In the next tick, with the same mode.
        assert_eq!(legs(&[again[0], again[2]]), 3);
    }

    #[test]
    fn another_mode_ends_a_pattern_with_its_complete_legs() {
        let holds: fn(&mut Progress) = |progress| progress.mode = Mode::Hold;
        let flight = [
            (59.0, State::Engaged, UNCHANGED),
            (60.0, State::Engaged, holds),
        ];
        assert_eq!(legs(&flight), 1);
    }

    #[test]
    fn a_pattern_that_is_resumed_is_not_scored() {
        let resumed: fn(&mut Progress) = |progress| {
            progress.elapsed_s += 30.0;
            progress.captured.heading_rad = 2.0;
        };
        assert_eq!(legs(&[(60.0, State::Engaged, resumed)]), 0);
        // The commands of a recovery are read in two ticks.
        let flight = [
            (DT_S, State::Engaged, UNCHANGED),
            (60.0, State::Engaged, resumed),
        ];
        assert_eq!(legs(&flight), 0);
    }

    #[test]
    fn a_corrected_altitude_is_the_same_pattern() {
        let corrected: fn(&mut Progress) = |progress| {
            progress.elapsed_s += 3.0;
            progress.captured.altitude_m += 0.3;
        };
        let flight = [
            (3.0, State::Engaged, UNCHANGED),
            (38.0, State::Engaged, corrected),
        ];
        assert_eq!(legs(&flight), 1);
    }
}
