//! What is between the outputs and their effect: latency, play, oscillation.

use super::{Autopilot, AutopilotConfig, flags};
use crate::control::{ElevatorResponse, LEAST_PACE, OscillationMonitor, PlayInverse, Schedule};
use fcc_core::blocks::limit;
use fcc_core::flight::Surfaces;
use fcc_core::framework::Flags;
use fcc_navigation::{DERIVED_RATES_LATE_S, Estimate};

/// The pitch loops keep 6 dB and 45° up to this latency, s: 25 ms and a servo
/// of 3 Hz, whose lag is 1/(2π 3 Hz) = 53 ms.
const PITCH_TUNED_FOR_S: f64 = 0.08;
/// The roll loops keep them up to this one, s.
const ROLL_TUNED_FOR_S: f64 = 0.12;
/// The time constant of the loops themselves, s: their bandwidth is
/// proportional to 1/(this + the latency in excess of what they are tuned for).
const OWN_S: f64 = 0.2;
/// In an aircraft whose loops are slower than this, by their unit of time, the
/// elevator's effect is not told from noise: the latency stays the assumed one.
const SLOWEST_MEASURED: f64 = 1.25;
/// A latency above the first is reported until it is below the second, s.
const LATE_S: (f64, f64) = (0.12, 0.1);

impl AutopilotConfig {
    /// The greatest latency for these gains, s, where it is not measured in flight.
    pub fn unmeasured_latency_s(&self) -> Option<f64> {
        let unit = 1.0 / self.pace;
        (unit > SLOWEST_MEASURED).then_some(PITCH_TUNED_FOR_S * unit)
    }
}

/// Follows how the aircraft responds to what was sent.
#[derive(Clone, Debug)]
pub(super) struct Actuation {
    elevator: ElevatorResponse,
    oscillation: OscillationMonitor,
    inverse: PlayInverse,
    is_late: bool,
    /// The latency that the age of the readings shows, s.
    known_s: f64,
    assumed_s: f64,
    /// How much later the body rates are than those with which the latency was
    /// measured, s.
    replaced_s: f64,
    /// The loops' own unit of time: 1 over the pace of the configuration.
    unit: f64,
}

impl Actuation {
    /// With the assumed latency, s, and the pace of the configuration.
    pub(super) fn new(assumed_latency_s: f64, configured_pace: f64) -> Self {
        Self {
            elevator: ElevatorResponse::new(assumed_latency_s),
            oscillation: OscillationMonitor::new(),
            inverse: PlayInverse::new(0.0),
            is_late: false,
            known_s: 0.0,
            assumed_s: assumed_latency_s,
            replaced_s: 0.0,
            unit: 1.0 / configured_pace,
        }
    }

    /// Begins with the present surfaces; what was found before may be another
    /// aircraft's.
    pub(super) fn engage(&mut self, standing: &Surfaces) {
        self.elevator.reset();
        self.oscillation = OscillationMonitor::new();
        self.inverse = PlayInverse::new(standing.elevator);
    }

    /// One step with what was sent before, and the load along the body's z axis.
    pub(super) fn follow(
        &mut self,
        sent: &Surfaces,
        estimate: &Estimate,
        load_mps2: f64,
        dt_s: f64,
    ) {
        self.watch(sent, estimate, dt_s);
        if self.unit <= SLOWEST_MEASURED {
            let rate_radps = estimate.body_rates.pitch_radps;
            self.elevator
                .step(sent.elevator, rate_radps, load_mps2, dt_s);
        }
        let (late_s, timely_s) = LATE_S;
        let latency_s = self.elevator.latency_s();
        self.is_late = latency_s > if self.is_late { timely_s } else { late_s };
    }

    /// Watches for oscillations, with body rates that need not be measured.
    pub(super) fn watch(&mut self, sent: &Surfaces, estimate: &Estimate, dt_s: f64) {
        self.oscillation.step(sent, estimate, dt_s);
    }

    /// The mean age of the body rates, s: measured or not, the latency is not less.
    pub(super) const fn knows_age(&mut self, age_s: f64) {
        self.known_s = self.assumed_s + age_s;
    }

    /// Whether the body rates are the derivative of the attitude, which is late.
    /// Nothing measures the latency then, and the one found before may be too
    /// small: that of the derivative counts twice.
    pub(super) const fn derives_rates(&mut self, derives: bool) {
        self.replaced_s = if derives {
            2.0 * DERIVED_RATES_LATE_S
        } else {
            0.0
        };
    }

    /// The schedule with the part of the loops' bandwidth that latency and
    /// oscillation leave.
    pub(super) fn slowed(&self, schedule: Schedule) -> Schedule {
        schedule.slowed(self.pace(PITCH_TUNED_FOR_S), self.pace(ROLL_TUNED_FOR_S))
    }

    fn pace(&self, tuned_for_s: f64) -> f64 {
        let latency_s = self.elevator.latency_s().max(self.known_s) + self.replaced_s;
        let excess_s = (latency_s - tuned_for_s * self.unit).max(0.0);
        let own_s = OWN_S * self.unit;
        let pace = own_s / (own_s + excess_s) * self.oscillation.pace();
        limit(pace, LEAST_PACE, 1.0)
    }

    /// The elevator to send for the one that the loops want.
    pub(super) fn elevator(&mut self, wanted: f64) -> f64 {
        self.inverse.step(wanted, self.elevator.play())
    }

    /// What is reported.
    pub(super) fn conditions(&self) -> Flags {
        Flags::NONE
            .with(flags::OSCILLATION, self.oscillation.is_oscillating())
            .with(flags::LATE_EFFECT, self.is_late)
    }

    /// The estimate with what was found.
    pub(super) fn shown_in(&self, estimate: &Estimate) -> Estimate {
        Estimate {
            output_latency_s: self.elevator.latency_s(),
            elevator_play: self.elevator.play(),
            ..*estimate
        }
    }
}

impl Autopilot {
    /// Follows how the aircraft responds to the last outputs.
    pub(super) fn follow_outputs(&mut self, estimate: &Estimate) {
        self.loops.actuation.knows_age(self.intake.ages.rates_s());
        let dt_s = self.intake.clock.step_s();
        let load_mps2 = -self.intake.accepted.specific_force.value.z_mps2;
        self.loops
            .actuation
            .follow(&self.loops.last, estimate, load_mps2, dt_s);
    }

    /// The gains for the present airspeed and latency.
    pub(super) fn schedule(&self) -> Schedule {
        let airspeed_mps = self.estimator.estimate().airspeed_mps;
        self.loops.schedule_at(&self.config, airspeed_mps)
    }
}
