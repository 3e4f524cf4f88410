//! Whether the airspeed sensor is believed, and the airspeed without it.

use super::airframe::AirframePrior;
use super::airspeed_reason::{Doubt, Reference};
use super::filter_bank::FilterBank;
use super::force_sample::{ForceSample, acceleration_mps2};
use super::scalar_update::squared;
use super::upward::Upward;
use super::wind::OverGround;
use fcc_core::blocks::{LowPass, smoothing_factor};
use libm::hypot;

mod compare;
mod ground;
mod path;
mod sensorless;
mod step;
mod trapped;

use ground::Behind;
use step::StepDetector;
use trapped::TrappedPressure;

/// The time between two corrections of the filters, s.
const CORRECTED_S: f64 = 0.1;
/// The throttle's lag: propeller and engine follow it over this time, s. Thrust
/// is taken as proportional to its square: the power of a piston engine rises
/// with the pressure in its manifold, which rises with the throttle's angle. Where a
/// lever gives a share of the power, it is proportional to the throttle; what is between
/// both is not known before it was flown.
const THRUST_LAG_S: f64 = 1.7;
/// The time over which a change of thrust counts as recent, s.
const THRUST_RECENT_S: f64 = 10.0;
/// The share of a change of thrust that the model does not explain; and of the change of
/// what is between both laws of the throttle.
const THRUST_ERROR: f64 = 0.15;
const LAW_SHARE: f64 = 0.5;
/// The time for which a filter runs without the sensor before it is compared, s.
const ALONE_S: f64 = 20.0;
/// The lags of the forces' vote and of the sensor's difference, s.
const VOTE_LAG_S: f64 = 2.0;
const DIFFERENCE_LAG_S: f64 = 0.5;
/// After attitude, rates, forces or altitude were not measured, the models learn
/// for this time, s, before they are compared again.
const SETTLED_S: f64 = 10.0;
/// The same after an upset of this time, s: meanwhile the airspeed was only integrated.
const LONG_UPSET_S: f64 = 3.0;
/// A difference of 11 % of the reference airspeed (11 kt of 100 kt) may be a fault.
const DIFFERS_RATIO: f64 = 0.11;
/// Below this share of the reference airspeed nothing is compared.
const LEAST_RATIO: f64 = 0.4;
/// Vertical gusts are the filter's vertical wind, over this time, s; at least
/// and at most these variances, m²/s².
const GUSTS_OVER_S: f64 = 20.0;
const LEAST_GUSTS_MPS2: f64 = 0.1;
const MOST_GUSTS_MPS2: f64 = 49.0;

/// One tick's inputs.
#[derive(Clone, Copy, Debug)]
pub(super) struct MonitorInput {
    /// Forces and motion; its thrust and gusts are not read.
    pub(super) sample: ForceSample,
    /// 0..=1, if it is known.
    pub(super) throttle: Option<f64>,
    pub(super) altitude_m: f64,
    /// Indicated, with the number of its sensor; none if it is silent.
    pub(super) sensor_mps: Option<(f64, u8)>,
    /// A new reading of the velocity over the ground.
    pub(super) over_ground: Option<OverGround>,
    /// The altimeter is excluded: the climb rate is the models' own.
    pub(super) altimeter_is_doubted: bool,
    /// Whether forces and motion are measured.
    pub(super) motion_is_known: bool,
    /// Whether the sensor may be doubted: while engaged.
    pub(super) may_doubt: bool,
}

/// Compares the airspeed sensor with forces and motion.
///
/// A sensor is doubted if it differs from the airspeed of a filter that has not
/// used it for at least 20 s (a multiple-model test; Willsky 1976), and if the
/// forces, by models as they were before, are nearer to the filter than to the
/// sensor. Otherwise the wind has changed, and the filters follow.
#[derive(Clone, Debug)]
pub(super) struct AirspeedMonitor {
    prior: AirframePrior,
    bank: Option<FilterBank>,
    /// Sums of the samples since the last correction, and their time.
    sum: ForceSample,
    sensor_sum_mps: f64,
    sum_s: f64,
    /// The part of that time in which the sensor had a reading.
    sensor_s: f64,
    thrust: LowPass,
    recent_thrust: LowPass,
    recent_law: LowPass,
    gusts_mps2: f64,
    difference: LowPass,
    /// By axial force and by lift.
    vote: [LowPass; 2],
    step: StepDetector,
    trapped: TrappedPressure,
    differs_s: f64,
    wind_s: f64,
    agrees_s: f64,
    /// For how long the models still learn before they are compared, s.
    settles_s: f64,
    /// For how long the models have not held, s.
    upset_s: f64,
    reference: Reference,
    doubt: Option<Doubt>,
    /// The time since the last velocity over the ground, s.
    ground_s: f64,
    behind: Behind,
    /// The airspeed for which the sensor is to be left, m/s.
    left_for_mps: Option<f64>,
    /// The airspeed by both and its standard deviation, while it is known, and the
    /// sensor's difference from it, m/s.
    by_ground: Option<(f64, f64)>,
    ground_difference: LowPass,
    /// A sensor was doubted in this flight: of several, readings that
    /// contradict the forces are left out.
    was_doubted: bool,
}

impl AirspeedMonitor {
    pub(super) const fn new(prior: AirframePrior) -> Self {
        Self {
            prior,
            bank: None,
            sum: ForceSample::NONE,
            sensor_sum_mps: 0.0,
            sum_s: 0.0,
            sensor_s: 0.0,
            thrust: LowPass::new(THRUST_LAG_S),
            recent_thrust: LowPass::new(THRUST_RECENT_S),
            recent_law: LowPass::new(THRUST_RECENT_S),
            gusts_mps2: 1.0,
            difference: LowPass::new(DIFFERENCE_LAG_S),
            vote: [LowPass::new(VOTE_LAG_S); 2],
            step: StepDetector::new(prior.reference_mps),
            trapped: TrappedPressure::new(),
            differs_s: 0.0,
            wind_s: 0.0,
            agrees_s: 0.0,
            settles_s: 0.0,
            upset_s: 0.0,
            reference: Reference::NONE,
            doubt: None,
            ground_s: 0.0,
            behind: Behind::NONE,
            left_for_mps: None,
            by_ground: None,
            ground_difference: LowPass::new(VOTE_LAG_S),
            was_doubted: false,
        }
    }

    /// The wind that the filter with the sensor has found, and the variation.
    pub(super) fn wind(&self) -> Option<([f64; 2], f64)> {
        self.bank.as_ref()?.believing.wind.found()
    }

    /// The doubt of the sensor, while it lasts.
    pub(super) const fn doubt(&self) -> Option<Doubt> {
        self.doubt
    }

    /// Whether an airspeed may be used beside others: until one was doubted,
    /// any.
    pub(super) fn permits(&self, airspeed_mps: f64) -> bool {
        let Some(bank) = self.bank.filter(|_| self.was_doubted) else {
            return true;
        };
        let differs = (airspeed_mps - bank.older.airspeed_mps()).abs();
        differs < self.limit_mps(&bank.older)
    }

    /// The airspeed by forces and motion and its standard deviation, m/s, if the
    /// sensor is not to be used.
    pub(super) fn without_sensor(&self, input: &MonitorInput) -> Option<(f64, f64)> {
        let bank = self.bank?;
        let filter = match (self.doubt, input.sensor_mps) {
            (Some(_), _) => bank.older,
            (None, None) => bank.believing,
            (None, Some(_)) => return None,
        };
        Some((filter.airspeed_mps(), filter.sd_mps()))
    }

    /// The altimeter has just been excluded: what was learned by it is forgotten.
    pub(super) fn exclude_altimeter(&mut self) {
        if let Some(bank) = &mut self.bank {
            bank.older.restore_models();
            (bank.believing, bank.younger) = (bank.older, bank.older);
            bank.younger_s = 0.0;
        }
    }

    /// Standard deviation of vertical gusts, m/s.
    pub(super) fn gusts_mps(&self) -> f64 {
        libm::sqrt(self.gusts_mps2)
    }

    /// Processes one tick.
    pub(super) fn step(&mut self, input: &MonitorInput, dt_s: f64) {
        if !input.motion_is_known {
            self.settles_s = SETTLED_S;
        }
        if dt_s <= 0.0 {
            return;
        }
        let least_mps = LEAST_RATIO * self.prior.reference_mps;
        let followed = self.bank.as_ref().map(|bank| bank.older.airspeed_mps());
        let is_used = self.doubt.is_none() && self.left_for_mps.is_none();
        if is_used && followed.is_some_and(|mps| mps < least_mps) {
            *self = Self::new(self.prior);
            return;
        }
        let sample = ForceSample {
            thrust: self.thrust_of(input.throttle, dt_s),
            gusts_mps: libm::sqrt(self.gusts_mps2),
            ..input.sample
        };
        if self.doubts_as_told(input, &sample) {
            return;
        }
        let Some(mut bank) = self.bank else {
            self.bank = match input.sensor_mps {
                Some((mps, _)) if mps > 1.2 * least_mps => {
                    Some(FilterBank::new(self.prior, mps, &sample))
                }
                Some(_) => None,
                None => self.begin_by_forces(input, &sample),
            };
            return;
        };
        let settles = self.settle(&mut bank, input, dt_s);
        let now_mps = bank.older.airspeed_mps();
        let acceleration = acceleration_mps2(&sample, now_mps);
        for filter in bank.each() {
            filter.accelerate(acceleration, dt_s);
        }
        let felt_mps = bank.older.airspeed_mps() - now_mps;
        self.add(&sample, input.sensor_mps, dt_s);
        bank.is_by_forces &= input.sensor_mps.is_none();
        let holds = sample.models_hold();
        self.upset_s = if holds {
            if self.upset_s > LONG_UPSET_S {
                self.settles_s = SETTLED_S;
            }
            0.0
        } else {
            self.upset_s + dt_s
        };
        if self.sum_s >= CORRECTED_S - 1e-6 {
            self.correct(&mut bank, &sample, holds);
        }
        bank.younger_s += dt_s;
        bank.learned_s += dt_s;
        if self.doubt.is_none() && bank.is_first && bank.learned_s > SETTLED_S {
            bank.is_first = false;
            self.follow_sensor(&mut bank);
        }
        let contradicted = self.follow_ground(&mut bank, input, &sample, dt_s);
        if contradicted
            || self.doubt_step(&mut bank, input, dt_s)
            || self.doubt_blocked(&mut bank, input, felt_mps, dt_s)
        {
            // Nothing else is compared in this tick.
        } else if settles {
            self.follow_sensor(&mut bank);
        } else if let Some(sensor) = input.sensor_mps
            && (input.motion_is_known || self.doubt.is_some())
        {
            self.compare(&mut bank, input, sensor, holds, dt_s);
        }
        self.bank = Some(bank);
    }

    /// Whether the copies only follow the sensor, until the models have settled
    /// after a time without known motion. They begin with those from before.
    fn settle(&mut self, bank: &mut FilterBank, input: &MonitorInput, dt_s: f64) -> bool {
        let settles = input.motion_is_known && self.settles_s > 0.0 && self.doubt.is_none();
        let Some((sensor_mps, _)) = input.sensor_mps.filter(|_| settles) else {
            return false;
        };
        if self.settles_s >= SETTLED_S {
            bank.older.adopt(sensor_mps);
            bank.older.restore_models();
            bank.believing = bank.older;
            self.sum = ForceSample::NONE;
            (self.sensor_sum_mps, self.sum_s, self.sensor_s) = (0.0, 0.0, 0.0);
        }
        self.settles_s -= dt_s;
        true
    }

    /// Thrust over that at full throttle, and what of its recent change is not known, one
    /// standard deviation.
    fn thrust_of(&mut self, throttle: Option<f64>, dt_s: f64) -> Option<(f64, f64)> {
        let follows = self.thrust.step(throttle?, dt_s);
        let thrust = squared(follows);
        let recent = self.recent_thrust.step(follows, dt_s);
        // From the square of the throttle to the throttle itself.
        let law = follows - thrust;
        let law_change = law - self.recent_law.step(law, dt_s);
        let unknown = hypot(
            THRUST_ERROR * (thrust - squared(recent)),
            LAW_SHARE * law_change,
        );
        Some((thrust, unknown))
    }

    fn add(&mut self, sample: &ForceSample, sensor_mps: Option<(f64, u8)>, dt_s: f64) {
        let sum = &mut self.sum;
        sum.forward += sample.forward * dt_s;
        sum.up += sample.up * dt_s;
        sum.pitch_rad += sample.pitch_rad * dt_s;
        sum.roll_rad += sample.roll_rad * dt_s;
        sum.climb_rate_mps += sample.climb_rate_mps * dt_s;
        if let Some((sensor_mps, _)) = sensor_mps {
            self.sensor_sum_mps += sensor_mps * dt_s;
            self.sensor_s += dt_s;
        }
        self.sum_s += dt_s;
    }

    /// Corrects the filters by the mean of the samples since the last time.
    fn correct(&mut self, bank: &mut FilterBank, now: &ForceSample, holds: bool) {
        let passed_s = core::mem::take(&mut self.sum_s);
        let sum = core::mem::replace(&mut self.sum, ForceSample::NONE);
        let sensor_sum_mps = core::mem::take(&mut self.sensor_sum_mps);
        let sensor_s = core::mem::take(&mut self.sensor_s);
        let (roll_rad, pitch_rad) = (sum.roll_rad / passed_s, sum.pitch_rad / passed_s);
        let mean = ForceSample {
            forward: sum.forward / passed_s,
            up: sum.up / passed_s,
            pitch_rad,
            roll_rad,
            upward: Upward::of(roll_rad, pitch_rad),
            climb_rate_mps: sum.climb_rate_mps / passed_s,
            ..*now
        };
        let knows = mean.thrust.is_some();
        if core::mem::replace(&mut bank.thrust_is_known, knows) != knows {
            bank.is_first = false;
            for filter in bank.each() {
                filter.learn_offset(&mean);
            }
        }
        for filter in bank.each() {
            if holds {
                filter.correct(&mean, passed_s);
            } else {
                filter.without_models(passed_s);
            }
        }
        if self.doubt.is_none() && sensor_s > 0.0 {
            bank.believing.correct_by_sensor(sensor_sum_mps / sensor_s);
        }
        if self.doubt.is_none() && (sensor_s > 0.0 || bank.is_by_forces) {
            let seen = (2.0 * squared(bank.believing.vertical_wind_mps())).min(MOST_GUSTS_MPS2);
            self.gusts_mps2 += smoothing_factor(passed_s, GUSTS_OVER_S)
                * (seen + LEAST_GUSTS_MPS2 - self.gusts_mps2);
        }
    }
}
