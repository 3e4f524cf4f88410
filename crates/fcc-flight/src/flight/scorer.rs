//! Scores the flown pattern.

use fcc_fixed_wing::Autopilot;
use fcc_guidance::GuidanceConfig;
use fcc_sim::Truth;
use fcc_telemetry::units::{G_MPS2, M_FT, MPS_KT};
use fcc_telemetry::{FlightRecord, PatternScorer, Sample, ScoredBy};

use super::observer::{FlightTime, Observer, Reports};
use super::outcome::Outcome;
use super::truth_recorder::TruthReceiver;

/// Scores the timed pattern from the truth, or from the measurements if there is
/// no truth.
pub(super) struct Scorer {
    pattern: Option<PatternScorer>,
    truth: Option<TruthReceiver>,
    was_engaged: bool,
}

impl Scorer {
    pub(super) fn new(guidance: &GuidanceConfig, truth: Option<TruthReceiver>) -> Self {
        let pattern = match guidance {
            GuidanceConfig::TimedPattern(pattern) => Some(PatternScorer::new(*pattern)),
            GuidanceConfig::Hold | GuidanceConfig::Plan => None,
        };
        Self {
            pattern,
            truth,
            was_engaged: false,
        }
    }
}

impl Observer<Autopilot> for Scorer {
    fn record(&mut self, record: &FlightRecord, at: &FlightTime) {
        self.was_engaged |= at.engaged_at_s.is_some();
        // A tick without its truth has no sample: measurements and truth are not
        // mixed in one score.
        let sample = match &mut self.truth {
            Some(truth) => truth
                .of_tick(record.tick.number)
                .map(|truth| true_sample(at.time_s, &truth)),
            None => Some(Sample::measured(&record.measurements, at.time_s)),
        };
        if let Some(pattern) = &mut self.pattern {
            let guidance = &record.setpoints.guidance;
            pattern.take(record.state.state(), guidance, sample, sample);
        }
    }

    fn end(&mut self, _: &str, outcome: &mut Outcome, _: &mut Reports) {
        outcome.scored_by = match self.truth {
            Some(_) => ScoredBy::Truth,
            None => ScoredBy::Measurement,
        };
        let Some((score, failed)) = self.pattern.as_ref().map(PatternScorer::result) else {
            return;
        };
        outcome.not_scored = match &failed {
            Some(error) => Some(error.to_string()),
            None if !self.was_engaged => Some("the autopilot was never engaged".to_owned()),
            None if score.legs.is_empty() => Some(
                "no leg of the timed pattern was flown to its end: fly longer\n\
                 (commanded set points end the pattern)"
                    .to_owned(),
            ),
            None => None,
        };
        outcome.flight = Some(score);
    }
}

/// A sample of the true flight, for scoring.
pub fn true_sample(time_s: f64, truth: &Truth) -> Sample {
    Sample {
        time_s,
        heading_deg: truth.heading_rad.to_degrees(),
        altitude_ft: truth.altitude_m * M_FT,
        airspeed_kt: truth.indicated_airspeed_mps * MPS_KT,
        lateral_g: truth.specific_force.y_mps2 / G_MPS2,
    }
}
