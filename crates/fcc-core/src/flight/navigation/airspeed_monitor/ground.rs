//! The airspeed sensor held against the velocity over the ground and the wind.

use super::super::airspeed_filter::AirspeedFilter;
use super::super::airspeed_reason::{Doubt, DoubtReason};
use super::super::filter_bank::FilterBank;
use super::super::force_sample::ForceSample;
use super::sensorless::UNKNOWN_WIND_MPS;
use super::{AirspeedMonitor, CORRECTED_S, MonitorInput};

/// Later than this, s, a velocity over the ground does not count any more.
const LOST_S: f64 = 1.5;
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

    /// Processes one tick of the velocity over the ground.
    pub(super) fn follow_ground(
        &mut self,
        bank: &mut FilterBank,
        input: &MonitorInput,
        sample: &ForceSample,
        dt_s: f64,
    ) {
        self.ground_s += dt_s;
        if self.ground_s > LOST_S {
            self.by_ground = None;
        }
        let is_due = self.ground_s > CORRECTED_S - 1e-6 && sample.models_hold();
        let Some(read) = input.over_ground.filter(|_| is_due) else {
            return;
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
            return;
        }
        bank.believing.wind.step(read, believed_mps, passed_s);
        bank.older.wind.step(read, None, passed_s);
        bank.younger.wind.step(read, None, passed_s);
        self.by_ground = bank.older.by_ground_mps(read);
        if let (Some((sensor_mps, _)), Some((mps, _))) = (input.sensor_mps, self.by_ground) {
            self.ground_difference.step(sensor_mps - mps, passed_s);
        }
        if believed.is_none() {
            for filter in bank.each() {
                filter.correct_by_ground(read, passed_s);
            }
        }
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
