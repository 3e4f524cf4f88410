//! The airspeed sensor held against the velocity over the ground and the wind.

use super::super::airspeed_filter::AirspeedFilter;
use super::super::airspeed_reason::{Doubt, DoubtReason};
use super::super::filter_bank::FilterBank;
use super::super::force_sample::ForceSample;
use super::super::scalar_update::squared;
use super::{AirspeedMonitor, CORRECTED_S, DIFFERS_RATIO, MonitorInput};

/// Later than this, s, a velocity over the ground does not count any more.
const LOST_S: f64 = 1.5;
/// An error of this many standard deviations, and of the share of the reference
/// airspeed at which a difference from the forces counts, must last for this time, s.
const ERROR_SDS: f64 = 3.5;
const DOUBTED_AFTER_S: f64 = 5.0;
/// That of the airspeed then, m/s.
const RIGHT_SD_MPS: f64 = 1.0;

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

    /// Processes one tick of the velocity over the ground. Returns whether the sensor
    /// has just been doubted.
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
        let Some((error, sd)) = bank.believing.wind.sensor_error() else {
            return false;
        };
        let limit_mps = (DIFFERS_RATIO * self.prior.reference_mps).max(ERROR_SDS * sd * sensor_mps);
        let is_wrong = squared(error * sensor_mps) > squared(limit_mps);
        self.contradicted_s = if is_wrong {
            self.contradicted_s + passed_s
        } else {
            0.0
        };
        if self.contradicted_s < DOUBTED_AFTER_S || !input.may_doubt {
            return false;
        }
        self.contradicted_s = 0.0;
        // What the models have learned came from that sensor.
        let right_mps = sensor_mps * (1.0 + error);
        bank.older = AirspeedFilter::new(self.prior, (right_mps, RIGHT_SD_MPS), sample);
        bank.older.wind = bank.believing.wind;
        (bank.younger, bank.younger_s) = (bank.older, 0.0);
        self.difference.reset(sensor_mps - right_mps);
        self.static_port = None;
        self.doubt = Some(Doubt {
            source,
            reason: DoubtReason::Wind,
        });
        self.was_doubted = true;
        self.agrees_s = 0.0;
        true
    }
}
