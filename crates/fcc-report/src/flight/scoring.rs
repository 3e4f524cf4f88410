//! The score along the timed pattern, by measurements.

use fcc_core::flight::Autopilot;
use fcc_core::flight::guidance::TimedPatternConfig;
use fcc_core::framework::{RecordOf, State};

use fcc_telemetry::units::{M_FT, MPS_KT};
use fcc_telemetry::{FlightLog, FlightScore, Sample};

/// Scores every engagement of a flight through the timed pattern.
///
/// The legs begin at the set points captured at engagement, not at the first,
/// noisy measurement.
#[derive(Clone, Debug)]
pub(super) struct Scoring {
    log: FlightLog,
    engaged: bool,
    /// Whether a command ended the pattern: later ticks are not scored.
    free: bool,
    legs: FlightScore,
    failed: Option<String>,
}

impl Scoring {
    pub(super) fn new(pattern: TimedPatternConfig) -> Self {
        Self {
            log: FlightLog::new(pattern),
            engaged: false,
            free: false,
            legs: FlightScore::of(Vec::new()),
            failed: None,
        }
    }

    pub(super) fn take(&mut self, record: &RecordOf<Autopilot>, time_s: f64) {
        let engaged = record.state == State::Engaged;
        if engaged && !self.engaged {
            self.free = false;
            self.log.push(captured(record, time_s));
        } else if engaged && !self.free {
            self.log.push(Sample::measured(record, time_s));
        } else if !engaged && self.engaged {
            self.close();
        }
        self.engaged = engaged;
    }

    /// A command to the autopilot ends the pattern.
    pub(super) fn command_received(&mut self) {
        if self.engaged {
            self.free = true;
        }
    }

    fn close(&mut self) {
        match self.log.score() {
            Ok(score) => {
                let mut legs = std::mem::take(&mut self.legs.legs);
                legs.extend(score.legs);
                self.legs = FlightScore::of(legs);
            }
            Err(error) => self.failed = Some(error.to_string()),
        }
        self.log.clear();
    }

    /// The legs of all engagements, and the reason if one could not be scored.
    pub(super) fn result(&self) -> (FlightScore, Option<String>) {
        let mut all = self.clone();
        if all.engaged {
            all.close();
        }
        (all.legs, all.failed)
    }
}

fn captured(record: &RecordOf<Autopilot>, time_s: f64) -> Sample {
    Sample {
        heading_deg: record.setpoints.heading_rad.to_degrees(),
        altitude_ft: record.setpoints.altitude_m * M_FT,
        airspeed_kt: record.setpoints.airspeed_mps * MPS_KT,
        ..Sample::measured(record, time_s)
    }
}
