//! The autopilot: navigation, guidance and control as one [`Controller`].

mod capture;
mod command;
mod config;
pub mod flags;
mod other_control;
mod plant_clock;
mod resume;
mod scale;
mod sensor_health;

use core::fmt;
use core::hint::black_box;

use libm::cos;

use capture::Capture;
pub use command::AutopilotCommand;
pub use config::AutopilotConfig;
use plant_clock::PlantClock;
pub use resume::Resume;
pub use scale::Scale;

use super::control::{AirspeedLoop, AltitudeLoop, HeadingLoop, Schedule, ThrottleDemand};
use super::guidance::{ActiveMode, Mode, ModeInput, Targets};
use super::navigation::{Estimate, FrozenDetector, Navigation, plausibility_gate};
use super::{Altimeter, AltitudeReference, Measurements, PlantState, Setpoints, Surfaces};
use crate::blocks::wrap_two_pi;
use crate::framework::{Controller, Flags, Reading, Switch, Tick, Time};

/// Beyond this bank or pitch the autopilot does not engage, rad.
const UPSET_RAD: f64 = 1.047;

/// Navigation, guidance and control as one [`Controller`].
///
/// ```
/// use fcc_core::flight::guidance::GuidanceConfig;
/// use fcc_core::flight::{
///     Attitude, Autopilot, AutopilotConfig, BodyRates, Measurements, SpecificForce,
/// };
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
    /// The last plausible measurements.
    accepted: Measurements,
    navigation: Navigation,
    frozen: FrozenDetector,
    guidance: ActiveMode,
    targets: Targets,
    capture: Option<Capture>,
    altimeter: Altimeter,
    /// What the target altitude refers to.
    reference: AltitudeReference,
    heading: HeadingLoop,
    altitude: AltitudeLoop,
    airspeed: AirspeedLoop,
    setpoints: Setpoints,
    clock: PlantClock,
    watching_since: Time,
}

impl Autopilot {
    /// An autopilot that is not engaged.
    pub fn new(config: AutopilotConfig) -> Self {
        Self {
            accepted: Measurements::default(),
            navigation: Navigation::new(&config.navigation),
            frozen: FrozenDetector::new(config.frozen_after.as_secs_f64()),
            guidance: ActiveMode::None,
            targets: Targets::default(),
            capture: None,
            altimeter: config.altimeter,
            reference: AltitudeReference::PressureLevel,
            heading: HeadingLoop::new(config.heading),
            altitude: AltitudeLoop::new(config.altitude, &config.envelope),
            airspeed: AirspeedLoop::new(config.airspeed),
            setpoints: Setpoints::default(),
            clock: PlantClock::default(),
            watching_since: Time::NEVER,
            config,
        }
    }

    /// The configuration.
    pub const fn config(&self) -> &AutopilotConfig {
        &self.config
    }

    fn schedule(&self) -> Schedule {
        Schedule::at(
            self.navigation.estimate().airspeed_mps,
            self.config.reference_airspeed_mps,
        )
    }

    fn throttle_demand(&self, climb_rate_mps: f64) -> ThrottleDemand {
        let estimate = self.navigation.estimate();
        ThrottleDemand {
            airspeed_mps: self.targets.airspeed_mps,
            climb_rate_mps,
            load_factor: 1.0 / cos(estimate.roll_rad).max(0.5),
            least_throttle: self.config.envelope.least_throttle(estimate.airspeed_mps),
        }
    }

    /// Enters the mode given by the transition table, with the present targets.
    fn change_mode(&mut self, input: ModeInput) {
        let config = &self.config.guidance;
        if let Some(mode) = self.guidance.mode().after(input, config.mode()) {
            self.guidance = ActiveMode::enter(mode, config, self.targets);
        }
    }

    /// Engages the loops with the present throttle and surfaces.
    fn take_over(&mut self, standing: &Surfaces) {
        let estimate = *self.navigation.estimate();
        let schedule = self.schedule();
        self.heading
            .engage(standing.aileron, standing.rudder, &estimate, schedule);
        self.altitude.engage(standing.elevator, &estimate, schedule);
        let demand = self.throttle_demand(estimate.climb_rate_mps);
        self.airspeed.engage(standing.throttle, &demand, &estimate);
    }
}

impl Controller for Autopilot {
    type Measurements = Measurements;
    type Estimate = Estimate;
    type Setpoints = Setpoints;
    type Outputs = Surfaces;
    type Command = AutopilotCommand;

    fn estimate(&mut self, tick: &Tick, measurements: &Measurements) {
        plausibility_gate(&mut self.accepted, measurements, self.config.max_age);
        if self.plant_is(PlantState::Jumped) {
            // The aircraft was repositioned, so no distance from the last
            // values is implausible.
            self.accepted = Measurements::default();
            plausibility_gate(&mut self.accepted, measurements, self.config.max_age);
            self.navigation.reset(&self.config.navigation);
            self.frozen = FrozenDetector::new(self.config.frozen_after.as_secs_f64());
            self.clock = PlantClock::default();
            self.watching_since = Time::NEVER;
        }
        self.clock.step(tick, &self.accepted, self.config.max_age);
        self.navigation
            .step(tick.woke, &self.accepted, self.clock.step_s());
        self.frozen.step(
            tick.woke,
            &self.accepted,
            self.navigation.estimate(),
            self.clock.step_s(),
        );
        if self.watching_since.is_never() && self.stale(tick.woke).is_empty() {
            self.watching_since = tick.woke;
        }
    }

    fn engage_inhibits(&self, tick: &Tick, measurements: &Measurements) -> Flags {
        let estimate = self.navigation.estimate();
        (self.unsafe_to_fly(tick.woke, measurements) | self.not_permitted(measurements))
            .with(flags::PLANT_PAUSED, self.plant_is(PlantState::Paused))
            .with(
                flags::SETTLING,
                self.watching_since.is_never()
                    || tick.woke.since(self.watching_since) < self.config.settling,
            )
            .with(
                flags::TOO_SLOW,
                estimate.airspeed_mps < self.config.envelope.min_airspeed_mps,
            )
            .with(
                flags::UPSET,
                estimate.roll_rad.abs() > UPSET_RAD || estimate.pitch_rad.abs() > UPSET_RAD,
            )
    }

    fn faults(&self, tick: &Tick, measurements: &Measurements) -> Flags {
        self.unsafe_to_fly(tick.woke, measurements) | self.not_flyable(measurements)
    }

    fn conditions(&self, _tick: &Tick, measurements: &Measurements) -> Flags {
        self.external(measurements)
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
        self.guidance.mode() as u8
    }

    fn mode_name(mode: u8) -> &'static str {
        Mode::from_number(mode).map_or("unknown", Mode::name)
    }

    fn engage(&mut self, tick: &Tick, _measurements: &Measurements) {
        let estimate = *self.navigation.estimate();
        self.targets = Targets {
            airspeed_mps: self.config.envelope.allowed_airspeed(estimate.airspeed_mps),
            heading_rad: estimate.heading_rad,
            altitude_m: estimate.altitude_m,
        };
        self.reference = AltitudeReference::PressureLevel;
        self.navigation.mark_altitude();
        self.capture = Some(Capture::of(estimate.altitude_m));
        self.change_mode(ModeInput::Engage);
        let standing = self
            .accepted
            .surfaces
            .fresh(tick.woke, self.config.max_age)
            .unwrap_or(Surfaces {
                throttle: self.config.airspeed.trim_throttle,
                ..Surfaces::default()
            });
        self.take_over(&standing);
    }

    fn warm_up(&self, tick: &Tick, measurements: &Measurements) {
        let mut scratch = self.clone();
        scratch.estimate(tick, measurements);
        let _ = black_box(scratch.faults(tick, measurements));
        scratch.guide(tick, measurements);
        black_box(scratch.control(tick, measurements));
    }

    fn guide(&mut self, _tick: &Tick, _measurements: &Measurements) {
        let marked = self.navigation.marked_altitude_m();
        let shift_m = match (&mut self.capture, marked) {
            (Some(capture), Some(altitude_m)) => capture.shift_m(altitude_m),
            _ => 0.0,
        };
        self.guidance.shift_altitude(shift_m);
        if let Some(targets) = self.guidance.targets() {
            self.targets = targets;
        }
        self.guidance
            .advance(self.navigation.estimate(), self.clock.step_s());
    }

    fn control(&mut self, _tick: &Tick, _measurements: &Measurements) -> Surfaces {
        let estimate = *self.navigation.estimate();
        let (schedule, dt_s) = (self.schedule(), self.clock.step_s());
        let envelope = self.config.envelope;
        let to = self.targets;
        let (heading, altitude) = (&mut self.heading, &mut self.altitude);
        let lateral = heading.step(to.heading_rad, &estimate, &envelope, schedule, dt_s);
        let vertical = altitude.step(to.altitude_m, &estimate, &envelope, schedule, dt_s);
        let demand = self.throttle_demand(vertical.climb_rate_mps);
        let throttle = self.airspeed.step(&demand, &estimate, dt_s);
        self.setpoints = Setpoints {
            airspeed_mps: self.targets.airspeed_mps,
            heading_rad: wrap_two_pi(self.targets.heading_rad),
            altitude_m: self.targets.altitude_m,
            altitude_reference: self.reference,
            altitude_above_reference_m: self.targets.altitude_m - self.datum_m(),
            roll_rad: lateral.roll_rad,
            climb_rate_mps: vertical.climb_rate_mps,
            pitch_rad: vertical.pitch_rad,
            ..self.setpoints
        };
        Surfaces {
            throttle,
            elevator: vertical.elevator,
            aileron: lateral.aileron,
            rudder: lateral.rudder,
        }
    }

    /// Wings level while the attitude is known, level flight while the climb
    /// rate is; otherwise the trims that the loops had found; trim throttle,
    /// idle while thrust is reversed.
    fn failsafe(&mut self, tick: &Tick, measurements: &Measurements) -> Surfaces {
        let unusable = flags::unusable(self.stale(tick.woke), self.frozen());
        let throttle = if measurements.other_control.value.reverse_thrust {
            0.0
        } else {
            self.config.airspeed.trim_throttle
        };
        self.setpoints.roll_rad = 0.0;
        self.setpoints.climb_rate_mps = 0.0;
        if unusable.intersects(flags::ATTITUDE | flags::BODY_RATES) {
            self.setpoints.pitch_rad = 0.0;
            return Surfaces {
                throttle,
                elevator: self.altitude.trim(),
                aileron: self.heading.aileron_trim(),
                rudder: self.heading.rudder_trim(),
            };
        }
        let mut estimate = *self.navigation.estimate();
        if unusable.contains(flags::SPECIFIC_FORCE) {
            estimate.side_force_mps2 = 0.0;
        }
        let (schedule, dt_s) = (self.schedule(), self.clock.step_s());
        let envelope = self.config.envelope;
        let lateral = self.heading.hold_bank(0.0, &estimate, schedule, dt_s);
        let vertical = if unusable.intersects(flags::ALTITUDE | flags::SPECIFIC_FORCE) {
            self.altitude
                .hold_level_pitch(&estimate, &envelope, schedule, dt_s)
        } else {
            self.altitude
                .hold_climb_rate(0.0, &estimate, &envelope, schedule, dt_s)
        };
        self.setpoints.climb_rate_mps = vertical.climb_rate_mps;
        self.setpoints.pitch_rad = vertical.pitch_rad;
        Surfaces {
            throttle,
            elevator: vertical.elevator,
            aileron: lateral.aileron,
            rudder: lateral.rudder,
        }
    }

    fn disengage(&mut self) {
        self.change_mode(ModeInput::Disengage);
        self.capture = None;
        self.setpoints = Setpoints::default();
    }

    fn command(&mut self, command: &AutopilotCommand) {
        self.execute(command);
    }

    fn estimated(&self) -> Estimate {
        *self.navigation.estimate()
    }

    fn setpoints(&self) -> Setpoints {
        let mut guidance = self.guidance.progress();
        guidance.captured.heading_rad = wrap_two_pi(guidance.captured.heading_rad);
        Setpoints {
            guidance,
            altimeter_setting_pa: self.altimeter.setting_pa,
            ..self.setpoints
        }
    }

    fn outputs_are_valid(&self, outputs: &Surfaces) -> bool {
        outputs.is_valid()
    }

    fn plausible(&self, measurements: &Measurements) -> Flags {
        plausibility_gate(
            &mut self.accepted.clone(),
            measurements,
            self.config.max_age,
        )
    }

    fn switch(&self, measurements: &Measurements) -> Reading<Switch> {
        measurements.engage_switch
    }
}
