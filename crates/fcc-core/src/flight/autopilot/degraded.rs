//! Degraded flight: what is held without a lost quantity, and for how long.

mod coming_and_going;

use core::time::Duration;

use coming_and_going::{FORGOTTEN_SLOWER, Intermittent, Repeated};

use super::runway::Low;
use super::{Autopilot, FailsafeEnd, flags};
use crate::flight::Measurements;
use crate::flight::navigation::{AirspeedSource, KnownMotion, Lost, MotionDoubt};
use crate::framework::{Flags, Notice, Tick, Time};

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
struct Row(Flags, Held);

const fn row(lost: Flags, lateral: Lateral, vertical: Vertical, power: Power, for_s: f64) -> Row {
    let held = Held {
        lateral,
        vertical,
        power,
        for_s,
    };
    Row(lost, held)
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
    const fn both(a: Flags, b: Flags) -> Flags {
        Flags::from_bits(a.bits() | b.bits())
    }
    [
        row(flags::HEADING, L::WingsLevel, V::Level, P::Airspeed, SOUND),
        // The rudder follows the aileron, and damps the yaw; the climb rate of
        // the barometer alone is too late for the loop.
        row(
            flags::SPECIFIC_FORCE,
            L::WingsLevel,
            V::Pitch,
            P::Airspeed,
            SOUND,
        ),
        // Pitch and power determine the airspeed, unless forces and motion do.
        row(flags::AIRSPEED, L::WingsLevel, V::Pitch, P::Trim, SOUND),
        row(flags::ALTITUDE, L::WingsLevel, V::Pitch, P::Trim, SOUND),
        // The derivative of attitude and heading replaces the gyroscope.
        row(
            flags::BODY_RATES,
            L::WingsLevel,
            V::Level,
            P::Airspeed,
            SOUND,
        ),
        // The integrated gyroscope replaces the attitude, corrected by gravity:
        // its error is some 10 s of the gyroscope's drift.
        row(flags::ATTITUDE, L::WingsLevel, V::Level, P::Airspeed, SOUND),
        row(
            both(flags::ATTITUDE, flags::SPECIFIC_FORCE),
            L::WingsLevel,
            V::Pitch,
            P::Trim,
            INTEGRATED_S,
        ),
        // An outage is flown through; then `failsafe.hold_s` ends it.
        row(
            both(flags::ATTITUDE, flags::BODY_RATES),
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
const FORCES_NEED: Flags = Flags::from_bits(
    flags::ATTITUDE.bits() | flags::SPECIFIC_FORCE.bits() | flags::ALTITUDE.bits(),
);
const ACCURATE_RATIO: f64 = 0.05;
/// ... and where there never was a sensor, so that the limits have been that much narrower
/// from the beginning.
const FLYABLE_RATIO: f64 = 0.1;

/// What is held without these quantities.
pub(super) fn held_without(lost: Flags) -> Held {
    let all = Held {
        lateral: Lateral::WingsLevel,
        vertical: Vertical::Level,
        power: Power::Airspeed,
        for_s: SOUND,
    };
    let rows = TABLE
        .iter()
        .filter(|Row(missing, _)| lost.contains(*missing));
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
    pub(super) frozen: Flags,
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
    /// What happened in this tick, by the number of a notice, after how long, s.
    news: Option<(u8, f64)>,
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

    /// The first tick of a failsafe, at an altitude, m.
    pub(super) fn begin(&mut self, altitude_m: f64) {
        self.is_failsafe = true;
        self.altitude_m = altitude_m;
        self.repeated.begin();
    }
}

impl Autopilot {
    /// The quantities that control cannot use: too old, frozen, or contradicted.
    pub(super) fn lost(&self, now: Time, measured: &Measurements) -> Flags {
        let contradicted = self
            .external(now, measured)
            .contains(flags::SUSPECT_AIRSPEED)
            || self.navigation.airspeed_doubt().is_some();
        let doubt = self.navigation.motion_doubt();
        let unusable = self
            .silent_or_frozen(now)
            .with(flags::ATTITUDE, doubt == Some(MotionDoubt::Attitude))
            .with(flags::BODY_RATES, doubt == Some(MotionDoubt::BodyRates));
        let left_out = self.degraded.intermittent.left_out_with(unusable);
        (unusable | left_out).with(flags::AIRSPEED, contradicted)
    }

    /// The quantities that are too old or frozen.
    pub(super) fn silent_or_frozen(&self, now: Time) -> Flags {
        flags::unusable(self.stale(now), self.frozen())
    }

    /// The quantities that come and go in a failsafe.
    pub(super) const fn intermittent(&self) -> Flags {
        self.degraded.intermittent.left_out
    }

    /// Follows which quantities come and go in a failsafe.
    pub(super) fn follow_intermittent(&mut self, dt_s: f64) {
        if self.degraded.is_failsafe {
            let old = self.too_old(&self.accepted);
            self.degraded.intermittent.step(old, dt_s);
        }
    }

    /// Whether all that the air data are compared with is measured. A frozen
    /// altimeter may be one whose static port is blocked.
    pub(super) fn known_motion(&self, now: Time, lost: Flags) -> KnownMotion {
        const MOTION: Flags =
            Flags::from_bits(flags::ATTITUDE.bits() | flags::SPECIFIC_FORCE.bits());
        let no_altitude = self.navigation.altitude_doubt().is_none()
            && (self.stale(now) | self.intermittent()).contains(flags::ALTITUDE);
        if lost.intersects(MOTION) || no_altitude || self.navigation.suspects_motion() {
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
    pub(super) fn unreplaced(&self, now: Time, lost: Flags) -> Flags {
        let is_known = self.is_accurate(ACCURATE_RATIO) && !lost.intersects(FORCES_NEED);
        let climb_is_known = self.accepted.velocity.is_fresh(now, self.config.max_age);
        lost.keeping(flags::AIRSPEED, !is_known)
            .keeping(flags::ALTITUDE, !climb_is_known)
    }

    fn is_accurate(&self, ratio: f64) -> bool {
        let estimate = self.navigation.estimate();
        let accurate_mps = ratio * self.config.reference_airspeed_mps;
        estimate.airspeed_source == AirspeedSource::Forces
            && estimate.airspeed_uncertainty_mps < accurate_mps
    }

    /// Whether the airspeed is known by forces and motion, of an aircraft that is learned
    /// and has no sensor of it; none of any other.
    pub(super) fn knows_airspeed_by_forces(&self) -> Option<bool> {
        let has_none = self.config.airframe.is_some() && self.accepted.airspeed_mps.is_never();
        has_none.then(|| self.is_accurate(FLYABLE_RATIO))
    }

    /// Follows a failsafe: for how long it has lasted, and whether all is good
    /// again.
    pub(super) fn follow_failsafe(&mut self, tick: &Tick, measured: &Measurements) {
        let recovered_s = self.degraded.recovered_s.take();
        self.degraded.news = recovered_s.map(|lasted_s| (GOOD_AGAIN, lasted_s));
        if !self.degraded.is_failsafe {
            self.degraded.repeated.flown_on(tick.dt_s);
            self.degraded.forget_unsound(tick.dt_s);
            return;
        }
        let faults = self.unsafe_now(tick.woke, measured) | self.not_flyable(tick.woke, measured);
        let held = held_without(self.unreplaced(tick.woke, self.lost(tick.woke, measured)));
        let config = &self.config.failsafe;
        let degraded = &mut self.degraded;
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
            degraded.good_s + self.clock.passed_s()
        } else {
            0.0
        };
        let glides = degraded.glides
            || config.end == FailsafeEnd::Glide && degraded.unsound_s > config.hold.as_secs_f64();
        if glides && !degraded.glides {
            degraded.news = Some((FLOWN_OTHERWISE, degraded.lasted_s));
        }
        degraded.glides = glides;
    }

    /// Whether the failsafe goes on: what it holds is sound, or nobody is there
    /// to take over.
    pub(super) fn goes_on(&self) -> bool {
        let degraded = &self.degraded;
        let is_sound = degraded.is_sound && !degraded.is_worn_out(self.config.failsafe.hold);
        is_sound || self.config.failsafe.end == FailsafeEnd::Glide
    }

    /// Whether what was lost has been good for long enough. Whether the failsafe
    /// ends then is for the loop to decide: one because of overruns goes on until
    /// these are over.
    pub(super) fn is_good_again(&self) -> bool {
        let after = self.config.failsafe.recovered_after * self.degraded.repeated.factor();
        let good = Duration::from_secs_f64(self.degraded.good_s);
        self.degraded.is_failsafe && after > Duration::ZERO && good >= after
    }

    /// What happened in this tick.
    pub(super) fn degraded_notice(&self) -> Option<Notice> {
        let (kind, lasted_s) = self.degraded.news?;
        Some(Notice {
            kind,
            lasted_ns: (lasted_s * 1e9) as u64,
            ..Notice::default()
        })
    }

    /// Whether it flies on without a quantity.
    pub(super) const fn is_degraded(&self) -> bool {
        let degraded = &self.degraded;
        degraded.is_sound && (degraded.good_s == 0.0 || !degraded.intermittent.left_out.is_empty())
    }
}

/// The lost quantities by name, for navigation.
pub(super) const fn by_name(lost: Flags) -> Lost {
    Lost {
        attitude: lost.contains(flags::ATTITUDE),
        heading: lost.contains(flags::HEADING),
        body_rates: lost.contains(flags::BODY_RATES),
        specific_force: lost.contains(flags::SPECIFIC_FORCE),
        airspeed: lost.contains(flags::AIRSPEED),
        altitude: lost.contains(flags::ALTITUDE),
    }
}
