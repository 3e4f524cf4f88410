//! The plausibility gate for measurements.
//!
//! A value that is not finite, outside the range of any aircraft of this kind,
//! or further from the last one than any aircraft can move in the time between,
//! is treated as if it had not arrived: the last good value is kept with its
//! time. A single outlier then has no effect; a lasting one is a loss of its
//! sensor.

use core::f64::consts::{FRAC_PI_2, PI};
use core::time::Duration;

use libm::{asin, cos, sin, sqrt};

use super::quantity::{Quantities, Quantity};
use fcc_core::blocks::wrap_pi;
use fcc_core::flight::{
    Attitude, Battery, BodyRates, GnssFix, Measurements, PilotControls, Plant, Position,
    SpecificForce, Surfaces, Velocity,
};
use fcc_core::framework::schema::{Schema, in_range};
use fcc_core::framework::{Reading, ReadingSet, Readings};

/// The largest plausible speed, that of sound, m/s.
const MAX_AIRSPEED_MPS: f64 = 340.0;
/// The plausible altitudes: from below the Dead Sea to above the tropopause, m.
const ALTITUDE_M: core::ops::RangeInclusive<f64> = -500.0..=20_000.0;
/// The largest plausible specific force, 20 g, m/s².
const MAX_SPECIFIC_FORCE_MPS2: f64 = 200.0;
/// The largest plausible turn rate, two turns per second, rad/s.
const MAX_RATE_RADPS: f64 = 12.6;
/// The largest plausible speed over the ground: that of sound, with a jet stream
/// from behind, m/s.
const MAX_GROUND_SPEED_MPS: f64 = 450.0;
/// The largest plausible angle, two turns in either direction: -180..180 and
/// 0..360 are both accepted.
const MAX_ANGLE_RAD: f64 = 12.6;

/// The permitted distance of a value from the last good one: a constant part
/// for sensor errors, gusts and landings, and a part that grows with the time
/// between the two.
///
/// The limits are wider than the motion of a light aircraft, so that only
/// impossible values are rejected: a smaller step passes through the filters
/// like noise.
#[derive(Debug)]
pub struct PlausibilityLimit {
    /// However short the time between two readings.
    pub at_once: f64,
    /// In addition, for each second between them.
    pub per_s: f64,
}

/// 10° for a sensor that recovers after a gap, and a roll rate of half a turn
/// per second: twice that of training aircraft.
const ATTITUDE_RAD: PlausibilityLimit = PlausibilityLimit {
    at_once: 0.175,
    per_s: PI,
};
/// 15° for a swinging compass, and half a turn per second, as in a fast spin.
const HEADING_RAD: PlausibilityLimit = PlausibilityLimit {
    at_once: 0.26,
    per_s: PI,
};
/// A gust, and twice the roll acceleration of full aileron.
pub const RATES_RADPS: PlausibilityLimit = PlausibilityLimit {
    at_once: 1.0,
    per_s: 8.0,
};
/// 3 g at once, as in a hard landing, and the build-up of a gust.
pub const SPECIFIC_FORCE_MPS2: PlausibilityLimit = PlausibilityLimit {
    at_once: 30.0,
    per_s: 200.0,
};
/// 23 kt at once, the shear of a gust front; 2 g along the path.
const AIRSPEED_MPS: PlausibilityLimit = PlausibilityLimit {
    at_once: 12.0,
    per_s: 20.0,
};
/// 50 ft at once, for a static source in a gust; 60 m/s, as in a steep dive.
pub const HEIGHT_M: PlausibilityLimit = PlausibilityLimit {
    at_once: 15.0,
    per_s: 60.0,
};

/// The time for which the limit grows, s: a few lost datagrams. A source that
/// keeps sending implausible values must not be accepted before its loss was
/// detected.
const GROWS_FOR_S: f64 = 0.1;

/// The time for which the limit of the airspeed grows over a gap in which the
/// aircraft flew on unheard, s: with the controls at their trims the airspeed
/// swings about the trimmed one, so a longer gap permits no larger change.
const AIRSPEED_GROWS_FOR_S: f64 = 1.0;

/// A rejected airspeed is accepted after this time, s, if it is this multiple of the
/// last good one: the aircraft may have gained or lost as much meanwhile. A tube
/// without total pressure, near 0, is not.
const AIRSPEED_RETURNS_AFTER_S: f64 = 10.0;
const AIRSPEED_RETURNS: core::ops::RangeInclusive<f64> = 0.6..=1.7;

/// After this many times the age at which a reading is too old, a source's new
/// value is accepted: either the old value was wrong, or the aircraft was
/// repositioned. By then its loss was detected.
const ACCEPTED_AFTER: u32 = 4;

impl PlausibilityLimit {
    fn holds(&self, difference: f64, gap_s: f64) -> bool {
        self.holds_over(difference, gap_s.min(GROWS_FOR_S))
    }

    /// Whether each axis of a vector can have changed so within a gap, s.
    pub fn holds_each(&self, from: [f64; 3], to: [f64; 3], gap_s: f64) -> bool {
        let mut axes = from.iter().zip(to);
        axes.all(|(from, to)| self.holds(to - from, gap_s))
    }

    /// Whether a value can have changed by this much in any length of time, s.
    pub fn holds_over(&self, difference: f64, passed_s: f64) -> bool {
        difference.abs() <= self.at_once + self.per_s * passed_s
    }
}

/// By what the plausibility of readings is judged, besides their values.
#[derive(Clone, Copy, Debug)]
pub struct GateLimits {
    /// Readings older than this are too old.
    pub max_age: Duration,
    /// The quantities of which only a value is accepted that can follow the last good one, however long that was ago.
    pub rejected_by_gate: Quantities,
    /// By how much the altitude of a coarse sensor changes at once, m.
    pub altitude_step_m: f64,
}

/// The reading of the airspeed.
pub const AIRSPEED: ReadingSet = ReadingSet::named(Measurements::NAMES, &["airspeed"]);
/// The reading of the engage switch.
pub const ENGAGE_SWITCH: ReadingSet = ReadingSet::named(Measurements::NAMES, &["engage switch"]);

/// Copies the plausible values from `new` into `good`, and returns which they are.
pub fn plausibility_gate(
    good: &mut Measurements,
    new: &Measurements,
    limits: &GateLimits,
) -> ReadingSet {
    let GateLimits {
        max_age,
        rejected_by_gate,
        altitude_step_m,
    } = *limits;
    let convinced = |quantity: Quantity| {
        if rejected_by_gate.contains(quantity) {
            Duration::MAX
        } else {
            ACCEPTED_AFTER * max_age
        }
    };
    let attitude = take(
        &mut good.attitude,
        &new.attitude,
        convinced(Quantity::Attitude),
        |a: &Attitude| within(a.pitch_rad, MAX_ANGLE_RAD) && within(a.roll_rad, MAX_ANGLE_RAD),
        |a, b, gap_s| {
            // Gravity turns by no more than both angles together.
            let most = (b.roll_rad - a.roll_rad).abs() + (b.pitch_rad - a.pitch_rad).abs();
            ATTITUDE_RAD.holds(most, gap_s) || ATTITUDE_RAD.holds(gravity_turned(*a, *b), gap_s)
        },
    );
    let pitch_rad = good.attitude.value.pitch_rad;
    let heading = take(
        &mut good.heading_rad,
        &new.heading_rad,
        convinced(Quantity::Heading),
        |rad| within(*rad, MAX_ANGLE_RAD),
        // Near the vertical a small rotation is a large change of the heading.
        |a, b, gap_s| {
            let turned = wrap_pi(b - a);
            HEADING_RAD.holds(turned, gap_s) || HEADING_RAD.holds(cos(pitch_rad) * turned, gap_s)
        },
    );
    let rates = take(
        &mut good.body_rates,
        &new.body_rates,
        convinced(Quantity::BodyRates),
        |r| turning(r).iter().all(|rate| within(*rate, MAX_RATE_RADPS)),
        |a, b, gap_s| RATES_RADPS.holds_each(turning(a), turning(b), gap_s),
    );
    let force = take(
        &mut good.specific_force,
        &new.specific_force,
        convinced(Quantity::SpecificForce),
        |f| {
            let within = |force: &f64| within(*force, MAX_SPECIFIC_FORCE_MPS2);
            forces(f).iter().all(within)
        },
        |a, b, gap_s| SPECIFIC_FORCE_MPS2.holds_each(forces(a), forces(b), gap_s),
    );
    let airspeed = take(
        &mut good.airspeed_mps,
        &new.airspeed_mps,
        convinced(Quantity::Airspeed),
        |mps| within(*mps, MAX_AIRSPEED_MPS),
        |a, b, gap_s| {
            AIRSPEED_MPS.holds(b - a, gap_s)
                || gap_s > AIRSPEED_RETURNS_AFTER_S && AIRSPEED_RETURNS.contains(&(b / a.max(1.0)))
        },
    );
    let altitude = take(
        &mut good.altitude_m,
        &new.altitude_m,
        convinced(Quantity::Altitude),
        |m| is_possible_altitude(*m),
        |a, b, gap_s| {
            let beyond_m = ((b - a).abs() - altitude_step_m).max(0.0);
            HEIGHT_M.holds(beyond_m, gap_s)
        },
    );
    let [angle, position, velocity, surfaces, plant, pilot] = take_others(good, new);
    [
        attitude, heading, rates, force, airspeed, altitude, angle, position, velocity, surfaces,
        true, plant, true, pilot,
    ]
    .into_iter()
    .chain(take_raw(good, new))
    .zip(0..)
    .fold(ReadingSet::NONE, |all, (plausible, bit)| {
        all.with(ReadingSet::one(bit), plausible)
    })
}

/// Copies what can be anything valid at once: angle of attack, position,
/// velocity, surfaces, plant, the pilot's controls; and what is always plausible.
fn take_others(good: &mut Measurements, new: &Measurements) -> [bool; 6] {
    let anywhere = Duration::ZERO;
    let angle = take(
        &mut good.angle_of_attack_rad,
        &new.angle_of_attack_rad,
        anywhere,
        |rad| within(*rad, FRAC_PI_2),
        |_, _, _| true,
    );
    let surfaces = take(
        &mut good.surfaces,
        &new.surfaces,
        anywhere,
        Surfaces::is_valid,
        |_, _, _| true,
    );
    let plant = take(
        &mut good.plant,
        &new.plant,
        anywhere,
        |plant: &Plant| plant.time_s.is_finite(),
        |_, _, _| true,
    );
    let position = take(
        &mut good.position,
        &new.position,
        anywhere,
        is_possible_position,
        |_, _, _| true,
    );
    let velocity = take(
        &mut good.velocity,
        &new.velocity,
        anywhere,
        is_possible_velocity,
        |_, _, _| true,
    );
    let pilot = take(
        &mut good.pilot_controls,
        &new.pilot_controls,
        anywhere,
        PilotControls::is_valid,
        |_, _, _| true,
    );
    replace(&mut good.engage_switch, &new.engage_switch);
    replace(&mut good.other_control, &new.other_control);
    [angle, position, velocity, surfaces, plant, pilot]
}

/// Whether an aircraft can be so high.
pub fn is_possible_altitude(altitude_m: f64) -> bool {
    ALTITUDE_M.contains(&altitude_m)
}

/// Whether an aircraft can be there.
fn is_possible_position(at: &Position) -> bool {
    at.is_on_earth() && is_possible_altitude(at.altitude_m)
}

/// Whether an aircraft can move over the ground like this.
fn is_possible_velocity(v: &Velocity) -> bool {
    let axes = [v.north_mps, v.east_mps, v.down_mps];
    axes.iter().all(|axis| within(*axis, MAX_GROUND_SPEED_MPS))
}

/// Whether a receiver's fix can be that of an aircraft: its position and velocity
/// are held to what is possible of any source.
pub fn is_possible_fix(fix: &GnssFix) -> bool {
    in_range(fix) && is_possible_position(&fix.position) && is_possible_velocity(&fix.velocity)
}

/// Copies the raw readings: any number, in its range if one is declared, and of a
/// receiver what is possible. What uses them judges them further.
fn take_raw(good: &mut Measurements, new: &Measurements) -> [bool; 11] {
    fn taken<T: Schema>(good: &mut Reading<T>, new: &Reading<T>) -> bool {
        taken_if(good, new, in_range)
    }
    fn taken_if<T: Schema>(
        good: &mut Reading<T>,
        new: &Reading<T>,
        can_be_true: fn(&T) -> bool,
    ) -> bool {
        new.is_never() || take(good, new, Duration::ZERO, can_be_true, |_, _, _| true)
    }
    [
        taken(&mut good.raw_specific_force, &new.raw_specific_force),
        taken(&mut good.raw_body_rates, &new.raw_body_rates),
        taken(&mut good.magnetic_field, &new.magnetic_field),
        taken(&mut good.static_pressure_pa, &new.static_pressure_pa),
        taken(
            &mut good.differential_pressure_pa,
            &new.differential_pressure_pa,
        ),
        taken(&mut good.air_temperature_k, &new.air_temperature_k),
        taken_if(&mut good.gnss, &new.gnss, is_possible_fix),
        taken(&mut good.range_m, &new.range_m),
        taken(&mut good.weight_on_wheels, &new.weight_on_wheels),
        taken(&mut good.engine_speed_radps, &new.engine_speed_radps),
        taken_if(&mut good.battery, &new.battery, Battery::is_valid),
    ]
}

/// Whether an airspeed can be that of an aircraft which had another one before it
/// flew on unheard for `passed_s`; none is, if none is plausible by itself.
pub fn airspeed_can_follow(before: &Reading<f64>, new: &Reading<f64>, passed_s: f64) -> bool {
    let most = AIRSPEED_MPS.at_once + AIRSPEED_MPS.per_s * passed_s.min(AIRSPEED_GROWS_FOR_S);
    before.is_never() || !new.is_never() && within(new.value - before.value, most)
}

fn take<T: Copy>(
    good: &mut Reading<T>,
    new: &Reading<T>,
    convinced: Duration,
    can_be_true: impl Fn(&T) -> bool,
    can_follow: impl Fn(&T, &T, f64) -> bool,
) -> bool {
    let gap = new.taken.since(good.taken);
    let plausible = can_be_true(&new.value)
        && (gap >= convinced || can_follow(&good.value, &new.value, gap.as_secs_f64()));
    if plausible {
        replace(good, new);
    }
    plausible
}

/// Takes a reading that is not older than the present one. One that is older
/// was accepted before, and its time postponed since.
fn replace<T: Copy>(good: &mut Reading<T>, new: &Reading<T>) {
    if new.taken >= good.taken {
        *good = *new;
    }
}

fn turning(r: &BodyRates) -> [f64; 3] {
    [r.roll_radps, r.pitch_radps, r.yaw_radps]
}

fn forces(f: &SpecificForce) -> [f64; 3] {
    [f.x_mps2, f.y_mps2, f.z_mps2]
}

/// How far the direction of gravity turned in body axes, rad: continuous through
/// the vertical, where roll jumps by half a turn.
fn gravity_turned(a: Attitude, b: Attitude) -> f64 {
    let down = |angles: Attitude| {
        let level = cos(angles.pitch_rad);
        [
            -sin(angles.pitch_rad),
            level * sin(angles.roll_rad),
            level * cos(angles.roll_rad),
        ]
    };
    let square = |(a, b): (f64, f64)| (a - b) * (a - b);
    let chord = sqrt(down(a).into_iter().zip(down(b)).map(square).sum());
    2.0 * asin((0.5 * chord).min(1.0))
}

/// False for NaN.
fn within(value: f64, most: f64) -> bool {
    value.abs() <= most
}

#[cfg(test)]
mod tests;
