//! An error-state Kalman filter (Solà 2017, *Quaternion kinematics for the
//! error-state Kalman filter*, arXiv 1711.02508): 25 states.
//!
//! | states | unit | source of what is known |
//! |---|---|---|
//! | attitude, as a rotation in earth axes | rad | gravity, acceleration, field |
//! | velocity; position | m/s; m | receiver, airspeed, barometer |
//! | biases of gyroscopes, accelerometers | rad/s, m/s² | rest; everything over time |
//! | bias of the barometer | m | the receiver's altitude |
//! | the earth's and the aircraft's magnetic field | µT | a model; turning |
//! | wind, north and east | m/s | airspeed with a receiver |
//! | lateness of a receiver's fixes | s | turns and changes of speed |
//!
//! A sample is used at the time at which it was taken: the filter runs behind
//! the present by the longest delay ([`KalmanConfig::delay`]), and the estimate
//! is predicted from there with the inertial samples since (as the delayed
//! horizon of PX4's EKF2). In a step nothing is allocated.

#![allow(
    clippy::indexing_slicing,
    reason = "of matrices of a fixed size, by the constants of `filter`"
)]

mod air;
mod align;
mod align_in_flight;
mod by_field;
mod displacement;
mod drift;
mod filter;
mod history;
mod in_flight;
mod innovations;
mod inputs;
mod magnetic;
mod motion;
mod noise;
mod output;
mod parameters;
mod path;
mod receiver;
mod refused_velocity;
mod rest;
mod scatter;
mod states;
mod track;
mod trend;
mod unaided;
mod update;

use core::time::Duration;

use align::Alignment;
use filter::Filter;
pub(super) use filter::GAP_S;
use history::{History, Sample};
use inputs::Inputs;
use rest::Rest;

pub use innovations::Innovation;
pub(super) use motion::turn;

use super::{GeodeticPosition, InertialNavigation, Observation, ObservationKind, Solution};
use fcc_core::framework::Time;

/// What the filter knows beforehand of the sensors and the place.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct KalmanConfig {
    /// By how much the latest sample of any sensor comes after it was taken.
    /// Samples that are later still are used as well as they can. Up to half a
    /// second: inertial samples are kept for that long.
    pub delay: Duration,
    /// The earth's magnetic field here, north, east, down, µT (from the World
    /// Magnetic Model): headings are true then. Otherwise the field's direction
    /// is called north, and headings are magnetic.
    pub earth_field_ut: Option<[f64; 3]>,
}

/// Navigation by a Kalman filter.
///
/// ```
/// use fcc_navigation::inertial::{
///     InertialNavigation, KalmanConfig, KalmanNavigation, Observation,
/// };
/// use fcc_core::framework::Time;
///
/// let mut navigation = KalmanNavigation::new(KalmanConfig::default());
/// let mut solution = navigation.step(Time::from_nanos(0));
/// for sample in 0..500 {
///     let now = Time::from_nanos(sample * 10_000_000);
///     navigation.observe(now, Observation::Rates([0.0, 0.0, 0.001]));
///     // At rest with the right wing down by 30°.
///     navigation.observe(now, Observation::SpecificForce([0.0, -4.903, -8.493]));
///     solution = navigation.step(now);
/// }
/// let [w, x, _, _] = solution.quaternion;
/// assert!((2.0 * x.atan2(w)).to_degrees().round() == 30.0);
/// assert!(solution.sigma.roll_rad.to_degrees() < 2.0);
/// ```
#[derive(Clone, Debug)]
pub struct KalmanNavigation {
    config: KalmanConfig,
    history: History,
    inputs: Inputs,
    /// `None` once the filter runs.
    alignment: Option<Alignment>,
    rest: Rest,
    filter: Filter,
    origin: GeodeticPosition,
}

impl KalmanNavigation {
    /// Before the first sample.
    pub fn new(config: KalmanConfig) -> Self {
        Self {
            config,
            history: History::new(),
            inputs: Inputs::new(),
            alignment: Some(Alignment::new()),
            rest: Rest::new(),
            filter: Filter::new(),
            origin: GeodeticPosition {
                latitude_rad: 0.0,
                longitude_rad: 0.0,
                altitude_m: f64::NAN,
            },
        }
    }

    /// What the measurements of the last step differed by from what was expected
    /// of them; each once, and not those that came more often than they are
    /// used.
    pub fn innovations(&self) -> &[Innovation] {
        self.filter.innovations.as_slice()
    }

    /// The earth's magnetic field here, north, east, down, µT, if it becomes
    /// known only now: what was called north until then is turned to true north.
    pub fn learn_earth_field(&mut self, field_ut: [f64; 3]) {
        self.config.earth_field_ut = Some(field_ut);
        if self.alignment.is_none() {
            self.filter.learn_earth_field(field_ut);
        }
    }

    /// From here on what is observed as rates is how the magnetic field turns, or that
    /// of gyroscopes again. Attitude and velocity were integrated from wrong ones
    /// before.
    pub fn turn_by_field(&mut self, turns_by_field: bool) {
        self.filter.turn_by_field(turns_by_field);
    }

    /// Begins anew, with what is known beforehand.
    pub fn restart(&mut self) {
        *self = Self::new(self.config);
    }

    /// From here on the rates are those of other gyroscopes, which differ from those before
    /// by so much, rad/s.
    pub fn change_gyroscopes(&mut self, differ: f64) {
        self.filter.change_gyroscopes(differ);
    }

    /// From here on the specific force is that of other accelerometers, which differ from
    /// those before by so much, m/s².
    pub fn change_accelerometers(&mut self, differ: f64) {
        self.filter.change_accelerometers(differ);
    }

    /// From here on the magnetic field is that of another magnetometer.
    pub fn change_magnetometer(&mut self) {
        self.filter.change_magnetometer();
    }

    /// Whether the receiver's velocities are not used because its own places, or air and
    /// compass, contradict them.
    pub fn refuses_velocity(&self) -> bool {
        self.filter.refuses_velocity()
    }

    /// Forgets the samples of a sensor that wait until they are used.
    pub fn forget(&mut self, kind: ObservationKind) {
        self.history.remove(kind);
    }

    /// Whether another filter tells which of two sensors is wrong: this one does not doubt
    /// itself early then, so that what is wrong shows.
    pub(super) const fn set_compared(&mut self, is_compared: bool) {
        self.filter.is_compared = is_compared;
    }

    /// From here on the static pressure is that of another barometer.
    pub fn change_barometer(&mut self) {
        self.filter.change_barometer();
    }

    /// Uses what has waited for the delay. The estimate of the present is not made.
    pub(super) fn catch_up(&mut self, now: Time) {
        self.filter.innovations.clear();
        let delay = i64::try_from(self.config.delay.as_nanos()).unwrap_or(i64::MAX);
        let until = Time::from_nanos(now.as_nanos().saturating_sub(delay));
        while let Some(sample) = self.history.pop(until) {
            self.process(sample);
        }
        self.filter.settle();
    }

    /// The biases of gyroscopes, rad/s, and accelerometers, m/s².
    pub(super) fn biases(&self) -> [[f64; 3]; 2] {
        [self.filter.rate_bias.into(), self.filter.force_bias.into()]
    }

    fn process(&mut self, sample: Sample) {
        if let Some(step) = self.inputs.take(&sample, &self.history, 0) {
            self.rest_or_advance(&step);
        }
        if self.alignment.is_some() {
            self.align(&sample);
            return;
        }
        self.use_measurement(&sample);
    }

    fn rest_or_advance(&mut self, step: &inputs::Step) {
        self.filter.time = step.now;
        if let Some(alignment) = &mut self.alignment {
            alignment.step(step);
            return;
        }
        self.filter.advance(&step.reading, step.dt_s);
        let mut is_still = false;
        if let (Some(rates), Some(force)) = (step.reading.rates, step.reading.force) {
            is_still = self.rest.step(step.now, rates, force, step.dt_s);
        }
        if is_still && !self.filter.is_moving() {
            let still_s = self.rest.still_s(step.now);
            self.filter.stands_still(step.now, self.rest.rates, still_s);
        }
        self.filter.velocity_ends(step.now);
    }

    fn align(&mut self, sample: &Sample) {
        let Some(alignment) = &mut self.alignment else {
            return;
        };
        if let Observation::MagneticField(field) = sample.observation {
            alignment.add_field(field);
        }
        if let Observation::StaticPressure(pressure_pa) = sample.observation {
            self.filter.static_pressure(sample.taken, pressure_pa, 0.0);
        }
        if alignment.is_complete() {
            let field = alignment.finish(&mut self.filter);
            self.alignment = None;
            if let Some(field) = field {
                let (now, model) = (self.filter.time, self.config.earth_field_ut);
                self.filter.magnetic_field(now, field, 0.0, model);
            }
        }
    }

    fn use_measurement(&mut self, sample: &Sample) {
        let filter = &mut self.filter;
        let after_s = signed_s(sample.taken, filter.time);
        let taken = sample.taken;
        let is_fix = matches!(
            sample.observation,
            Observation::Position(_) | Observation::Velocity(_)
        );
        // Too late to be of use.
        if after_s < -5.0 * GAP_S && !(is_fix && filter.path.knows(taken)) {
            return;
        }
        let is_soon = |track: track::Track| {
            /// More often than this, s, is not looked at: errors last longer.
            const LEAST_INTERVAL_S: f64 = 0.018;
            track.since_tried_s(taken) < LEAST_INTERVAL_S
        };
        match sample.observation {
            Observation::MagneticField(field) if !is_soon(filter.tracks.field) => {
                filter.magnetic_field(taken, field, after_s, self.config.earth_field_ut);
            }
            Observation::StaticPressure(pa) if !is_soon(filter.tracks.barometer) => {
                filter.static_pressure(taken, pa, after_s);
            }
            Observation::DifferentialPressure(pa) if !is_soon(filter.tracks.airspeed) => {
                filter.differential_pressure(taken, pa, after_s);
            }
            Observation::Airspeed(mps) if !is_soon(filter.tracks.airspeed) => {
                filter.airspeed(sample.observation.kind(), taken, mps, after_s);
            }
            Observation::Position(place) => {
                let is_first = !filter.motion.is_located;
                filter.position(taken, place, after_s);
                if is_first {
                    self.origin = filter.motion.place;
                }
            }
            Observation::Velocity(velocity) => filter.velocity(taken, velocity, after_s),
            _ => {}
        }
    }
}

impl InertialNavigation for KalmanNavigation {
    fn observe(&mut self, taken: Time, observation: Observation) {
        if taken.is_never() || !observation.is_finite() {
            return;
        }
        // A full history: more samples than it is for, so the oldest are used
        // before their time.
        let sample = Sample { taken, observation };
        if !self.history.insert(sample)
            && let Some(oldest) = self.history.pop(Time::NEVER)
        {
            self.process(oldest);
            self.history.insert(sample);
        }
    }

    fn step(&mut self, now: Time) -> Solution {
        self.catch_up(now);
        if self.origin.altitude_m.is_nan() && !self.filter.time.is_never() {
            self.origin.altitude_m = self.filter.motion.place.altitude_m;
        }
        self.solution(now)
    }
}

/// From one instant to another, s; negative if it is earlier.
fn signed_s(to: Time, from: Time) -> f64 {
    if to >= from {
        to.since(from).as_secs_f64()
    } else {
        -from.since(to).as_secs_f64()
    }
}

/// A time that is by so much earlier.
fn earlier(time: Time, by_s: f64) -> Time {
    let by = Duration::from_secs_f64(by_s.abs());
    if by_s < 0.0 { time + by } else { time - by }
}
