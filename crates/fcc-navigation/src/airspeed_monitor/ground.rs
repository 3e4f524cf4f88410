//! The airspeed sensor compared with the velocity over the ground and the wind.

use libm::{fabs, hypot};

use super::super::airspeed_filter::AirspeedFilter;
use super::super::airspeed_reason::{Doubt, DoubtReason};
use super::super::filter_bank::FilterBank;
use super::super::force_sample::ForceSample;
use super::super::scalar_update::squared;
use super::super::wind::OverGround;
use super::sensorless::UNKNOWN_WIND_MPS;
use super::{AirspeedMonitor, CORRECTED_S, MonitorInput};
use fcc_core::blocks::smoothing_factor;

/// Later than this, s, a velocity over the ground does not count any more.
const LOST_S: f64 = 1.5;
/// A sensor that is blocked in a take-off roll stays behind the speed over the ground by
/// more than this, m/s, for this time, s: more than the wind changes in the first climb, of
/// the time below. It was slow when it was first read, below this share of the reference
/// airspeed, within this time, s.
const SHEAR_MPS: f64 = 12.0;
const LAGS_FOR_S: f64 = 1.0;
/// One that stands still while the aircraft becomes faster or slower by more than this
/// share of the reference airspeed and so many times the gusts, over this lag, s, moves by
/// less than this share of that, for this time, s: shorter is a gust of turbulence 4 and 5.
const STILL_RATIO: f64 = 0.14;
const STILL_GUSTS: f64 = 3.0;
const STILL_FOR_S: f64 = 2.0;
const STILL_LAG_S: f64 = 10.0;
const STILL_SHARE: f64 = 0.2;
const AT_FIRST_S: f64 = 60.0;
const SLOW_RATIO: f64 = 0.6;
const FIRST_READ_S: f64 = 1.5;
/// What rolls neither climbs nor sinks faster than this, m/s: in a spin the way over the ground
/// is short, too.
const ROLLS_MPS: f64 = 2.0;
/// That of the airspeed then, m/s.
const RIGHT_SD_MPS: f64 = 1.0;

/// What shows that a sensor stays behind the velocity over the ground.
#[derive(Clone, Copy, Debug)]
pub(super) struct Behind {
    /// How much faster it was over the ground than through the air in the take-off roll,
    /// m/s, and for how long it has been more, s.
    began_tail_mps: Option<f64>,
    lags_s: f64,
    /// The sensor's airspeed and that by the ground velocity, with a lag, m/s, and for how
    /// long only the latter has changed, s.
    slow_mps: Option<(f64, f64)>,
    still_s: f64,
}

impl Behind {
    pub(super) const NONE: Self = Self {
        began_tail_mps: None,
        lags_s: 0.0,
        slow_mps: None,
        still_s: 0.0,
    };
}

impl AirspeedMonitor {
    /// Whether the velocity over the ground, with the wind as it was when the older copy
    /// began, agrees with the sensor within half of this, m/s: then the forces are not the
    /// aircraft's any more.
    pub(super) fn agrees_with_ground(&self, limit_mps: f64) -> bool {
        let within_mps = 0.5 * limit_mps;
        self.by_ground
            .is_some_and(|(_, sd_mps)| sd_mps < within_mps)
            && self.ground_difference.output().abs() < within_mps
    }

    /// Processes one tick of the velocity over the ground; whether the sensor has just been
    /// excluded.
    pub(super) fn follow_ground(
        &mut self,
        bank: &mut FilterBank,
        input: &MonitorInput,
        sample: &ForceSample,
        dt_s: f64,
    ) -> bool {
        self.ground_s += dt_s;
        if self.ground_s > LOST_S {
            self.by_ground = None;
        }
        let is_due = self.ground_s > CORRECTED_S - 1e-6 && sample.models_hold();
        let Some(read) = input.over_ground.filter(|_| is_due) else {
            return false;
        };
        let read = &read;
        let passed_s = core::mem::take(&mut self.ground_s).min(LOST_S);
        let believed = input.sensor_mps.filter(|_| self.doubt.is_none());
        let believed_mps = believed.map(|(mps, _)| (mps, 0.0));
        if bank.is_by_forces {
            let forces = &bank.older;
            let found = (forces.airspeed_mps(), forces.sd_mps());
            bank.believing.wind.step(read, Some(found), passed_s);
            bank.believing.correct_by_ground(read, passed_s);
            return false;
        }
        bank.believing.wind.step(read, believed_mps, passed_s);
        bank.older.wind.step(read, None, passed_s);
        bank.younger.wind.step(read, None, passed_s);
        self.by_ground = bank.older.by_ground_mps(read);
        if let (Some((sensor_mps, _)), Some((mps, _))) = (input.sensor_mps, self.by_ground) {
            self.ground_difference.step(sensor_mps - mps, passed_s);
        }
        let Some((sensor_mps, source)) = believed else {
            for filter in bank.each() {
                filter.correct_by_ground(read, passed_s);
            }
            return false;
        };
        let right_mps = self
            .lags_ground(bank, read, sensor_mps, passed_s)
            .or_else(|| self.stands_still(bank, sensor_mps, passed_s));
        let Some(right_mps) = right_mps.filter(|_| input.may_doubt) else {
            return false;
        };
        let found = (right_mps, RIGHT_SD_MPS);
        self.leave_sensor(bank, (sensor_mps, source), found, sample);
        true
    }

    /// The right airspeed, m/s, if the sensor has stayed behind the speed over the ground
    /// since the take-off roll: nothing is known yet of the models and the wind but its
    /// share along the runway.
    fn lags_ground(
        &mut self,
        bank: &FilterBank,
        read: &OverGround,
        sensor_mps: f64,
        passed_s: f64,
    ) -> Option<f64> {
        if bank.learned_s > AT_FIRST_S {
            return None;
        }
        let ground_mps = hypot(read.north_mps, read.east_mps);
        let tail_mps = ground_mps - sensor_mps / read.sqrt_density;
        let rolls = fabs(read.climb_rate_mps) < ROLLS_MPS
            && sensor_mps < SLOW_RATIO * self.prior.reference_mps;
        if bank.learned_s < FIRST_READ_S && rolls {
            self.behind.began_tail_mps = Some(tail_mps);
        }
        let lags_mps = tail_mps - self.behind.began_tail_mps?;
        let lags = lags_mps > SHEAR_MPS;
        self.behind.lags_s = if lags {
            self.behind.lags_s + passed_s
        } else {
            0.0
        };
        (self.behind.lags_s > LAGS_FOR_S).then_some(sensor_mps + lags_mps * read.sqrt_density)
    }

    /// The right airspeed, m/s, if the sensor shows the same while the aircraft becomes
    /// faster or slower, by the velocity over the ground with the wind as it was, and by
    /// the accelerometers. A gust moves the sensor, and not the others.
    fn stands_still(&mut self, bank: &FilterBank, sensor_mps: f64, passed_s: f64) -> Option<f64> {
        let Some((by_ground_mps, _)) = self.by_ground else {
            self.behind.slow_mps = None;
            return None;
        };
        let (slow_sensor_mps, slow_ground_mps) = self
            .behind
            .slow_mps
            .get_or_insert((sensor_mps, by_ground_mps));
        let share = smoothing_factor(passed_s, STILL_LAG_S);
        *slow_sensor_mps += share * (sensor_mps - *slow_sensor_mps);
        *slow_ground_mps += share * (by_ground_mps - *slow_ground_mps);
        let moved_mps = by_ground_mps - *slow_ground_mps;
        let shown_mps = sensor_mps - *slow_sensor_mps;
        let (off_mps, forces_mps) = (by_ground_mps - sensor_mps, bank.older.airspeed_mps());
        let gusts_mps = STILL_GUSTS * self.gusts_mps();
        let is_still = fabs(moved_mps) > (STILL_RATIO * self.prior.reference_mps).max(gusts_mps)
            && fabs(shown_mps) < STILL_SHARE * fabs(moved_mps)
            && off_mps * moved_mps > 0.5 * squared(moved_mps)
            && (forces_mps - sensor_mps) * off_mps > 0.5 * squared(off_mps);
        self.behind.still_s = if is_still {
            self.behind.still_s + passed_s
        } else {
            0.0
        };
        (self.behind.still_s > STILL_FOR_S).then_some(by_ground_mps)
    }

    /// The sensor is to be left for an airspeed, m/s.
    pub(in super::super) const fn leave_for(&mut self, airspeed_mps: f64) {
        self.left_for_mps = Some(airspeed_mps);
    }

    /// Doubts the sensor if it is to be left: of a tube that was blocked before the take-off
    /// nothing was learned, and of the wind nothing is known.
    pub(super) fn doubts_as_told(&mut self, input: &MonitorInput, sample: &ForceSample) -> bool {
        let (Some(right_mps), Some(sensor)) = (self.left_for_mps.take(), input.sensor_mps) else {
            return false;
        };
        if self.doubt.is_some() {
            return false;
        }
        let found = (right_mps, UNKNOWN_WIND_MPS);
        let mut bank = FilterBank::new(self.prior, right_mps, sample);
        self.leave_sensor(&mut bank, sensor, found, sample);
        bank.believing = bank.older;
        self.bank = Some(bank);
        true
    }

    /// Doubts the sensor: what the models have learned came from it. The right airspeed is
    /// this one, with its standard deviation, m/s.
    fn leave_sensor(
        &mut self,
        bank: &mut FilterBank,
        (sensor_mps, source): (f64, u8),
        (right_mps, sd_mps): (f64, f64),
        sample: &ForceSample,
    ) {
        bank.older = AirspeedFilter::new(self.prior, (right_mps, sd_mps), sample);
        bank.older.wind = bank.believing.wind;
        (bank.younger, bank.younger_s) = (bank.older, 0.0);
        self.difference.reset(sensor_mps - right_mps);
        self.doubt = Some(Doubt {
            source,
            reason: DoubtReason::Ground,
        });
        self.was_doubted = true;
        self.agrees_s = 0.0;
    }
}
