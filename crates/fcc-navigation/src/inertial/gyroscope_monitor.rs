//! Whether the gyroscopes and the magnetic field agree on how the aircraft turns,
//! and which of the two is wrong if they do not.
//!
//! A field that turns, keeps its strength, and turns otherwise than the
//! gyroscopes say for longer than a jump lasts: few failures of a magnetometer
//! do that (one that turns in its mount, a current that follows the ailerons), so
//! the gyroscopes are wrong unless a satellite receiver agrees with them. A field
//! that does not turn while the gyroscopes do may be that of a frozen magnetometer
//! as well: nothing is decided. With gyroscopes that are really wrong that does not
//! last, because an autopilot that follows them turns the aircraft.
//!
//! An axis that gives one rate to the last bit while the others change is wrong without
//! the field.

use libm::{acos, sqrt};
use nalgebra::{UnitQuaternion, Vector3};

use super::Solution;
use super::field_turning::{FieldTurning, Turning};
use super::receiver_witness::{ReceiverWitness, SILENT_S};
use super::stuck::StuckAxis;
use fcc_core::blocks::smoothing_factor;
use fcc_core::framework::Time;

/// They contradict each other beyond this angle, rad (12°), of several windows, the
/// largest of them less than half of it: nobody turns that far unnoticed, and a
/// current of the aircraft turns the field by less.
const CONTRADICTS_RAD: f64 = 0.21;
/// ... and beyond this share of the angle that either has turned: a compass that
/// is turned by 30° errs by half of what the aircraft has turned, 2 sin 15°, whatever part
/// of that is along the field, and so does one with 20 µT of iron.
const CONTRADICTS_SHARE: f64 = 0.6;
/// ... and beyond so many standard deviations.
const CONTRADICTS_SIGMAS: f64 = 5.0;
/// Where they contradict each other the field turns by this share of it at least, and by
/// so many standard deviations.
const FIELD_TURNS_SHARE: f64 = 0.4;
const NOISE_SIGMAS: f64 = 3.0;
/// Instead of the share by this angle, rad (30°), without the window in which it turns the most: within
/// that one it may have been frozen.
const FIELD_TURNS_RAD: f64 = 0.52;
/// Of so many windows, 2.4 s, each number from the latest on is looked at: gyroscopes
/// that are wrong by a little take longer.
const WINDOWS: usize = 12;

/// The bias of the gyroscopes is that of so many seconds, s: a filter that follows wrong rates
/// takes what is wrong for a bias, and another one in the next turn.
const BIAS_S: f64 = 5.0;

/// The strength differs from the earth's by less than this share, and within the
/// windows by less than this one: otherwise something disturbs it.
const STRENGTH_SHARE: f64 = 0.15;
const STEADY_STRENGTH_SHARE: f64 = 0.08;
/// Beyond this share of the earth's field, what the filter has learned as the aircraft's
/// own is a magnetometer that has failed, or was not calibrated.
const OWN_SHARE: f64 = 0.2;
/// Samples that scatter by more than this share contain a jump, or are too noisy.
const SCATTER_SHARE: f64 = 0.05;
/// The field is believed once it has been where attitude and model expect it, within
/// this angle (10°), for so long; until it jumps, or is not there for longer than the
/// second time: wrong gyroscopes turn the attitude away from it, too. A compass that is
/// turned about its own z axis is right for some seconds of a turn, where that points
/// along the field.
const EXPECTED_RAD: f64 = 0.175;
const EXPECTED_FOR_S: f64 = 10.0;
const UNEXPECTED_FOR_S: f64 = 10.0;

/// Doubted gyroscopes are believed again when they have turned by this angle in all,
/// rad (90°), over this time at least, s, counted in windows of more than the second
/// angle (1°, at 5 °/s), and the field with them, but for this share of it.
const BELIEVED_AFTER_RAD: f64 = 1.57;
const BELIEVED_AFTER_S: f64 = 5.0;
const TURNS_RAD: f64 = 0.0175;
const AGREES_SHARE: f64 = 0.4;

/// In flight the field is waited for for so long, s: one that does not count then is
/// not that of the earth, and gyroscopes are flown unchecked. One that is silent is not
/// waited for.
const AWAITED_FOR_S: f64 = 20.0;

/// Gyroscopes that the field contradicts within so many windows (0.6 s, 20 °/s) are doubted at
/// once. Others are as soon as a receiver contradicts them, too; if it has not after this time,
/// s, it is the field that is wrong.
const FAST_WINDOWS: usize = 3;
const HEARD_FOR_S: f64 = 2.0;

/// Slower nothing flies, m/s: on the ground there is iron nearby.
const FLIES_MPS: f64 = 15.0;

/// Compares the gyroscopes with the magnetic field.
#[derive(Clone, Debug)]
pub(super) struct GyroscopeMonitor {
    turning: FieldTurning,
    /// Of the gyroscopes, as it was before they were doubted, rad/s.
    bias: Vector3<f64>,
    rates_taken: Time,
    /// The latest first.
    windows: [Turning; WINDOWS],
    known: usize,
    /// Since when the field has been where it is expected, and when it last was.
    expected_since: Time,
    expected_last: Time,
    is_field_sound: bool,
    awaited: Awaited,
    is_doubted: bool,
    /// Since when a receiver is asked who is wrong.
    accused_since: Time,
    pub(super) witness: ReceiverWitness,
    axes: StuckAxis,
    is_stuck: bool,
    agreeing: Agreeing,
}

/// The first field in flight, the latest one, and whether it has ever counted.
#[derive(Clone, Copy, Debug, Default)]
struct Awaited {
    since: Time,
    latest: Time,
    has_counted: bool,
}

/// What doubted gyroscopes have shown since they last contradicted the field: how far
/// they turned, rad, and sums of squares of that and of what the field did not turn
/// with them, rad².
#[derive(Clone, Copy, Debug, Default)]
struct Agreeing {
    since: Time,
    turned_rad: f64,
    turned_squared: f64,
    error_squared: f64,
}

impl GyroscopeMonitor {
    pub(super) fn new() -> Self {
        Self {
            turning: FieldTurning::new(),
            bias: Vector3::zeros(),
            rates_taken: Time::NEVER,
            windows: [Turning::NONE; WINDOWS],
            known: 0,
            expected_since: Time::NEVER,
            expected_last: Time::NEVER,
            is_field_sound: false,
            awaited: Awaited::default(),
            is_doubted: false,
            accused_since: Time::NEVER,
            witness: ReceiverWitness::new(),
            axes: StuckAxis::default(),
            is_stuck: false,
            agreeing: Agreeing::default(),
        }
    }

    /// Whether the gyroscopes are not to be used.
    pub(super) const fn is_doubted(&self) -> bool {
        self.is_doubted
    }

    /// Whether the field contradicts them, and a receiver is asked who is wrong.
    pub(super) const fn is_questioned(&self) -> bool {
        !self.accused_since.is_never()
    }

    /// Whether the gyroscopes cannot be compared with the field yet, and soon will be.
    pub(super) fn awaits_field(&self, now: Time) -> bool {
        let Awaited {
            since,
            latest,
            has_counted,
        } = self.awaited;
        !since.is_never()
            && !has_counted
            && latest.since(since).as_secs_f64() < AWAITED_FOR_S
            && now.since(latest).as_secs_f64() < SILENT_S
    }

    /// From here on the samples are those of other gyroscopes.
    pub(super) fn change(&mut self) {
        self.is_doubted = false;
        self.accused_since = Time::NEVER;
        self.bias = Vector3::zeros();
        self.turning = FieldTurning::new();
        self.known = 0;
        self.axes = StuckAxis::default();
        self.is_stuck = false;
        self.agreeing = Agreeing::default();
    }

    /// Takes a new sample of the gyroscopes, rad/s, and what is known of their bias;
    /// whether it is to be used.
    pub(super) fn add_rates(&mut self, taken: Time, rates: [f64; 3], known: &Solution) -> bool {
        let (is_held, is_stuck) = self.axes.step(taken, rates);
        self.is_stuck = is_stuck;
        if !self.is_doubted {
            let bias = Vector3::from(known.gyroscope_bias_radps.map(finite));
            let since_s = taken.since(self.rates_taken).as_secs_f64();
            self.bias += (bias - self.bias) * smoothing_factor(since_s, BIAS_S);
        }
        self.rates_taken = taken;
        let rates = Vector3::from(rates) - self.bias;
        self.turning.add_rates(taken, rates);
        self.witness.add_rates(taken, rates, known);
        !is_held && !self.is_doubted
    }

    /// Takes a sample of the magnetic field, µT, body axes, and what is known of
    /// the field, the attitude and the velocity.
    pub(super) fn add_field(&mut self, taken: Time, field: [f64; 3], known: &Solution) {
        let own = Vector3::from(known.body_field_ut.map(finite));
        let field = Vector3::from(field);
        let flies = Vector3::from(known.velocity_mps).norm() > FLIES_MPS;
        if flies && self.awaited.since.is_never() {
            self.awaited.since = taken;
        }
        self.awaited.latest = taken;
        // Attitude is found by a field that is sound; without one there is none.
        self.is_doubted |= self.is_stuck && self.is_field_sound && flies;
        self.judge(taken);
        let Some(turning) = self.turning.add_field(taken, field, own) else {
            return;
        };
        self.expect(taken, field - own, known);
        let earth_ut = Vector3::from(known.earth_field_ut).norm();
        let is_smooth = turning.scatter < SCATTER_SHARE;
        self.is_field_sound &= is_smooth || self.is_doubted;
        let is_calibrated = self.is_doubted || own.norm() < OWN_SHARE * earth_ut;
        let differs_ut = (turning.strength_ut - earth_ut).abs();
        if !(self.is_field_sound
            && is_smooth
            && is_calibrated
            && differs_ut < STRENGTH_SHARE * earth_ut)
        {
            self.known = 0;
            return;
        }
        self.windows.rotate_right(1);
        if let Some(latest) = self.windows.first_mut() {
            *latest = turning;
        }
        self.known = (self.known + 1).min(WINDOWS);
        if let Some(windows) = self.contradicts(earth_ut) {
            if windows <= FAST_WINDOWS {
                self.is_doubted |= flies;
            } else if flies && !self.is_doubted && self.accused_since.is_never() {
                self.accused_since = taken;
                self.judge(taken);
            }
            self.agreeing = Agreeing::default();
        } else if self.is_stuck {
            self.agreeing = Agreeing::default();
        } else if self.is_doubted {
            self.agree(taken, &turning);
        }
    }

    /// Decides who is wrong where the field contradicts the gyroscopes.
    fn judge(&mut self, now: Time) {
        if self.accused_since.is_never() {
            return;
        }
        let for_s = now.since(self.accused_since).as_secs_f64();
        if self.witness.agrees(now) != Some(true) {
            self.is_doubted = true;
        } else if for_s >= HEARD_FOR_S {
            self.is_field_sound = false;
            self.expected_since = Time::NEVER;
            self.known = 0;
        } else {
            return;
        }
        self.accused_since = Time::NEVER;
    }

    /// Follows whether the field is where it is expected to be.
    fn expect(&mut self, taken: Time, field: Vector3<f64>, known: &Solution) {
        let [w, x, y, z] = known.quaternion;
        let to_earth = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
        let expected = to_earth.inverse() * Vector3::from(known.earth_field_ut);
        let cosine = expected.dot(&field) / (expected.norm() * field.norm());
        // Not a number without an attitude or a field.
        let is_expected = acos(cosine.clamp(-1.0, 1.0)) < EXPECTED_RAD;
        if !is_expected {
            self.expected_since = Time::NEVER;
            let for_s = taken.since(self.expected_last).as_secs_f64();
            self.is_field_sound &= self.is_doubted || for_s < UNEXPECTED_FOR_S;
            return;
        }
        self.expected_last = taken;
        if self.expected_since.is_never() {
            self.expected_since = taken;
        }
        let for_s = taken.since(self.expected_since).as_secs_f64();
        self.is_field_sound |= for_s >= EXPECTED_FOR_S;
        self.awaited.has_counted |= self.is_field_sound;
    }

    /// Over how many of the latest windows gyroscopes and field contradict each other.
    fn contradicts(&self, earth_ut: f64) -> Option<usize> {
        let (mut error, mut shown) = (Vector3::zeros(), Vector3::zeros());
        let (mut by_field, mut by_rates, mut variance) = (0.0, 0.0, 0.0);
        let (mut largest, mut most_shown) = (Vector3::zeros(), Vector3::zeros());
        let (mut weakest_ut, mut strongest_ut) = (f64::INFINITY, 0.0_f64);
        let mut windows = self.windows.iter().take(self.known);
        let last = windows.position(|window| {
            error += window.error;
            // Where they agreed the field may have turned before it was frozen.
            let (turned, wrong) = (window.shown.norm(), window.error.norm());
            shown += window.shown * (wrong / turned.max(1e-9)).min(1.0);
            by_field += turned;
            by_rates += window.turned_rad;
            // Of both parts across the field.
            variance += 2.0 * window.variance;
            if wrong > largest.norm() {
                largest = window.error;
            }
            if turned > most_shown.norm() {
                most_shown = window.shown;
            }
            weakest_ut = weakest_ut.min(window.strength_ut);
            strongest_ut = strongest_ut.max(window.strength_ut);
            let angle = error.norm();
            angle > CONTRADICTS_RAD
                && (error - largest).norm() > 0.5 * CONTRADICTS_RAD
                && angle > CONTRADICTS_SHARE * by_field.max(by_rates)
                && angle > CONTRADICTS_SIGMAS * sqrt(variance)
                && (shown.norm() > FIELD_TURNS_SHARE * angle
                    || (shown - most_shown).norm() > FIELD_TURNS_RAD)
                && shown.norm() > NOISE_SIGMAS * sqrt(variance)
                && strongest_ut - weakest_ut < STEADY_STRENGTH_SHARE * earth_ut
        });
        last.map(|last| last + 1)
    }

    /// Believes doubted gyroscopes again when they have agreed for long enough while
    /// turning: in straight flight a wrong one agrees, too.
    fn agree(&mut self, taken: Time, turning: &Turning) {
        if self.agreeing.since.is_never() {
            self.agreeing.since = taken;
        }
        let agreeing = &mut self.agreeing;
        let turned = (turning.shown + turning.error).norm();
        let noise = NOISE_SIGMAS * sqrt(2.0 * turning.variance);
        if turned > TURNS_RAD {
            agreeing.turned_rad += turned;
        }
        if turned > TURNS_RAD || turning.shown.norm() > TURNS_RAD + noise {
            agreeing.turned_squared += turned * turned;
            agreeing.error_squared += turning.error.norm_squared() - 2.0 * turning.variance;
        }
        let lasted_s = taken.since(agreeing.since).as_secs_f64();
        if lasted_s >= BELIEVED_AFTER_S && agreeing.turned_rad >= BELIEVED_AFTER_RAD {
            let most = AGREES_SHARE * AGREES_SHARE * agreeing.turned_squared;
            self.is_doubted = agreeing.error_squared > most;
            self.agreeing = Agreeing::default();
            self.known = 0;
        }
    }
}

/// What is not known is none.
fn finite(value: f64) -> f64 {
    if value.is_finite() { value } else { 0.0 }
}
