//! Which raw sensors only repeat what they gave before.

use core::time::Duration;

use libm::hypot;

use super::super::stuck::{MOVED_FIELD, MOVED_FORCE, MOVED_MPS, MOVED_RATE, StuckSensor};
use super::RawNavigation;
use fcc_core::flight::{GnssFix, Measurements, Velocity};
use fcc_core::framework::{Reading, Time};

/// For so long a place or a velocity may be repeated: that of a receiver that gives one fix
/// a second is read several times, and a coarse velocity of steady flight is the same for
/// some fixes.
const LASTS: Duration = Duration::from_secs(2);

/// An inertial unit that repeats a specific force of less than this, m/s², and its rates: zeros
/// of a bus that does not answer, less the biases. All other sensors may be at the same bus.
const NO_FORCE_MPS2: f64 = 3.0;

/// Of the latest readings, which are only repeated.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Repeated {
    pub(super) force: bool,
    pub(super) rates: bool,
    pub(super) field: bool,
}

/// Follows the readings of accelerometers, gyroscopes, magnetometer and receiver.
#[derive(Clone, Debug, Default)]
pub(super) struct Repeats {
    force: StuckSensor,
    rates: StuckSensor,
    field: StuckSensor,
    now: Repeated,
    /// Whether the latest fix is at the place of the one before.
    pub(super) is_same_place: bool,
    /// For how long the receiver has repeated its place.
    place_lasts: Duration,
    /// Whether the latest fix has the velocity of the one before at another place, and since
    /// which fix that is the velocity, and the vertical one.
    pub(super) is_same_velocity: bool,
    velocity_since: Time,
    down_since: Time,
    last_fix: Time,
}

impl RawNavigation {
    /// Whether a magnetometer only repeats its field although the aircraft moves.
    pub const fn repeats_field(&self) -> bool {
        self.repeats.now.field
    }

    /// Whether a receiver has only repeated its place for seconds, although it moves.
    pub fn repeats_place(&self) -> bool {
        self.repeats.place_lasts > LASTS
    }
}

impl Repeats {
    /// Takes the readings of a tick, force, rates and field as vectors, and the fix that
    /// was used last.
    pub(super) fn step(
        &mut self,
        raw: &Measurements,
        [force, rates, field]: [[f64; 3]; 3],
        used: &Reading<GnssFix>,
    ) -> Repeated {
        let is_silent = self.force.is_last(force)
            && self.rates.is_last(rates)
            && force.iter().all(|part| part.abs() < NO_FORCE_MPS2);
        let of_force = [rates, field];
        let of_rates = [force, field];
        let of_field = [force, rates];
        self.now = Repeated {
            force: self.force.step(
                raw.raw_specific_force.taken,
                force,
                of_force,
                [MOVED_RATE, MOVED_FIELD],
            ),
            rates: self.rates.step(
                raw.raw_body_rates.taken,
                rates,
                of_rates,
                [MOVED_FORCE, MOVED_FIELD],
            ),
            field: self.field.step(
                raw.magnetic_field.taken,
                field,
                of_field,
                [MOVED_FORCE, MOVED_RATE],
            ),
        };
        self.now.force |= is_silent;
        self.now.rates |= is_silent;
        self.is_same_place = is_same_place(&used.value, &raw.gnss.value);
        self.place_lasts = if self.is_same_place {
            raw.gnss.taken.since(used.taken)
        } else {
            Duration::ZERO
        };
        if raw.gnss.taken > used.taken && !self.is_same_place {
            self.follow_velocity(&raw.gnss, &used.value.velocity);
        }
        self.now
    }

    fn follow_velocity(&mut self, fix: &Reading<GnssFix>, last: &Velocity) {
        let velocity = fix.value.velocity;
        self.is_same_velocity = velocity == *last && moves(&velocity);
        if !self.is_same_velocity {
            self.velocity_since = fix.taken;
        }
        if velocity.down_mps.to_bits() != last.down_mps.to_bits() || !moves(&velocity) {
            self.down_since = fix.taken;
        }
        self.last_fix = fix.taken;
    }

    /// Whether the receiver has repeated its velocity for longer than it may.
    pub(super) fn is_velocity_old(&self) -> bool {
        self.lasts(self.velocity_since)
    }

    /// Whether it has repeated its vertical velocity for so long: one that measures none gives
    /// always 0.
    pub(super) fn is_down_old(&self) -> bool {
        self.lasts(self.down_since)
    }

    fn lasts(&self, since: Time) -> bool {
        !since.is_never() && self.last_fix.since(since) > LASTS
    }
}

/// Whether a receiver gives the place again that it gave before, although it says that
/// it moves.
fn is_same_place(last: &GnssFix, fix: &GnssFix) -> bool {
    fix.position == last.position && moves(&fix.velocity)
}

fn moves(velocity: &Velocity) -> bool {
    hypot(velocity.north_mps, velocity.east_mps) > MOVED_MPS
}
