//! The autopilot: navigation, guidance and control as one [`Controller`].

mod actuation;
mod airspeed_doubt;
mod assembly;
mod capture;
mod command;
mod config;
mod contingency;
mod degraded;
mod engaging;
mod estimator;
mod failsafe;
pub mod flags;
mod floor;
mod flying;
mod following;
mod future;
mod gliding;
mod ground_below;
mod ground_contact;
mod ground_motion;
mod guidance;
mod intake;
mod journal;
mod loops;
mod notices;
mod observe;
mod pilot_takeover;
mod place_monitor;
mod plant_clock;
mod reading_age;
mod receiver;
mod refusal;
mod release;
mod replacing;
mod reported;
mod resume;
mod routing;
mod runway;
mod scale;
mod sensor_health;
mod silence;
mod supervisor;
mod throttle_demand;
mod upset;
mod whereabouts;
mod wrong_sensors;

use core::fmt;
use core::hint::black_box;

pub use command::AutopilotCommand;
pub use config::AutopilotConfig;
pub use contingency::{Contingency, ContingencyAction, ContingencyConfig};
use degraded::Degraded;
use estimator::Estimator;
pub use failsafe::{FailsafeConfig, FailsafeEnd};
use guidance::GuidanceState;
use intake::Intake;
use journal::Journal;
use loops::Loops;
pub use pilot_takeover::StickTakeover;
pub use refusal::{COMMAND_ANSWER, why_refused};
pub use replacing::PlanReplacement;
pub use resume::Resume;
pub use routing::ITEM_REACHED;
pub use runway::{gives_up_runway, touches_ground};
pub use scale::Scale;
use supervisor::Supervisor;

use crate::Setpoints;
use crate::control::{ElevatorTrim, Recovery};
use fcc_core::blocks::wrap_two_pi;
use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Controller, Flags, Notice, Reading, ReadingSet, Switch, Tick};
use fcc_guidance::{Mode, ModeInput};
use fcc_navigation::{AIRSPEED, ENGAGE_SWITCH, Estimate, Quantities, Quantity, plausibility_gate};

/// Navigation, guidance and control as one [`Controller`].
///
/// ```
/// use fcc_guidance::GuidanceConfig;
/// use fcc_core::flight::{Attitude, BodyRates, Measurements, SpecificForce};
/// use fcc_fixed_wing::{Autopilot, AutopilotConfig};
/// use fcc_core::framework::{Controller, Reading, Tick, Time};
///
/// let mut autopilot = Autopilot::new(AutopilotConfig {
///     guidance: GuidanceConfig::Hold,
///     ..AutopilotConfig::default()
/// });
/// // Two seconds of level flight at 100 kt and 3,000 ft, heading 30°.
/// let mut tick = Tick { dt_s: 0.025, ..Tick::default() };
/// let mut measured = Measurements::default();
/// for n in 1..=80 {
///     let now = Time::from_nanos(n * 25_000_000);
///     (tick.scheduled, tick.woke) = (now, now);
///     let force = SpecificForce { z_mps2: -9.806_65, ..SpecificForce::default() };
///     measured = Measurements {
///         attitude: Reading::new(Attitude::default(), now),
///         heading_rad: Reading::new(30.0_f64.to_radians(), now),
///         body_rates: Reading::new(BodyRates::default(), now),
///         specific_force: Reading::new(force, now),
///         airspeed_mps: Reading::new(51.444, now),
///         altitude_m: Reading::new(914.4, now),
///         ..Measurements::default()
///     };
///     autopilot.estimate(&tick, &measured);
/// }
/// assert!(autopilot.engage_inhibits(&tick, &measured).is_empty());
/// autopilot.engage(&tick, &measured);
/// autopilot.guide(&tick, &measured);
/// assert!(autopilot.control(&tick, &measured).is_valid());
/// assert!((autopilot.setpoints().heading_rad.to_degrees() - 30.0).abs() < 1e-6);
/// ```
#[derive(Clone, Debug)]
pub struct Autopilot {
    config: AutopilotConfig,
    intake: Intake,
    estimator: Estimator,
    supervisor: Supervisor,
    guidance: GuidanceState,
    loops: Loops,
    journal: Journal,
}

impl Controller for Autopilot {
    type Measurements = Measurements;
    type Estimate = Estimate;
    type Setpoints = Setpoints;
    type Outputs = Surfaces;
    type Command = AutopilotCommand;

    fn estimate(&mut self, tick: &Tick, measurements: &Measurements) {
        self.journal.begin();
        match &mut self.estimator.raw {
            Some(raw) => {
                let found = *raw.step(tick.woke, measurements);
                self.observe(tick, &found);
            }
            None => self.observe(tick, measurements),
        }
        self.journal.report();
    }

    fn engage_inhibits(&self, tick: &Tick, measurements: &Measurements) -> Flags {
        self.inhibits(tick.woke, self.estimator.seen(measurements))
    }

    fn faults(&self, tick: &Tick, measurements: &Measurements) -> Flags {
        let seen = self.estimator.seen(measurements);
        self.unsafe_to_fly(tick.woke, seen)
    }

    fn conditions(&self, tick: &Tick, measurements: &Measurements) -> Flags {
        let of_parts =
            self.loops.actuation.conditions() | self.estimator.doubted() | self.trim_conditions();
        let unused = self.estimator.unused_sensors(measurements) | self.route_conditions();
        (self.external(tick.woke, self.estimator.seen(measurements)) | of_parts | unused)
            .with(flags::RECOVERING, self.loops.recovery.is_active())
            .with(
                flags::UNDERSPEED,
                self.loops.altitude.gives_up_height() && self.guidance.runway().is_none(),
            )
            .with(
                flags::STALLS_FASTER,
                self.loops.recovery.found_stall_mps() > 0.0,
            )
            .with(flags::AT_FLOOR, self.guidance.is_at_floor)
            .with(flags::RELEASING, self.supervisor.release.is_some())
    }

    fn failsafe_goes_on(&self) -> bool {
        self.supervisor.degraded.goes_on(&self.config.failsafe)
    }

    fn is_unattended(&self) -> bool {
        self.config.failsafe.end == FailsafeEnd::Glide
    }

    fn has_recovered(&self) -> bool {
        self.supervisor
            .degraded
            .is_good_again(&self.config.failsafe)
    }

    fn recover(&mut self, _tick: &Tick, _measurements: &Measurements) {
        self.fly_on();
    }

    fn must_release(&self, _tick: &Tick, _measurements: &Measurements) -> Flags {
        self.intake.is_elsewhere()
    }

    fn is_taken_over(&self, _tick: &Tick, _measurements: &Measurements) -> Flags {
        Flags::NONE.with(flags::PILOT_TAKES_OVER, self.supervisor.pilot.is_moved())
    }

    fn prepare_release(&mut self, tick: &Tick, measurements: &Measurements) -> bool {
        let seen = *self.estimator.seen(measurements);
        self.begin_to_release(false, tick.woke, &seen)
    }

    fn is_ready_for_release(&self) -> bool {
        (self.supervisor.release.as_ref())
            .is_none_or(|release| release.is_trimmed(self.config.level_and_trim))
    }

    fn withholds_outputs(&self, tick: &Tick, _measurements: &Measurements) -> bool {
        self.intake.withholds(&self.config, tick.woke)
    }

    fn notices(&self) -> &[Notice] {
        self.journal.reported()
    }

    fn write_notice(notice: &Notice, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        notices::write(notice, f)
    }

    fn flag_name(bit: u32) -> &'static str {
        flags::NAMES
            .get(bit as usize)
            .copied()
            .unwrap_or("unknown condition")
    }

    /// In the units in which commands are given: knots, degrees, feet.
    fn write_command(command: &AutopilotCommand, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{command}")
    }

    /// The mode of guidance.
    fn mode(&self) -> u8 {
        self.guidance.mode.mode() as u8
    }

    fn mode_name(mode: u8) -> &'static str {
        Mode::from_number(mode).map_or("unknown", Mode::name)
    }

    fn engage(&mut self, tick: &Tick, _measurements: &Measurements) {
        self.begin_flight(tick.woke);
    }

    fn warm_up(&self, tick: &Tick, measurements: &Measurements) {
        let mut scratch = self.clone();
        scratch.estimate(tick, measurements);
        let _ = black_box(scratch.faults(tick, measurements));
        scratch.guide(tick, measurements);
        black_box(scratch.control(tick, measurements));
    }

    fn guide(&mut self, _tick: &Tick, _measurements: &Measurements) {
        self.meet_contingencies();
        self.set_targets();
    }

    fn control(&mut self, tick: &Tick, _measurements: &Measurements) -> Surfaces {
        let outputs = self.fly(tick.woke);
        self.loops.last = self.with_gear(outputs);
        self.loops.last
    }

    fn failsafe(&mut self, tick: &Tick, measurements: &Measurements) -> Surfaces {
        let seen = *self.estimator.seen(measurements);
        self.prepare_end_of_failsafe(tick.woke, &seen);
        let lost = self.lost(tick.woke);
        let estimate = *self.estimator.estimate();
        if !lost.intersects(Quantity::BodyRates | Quantity::Attitude) {
            self.follow_outputs(&estimate);
        } else if !lost.contains(Quantity::Attitude) {
            self.loops
                .actuation
                .watch(&self.loops.last, &estimate, self.intake.clock.step_s());
        }
        let held = self.safest(tick.woke, &seen);
        let stops = self.stop_on_wheels(lost);
        let outputs = Surfaces {
            gear: self.gear_in_failsafe(stops.is_some()),
            ..stops.unwrap_or(held)
        };
        self.loops.last = self.with_trim(tick.woke, outputs, lost);
        self.loops.last
    }

    fn disengage(&mut self) {
        self.intake.rejected_by_gate = Quantities::NONE;
        self.supervisor.degraded = Degraded::default();
        self.supervisor.pilot.set_engaged(false);
        self.change_mode(ModeInput::Disengage);
        self.supervisor.left_plan = None;
        self.supervisor.contingencies.reset();
        self.guidance.is_at_floor = false;
        self.guidance.capture = None;
        self.loops.recovery = Recovery::new();
        self.supervisor.release = None;
        self.loops.trim = ElevatorTrim::new(None);
        self.guidance.setpoints = Setpoints::default();
    }

    fn command(&mut self, command: &AutopilotCommand) {
        self.execute(command);
    }

    fn estimated(&self) -> Estimate {
        let estimate = self.intake.ages.shown_in(self.estimator.estimate());
        let estimate = self.estimator.ground.shown_in(&estimate);
        Estimate {
            heading_rad: wrap_two_pi(estimate.heading_rad),
            ..self.loops.actuation.shown_in(&estimate)
        }
    }

    fn setpoints(&self) -> Setpoints {
        let mut guidance = self.guidance.mode.progress();
        guidance.captured.heading_rad = wrap_two_pi(guidance.captured.heading_rad);
        Setpoints {
            guidance,
            altimeter_setting_pa: self.guidance.altimeter.setting_pa,
            ..self.with_track(self.guidance.setpoints)
        }
    }

    fn outputs_are_valid(&self, outputs: &Surfaces) -> bool {
        outputs.is_valid()
    }

    fn observe_sensor(&mut self, sensor: u8, measurements: &Measurements) {
        if let Some(raw) = &mut self.estimator.raw {
            raw.observe_sensor(sensor, measurements);
        }
    }

    fn plausible(&self, sensor: u8, measurements: &Measurements) -> ReadingSet {
        let plausible = plausibility_gate(
            &mut self.intake.accepted.clone(),
            measurements,
            &self.gate_limits(),
        );
        let plausible = plausible.keeping(AIRSPEED, self.estimator.permits_airspeed(measurements));
        match &self.estimator.raw {
            Some(raw) => raw.permitted(sensor, plausible),
            None => plausible,
        }
    }

    fn of_one_sensor(&self) -> ReadingSet {
        // The difference between two sensors' switches is no movement of either.
        ENGAGE_SWITCH
    }

    fn switch(&self, measurements: &Measurements) -> Reading<Switch> {
        measurements.engage_switch
    }
}
