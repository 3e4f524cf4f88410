//! Several sensors of one kind: the first that is not bad is used.

use nalgebra::Vector3;

use super::readings::{force_in, rates_in};
use super::{FoundBy, RawNavigation, Units, WrongSensor};
use fcc_core::flight::{MagneticField, Measurements};
use fcc_core::framework::{Reading, ReadingSet, Readings, Time};

/// The readings of an inertial unit.
const FORCE: ReadingSet = ReadingSet::named(Measurements::NAMES, &["raw acceleration"]);
const RATES: ReadingSet = ReadingSet::named(Measurements::NAMES, &["raw body rates"]);

/// Gyroscopes that are left after such a rate, rad/s (290 °/s), have ruined the attitude: an
/// aircraft that really spins would have to be found anew, too.
const SPINS_RADPS: f64 = 5.0;
/// Of the fastest rate this share is kept from sample to sample.
const KEPT_SHARE: f64 = 0.98;

impl RawNavigation {
    /// Follows the fastest rate of the latest seconds.
    pub(super) fn follow_rates(&mut self, rates: [f64; 3]) {
        let now_radps = distance(rates, [0.0; 3]);
        self.fastest_radps = now_radps.max(KEPT_SHARE * self.fastest_radps);
    }

    /// Of a sensor's plausible readings those that may be used: gyroscopes that the magnetic
    /// field contradicts are left for those of the next sensor, with the accelerometers of
    /// the same unit, and so are those that repeat themselves, and any sensor that is wrong
    /// where another of its kind is not.
    pub fn permitted(&self, sensor: u8, plausible: ReadingSet) -> ReadingSet {
        self.sensors
            .permitted(sensor, plausible)
            .keeping(FORCE, !self.accelerometers.is_left(sensor))
            .keeping(RATES, !self.gyroscopes.is_left(sensor))
    }

    /// Takes what one of several sensors measures, before one is chosen for each reading.
    /// It changes what is permitted, and nothing else: a recording has the readings that
    /// were used.
    pub fn observe_sensor(&mut self, sensor: u8, measured: &Measurements) {
        self.sensors.observe(sensor, measured);
    }

    /// Whether an inertial unit was left for another one.
    pub const fn left_a_unit(&self) -> bool {
        self.accelerometers.left_one() || self.gyroscopes.left_one()
    }

    /// Whether a magnetometer, a barometer or a receiver was found to be wrong.
    pub fn has_wrong_sensor(&self) -> bool {
        self.sensors.has_wrong_sensor()
    }

    /// Which of several sensors is not used any more since the last step.
    pub const fn wrong_sensor(&self) -> Option<WrongSensor> {
        self.wrong
    }

    /// Compares the sensors after a step of the method at a time.
    pub(super) fn judge_sensors(&mut self, at: Time) {
        let filter = (!self.gyroscope.is_doubted()).then_some(&self.filter);
        self.sensors.follow(&self.used);
        self.sensors.judge(at, filter);
        self.filter.set_compared(self.sensors.is_trying());
        self.wrong = self.sensors.take_found().or(self.wrong);
    }

    /// Follows which of them the readings of a tick are of, and whether these repeat
    /// themselves.
    pub(super) fn follow_units(
        &mut self,
        raw: &Measurements,
        repeats_force: bool,
        repeats_rates: bool,
    ) {
        let (force, rates) = (raw.raw_specific_force, raw.raw_body_rates);
        self.wrong = None;
        let other = |of: &mut Units, taken: Time, sensor| {
            (!taken.is_never()).then(|| of.use_of(sensor)).flatten()
        };
        let left_force = other(&mut self.accelerometers, force.taken, force.source);
        let left_rates = other(&mut self.gyroscopes, rates.taken, rates.source);
        if left_force.is_some() {
            let before = force_in(&self.used.raw_specific_force.value);
            self.filter
                .change_accelerometers(distance(force_in(&force.value), before));
        }
        if left_rates.is_some() {
            self.gyroscope.change();
            self.change_gyroscopes(rates_in(&rates.value));
        }
        if let Some((sensor, by)) = left_rates.or(left_force) {
            self.wrong = self.sensors.leave_unit(sensor, by);
        }
        let is_one_unit = force.source == rates.source;
        let rates_why = if repeats_rates || (repeats_force && is_one_unit) {
            Some(FoundBy::Repeats)
        } else {
            self.doubts_gyroscopes().then_some(FoundBy::MagneticField)
        };
        let force_why = repeats_force.then_some(FoundBy::Repeats);
        self.gyroscopes.judge(rates_why);
        self.accelerometers
            .judge(force_why.or(rates_why.filter(|_| is_one_unit)));
    }

    /// From here on the rates are those of other gyroscopes.
    fn change_gyroscopes(&mut self, rates: [f64; 3]) {
        let before = rates_in(&self.used.raw_body_rates.value);
        if self.fastest_radps > SPINS_RADPS {
            self.filter.restart();
        } else {
            self.filter.change_gyroscopes(distance(rates, before));
        }
        self.fastest_radps = 0.0;
    }

    /// Follows which magnetometer is used, after a sample of another one perhaps than the one
    /// before.
    pub(super) fn follow_magnetometers(&mut self, before: &Reading<MagneticField>) {
        if !before.is_never() && before.source != self.used.magnetic_field.source {
            self.filter.change_magnetometer();
        }
    }
}

/// The distance of two vectors.
fn distance(one: [f64; 3], other: [f64; 3]) -> f64 {
    (Vector3::from(one) - Vector3::from(other)).norm()
}
