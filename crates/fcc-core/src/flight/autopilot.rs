//! The autopilot: navigation, guidance and control as one [`Controller`].

use core::fmt;
use core::time::Duration;

use libm::cos;

use super::control::{
    AirspeedConfig, AirspeedLoop, AltitudeConfig, AltitudeLoop, Envelope, HeadingConfig,
    HeadingLoop, Schedule, ThrottleDemand,
};
use super::guidance::{Targets, TimedPattern, TimedPatternConfig};
use super::navigation::{Estimate, Navigation, NavigationConfig, accept};
use super::{Measurements, PlantState, Setpoints, Surfaces};
use crate::blocks::{limit, wrap_pi, wrap_two_pi};
use crate::framework::{Controller, Flags, Reading, Switch, Tick, Time};

/// Everything about the autopilot that is the user's choice.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct AutopilotConfig {
    /// The airspeed at which the gains hold as they are, m/s.
    pub reference_airspeed_mps: f64,
    /// Older readings than this are a loss of their sensor.
    pub max_age: Duration,
    /// Navigation's time constants.
    pub navigation: NavigationConfig,
    /// What is flown once engaged.
    pub course: Course,
    /// Gains of the heading loop.
    pub heading: HeadingConfig,
    /// Gains of the altitude loop.
    pub altitude: AltitudeConfig,
    /// Gains of the airspeed loop.
    pub airspeed: AirspeedConfig,
    /// What the loops may ask of the aircraft.
    pub envelope: Envelope,
}

impl Default for AutopilotConfig {
    /// A Cessna 172 and the thesis' pattern.
    fn default() -> Self {
        Self {
            reference_airspeed_mps: 51.444_444, // 100 kt
            max_age: Duration::from_millis(250),
            navigation: NavigationConfig::default(),
            course: Course::TimedPattern(TimedPatternConfig::default()),
            heading: HeadingConfig::default(),
            altitude: AltitudeConfig::default(),
            airspeed: AirspeedConfig::default(),
            envelope: Envelope::default(),
        }
    }
}

/// What is flown once engaged.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Course {
    /// Keep what was captured, until ordered otherwise.
    Hold,
    /// The timed pattern of the thesis.
    TimedPattern(TimedPatternConfig),
}

/// What may be asked of the autopilot while it is engaged. Each changes one
/// set point, ends a pattern and keeps the other set points as they are.
#[derive(Clone, Copy, PartialEq, Debug)]
#[non_exhaustive]
pub enum Order {
    /// Indicated airspeed, m/s.
    Airspeed(f64),
    /// Magnetic heading, rad, turned to the shorter way.
    Heading(f64),
    /// Barometric altitude, m.
    Altitude(f64),
}

/// What may block engaging or fail the flight, as bits of
/// [`Flags`](crate::framework::Flags).
pub mod flags {
    use crate::framework::Flags;

    /// Pitch and roll are too old.
    pub const ATTITUDE: Flags = Flags::bit(0);
    /// The heading is too old.
    pub const HEADING: Flags = Flags::bit(1);
    /// The body rates are too old.
    pub const BODY_RATES: Flags = Flags::bit(2);
    /// The specific force is too old.
    pub const SPECIFIC_FORCE: Flags = Flags::bit(3);
    /// The airspeed is too old.
    pub const AIRSPEED: Flags = Flags::bit(4);
    /// The altitude is too old.
    pub const ALTITUDE: Flags = Flags::bit(5);
    /// The simulator's clock jumped.
    pub const PLANT_JUMPED: Flags = Flags::bit(6);
    /// The simulator is paused or stalled.
    pub const PLANT_HALTED: Flags = Flags::bit(7);
    /// Too slow to be flying.
    pub const TOO_SLOW: Flags = Flags::bit(8);
    /// Bank or pitch is beyond what may be taken over.
    pub const UPSET: Flags = Flags::bit(9);

    /// What each bit says, lowest first.
    pub(super) const NAMES: [&str; 10] = [
        "attitude is missing or too old",
        "heading is missing or too old",
        "body rates are missing or too old",
        "acceleration is missing or too old",
        "airspeed is missing or too old",
        "altitude is missing or too old",
        "simulator time jumped",
        "simulator is paused or stalled",
        "airspeed is below the floor",
        "bank or pitch is beyond 60 degrees",
    ];
}

/// Beyond this bank or pitch the autopilot does not take over, rad.
const UPSET_RAD: f64 = 1.047;

/// No single step of the plant's time is longer than this, s: after a gap, the
/// loops go on from what is, not from an extrapolation.
const MAX_STEP_S: f64 = 0.2;

/// Navigation, guidance and control as one [`Controller`].
#[derive(Clone, Debug)]
pub struct Autopilot {
    config: AutopilotConfig,
    /// The last measurements that can be true.
    accepted: Measurements,
    navigation: Navigation,
    course: Option<TimedPattern>,
    targets: Targets,
    heading: HeadingLoop,
    altitude: AltitudeLoop,
    airspeed: AirspeedLoop,
    setpoints: Setpoints,
    level_pitch_rad: f64,
    last: Surfaces,
    plant_time_s: Option<f64>,
    dt_s: f64,
}

impl Autopilot {
    /// An autopilot at rest.
    pub fn new(config: AutopilotConfig) -> Self {
        Self {
            accepted: Measurements::default(),
            navigation: Navigation::new(&config.navigation),
            course: None,
            targets: Targets::default(),
            heading: HeadingLoop::new(config.heading),
            altitude: AltitudeLoop::new(config.altitude, &config.envelope),
            airspeed: AirspeedLoop::new(config.airspeed),
            setpoints: Setpoints::default(),
            level_pitch_rad: 0.0,
            last: Surfaces::default(),
            plant_time_s: None,
            dt_s: 0.0,
            config,
        }
    }

    /// The configuration.
    pub const fn config(&self) -> &AutopilotConfig {
        &self.config
    }

    /// What navigation makes of the measurements.
    pub const fn estimated(&self) -> &Estimate {
        self.navigation.estimate()
    }

    /// The plant's time since the last tick: by its own clock if it has one,
    /// none while it is halted.
    fn plant_step_s(&mut self, tick: &Tick) -> f64 {
        let plant = self.accepted.plant;
        if plant.is_never() {
            return tick.dt_s.min(MAX_STEP_S);
        }
        let last = self.plant_time_s.replace(plant.value.time_s);
        match (plant.value.state, last) {
            (PlantState::Running | PlantState::Slow, Some(last)) => {
                limit(plant.value.time_s - last, 0.0, MAX_STEP_S)
            }
            _ => 0.0,
        }
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
            underspeed: self.config.envelope.is_underspeed(estimate.airspeed_mps),
        }
    }

    fn stale(&self, now: Time) -> Flags {
        let measurements = &self.accepted;
        let max_age = self.config.max_age;
        Flags::NONE
            .with(
                flags::ATTITUDE,
                !measurements.attitude.is_fresh(now, max_age),
            )
            .with(
                flags::HEADING,
                !measurements.heading_rad.is_fresh(now, max_age),
            )
            .with(
                flags::BODY_RATES,
                !measurements.body_rates.is_fresh(now, max_age),
            )
            .with(
                flags::SPECIFIC_FORCE,
                !measurements.specific_force.is_fresh(now, max_age),
            )
            .with(
                flags::AIRSPEED,
                !measurements.airspeed_mps.is_fresh(now, max_age),
            )
            .with(
                flags::ALTITUDE,
                !measurements.altitude_m.is_fresh(now, max_age),
            )
    }

    fn plant_is(&self, state: PlantState) -> bool {
        !self.accepted.plant.is_never() && self.accepted.plant.value.state == state
    }
}

impl Controller for Autopilot {
    type Measurements = Measurements;
    type Setpoints = Setpoints;
    type Outputs = Surfaces;
    type Order = Order;

    fn estimate(&mut self, tick: &Tick, measurements: &Measurements) {
        accept(&mut self.accepted, measurements);
        if self.plant_is(PlantState::Jumped) {
            self.navigation.reset(&self.config.navigation);
            self.plant_time_s = None;
        }
        self.dt_s = self.plant_step_s(tick);
        self.navigation.step(tick.woke, &self.accepted, self.dt_s);
    }

    fn blockers(&self, tick: &Tick, _measurements: &Measurements) -> Flags {
        let estimate = self.navigation.estimate();
        self.stale(tick.woke)
            .with(flags::PLANT_JUMPED, self.plant_is(PlantState::Jumped))
            .with(
                flags::PLANT_HALTED,
                self.plant_is(PlantState::Paused) || self.plant_is(PlantState::Stalled),
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

    fn faults(&self, tick: &Tick, _measurements: &Measurements) -> Flags {
        self.stale(tick.woke)
            .with(flags::PLANT_JUMPED, self.plant_is(PlantState::Jumped))
    }

    fn flag_name(bit: u32) -> &'static str {
        flags::NAMES
            .get(bit as usize)
            .copied()
            .unwrap_or("unknown condition")
    }

    fn write_order(order: &Order, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match order {
            Order::Airspeed(mps) => write!(f, "airspeed {mps:.1} m/s"),
            Order::Heading(rad) => write!(f, "heading {:.1}°", rad.to_degrees()),
            Order::Altitude(m) => write!(f, "altitude {m:.1} m"),
        }
    }

    fn engage(&mut self, tick: &Tick, _measurements: &Measurements) {
        let estimate = *self.navigation.estimate();
        let schedule = self.schedule();
        self.targets = Targets {
            airspeed_mps: estimate.airspeed_mps,
            heading_rad: estimate.heading_rad,
            altitude_m: estimate.altitude_m,
        };
        self.course = match self.config.course {
            Course::Hold => None,
            Course::TimedPattern(config) => Some(TimedPattern::begin(config, self.targets)),
        };
        let standing = self
            .accepted
            .surfaces
            .fresh(tick.woke, self.config.max_age)
            .unwrap_or(Surfaces {
                throttle: self.config.airspeed.trim_throttle,
                ..Surfaces::default()
            });
        self.heading
            .engage(standing.aileron, standing.rudder, &estimate, schedule);
        self.altitude.engage(standing.elevator, &estimate, schedule);
        let demand = self.throttle_demand(estimate.climb_rate_mps);
        self.airspeed.engage(standing.throttle, &demand, &estimate);
        self.level_pitch_rad = estimate.pitch_rad;
        self.last = standing;
    }

    fn guide(&mut self, _tick: &Tick, _measurements: &Measurements) {
        if let Some(pattern) = &mut self.course {
            self.targets = pattern.step(self.dt_s);
        }
    }

    fn control(&mut self, _tick: &Tick, _measurements: &Measurements) -> Surfaces {
        let estimate = *self.navigation.estimate();
        let (schedule, dt_s) = (self.schedule(), self.dt_s);
        let envelope = self.config.envelope;
        let lateral = self.heading.step(
            self.targets.heading_rad,
            &estimate,
            &envelope,
            schedule,
            dt_s,
        );
        let vertical = self.altitude.step(
            self.targets.altitude_m,
            &estimate,
            &envelope,
            schedule,
            dt_s,
        );
        let demand = self.throttle_demand(vertical.climb_rate_mps);
        let throttle = self.airspeed.step(&demand, &estimate, dt_s);
        self.setpoints = Setpoints {
            airspeed_mps: self.targets.airspeed_mps,
            heading_rad: wrap_two_pi(self.targets.heading_rad),
            altitude_m: self.targets.altitude_m,
            roll_rad: lateral.roll_rad,
            climb_rate_mps: vertical.climb_rate_mps,
            pitch_rad: vertical.pitch_rad,
        };
        self.last = Surfaces {
            throttle,
            elevator: vertical.elevator,
            aileron: lateral.aileron,
            rudder: lateral.rudder,
        };
        self.last
    }

    /// Wings level and the pitch of engagement while the attitude is known,
    /// neutral aileron and the last trim when it is not; trim throttle.
    fn failsafe(&mut self, tick: &Tick, _measurements: &Measurements) -> Surfaces {
        let gone = self.stale(tick.woke);
        let throttle = self.config.airspeed.trim_throttle;
        let attitude_is_known = (gone.bits() & (flags::ATTITUDE | flags::BODY_RATES).bits()) == 0;
        self.setpoints.roll_rad = 0.0;
        self.setpoints.climb_rate_mps = 0.0;
        self.setpoints.pitch_rad = self.level_pitch_rad;
        if !attitude_is_known {
            return Surfaces {
                throttle,
                elevator: self.altitude.trim(),
                aileron: self.heading.aileron_trim(),
                rudder: self.heading.rudder_trim(),
            };
        }
        let mut estimate = *self.navigation.estimate();
        if gone.contains(flags::SPECIFIC_FORCE) {
            estimate.side_force_mps2 = 0.0;
        }
        let (schedule, dt_s) = (self.schedule(), self.dt_s);
        let lateral = self.heading.hold_bank(0.0, &estimate, schedule, dt_s);
        let vertical = self.altitude.hold_pitch(
            self.level_pitch_rad,
            &estimate,
            &self.config.envelope,
            schedule,
            dt_s,
        );
        Surfaces {
            throttle,
            elevator: vertical.elevator,
            aileron: lateral.aileron,
            rudder: lateral.rudder,
        }
    }

    fn disengage(&mut self) {
        self.course = None;
        self.setpoints = Setpoints::default();
    }

    fn command(&mut self, order: &Order) {
        match *order {
            Order::Airspeed(mps) if mps.is_finite() => {
                self.targets.airspeed_mps = limit(
                    mps,
                    self.config.envelope.min_airspeed_mps,
                    self.config.envelope.max_airspeed_mps,
                );
            }
            Order::Heading(rad) if rad.is_finite() => {
                self.targets.heading_rad += wrap_pi(rad - self.targets.heading_rad);
            }
            Order::Altitude(m) if m.is_finite() => self.targets.altitude_m = m,
            _ => return,
        }
        self.course = None;
    }

    fn setpoints(&self) -> Setpoints {
        self.setpoints
    }

    fn outputs_are_valid(&self, outputs: &Surfaces) -> bool {
        outputs.is_valid()
    }

    fn switch(&self, measurements: &Measurements) -> Reading<Switch> {
        measurements.engage_switch
    }
}
