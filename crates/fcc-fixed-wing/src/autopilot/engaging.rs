//! When the autopilot may engage, and how it begins.

use super::capture::Capture;
use super::degraded::Degraded;
use super::ground_contact::ToldOnce;
use super::upset::is_far_from_level;
use super::{Autopilot, flags};
use crate::control::ElevatorTrim;
use fcc_core::flight::{AltitudeReference, Measurements, PlantState, Surfaces};
use fcc_core::framework::{Flags, ROUNDING_S, Time};
use fcc_guidance::{ActiveMode, Mode, ModeInput, Targets};
use fcc_navigation::inertial::RawNavigation;
use fcc_navigation::{Quantities, Quantity};

impl Autopilot {
    /// Why the autopilot does not engage.
    pub(super) fn inhibits(&self, now: Time, measurements: &Measurements) -> Flags {
        let estimate = self.estimator.estimate();
        let contradictions = self.estimator.navigation.contradictions();
        let stale = self.stale(now);
        let is_slow = estimate.airspeed_mps < self.config.envelope.min_airspeed_mps
            && !stale.contains(Quantity::Airspeed);
        (self.unsafe_with(stale, now, measurements)
            | self.external(now, measurements)
            | self.route_inhibits()
            | self.battery_inhibits(now))
        .with(
            flags::ATTITUDE_AGAINST_RATES,
            contradictions.attitude_and_rates,
        )
        .with(flags::LOAD_AGAINST_GRAVITY, contradictions.load)
        .with(flags::PITCH_AGAINST_FORCE, contradictions.pitch_and_force)
        .with(
            flags::PLANT_REPLAYING,
            self.intake.plant_is(PlantState::Replaying),
        )
        .with(flags::PILOT_TAKES_OVER, self.supervisor.pilot.is_moved())
        .with(
            flags::PLANT_PAUSED,
            self.intake.plant_is(PlantState::Paused),
        )
        .with(flags::PLANT_STALLED, self.intake.clock.has_stopped())
        .with(
            flags::SETTLING,
            self.intake.settled_s.is_none_or(|settled_s| {
                settled_s + ROUNDING_S < self.config.settling.as_secs_f64()
            }),
        )
        .with(
            flags::UNCHECKED_GYROSCOPE,
            self.estimator
                .raw
                .as_ref()
                .is_some_and(RawNavigation::awaits_field),
        )
        .with(
            flags::TOO_SLOW,
            self.may_not_take_off_here(now)
                || is_slow
                    && !self.begins_on_runway()
                    && !(is_far_from_level(estimate) && self.may_engage_in_upset()),
        )
        .with(
            flags::UPSET,
            is_far_from_level(estimate) && !self.may_engage_in_upset(),
        )
    }

    /// Engages: what is flown now is held, or the pattern begins.
    pub(super) fn begin_flight(&mut self, now: Time) {
        self.intake.rejected_by_gate = Quantities::NONE;
        self.supervisor.told_once = ToldOnce::default();
        self.supervisor.contingencies.reset();
        self.supervisor.pilot.set_engaged(true);
        self.supervisor.degraded = Degraded::default();
        let estimate = *self.estimator.estimate();
        self.guidance.targets = Targets {
            airspeed_mps: self.config.envelope.allowed_airspeed(estimate.airspeed_mps),
            heading_rad: estimate.heading_rad,
            altitude_m: estimate.altitude_m,
        };
        self.guidance.reference = AltitudeReference::PressureLevel;
        self.estimator.navigation.mark_altitude();
        self.guidance.capture = Some(Capture::of(estimate.altitude_m));
        self.change_mode(ModeInput::Engage);
        let standing = self
            .intake
            .accepted
            .surfaces
            .fresh(now, self.config.max_age)
            .unwrap_or(Surfaces {
                throttle: self.config.airspeed.trim_throttle,
                ..Surfaces::default()
            });
        let trim = standing.elevator_trim.filter(|_| self.config.trims);
        self.loops.trim = ElevatorTrim::new(trim);
        self.supervisor.release = None;
        self.loops.actuation.engage(&standing);
        self.take_over(&standing);
        self.begin_straight_trims();
        self.begin_watching_for_upsets();
    }

    /// Engages the loops with the present throttle and surfaces.
    pub(super) fn take_over(&mut self, standing: &Surfaces) {
        self.loops.last = *standing;
        self.loops.trim.take_over(standing.elevator_trim);
        let estimate = *self.estimator.estimate();
        self.loops.bank.reset(estimate.roll_rad);
        let schedule = self.schedule();
        self.loops
            .heading
            .engage(standing.aileron, standing.rudder, &estimate, schedule);
        self.loops
            .altitude
            .engage(standing.elevator, &estimate, schedule);
        let demand = self.throttle_demand(estimate.climb_rate_mps);
        self.loops
            .airspeed
            .engage(standing.throttle, &demand, &estimate);
        self.keep_trims();
    }

    /// Starts the loops at the present state with the trims that they have found, after
    /// a time in which nobody else flew: the surfaces stood at these trims, so what is
    /// off now is none of them.
    pub(super) fn rejoin(&mut self) {
        let estimate = *self.estimator.estimate();
        self.loops.bank.reset(estimate.roll_rad);
        self.loops.heading.restart(&estimate);
        self.loops.altitude.restart(&estimate);
        self.loops.airspeed.restart(&estimate);
    }

    /// Enters the mode given by the transition table, with the present targets.
    pub(super) fn change_mode(&mut self, input: ModeInput) {
        let (config, plan) = (self.config.guidance, self.config.plan);
        let Some(mode) = self.guidance.mode.mode().after(input, config.mode()) else {
            return;
        };
        if let (Mode::Plan, Some(plan)) = (mode, plan) {
            self.begin_plan(&plan, 0);
        } else {
            self.leave();
            self.guidance.mode = ActiveMode::enter(mode, &config, self.guidance.targets);
        }
    }
}
