//! Scores the flown pattern.

use fcc_core::flight::Autopilot;
use fcc_core::flight::guidance::GuidanceConfig;
use fcc_core::framework::{EventKind, LoopCommand, State};
use fcc_sim::Truth;
use fcc_telemetry::units::{G_MPS2, M_FT, MPS_KT};
use fcc_telemetry::{FlightEvent, FlightLog, FlightRecord, Sample, ScoredBy};

use super::observer::{FlightTime, Observer, Reports};
use super::outcome::Outcome;
use super::truth_recorder::TruthReceiver;

/// Scores a pattern from the truth, or from the measurements if there is no
/// truth.
pub(super) struct Scorer {
    log: Option<FlightLog>,
    truth: Option<TruthReceiver>,
    was_engaged: bool,
}

impl Scorer {
    pub(super) fn new(guidance: &GuidanceConfig, truth: Option<TruthReceiver>) -> Self {
        let pattern = match guidance {
            GuidanceConfig::TimedPattern(pattern) => Some(*pattern),
            GuidanceConfig::Hold => None,
        };
        Self {
            log: pattern.map(FlightLog::new),
            truth,
            was_engaged: false,
        }
    }
}

impl Observer<Autopilot> for Scorer {
    fn record(&mut self, record: &FlightRecord, at: &FlightTime) {
        let truth = self
            .truth
            .as_mut()
            .and_then(|truth| truth.of_tick(record.tick.number));
        let is_engaged = record.state == State::Engaged;
        let is_first = is_engaged && !self.was_engaged;
        self.was_engaged = is_engaged;
        let Some(log) = self.log.as_mut().filter(|_| is_engaged) else {
            return;
        };
        if is_first {
            log.clear();
        }
        // If there is truth, a tick without it is left out: measurements and
        // truth are not mixed in one score.
        let sample = match truth {
            Some(truth) => Some(true_sample(at.time_s, &truth)),
            None if self.truth.is_some() => None,
            None => Some(Sample::measured(record, at.time_s)),
        };
        if let Some(sample) = sample {
            log.push(sample);
        }
    }

    fn event(&mut self, event: &FlightEvent, _: &str, _: &FlightTime) {
        if matches!(
            event.kind,
            EventKind::CommandReceived(LoopCommand::Controller(_))
        ) {
            // The pattern is not flown from its beginning: no score.
            self.log = None;
        }
    }

    fn end(&mut self, _: &str, outcome: &mut Outcome, _: &mut Reports) {
        outcome.scored_by = match self.truth {
            Some(_) => ScoredBy::Truth,
            None => ScoredBy::Measurement,
        };
        // A flight with an incomplete leg has no score.
        outcome.flight = self.log.take().and_then(|log| log.score().ok());
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
