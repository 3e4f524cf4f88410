//! The outputs of the failsafe, its configuration, and the way back.

use core::time::Duration;

use super::Autopilot;
use super::degraded::{Lateral, Power, Vertical, held_without};
use super::release::Release;
use crate::control::Envelope;
use fcc_core::blocks::{limit_abs, wrap_two_pi};
use fcc_core::flight::atmosphere::true_airspeed_mps;
use fcc_core::flight::{Attitude, BodyRates, Measurements, Surfaces};
use fcc_core::framework::Time;
use fcc_navigation::{Estimate, Quantities, Quantity, ReturningAltitude, is_current};

/// What ends a failsafe in which nothing sound can be held.
///
/// ```
/// use fcc_fixed_wing::{FailsafeConfig, FailsafeEnd};
///
/// assert_eq!(FailsafeConfig::default().end, FailsafeEnd::Release);
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum FailsafeEnd {
    /// The controls are given back: a pilot is there.
    #[default]
    Release,
    /// None is there: a glide in a gentle turn, with idle throttle, as far as
    /// the attitude is known.
    Glide,
}

/// The failsafe of lost sensors.
///
/// ```
/// use core::time::Duration;
/// use fcc_fixed_wing::{FailsafeConfig, FailsafeEnd};
///
/// // Without a pilot.
/// let config = FailsafeConfig { end: FailsafeEnd::Glide, ..FailsafeConfig::default() };
/// assert_eq!(config.recovered_after, Duration::from_secs(2));
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct FailsafeConfig {
    /// What ends it.
    pub end: FailsafeEnd,
    /// A glide begins when nothing sound could be held for so long.
    pub hold: Duration,
    /// How long at most is flown without a quantity.
    pub degraded: Duration,
    /// What was flown before is continued when all has been good for so long;
    /// zero for never.
    pub recovered_after: Duration,
    /// The ratio of distance to height of the best glide.
    pub glide_ratio: f64,
    /// The bank of the glide, rad.
    pub glide_bank_rad: f64,
}

impl Default for FailsafeConfig {
    /// A Cessna 172: its best glide is 1.5 nautical miles for 1,000 ft (handbook
    /// of the 172P, 1981, section 3).
    fn default() -> Self {
        Self {
            end: FailsafeEnd::Release,
            hold: Duration::from_secs(5),
            degraded: Duration::from_secs(600),
            recovered_after: Duration::from_secs(2),
            glide_ratio: 9.1,
            glide_bank_rad: 0.261_799, // 15°
        }
    }
}

/// Sink rate above that of the glide per airspeed below it, m/s per m/s: the
/// airspeed error decays with g/V times it, in 3 s.
const GLIDE_GAIN: f64 = 1.2;

/// The most that the lowest and the stalling airspeed are of an airspeed that is only
/// assumed.
const LOWEST_OF_ASSUMED: f64 = 0.8;
const STALL_OF_ASSUMED: f64 = 0.6;

/// Flight path per height below the altitude that is to be kept by pitch, rad/m:
/// a bandwidth of 0.1 rad/s at 100 kt, a tenth of the flight path's. At most 2°:
/// the power stays.
const PATH_PER_M: f64 = 0.002;
const MOST_PATH_RAD: f64 = 0.035;

/// The trims that the loops had found when the body rates last changed: with
/// rates that no longer change, the loops' integrals run away.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct KeptTrims {
    pub(super) found_with: BodyRates,
    trims: Surfaces,
}

impl Autopilot {
    /// Keeps the present trims.
    pub(super) fn keep_trims(&mut self) {
        self.loops.kept_trims = KeptTrims {
            found_with: self.intake.accepted.body_rates.value,
            trims: self.loops.trims(),
        };
    }

    /// Begins a failsafe, or goes on with it: what is rejected from now on is not believed
    /// again at once.
    fn begin_or_go_on(&mut self, measured: &Measurements) {
        // One that was frozen stood still: what comes after it is no jump.
        self.supervisor.degraded.frozen |= self.frozen();
        let jumped = self.rejected(measured) & !self.supervisor.degraded.frozen;
        let rejected_by_gate = self.intake.rejected_by_gate | jumped;
        if rejected_by_gate.contains(Quantity::Altitude)
            && !self.intake.rejected_by_gate.contains(Quantity::Altitude)
        {
            self.intake.returning_altitude =
                ReturningAltitude::after(self.intake.accepted.altitude_m);
        }
        self.intake.rejected_by_gate = rejected_by_gate;
        if !self.supervisor.degraded.is_failsafe {
            self.supervisor
                .degraded
                .begin(self.estimator.estimate().altitude_m);
            self.begin_low();
            if self.frozen().contains(Quantity::BodyRates) {
                let trims = Surfaces {
                    throttle: self.loops.last.throttle,
                    ..self.loops.kept_trims.trims
                };
                self.take_over(&trims);
            }
        }
    }

    /// What the table of [degraded flight](super::degraded) holds without the
    /// lost quantities; idle throttle while thrust is reversed. A silent plant
    /// keeps its throttle: it may return with another aircraft. What was
    /// rejected as implausible is not believed again while the failsafe lasts,
    /// unless it agrees with the estimate, or is an altitude that
    /// [returns](ReturningAltitude).
    pub(super) fn safest(&mut self, now: Time, measured: &Measurements) -> Surfaces {
        self.begin_or_go_on(measured);
        let lost = self.unreplaced(now, self.lost(now));
        let held = held_without(lost);
        let glides = self.supervisor.degraded.glides;
        self.guidance.setpoints.roll_rad = 0.0;
        self.guidance.setpoints.climb_rate_mps = 0.0;
        let silent = self.intake.is_silent(&self.config, now);
        let idle = glides && !silent;
        if held.lateral == Lateral::Trims {
            self.guidance.setpoints.pitch_rad = 0.0;
            self.loops.recovery.end();
            if silent {
                return self.silent_trims();
            }
            let throttle = if idle {
                0.0
            } else {
                self.loops.airspeed.trim()
            };
            return Surfaces {
                throttle,
                ..self.loops.trims()
            };
        }
        let config = self.config.failsafe;
        let estimate = self.estimate_without(lost);
        if let Some(recovering) = self.recover_degraded(now, lost, &estimate, idle) {
            return recovering;
        }
        let (schedule, dt_s) = (
            self.loops.schedule_at(&self.config, estimate.airspeed_mps),
            self.intake.clock.step_s(),
        );
        if !idle && let Some(low) = self.fly_low(lost, &estimate, dt_s) {
            return low;
        }
        let envelope = self.envelope_without(lost, &estimate);
        // A constant pitch: one that follows the airspeed lets it diverge.
        let trimmed = self.loops.schedule_at(
            &self.config,
            if glides {
                self.config.envelope.best_glide_airspeed_mps
            } else {
                self.trimmed_mps()
            },
        );
        let roll_rad = if glides { config.glide_bank_rad } else { 0.0 };
        let lateral = self
            .loops
            .heading
            .hold_bank(roll_rad, &estimate, schedule, dt_s);
        let glide_mps = estimate.true_airspeed_mps / config.glide_ratio;
        let (kept_m, kept_mps) = (self.kept_altitude_m(), self.kept_climb_rate_mps());
        let altitude = &mut self.loops.altitude;
        let vertical = match held.vertical {
            Vertical::Level if glides => {
                let fast_mps = estimate.airspeed_mps - self.config.envelope.best_glide_airspeed_mps;
                let climb_rate_mps = GLIDE_GAIN * fast_mps - glide_mps;
                altitude.hold_climb_rate(climb_rate_mps, &estimate, &envelope, schedule, dt_s)
            }
            Vertical::Level => {
                altitude.hold_climb_rate(kept_mps, &estimate, &envelope, schedule, dt_s)
            }
            Vertical::Pitch | Vertical::Trim => {
                let low_m = kept_m - estimate.altitude_m;
                let path_rad = if glides {
                    -1.0 / config.glide_ratio
                } else if lost.contains(Quantity::Altitude) {
                    0.0
                } else {
                    limit_abs(PATH_PER_M * low_m, MOST_PATH_RAD)
                };
                altitude.hold_path_pitch(path_rad, trimmed, &estimate, &envelope, schedule, dt_s)
            }
        };
        self.guidance.setpoints.roll_rad = lateral.roll_rad;
        self.guidance.setpoints.climb_rate_mps = vertical.climb_rate_mps;
        self.guidance.setpoints.pitch_rad = vertical.pitch_rad;
        let throttle = if idle {
            0.0
        } else if held.power == Power::Airspeed {
            let demand = self.throttle_demand(vertical.climb_rate_mps);
            self.loops.airspeed.step(&demand, &estimate, dt_s)
        } else {
            self.loops.airspeed.trim()
        };
        Surfaces {
            throttle,
            elevator: self.loops.actuation.elevator(vertical.elevator),
            aileron: lateral.aileron,
            rudder: lateral.rudder,
            ..Surfaces::IDLE
        }
    }

    /// The estimate, with what takes the place of the lost quantities.
    fn estimate_without(&self, lost: Quantities) -> Estimate {
        let mut estimate = *self.estimator.estimate();
        if lost.contains(Quantity::SpecificForce) {
            estimate.side_force_mps2 = 0.0;
        }
        if lost.contains(Quantity::Airspeed) {
            // That of the pitch and power that are held.
            estimate.airspeed_mps = if self.supervisor.degraded.glides {
                self.config.envelope.best_glide_airspeed_mps
            } else {
                self.trimmed_mps()
            };
            estimate.true_airspeed_mps =
                true_airspeed_mps(estimate.airspeed_mps, estimate.altitude_m);
        }
        estimate
    }

    /// The airspeed of the pitch and the power that are held, m/s.
    fn trimmed_mps(&self) -> f64 {
        let other_mps = self.supervisor.degraded.trimmed_mps;
        other_mps.unwrap_or(self.guidance.targets.airspeed_mps)
    }

    /// The envelope. An airspeed that is not known, but assumed, is inside of it: no
    /// change of pitch would change it.
    fn envelope_without(&self, lost: Quantities, estimate: &Estimate) -> Envelope {
        let envelope = self.config.envelope;
        if !lost.contains(Quantity::Airspeed) {
            return envelope;
        }
        Envelope {
            min_airspeed_mps: envelope
                .min_airspeed_mps
                .min(LOWEST_OF_ASSUMED * estimate.airspeed_mps),
            stall_airspeed_mps: envelope
                .stall_airspeed_mps
                .min(STALL_OF_ASSUMED * estimate.airspeed_mps),
            ..envelope
        }
    }

    /// Continues what was flown before the failsafe: targets, mode and progress
    /// are as they were.
    pub(super) fn fly_on(&mut self) {
        self.intake.rejected_by_gate = Quantities::NONE;
        self.supervisor.degraded = self.supervisor.degraded.recovered();
        self.supervisor.release.take_if(Release::is_of_failsafe);
        let last = self.loops.last;
        self.take_over(&last);
        self.loops
            .heading
            .lead_from(self.guidance.setpoints.roll_rad);
    }

    /// A value that was rejected is believed again when it agrees with what the
    /// others tell about it: the last good one is moved with the estimate. An altitude is
    /// also when it is that of an aircraft again: the estimate without it drifts.
    pub(super) fn move_rejected(&mut self, now: Time, measured: &Measurements) {
        if self.intake.rejected_by_gate.is_empty() {
            return;
        }
        let (estimate, rejected_by_gate) =
            (*self.estimator.estimate(), self.intake.rejected_by_gate);
        let last = &mut self.intake.accepted;
        if rejected_by_gate.contains(Quantity::Attitude) {
            last.attitude.value = Attitude {
                pitch_rad: estimate.pitch_rad,
                roll_rad: estimate.roll_rad,
            };
        }
        if rejected_by_gate.contains(Quantity::Heading) {
            last.heading_rad.value = wrap_two_pi(estimate.heading_rad);
        }
        if rejected_by_gate.contains(Quantity::BodyRates) {
            last.body_rates.value = estimate.body_rates;
        }
        if rejected_by_gate.contains(Quantity::Altitude) {
            let (new, position) = (measured.altitude_m, &measured.position);
            let receiver_m = is_current(position, now).then_some(position.value.altitude_m);
            if self.intake.returning_altitude.step(&new, receiver_m) {
                last.altitude_m = new;
                self.intake.rejected_by_gate = rejected_by_gate.keeping(Quantity::Altitude, false);
            } else {
                last.altitude_m.value = estimate.altitude_m;
            }
        }
    }
}
