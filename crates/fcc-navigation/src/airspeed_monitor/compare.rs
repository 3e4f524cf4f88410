//! Comparison of the airspeed sensor with forces and motion.

use super::super::airspeed_filter::AirspeedFilter;
use super::super::airspeed_reason::{Doubt, DoubtReason, Reference};
use super::super::filter_bank::FilterBank;
use super::super::scalar_update::squared;
use super::trapped::Shown;
use super::{ALONE_S, AirspeedMonitor, DIFFERS_RATIO, MonitorInput};

/// A difference of that share of the reference airspeed, of 11 kt, of 3.5 standard deviations
/// and of 7.5 times the gusts must last for 2.5 s.
const DIFFERS_MPS: f64 = 5.7;
const DIFFERS_SDS: f64 = 3.5;
const DIFFERS_GUSTS: f64 = 7.5;
const DOUBTED_AFTER_S: f64 = 2.5;
/// So does the younger copy, older than this time, s, by this share of it: what the models
/// are wrong by grows with the time since the copy.
const YOUNGER_S: f64 = 6.0;
const YOUNGER_SHARE: f64 = 0.3;
/// The forces vote for the sensor if they put the airspeed more than this share
/// of the way towards it: then the wind has changed, after this time in s.
const SENSOR_SHARE: f64 = 0.45;
const WIND_CHANGED_AFTER_S: f64 = 2.0;
/// An excluded sensor is used again when it has agreed for 10 s longer than not, another one of
/// the same quantity for 1 s: within 7 % of the reference airspeed, 2 standard deviations or 3
/// times the gusts, of the estimate or, since that may have drifted, of what both forces say.
const AGREES_RATIO: f64 = 0.07;
const AGREES_SDS: f64 = 2.0;
const AGREES_GUSTS: f64 = 3.0;
const BELIEVED_AFTER_S: f64 = 10.0;
const ANOTHER_BELIEVED_AFTER_S: f64 = 1.0;
/// Doubt needs models that have learned the aircraft for this time, s; for this
/// one if the sensor has stepped, which they need not tell.
const LEARNED_S: f64 = 15.0;
const LEARNED_FOR_STEP_S: f64 = 5.0;

/// Whether a force puts the airspeed nearer to the sensor, `differs` from the filter, than to
/// the filter.
fn sides_with(vote_mps: f64, differs_mps: f64) -> bool {
    vote_mps * differs_mps.signum() > SENSOR_SHARE * differs_mps.abs()
}

impl AirspeedMonitor {
    pub(super) fn limit_mps(&self, filter: &AirspeedFilter) -> f64 {
        (DIFFERS_RATIO * self.prior.reference_mps)
            .max(DIFFERS_MPS)
            .max(DIFFERS_SDS * filter.sd_mps())
            .max(DIFFERS_GUSTS * libm::sqrt(self.gusts_mps2))
    }

    /// Processes one tick of the sensor.
    pub(super) fn compare(
        &mut self,
        bank: &mut FilterBank,
        input: &MonitorInput,
        (sensor_mps, source): (f64, u8),
        holds: bool,
        dt_s: f64,
    ) {
        let filter_mps = bank.older.airspeed_mps();
        let differs = self.difference.step(sensor_mps - filter_mps, dt_s);
        let votes = bank.older.by_forces_mps(sensor_mps - filter_mps);
        let mut vote = [0.0; 2];
        for ((vote, lag), of) in vote.iter_mut().zip(&mut self.vote).zip(votes) {
            *vote = lag.step(of, dt_s);
        }
        if input.altimeter_is_doubted {
            // The path comes from the lift then: it is no second force.
            vote = [vote[0]; 2];
        }
        if let Some(doubt) = self.doubt {
            let sensor = (sensor_mps, source, differs);
            self.compare_doubted(bank, doubt, sensor, vote, dt_s);
            return;
        }
        let limit_mps = self.limit_mps(&bank.older);
        let by_younger = differs + filter_mps - bank.younger.airspeed_mps();
        // A static port that is closed is slow: what was copied last has followed it.
        let younger_agrees = !input.altimeter_is_doubted
            && bank.younger_s > YOUNGER_S
            && by_younger * differs.signum() < YOUNGER_SHARE * limit_mps;
        let is_large = holds && differs.abs() > limit_mps && !younger_agrees;
        // The sensor is contradicted if neither force sides with it, and the wind has changed
        // if both do.
        let sides = vote.map(|vote| sides_with(vote, differs));
        let by_ground = self.agrees_with_ground(limit_mps);
        let count = |now: bool, s: f64| if now { s + dt_s } else { (s - dt_s).max(0.0) };
        self.differs_s = count(
            is_large && sides == [false; 2] && !by_ground,
            self.differs_s,
        );
        self.wind_s = count(is_large && (sides == [true; 2] || by_ground), self.wind_s);
        if differs.abs() < 0.3 * limit_mps {
            self.reference = Reference::new(input.altitude_m, sensor_mps);
        }
        if self.wind_s > WIND_CHANGED_AFTER_S {
            self.follow_sensor(bank);
        } else if self.differs_s > DOUBTED_AFTER_S {
            if input.may_doubt && bank.learned_s > LEARNED_S {
                self.begin_doubt(source, self.reason(input, sensor_mps, differs));
            } else {
                self.follow_sensor(bank);
            }
        } else if bank.younger_s >= ALONE_S && self.differs_s == 0.0 && !input.altimeter_is_doubted
        {
            bank.older = bank.younger;
            bank.younger = bank.believing.kept();
            bank.younger_s = 0.0;
        }
    }

    /// Why a sensor that differs by this is wrong.
    fn reason(&self, input: &MonitorInput, sensor_mps: f64, differs_mps: f64) -> DoubtReason {
        let sigma = squared(input.sample.sqrt_density);
        self.reference
            .reason(input.altitude_m, sensor_mps, sigma, differs_mps)
    }

    /// Doubts the sensor of this number.
    const fn begin_doubt(&mut self, source: u8, reason: DoubtReason) {
        self.doubt = Some(Doubt { source, reason });
        self.was_doubted = true;
        self.agrees_s = 0.0;
    }

    /// Doubts a sensor whose tube is blocked: its airspeed before and the forces since are
    /// known.
    pub(super) fn doubt_blocked(
        &mut self,
        bank: &mut FilterBank,
        input: &MonitorInput,
        felt_mps: f64,
        dt_s: f64,
    ) -> bool {
        let is_believed = self.doubt.is_none() && !input.altimeter_is_doubted;
        let Some((sensor_mps, source)) = input.sensor_mps.filter(|_| is_believed) else {
            self.trapped.reset();
            return false;
        };
        let shown = Shown {
            altitude_m: input.altitude_m,
            density_ratio: squared(input.sample.sqrt_density),
            sensor_mps,
            felt_mps,
        };
        let Some(known_mps) = self.trapped.step(&shown, dt_s) else {
            return false;
        };
        let doubts = input.may_doubt && input.motion_is_known;
        if doubts {
            bank.older.adopt_known(known_mps);
            self.begin_doubt(source, DoubtReason::BlockedTube);
        }
        doubts
    }

    /// Doubts a sensor that has stepped, whatever else is measured: its airspeed
    /// before is the one that is known, unless that could have been doubted. Not if it has returned from an airspeed that
    /// could have been doubted to that of the older copy.
    pub(super) fn doubt_step(
        &mut self,
        bank: &mut FilterBank,
        input: &MonitorInput,
        dt_s: f64,
    ) -> bool {
        let Some((sensor_mps, source)) = input.sensor_mps.filter(|_| self.doubt.is_none()) else {
            self.step.reset();
            return false;
        };
        let Some(before_mps) = self.step.step(sensor_mps, dt_s) else {
            return false;
        };
        let likely_mps = bank.older.airspeed_mps();
        let differed_mps = (before_mps - likely_mps).abs();
        let was_wrong = differed_mps > self.limit_mps(&bank.older);
        let returns = was_wrong && (sensor_mps - likely_mps).abs() < differed_mps;
        let doubts = !returns && input.may_doubt && bank.learned_s > LEARNED_FOR_STEP_S;
        if doubts {
            if !was_wrong {
                bank.older.adopt_known(before_mps);
            }
            let reason = self.reason(input, sensor_mps, sensor_mps - before_mps);
            self.begin_doubt(source, reason);
        }
        doubts
    }

    /// Looks whether a doubted sensor, `(m/s, number, difference)`, is right again.
    fn compare_doubted(
        &mut self,
        bank: &mut FilterBank,
        doubt: Doubt,
        (sensor_mps, source, differs): (f64, u8, f64),
        votes: [f64; 2],
        dt_s: f64,
    ) {
        // Models that were begun anew for the sensor's sake say little against it.
        let (sd_mps, learned) = (bank.older.sd_mps(), bank.older.is_copy());
        let uncertain_mps = if learned {
            (AGREES_SDS * sd_mps).max(AGREES_GUSTS * libm::sqrt(self.gusts_mps2))
        } else {
            0.0
        };
        let agrees_mps = (AGREES_RATIO * self.prior.reference_mps).max(uncertain_mps);
        let by_forces = learned && votes.iter().all(|vote| (differs - vote).abs() < agrees_mps);
        let agrees = differs.abs() < agrees_mps || by_forces || self.agrees_with_ground(agrees_mps);
        let step_s = if agrees { dt_s } else { -dt_s };
        self.agrees_s = (self.agrees_s + step_s).max(0.0);
        let needed_s = if source == doubt.source {
            BELIEVED_AFTER_S
        } else {
            ANOTHER_BELIEVED_AFTER_S
        };
        if self.agrees_s > needed_s {
            bank.believing = bank.older;
            bank.believing.adopt(sensor_mps);
            bank.believing.wind.trust_sensor();
            self.follow_sensor(bank);
            self.doubt = None;
        }
    }

    /// The filters follow the sensor from now on.
    pub(super) fn follow_sensor(&mut self, bank: &mut FilterBank) {
        bank.follow_sensor();
        self.difference.reset(0.0);
        for vote in &mut self.vote {
            vote.reset(0.0);
        }
        self.differs_s = 0.0;
        self.wind_s = 0.0;
    }
}
