//! Degraded flight: what is held without a lost quantity, and for how long.

mod coming_and_going;

use core::time::Duration;

use coming_and_going::{FORGOTTEN_SLOWER, Intermittent, Repeated};

use super::runway::Low;
use super::{Autopilot, FailsafeConfig, FailsafeEnd, flags};
use fcc_core::flight::Measurements;
use fcc_core::framework::{Notice, Tick, Time};
use fcc_navigation::{KnownMotion, MotionDoubt, Quantities, Quantity};

/// The kinds of notices.
pub(super) const GOOD_AGAIN: u8 = 3;
pub(super) const FLOWN_OTHERWISE: u8 = 4;

/// The items of notices of what is flown otherwise than before; 0 is the glide.
pub(super) mod otherwise {
    /// Not used any more.
    pub(in super::super) const LATE_FIXES: u16 = 1;
    pub(in super::super) const VELOCITY_REFUSED: u16 = 2;
    pub(in super::super) const VELOCITY_USED: u16 = 3;
}

/// The notice of what has lasted for so long, s.
fn lasted(kind: u8, lasted_s: f64) -> Notice {
    Notice {
        kind,
        lasted_ns: (lasted_s * 1e9) as u64,
        ..Notice::default()
    }
}

/// The notice with one of these items.
pub(super) fn flown_otherwise(item: u16) -> Notice {
    Notice {
        kind: FLOWN_OTHERWISE,
        item,
        ..Notice::default()
    }
}

/// How the failsafe rolls; the weakest first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) enum Lateral {
    /// The surfaces stay at the trims that the loops have found.
    Trims,
    /// Wings level.
    WingsLevel,
}

/// How the failsafe holds height; the weakest first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) enum Vertical {
    /// The elevator stays at the trim that the loop has found.
    Trim,
    /// The pitch of level flight, slowly corrected by the altitude if it is
    /// known.
    Pitch,
    /// No climb.
    Level,
}

/// How the failsafe sets the power; the weakest first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) enum Power {
    /// The throttle that the loop has found for level flight.
    Trim,
    /// As the commanded airspeed needs it.
    Airspeed,
}

/// What is held.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    pub(super) lateral: Lateral,
    pub(super) vertical: Vertical,
    pub(super) power: Power,
    /// For how long that is sound, s.
    pub(super) for_s: f64,
}

/// A row of the table: what is held without these quantities.
struct Row(Quantities, Held);

const fn row(
    lost: &[Quantity],
    lateral: Lateral,
    vertical: Vertical,
    power: Power,
    for_s: f64,
) -> Row {
    let held = Held {
        lateral,
        vertical,
        power,
        for_s,
    };
    Row(Quantities::of(lost), held)
}

/// A limit only by `failsafe.degraded_s`: its error does not grow.
const SOUND: f64 = f64::INFINITY;
/// The integrated gyroscope alone: a bias of 10°/min, that of a phone's, makes
/// 5° of it.
const INTEGRATED_S: f64 = 30.0;

/// Without several quantities, the weakest of all rows that apply is held; the
/// same table for users is in `docs/faults.md`.
const TABLE: [Row; 8] = {
    use {Lateral as L, Power as P, Vertical as V};
    [
        row(
            &[Quantity::Heading],
            L::WingsLevel,
            V::Level,
            P::Airspeed,
            SOUND,
        ),
        // The rudder follows the aileron, and damps the yaw; the climb rate of
        // the barometer alone is too late for the loop.
        row(
            &[Quantity::SpecificForce],
            L::WingsLevel,
            V::Pitch,
            P::Airspeed,
            SOUND,
        ),
        // Pitch and power determine the airspeed, unless forces and motion do.
        row(
            &[Quantity::Airspeed],
            L::WingsLevel,
            V::Pitch,
            P::Trim,
            SOUND,
        ),
        row(
            &[Quantity::Altitude],
            L::WingsLevel,
            V::Pitch,
            P::Trim,
            SOUND,
        ),
        // The derivative of attitude and heading replaces the gyroscope.
        row(
            &[Quantity::BodyRates],
            L::WingsLevel,
            V::Level,
            P::Airspeed,
            SOUND,
        ),
        // The integrated gyroscope replaces the attitude, corrected by gravity:
        // its error is some 10 s of the gyroscope's drift.
        row(
            &[Quantity::Attitude],
            L::WingsLevel,
            V::Level,
            P::Airspeed,
            SOUND,
        ),
        row(
            &[Quantity::Attitude, Quantity::SpecificForce],
            L::WingsLevel,
            V::Pitch,
            P::Trim,
            INTEGRATED_S,
        ),
        // An outage is flown through; then `failsafe.hold_s` ends it.
        row(
            &[Quantity::Attitude, Quantity::BodyRates],
            L::Trims,
            V::Trim,
            P::Trim,
            0.0,
        ),
    ]
};

/// What an airspeed by forces and motion needs, and the standard deviation up to
/// which it counts as known, by the reference airspeed: 5 kt of 100 kt, so that
/// three of them lie between cruise and the lowest airspeed of a Cessna 172.
const FORCES_NEED: Quantities = Quantities::of(&[
    Quantity::Attitude,
    Quantity::SpecificForce,
    Quantity::Altitude,
]);
const ACCURATE_RATIO: f64 = 0.05;
/// ... and where there never was a sensor, so that the limits have been that much narrower
/// from the beginning.
const FLYABLE_RATIO: f64 = 0.1;

/// What is held without these quantities.
pub(super) fn held_without(lost: Quantities) -> Held {
    let all = Held {
        lateral: Lateral::WingsLevel,
        vertical: Vertical::Level,
        power: Power::Airspeed,
        for_s: SOUND,
    };
    let rows = TABLE
        .iter()
        .filter(|Row(missing, _)| lost.contains_all(*missing));
    rows.fold(all, |weakest, Row(_, held)| Held {
        lateral: weakest.lateral.min(held.lateral),
        vertical: weakest.vertical.min(held.vertical),
        power: weakest.power.min(held.power),
        for_s: weakest.for_s.min(held.for_s),
    })
}

/// A failsafe because of faults: since when, and whether it can go on or end.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Degraded {
    /// The loop is in failsafe.
    pub(super) is_failsafe: bool,
    /// The altitude at its beginning, or after a climb from a runway, m.
    pub(super) altitude_m: f64,
    /// What is flown first, over a runway; and the airspeed of the pitch and the power that
    /// are held, if it is not the commanded one, m/s.
    pub(super) low: Low,
    pub(super) trimmed_mps: Option<f64>,
    /// The quantities that were frozen in it.
    pub(super) frozen: Quantities,
    /// How long it has lasted, s.
    lasted_s: f64,
    /// For how long nothing sound could be held, as far as it is not forgotten, and all
    /// has been good, s.
    unsound_s: f64,
    good_s: f64,
    repeated: Repeated,
    is_sound: bool,
    pub(super) glides: bool,
    intermittent: Intermittent,
    /// How long the failsafe lasted that the loop ended in the last tick because
    /// all was good again, s.
    recovered_s: Option<f64>,
}

impl Degraded {
    /// Whether what is held is sound.
    pub(super) const fn is_sound(&self) -> bool {
        self.is_sound
    }

    /// After a failsafe that the loop has ended because all is good again.
    pub(super) fn recovered(&self) -> Self {
        Self {
            recovered_s: Some(self.lasted_s),
            unsound_s: self.unsound_s,
            repeated: self.repeated,
            ..Self::default()
        }
    }

    fn forget_unsound(&mut self, dt_s: f64) {
        self.unsound_s = (self.unsound_s - dt_s / FORGOTTEN_SLOWER).max(0.0);
    }

    /// Whether nothing sound could be held for longer than `hold` in all, with
    /// interruptions.
    fn is_worn_out(&self, hold: Duration) -> bool {
        self.unsound_s > hold.as_secs_f64()
    }

    /// The quantities that come and go.
    pub(super) const fn intermittent(&self) -> Quantities {
        self.intermittent.left_out
    }

    /// Whether it goes on: what it holds is sound, or nobody is there to take over.
    pub(super) fn goes_on(&self, config: &FailsafeConfig) -> bool {
        let is_sound = self.is_sound && !self.is_worn_out(config.hold);
        is_sound || config.end == FailsafeEnd::Glide
    }

    /// Whether what was lost has been good for long enough. Whether the failsafe
    /// ends then is for the loop to decide: one because of overruns goes on until
    /// these are over.
    pub(super) fn is_good_again(&self, config: &FailsafeConfig) -> bool {
        let after = config.recovered_after * self.repeated.factor();
        let good = Duration::from_secs_f64(self.good_s);
        self.is_failsafe && after > Duration::ZERO && good >= after
    }

    /// Whether it flies on without a quantity.
    pub(super) const fn flies_without(&self) -> bool {
        self.is_sound && (self.good_s == 0.0 || !self.intermittent.left_out.is_empty())
    }

    /// Whether a flare is flown to the ground.
    pub(super) fn lands(&self) -> bool {
        self.low == Low::Lands
    }

    /// The first tick of a failsafe, at an altitude, m.
    pub(super) fn begin(&mut self, altitude_m: f64) {
        self.is_failsafe = true;
        self.altitude_m = altitude_m;
        self.repeated.begin();
    }
}

impl Autopilot {
    /// The quantities that control cannot use: too old, frozen, or contradicted.
    pub(super) fn lost(&self, now: Time) -> Quantities {
        let contradicted = self.estimator.navigation.airspeed_doubt().is_some();
        let doubt = self.estimator.navigation.motion_doubt();
        let unusable = self
            .silent_or_frozen(now)
            .with(Quantity::Attitude, doubt == Some(MotionDoubt::Attitude))
            .with(Quantity::BodyRates, doubt == Some(MotionDoubt::BodyRates));
        let left_out = self
            .supervisor
            .degraded
            .intermittent
            .left_out_with(unusable);
        (unusable | left_out).with(Quantity::Airspeed, contradicted)
    }

    /// The quantities that are too old or frozen.
    pub(super) fn silent_or_frozen(&self, now: Time) -> Quantities {
        self.stale(now) | self.frozen()
    }

    /// Follows which quantities come and go in a failsafe.
    pub(super) fn follow_intermittent(&mut self, dt_s: f64) {
        if self.supervisor.degraded.is_failsafe {
            let old = self.too_old(&self.intake.accepted);
            self.supervisor.degraded.intermittent.step(old, dt_s);
        }
    }

    /// Whether all that the air data are compared with is measured. A frozen
    /// altimeter may be one whose static port is blocked.
    pub(super) fn known_motion(&self, now: Time, lost: Quantities) -> KnownMotion {
        const MOTION: Quantities = Quantities::of(&[Quantity::Attitude, Quantity::SpecificForce]);
        let no_altitude = self.estimator.navigation.altitude_doubt().is_none()
            && (self.stale(now) | self.supervisor.degraded.intermittent())
                .contains(Quantity::Altitude);
        if lost.intersects(MOTION) || no_altitude || self.estimator.navigation.suspects_motion() {
            KnownMotion::Unknown
        } else if self.is_on_wheels() {
            KnownMotion::OnWheels
        } else {
            KnownMotion::InFlight
        }
    }

    /// What is lost and not replaced by what counts as measured: an airspeed by
    /// forces and motion does while it is accurate, and nothing is lost that it
    /// comes from; so does the climb by a satellite receiver in place of an altitude.
    pub(super) fn unreplaced(&self, now: Time, lost: Quantities) -> Quantities {
        let is_known = self.estimator.is_accurate(&self.config, ACCURATE_RATIO)
            && !lost.intersects(FORCES_NEED);
        let climb_is_known = self
            .intake
            .accepted
            .velocity
            .is_fresh(now, self.config.max_age);
        lost.keeping(Quantity::Airspeed, !is_known)
            .keeping(Quantity::Altitude, !climb_is_known)
    }

    /// Whether the airspeed is known by forces and motion, of an aircraft that is learned
    /// and has no sensor of it; none of any other.
    pub(super) fn knows_airspeed_by_forces(&self) -> Option<bool> {
        let has_none =
            self.config.airframe.is_some() && self.intake.accepted.airspeed_mps.is_never();
        has_none.then(|| self.estimator.is_accurate(&self.config, FLYABLE_RATIO))
    }

    /// Follows a failsafe: for how long it has lasted, and whether all is good
    /// again.
    pub(super) fn follow_failsafe(&mut self, tick: &Tick, measured: &Measurements) {
        if let Some(lasted_s) = self.supervisor.degraded.recovered_s.take() {
            self.journal.add(lasted(GOOD_AGAIN, lasted_s));
        }
        if !self.supervisor.degraded.is_failsafe {
            self.supervisor.degraded.repeated.flown_on(tick.dt_s);
            self.supervisor.degraded.forget_unsound(tick.dt_s);
            return;
        }
        let faults = self.unsafe_now(tick.woke, measured);
        let held = held_without(self.unreplaced(tick.woke, self.lost(tick.woke)));
        let config = &self.config.failsafe;
        let degraded = &mut self.supervisor.degraded;
        degraded.lasted_s += tick.dt_s;
        let limit_s = held.for_s.min(config.degraded.as_secs_f64());
        degraded.is_sound = !faults.contains(flags::DOUBTED_GYROSCOPE)
            && !faults.intersects(flags::NOT_SENSED)
            && degraded.lasted_s <= limit_s;
        if degraded.is_sound {
            degraded.forget_unsound(tick.dt_s);
        } else {
            degraded.unsound_s += tick.dt_s;
        }
        degraded.good_s = if faults.is_empty() {
            degraded.good_s + self.intake.clock.passed_s()
        } else {
            0.0
        };
        let glides = degraded.glides
            || config.end == FailsafeEnd::Glide && degraded.unsound_s > config.hold.as_secs_f64();
        if glides && !degraded.glides {
            self.journal.add(lasted(FLOWN_OTHERWISE, degraded.lasted_s));
        }
        degraded.glides = glides;
    }
}
