//! Navigation from raw sensors in flight: what the raw readings of each tick say
//! of attitude, heading, rates, specific force, airspeed and altitude, in the
//! place of sensors that measure these.

mod by_field;
mod compared;
mod config;
mod consistency;
mod late_fixes;
mod outliers;
mod range_end;
mod readings;
mod receiver;
mod repeats;
mod sensor_kind;
mod sensor_monitor;
mod several;
mod trial;

pub use config::{MagneticNorth, RawNavigationConfig};
use late_fixes::LateFixes;
use libm::atan2;
use outliers::Outliers;
use range_end::RangeEnd;
use readings::{
    attitude_of, either, field_in, force_in, force_of, is_certain, is_elsewhere, is_new, rates_in,
    rates_of,
};
use repeats::Repeats;
use sensor_monitor::SensorMonitor;

pub use sensor_kind::SensorKind;
pub use sensor_monitor::{FoundBy, WrongSensor};

use super::field_rates::FieldRates;
use super::gyroscope_monitor::GyroscopeMonitor;
use super::units::Units;
use super::{
    InertialNavigation, Innovation, KalmanConfig, KalmanNavigation, Observation, Solution,
};
use crate::{RATES_RADPS, SPECIFIC_FORCE_MPS2, is_possible_fix};
use fcc_core::blocks::wrap_two_pi;
use fcc_core::flight::atmosphere::{calibrated_airspeed_mps, pressure_altitude_m};
use fcc_core::flight::orientation::euler_from_quaternion;
use fcc_core::flight::{BodyRates, Measurements};
use fcc_core::framework::{Reading, Time};

/// A heading less certain than this is none, rad.
const USABLE_HEADING: f64 = 0.35;

/// Computes from the raw readings of each tick what control needs.
///
/// | of | from |
/// |---|---|
/// | attitude, heading | the filter, at the time of the latest sample of the gyroscopes |
/// | body rates, specific force | gyroscopes and accelerometers, without the biases that the filter found |
/// | altitude | static pressure, by the standard atmosphere |
/// | airspeed | differential pressure |
/// | position, velocity | the satellite receiver, as it gives them; the filter, if they come more than half a second late |
///
/// Readings that sensors give of these themselves are not used, except airspeed
/// and altitude where there is no raw reading of their pressure, and position
/// and velocity without a receiver. An attitude or a heading that is less
/// certain than 8.6° and 20° (one standard deviation) is left out, and counts as
/// lost after a while.
///
/// ```
/// use core::time::Duration;
/// use fcc_navigation::inertial::{MagneticNorth, RawNavigation, RawNavigationConfig};
/// use fcc_core::flight::{BodyRates, MagneticField, Measurements, SpecificForce};
/// use fcc_core::framework::{Reading, Time};
///
/// let mut navigation = RawNavigation::new(RawNavigationConfig {
///     delay: Duration::from_millis(200),
///     north: MagneticNorth::Field([20.0, 0.0, 40.0]),
/// });
/// // At rest, and the nose points east.
/// let mut found = Measurements::default();
/// for tick in 0..400 {
///     let now = Time::from_nanos(tick * 25_000_000);
///     let field = MagneticField { y_ut: -20.0, z_ut: 40.0, ..MagneticField::default() };
///     let force = SpecificForce { z_mps2: -9.81, ..SpecificForce::default() };
///     let raw = Measurements {
///         raw_body_rates: Reading::new(BodyRates::default(), now),
///         raw_specific_force: Reading::new(force, now),
///         magnetic_field: Reading::new(field, now),
///         ..Measurements::default()
///     };
///     found = *navigation.step(now, &raw);
/// }
/// assert!(found.attitude.value.roll_rad.abs() < 0.01);
/// assert_eq!(found.heading_rad.value.to_degrees().round(), 90.0);
/// ```
#[derive(Clone, Debug)]
pub struct RawNavigation {
    config: RawNavigationConfig,
    filter: KalmanNavigation,
    /// Those that were used last.
    used: Measurements,
    repeats: Repeats,
    force_outliers: Outliers,
    rate_outliers: Outliers,
    range_end: RangeEnd,
    accelerometers: Units,
    gyroscopes: Units,
    sensors: SensorMonitor,
    /// Of several the one that is not used any more since the last step.
    wrong: Option<WrongSensor>,
    late_fixes: LateFixes,
    /// The gyroscopes' last sample, used or not.
    rates_read: Reading<BodyRates>,
    /// The fastest of the latest rates that were used, rad/s.
    fastest_radps: f64,
    gyroscope: GyroscopeMonitor,
    field_rates: FieldRates,
    /// Since when gyroscopes are doubted, if they are.
    by_field_since: Time,
    /// Whether the model has given the field at the first fix.
    knows_field: bool,
    /// How far magnetic north is to the east of the filter's, rad.
    declination_rad: f64,
    /// That of the last step.
    solution: Solution,
    found: Measurements,
}

impl RawNavigation {
    /// Before the first reading.
    pub fn new(config: RawNavigationConfig) -> Self {
        let field = match config.north {
            MagneticNorth::Field(field) => Some(field),
            MagneticNorth::ModelOf(_) => None,
        };
        let kalman = KalmanConfig {
            delay: config.delay,
            earth_field_ut: field,
        };
        Self {
            config,
            filter: KalmanNavigation::new(kalman),
            used: Measurements::default(),
            repeats: Repeats::default(),
            force_outliers: Outliers::beyond(&SPECIFIC_FORCE_MPS2),
            rate_outliers: Outliers::beyond(&RATES_RADPS),
            range_end: RangeEnd::default(),
            accelerometers: Units::default(),
            gyroscopes: Units::default(),
            sensors: SensorMonitor::default(),
            wrong: None,
            late_fixes: LateFixes::default(),
            rates_read: Reading::default(),
            fastest_radps: 0.0,
            gyroscope: GyroscopeMonitor::new(),
            field_rates: FieldRates::default(),
            by_field_since: Time::NEVER,
            knows_field: false,
            declination_rad: field.map_or(0.0, declination_rad),
            solution: Solution::UNKNOWN,
            found: Measurements::default(),
        }
    }

    /// The measurements of the last step, with what they say.
    pub const fn found(&self) -> &Measurements {
        &self.found
    }

    /// Whether the gyroscopes are not used, because the magnetic field turns otherwise
    /// than they say.
    pub const fn doubts_gyroscopes(&self) -> bool {
        self.gyroscope.is_doubted()
    }

    /// Whether the magnetic field contradicts the gyroscopes, and it is not known yet which of
    /// them is wrong.
    pub const fn questions_gyroscopes(&self) -> bool {
        self.gyroscope.is_questioned()
    }

    /// Whether there is an attitude: not for a moment after gyroscopes began to be
    /// doubted, and then by the magnetic field.
    pub fn knows_attitude(&self) -> bool {
        !self.doubts_gyroscopes() || self.settled_by_field(self.found.attitude.taken)
    }

    /// Whether the gyroscopes cannot be compared with the magnetic field yet, and soon
    /// will be: some 10 s after the start, 20 s at most.
    pub fn awaits_field(&self) -> bool {
        self.gyroscope.awaits_field(self.latest_inertial())
    }

    /// What the filter found at the latest inertial sample; its headings are true
    /// if the declination is known.
    pub const fn solution(&self) -> &Solution {
        &self.solution
    }

    /// The standard deviation of roll and pitch, rad; 0 before it is known.
    pub fn tilt_sigma_rad(&self) -> f64 {
        let sigma = &self.solution.sigma;
        sigma.roll_rad.max(sigma.pitch_rad).max(0.0)
    }

    /// How the measurements differed from what was expected of them, since the
    /// inertial sample before that.
    pub fn innovations(&self) -> &[Innovation] {
        self.filter.innovations()
    }

    /// Takes the measurements of a tick; those, with what they say in the place
    /// of what was measured.
    pub fn step(&mut self, now: Time, measured: &Measurements) -> &Measurements {
        if is_elsewhere(measured) && !is_elsewhere(&self.found) {
            *self = Self::new(self.config);
        }
        let before = self.latest_inertial();
        self.observe(now, measured);
        let at = self.latest_inertial();
        let (mut attitude, mut heading) = (self.found.attitude, self.found.heading_rad);
        let (mut rates, mut force) = (self.found.body_rates, self.found.specific_force);
        if at > before {
            let solution = self.filter.step(at);
            if self.doubts_gyroscopes() && !self.settled_by_field(at) {
                (attitude, heading) = (Reading::default(), Reading::default());
            } else {
                attitude = attitude_of(&solution, at).unwrap_or(attitude);
                heading = self.heading_of(&solution, at).unwrap_or(heading);
            }
            rates = rates_of(&self.used.raw_body_rates, &solution);
            force = force_of(&self.used.raw_specific_force, &solution);
            self.solution = solution;
            let witness = &mut self.gyroscope.witness;
            witness.add_innovations(self.filter.innovations());
            self.judge_sensors(at);
        }
        self.follow_late_fixes(now);
        let fix = self.used.gnss;
        let (position, mut velocity) = self.present().unwrap_or_else(|| {
            (
                either(fix, |fix| fix.position, measured.position),
                either(fix, |fix| fix.velocity, measured.velocity),
            )
        });
        let down_mps = self.solution.velocity_mps[2];
        if self.repeats.is_down_old() && down_mps.is_finite() {
            velocity.value.down_mps = down_mps;
        }
        self.found = Measurements {
            attitude,
            heading_rad: heading,
            body_rates: rates,
            specific_force: force,
            altitude_m: either(
                self.used.static_pressure_pa,
                pressure_altitude_m,
                measured.altitude_m,
            ),
            airspeed_mps: either(
                self.used.differential_pressure_pa,
                |pressure_pa| calibrated_airspeed_mps(pressure_pa.max(0.0)),
                measured.airspeed_mps,
            ),
            position,
            velocity,
            ..*measured
        };
        &self.found
    }

    /// Passes the new plausible readings on, and none that a sensor only repeats.
    fn observe(&mut self, now: Time, raw: &Measurements) {
        let (f, r, m) = (
            raw.raw_specific_force,
            raw.raw_body_rates,
            raw.magnetic_field,
        );
        let force = force_in(&f.value);
        let rates = rates_in(&r.value);
        let field = field_in(&m.value);
        let repeats = self
            .repeats
            .step(raw, [force, rates, field], &self.used.gnss);
        self.follow_units(raw, repeats.force, repeats.rates);
        if !self.force_outliers.is_one(f.taken, force)
            && !repeats.force
            && is_new(&mut self.used.raw_specific_force, &f, now)
        {
            let force = self.restored_force(&r);
            self.take(f.taken, Observation::SpecificForce(force));
        }
        if !self.rate_outliers.is_one(r.taken, rates)
            && !repeats.rates
            && is_new(&mut self.rates_read, &r, now)
            && self.gyroscope.add_rates(r.taken, rates, &self.solution)
        {
            self.used.raw_body_rates = r;
            self.follow_rates(rates);
            self.take(r.taken, Observation::Rates(rates));
        }
        let before = self.used.magnetic_field;
        if !repeats.field && is_new(&mut self.used.magnetic_field, &m, now) {
            self.follow_magnetometers(&before);
            self.gyroscope.add_field(m.taken, field, &self.solution);
            self.turn_by_field(m.taken, field);
            self.take(m.taken, Observation::MagneticField(field));
        }
        let pressure = raw.static_pressure_pa;
        if is_new(&mut self.used.static_pressure_pa, &pressure, now) {
            self.take(pressure.taken, Observation::StaticPressure(pressure.value));
        }
        let pressure = raw.differential_pressure_pa;
        if is_new(&mut self.used.differential_pressure_pa, &pressure, now) {
            let observation = Observation::DifferentialPressure(pressure.value);
            self.take(pressure.taken, observation);
        }
        if !self.repeats.is_same_place
            && is_possible_fix(&raw.gnss.value)
            && is_new(&mut self.used.gnss, &raw.gnss, now)
        {
            self.take_fix(raw.gnss.taken, &raw.gnss.value);
        }
    }

    /// When the gyroscopes that are used, or without them the accelerometers, were last
    /// sampled.
    const fn latest_inertial(&self) -> Time {
        let (rates, force) = (
            self.used.raw_body_rates.taken,
            self.used.raw_specific_force.taken,
        );
        if rates.is_never() || self.doubts_gyroscopes() {
            force
        } else {
            rates
        }
    }

    fn take(&mut self, taken: Time, observation: Observation) {
        self.sensors.share(taken, observation);
        self.filter.observe(taken, observation);
    }

    fn heading_of(&self, solution: &Solution, at: Time) -> Option<Reading<f64>> {
        let heading_rad = euler_from_quaternion(solution.quaternion).heading_rad;
        let is_known =
            heading_rad.is_finite() && is_certain(solution.sigma.heading_rad, USABLE_HEADING);
        is_known.then(|| Reading::new(wrap_two_pi(heading_rad - self.declination_rad), at))
    }
}

fn declination_rad([north, east, _]: [f64; 3]) -> f64 {
    atan2(east, north)
}

#[cfg(test)]
mod tests;
