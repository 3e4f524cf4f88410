//! Which measurements are taken at all.
//!
//! A value that is not finite, or outside what any aircraft of this kind can
//! do, is treated as one that did not arrive: the last good one stays, and
//! grows old.

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

/// Copies from `new` into `good` what can be true.
pub(crate) fn accept(good: &mut Measurements, new: &Measurements) {
    take(&mut good.attitude, &new.attitude, |a: &Attitude| {
        within(a.pitch_rad, MAX_ANGLE_RAD) && within(a.roll_rad, MAX_ANGLE_RAD)
    });
    take(&mut good.heading_rad, &new.heading_rad, |rad| {
        within(*rad, MAX_ANGLE_RAD)
    });
    take(&mut good.body_rates, &new.body_rates, |r: &BodyRates| {
        [r.roll_radps, r.pitch_radps, r.yaw_radps]
            .iter()
            .all(|rate| within(*rate, MAX_RATE_RADPS))
    });
    take(
        &mut good.specific_force,
        &new.specific_force,
        |f: &SpecificForce| {
            [f.x_mps2, f.y_mps2, f.z_mps2]
                .iter()
                .all(|force| within(*force, MAX_SPECIFIC_FORCE_MPS2))
        },
    );
    take(&mut good.airspeed_mps, &new.airspeed_mps, |mps| {
        within(*mps, MAX_AIRSPEED_MPS)
    });
    take(&mut good.altitude_m, &new.altitude_m, |m| {
        ALTITUDE_M.contains(m)
    });
    take(
        &mut good.angle_of_attack_rad,
        &new.angle_of_attack_rad,
        |rad| within(*rad, MAX_ANGLE_RAD),
    );
    take(&mut good.surfaces, &new.surfaces, Surfaces::is_valid);
    take(&mut good.plant, &new.plant, |plant: &Plant| {
        plant.time_s.is_finite()
    });
    good.engage_switch = new.engage_switch;
    good.position = new.position;
    good.velocity = new.velocity;
}

fn take<T: Copy>(good: &mut Reading<T>, new: &Reading<T>, can_be_true: impl Fn(&T) -> bool) {
    if can_be_true(&new.value) {
        *good = *new;
    }
}

/// False for NaN.
fn within(value: f64, most: f64) -> bool {
    value.abs() <= most
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::framework::Time;

    #[test]
    fn what_cannot_be_true_leaves_the_last_good_value_to_grow_old() {
        let mut good = Measurements::default();
        let mut new = Measurements {
            airspeed_mps: Reading::new(51.0, Time::from_nanos(1)),
            altitude_m: Reading::new(914.0, Time::from_nanos(1)),
            ..Measurements::default()
        };
        accept(&mut good, &new);
        for bad in [f64::NAN, f64::INFINITY, -1e9, 1e9] {
            new.airspeed_mps = Reading::new(bad, Time::from_nanos(2));
            new.altitude_m = Reading::new(bad, Time::from_nanos(2));
            accept(&mut good, &new);
            assert_eq!(good.airspeed_mps, Reading::new(51.0, Time::from_nanos(1)));
            assert_eq!(good.altitude_m, Reading::new(914.0, Time::from_nanos(1)));
        }
    }
}
