//! Which measurements are taken at all.
//!
//! A value that is not finite, outside what any aircraft of this kind can do,
//! or further from the last than any aircraft moves in between, is treated as
//! one that did not arrive: the last good one stays, and grows old. A single
//! outlier costs nothing then; one that stays is a loss of its sensor.

use core::f64::consts::PI;
use core::time::Duration;

use crate::blocks::wrap_pi;
use crate::flight::{Attitude, BodyRates, Measurements, Plant, SpecificForce, Surfaces};
use crate::framework::Reading;

/// Faster than sound is out of range, m/s.
const MAX_AIRSPEED_MPS: f64 = 340.0;
/// Below the Dead Sea and above the tropopause is out of range, m.
const ALTITUDE_M: core::ops::RangeInclusive<f64> = -500.0..=20_000.0;
/// More than 20 g is out of range, m/s².
const MAX_SPECIFIC_FORCE_MPS2: f64 = 200.0;
/// More than two turns a second is out of range, rad/s.
const MAX_RATE_RADPS: f64 = 12.6;
/// Angles are good to two turns either way: -180..180 and 0..360 both pass.
const MAX_ANGLE_RAD: f64 = 12.6;

/// How far a value may be from the last good one: a part that sensors, gusts
/// and landings are granted at once, and one that grows with the time between
/// the two.
///
/// Wide of what a light aircraft does, so that only what no aircraft does is
/// kept out: a smaller step goes through the filters as noise does.
struct PlausibilityLimit {
    at_once: f64,
    per_s: f64,
}

/// 10° of a sensor that finds its way back after a gap, and a roll of half a
/// turn a second: twice what trainers do.
const ATTITUDE_RAD: PlausibilityLimit = PlausibilityLimit {
    at_once: 0.175,
    per_s: PI,
};
/// 15° of a compass that swings, and half a turn a second: a fast spin.
const HEADING_RAD: PlausibilityLimit = PlausibilityLimit {
    at_once: 0.26,
    per_s: PI,
};
/// A gust, and the roll acceleration of full aileron twice over.
const RATES_RADPS: PlausibilityLimit = PlausibilityLimit {
    at_once: 1.0,
    per_s: 8.0,
};
/// 3 g at once, as a hard landing, and what a gust builds up.
const SPECIFIC_FORCE_MPS2: PlausibilityLimit = PlausibilityLimit {
    at_once: 30.0,
    per_s: 200.0,
};
/// 23 kt at once is the shear of a gust front; 2 g along the path.
const AIRSPEED_MPS: PlausibilityLimit = PlausibilityLimit {
    at_once: 12.0,
    per_s: 20.0,
};
/// 50 ft at once, of a static source in a gust; 60 m/s is a steep dive.
const HEIGHT_M: PlausibilityLimit = PlausibilityLimit {
    at_once: 15.0,
    per_s: 60.0,
};

/// The reach grows for so long, s: through a few lost datagrams. A source that
/// goes on to say what cannot be is not to be believed for its persistence
/// before its loss was seen.
const GROWS_FOR_S: f64 = 0.1;

/// A source that goes on for so many times the age at which a reading is too
/// old has convinced us: it is the old value that was wrong, or the aircraft
/// was put somewhere else. By then its loss was seen.
const CONVINCED_AFTER: u32 = 4;

impl PlausibilityLimit {
    fn holds(&self, difference: f64, gap_s: f64) -> bool {
        difference.abs() <= self.at_once + self.per_s * gap_s.min(GROWS_FOR_S)
    }
}

/// Copies from `new` into `good` what can be true. Readings are too old at
/// `max_age`.
pub(crate) fn plausibility_gate(good: &mut Measurements, new: &Measurements, max_age: Duration) {
    let convinced = CONVINCED_AFTER * max_age;
    take(
        &mut good.attitude,
        &new.attitude,
        convinced,
        |a: &Attitude| within(a.pitch_rad, MAX_ANGLE_RAD) && within(a.roll_rad, MAX_ANGLE_RAD),
        |a, b, gap_s| {
            ATTITUDE_RAD.holds(b.pitch_rad - a.pitch_rad, gap_s)
                && ATTITUDE_RAD.holds(wrap_pi(b.roll_rad - a.roll_rad), gap_s)
        },
    );
    take(
        &mut good.heading_rad,
        &new.heading_rad,
        convinced,
        |rad| within(*rad, MAX_ANGLE_RAD),
        |a, b, gap_s| HEADING_RAD.holds(wrap_pi(b - a), gap_s),
    );
    take(
        &mut good.body_rates,
        &new.body_rates,
        convinced,
        |r| rates(r).iter().all(|rate| within(*rate, MAX_RATE_RADPS)),
        |a, b, gap_s| near(rates(a), rates(b), &RATES_RADPS, gap_s),
    );
    take(
        &mut good.specific_force,
        &new.specific_force,
        convinced,
        |f| {
            let within = |force: &f64| within(*force, MAX_SPECIFIC_FORCE_MPS2);
            forces(f).iter().all(within)
        },
        |a, b, gap_s| near(forces(a), forces(b), &SPECIFIC_FORCE_MPS2, gap_s),
    );
    take(
        &mut good.airspeed_mps,
        &new.airspeed_mps,
        convinced,
        |mps| within(*mps, MAX_AIRSPEED_MPS),
        |a, b, gap_s| AIRSPEED_MPS.holds(b - a, gap_s),
    );
    take(
        &mut good.altitude_m,
        &new.altitude_m,
        convinced,
        |m| ALTITUDE_M.contains(m),
        |a, b, gap_s| HEIGHT_M.holds(b - a, gap_s),
    );
    let anywhere = Duration::ZERO;
    take(
        &mut good.angle_of_attack_rad,
        &new.angle_of_attack_rad,
        anywhere,
        |rad| within(*rad, MAX_ANGLE_RAD),
        |_, _, _| true,
    );
    take(
        &mut good.surfaces,
        &new.surfaces,
        anywhere,
        Surfaces::is_valid,
        |_, _, _| true,
    );
    take(
        &mut good.plant,
        &new.plant,
        anywhere,
        |plant: &Plant| plant.time_s.is_finite(),
        |_, _, _| true,
    );
    good.engage_switch = new.engage_switch;
    good.position = new.position;
    good.velocity = new.velocity;
}

fn take<T: Copy>(
    good: &mut Reading<T>,
    new: &Reading<T>,
    convinced: Duration,
    can_be_true: impl Fn(&T) -> bool,
    can_follow: impl Fn(&T, &T, f64) -> bool,
) {
    if !can_be_true(&new.value) {
        return;
    }
    let gap = new.taken.since(good.taken);
    if gap >= convinced || can_follow(&good.value, &new.value, gap.as_secs_f64()) {
        *good = *new;
    }
}

fn rates(r: &BodyRates) -> [f64; 3] {
    [r.roll_radps, r.pitch_radps, r.yaw_radps]
}

fn forces(f: &SpecificForce) -> [f64; 3] {
    [f.x_mps2, f.y_mps2, f.z_mps2]
}

fn near(a: [f64; 3], b: [f64; 3], reach: &PlausibilityLimit, gap_s: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| reach.holds(b - a, gap_s))
}

/// False for NaN.
fn within(value: f64, most: f64) -> bool {
    value.abs() <= most
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::framework::Time;

    const MAX_AGE: Duration = Duration::from_millis(250);

    fn ms(ms: i64) -> Time {
        Time::from_nanos(ms * 1_000_000)
    }

    fn flying(at: Time) -> Measurements {
        Measurements {
            airspeed_mps: Reading::new(51.0, at),
            altitude_m: Reading::new(914.0, at),
            heading_rad: Reading::new(6.2, at),
            ..Measurements::default()
        }
    }

    #[test]
    fn what_cannot_be_true_leaves_the_last_good_value_to_grow_old() {
        let mut good = Measurements::default();
        let mut new = flying(ms(1));
        plausibility_gate(&mut good, &new, MAX_AGE);
        for bad in [f64::NAN, f64::INFINITY, -1e9, 1e9] {
            new.airspeed_mps = Reading::new(bad, ms(2));
            new.altitude_m = Reading::new(bad, ms(2));
            plausibility_gate(&mut good, &new, MAX_AGE);
            assert_eq!(good.airspeed_mps, Reading::new(51.0, ms(1)));
            assert_eq!(good.altitude_m, Reading::new(914.0, ms(1)));
        }
    }

    #[test]
    fn a_jump_is_kept_out_until_it_lasts() {
        let mut good = flying(ms(0));
        for at_ms in (25..1_000).step_by(25) {
            let mut new = flying(ms(at_ms));
            new.altitude_m.value = 1_200.0;
            plausibility_gate(&mut good, &new, MAX_AGE);
            assert_eq!(good.altitude_m, Reading::new(914.0, ms(0)), "{at_ms} ms");
            assert_eq!(good.airspeed_mps.taken, ms(at_ms));
        }
        let mut new = flying(ms(1_000));
        new.altitude_m.value = 1_200.0;
        plausibility_gate(&mut good, &new, MAX_AGE);
        assert_eq!(good.altitude_m, new.altitude_m);
    }

    #[test]
    fn a_single_outlier_costs_one_reading() {
        let mut good = flying(ms(0));
        let mut new = flying(ms(25));
        new.airspeed_mps.value = 90.0;
        plausibility_gate(&mut good, &new, MAX_AGE);
        plausibility_gate(&mut good, &flying(ms(50)), MAX_AGE);
        assert_eq!(good.airspeed_mps, Reading::new(51.0, ms(50)));
    }

    #[test]
    fn headings_on_both_sides_of_north_are_neighbours() {
        let mut good = flying(ms(0));
        let mut new = flying(ms(25));
        new.heading_rad.value = 0.05;
        plausibility_gate(&mut good, &new, MAX_AGE);
        assert_eq!(good.heading_rad, new.heading_rad);
    }
}
