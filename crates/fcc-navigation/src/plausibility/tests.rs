//! The gate, one value after the other.

use std::vec::Vec;

use super::*;
use fcc_core::framework::schema::{Field, Schema, Sink, Source, Value};
use fcc_core::framework::{Readings, Time};

const LIMITS: GateLimits = GateLimits {
    max_age: Duration::from_millis(250),
    rejected_by_gate: Quantities::NONE,
    altitude_step_m: 0.0,
};

/// The number of readings.
const READINGS: u32 = <Measurements as Readings>::NAMES.len() as u32;
const ALL: ReadingSet = ReadingSet::from_bits((1 << READINGS) - 1);

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
fn an_implausible_value_leaves_the_last_good_one() {
    let mut good = Measurements::default();
    let mut new = flying(ms(1));
    plausibility_gate(&mut good, &new, &LIMITS);
    for bad in [f64::NAN, f64::INFINITY, -1e9, 1e9] {
        new.airspeed_mps = Reading::new(bad, ms(2));
        new.altitude_m = Reading::new(bad, ms(2));
        plausibility_gate(&mut good, &new, &LIMITS);
        assert_eq!(good.airspeed_mps, Reading::new(51.0, ms(1)));
        assert_eq!(good.altitude_m, Reading::new(914.0, ms(1)));
    }
}

#[test]
fn a_jump_is_rejected_until_it_lasts() {
    let mut good = flying(ms(0));
    for at_ms in (25..1_000).step_by(25) {
        let mut new = flying(ms(at_ms));
        new.altitude_m.value = 1_200.0;
        plausibility_gate(&mut good, &new, &LIMITS);
        assert_eq!(good.altitude_m, Reading::new(914.0, ms(0)), "{at_ms} ms");
        assert_eq!(good.airspeed_mps.taken, ms(at_ms));
    }
    let mut new = flying(ms(1_000));
    new.altitude_m.value = 1_200.0;
    plausibility_gate(&mut good, &new, &LIMITS);
    assert_eq!(good.altitude_m, new.altitude_m);
}

#[test]
fn which_values_are_plausible_is_returned_in_the_order_of_the_measurements() {
    let mut good = flying(ms(0));
    let mut new = flying(ms(25));
    assert_eq!(plausibility_gate(&mut good, &new, &LIMITS), ALL);
    // 30 m in 25 ms, and 400 kt more.
    new.altitude_m = Reading::new(944.0, ms(50));
    new.airspeed_mps = Reading::new(257.0, ms(50));
    new.plant.value.time_s = f64::NAN;
    let plausible = plausibility_gate(&mut good, &new, &LIMITS);
    let rejected = (0..READINGS)
        .filter(|bit| !plausible.contains(ReadingSet::one(*bit)))
        .map(|bit| <Measurements as Readings>::NAMES[bit as usize]);
    assert!(rejected.eq(["airspeed", "altitude", "the plant's state"]));
}

#[test]
fn a_single_outlier_loses_one_reading() {
    let mut good = flying(ms(0));
    let mut new = flying(ms(25));
    new.airspeed_mps.value = 90.0;
    plausibility_gate(&mut good, &new, &LIMITS);
    plausibility_gate(&mut good, &flying(ms(50)), &LIMITS);
    assert_eq!(good.airspeed_mps, Reading::new(51.0, ms(50)));
}

/// Of a known altimeter of 100 ft.
#[test]
fn a_step_of_a_coarse_altimeter_is_plausible_and_two_are_not() {
    let coarse = GateLimits {
        altitude_step_m: 30.48,
        ..LIMITS
    };
    for (step_m, is_plausible) in [(30.48, true), (-30.48, true), (60.96, false)] {
        let mut good = flying(ms(0));
        let mut new = flying(ms(25));
        new.altitude_m.value += step_m;
        plausibility_gate(&mut good, &new, &coarse);
        assert_eq!(good.altitude_m.taken == ms(25), is_plausible, "{step_m}");
    }
}

#[test]
fn headings_on_both_sides_of_north_are_neighbours() {
    let mut good = flying(ms(0));
    let mut new = flying(ms(25));
    new.heading_rad.value = 0.05;
    plausibility_gate(&mut good, &new, &LIMITS);
    assert_eq!(good.heading_rad, new.heading_rad);
}

/// Repeats the values of a struct, with one number replaced.
struct Damaged {
    values: Vec<Value>,
    next: usize,
    damaged: usize,
    by: f64,
}

impl Sink for Damaged {
    fn value(&mut self, _: &'static Field, value: Value) {
        self.values.push(value);
    }
}

impl Source for Damaged {
    fn value(&mut self, _: &'static Field) -> Option<Value> {
        let value = self.values.get(self.next).copied();
        let is_damaged = self.next == self.damaged;
        self.next += 1;
        match value {
            Some(Value::Number(_)) if is_damaged => Some(Value::Number(self.by)),
            value => value,
        }
    }
}

/// All numbers; what an aircraft need not have, and does not, is 0.
fn numbers(measurements: &Measurements) -> Vec<f64> {
    let mut measurements = *measurements;
    let (surfaces, battery) = (
        &mut measurements.surfaces.value,
        &mut measurements.battery.value,
    );
    for value in [
        &mut battery.voltage_v,
        &mut battery.charge,
        &mut surfaces.elevator_trim,
        &mut surfaces.flaps,
        &mut surfaces.left_brake,
        &mut surfaces.right_brake,
        &mut surfaces.nose_wheel,
        &mut surfaces.gear,
    ] {
        *value = Some(value.unwrap_or(0.0));
    }
    let mut all = Damaged {
        values: Vec::new(),
        next: 0,
        damaged: 0,
        by: 0.0,
    };
    measurements.visit(&mut all);
    let number = |value: &Value| match value {
        Value::Number(number) => Some(*number),
        _ => None,
    };
    all.values.iter().filter_map(number).collect()
}

/// Each number that is declared in the measurements, whatever it is.
#[test]
fn what_is_not_a_number_does_not_pass_in_any_field() {
    let mut whole = Measurements::default();
    whole.each_time(&mut |taken| *taken = ms(25));
    let mut damaged = Damaged {
        values: Vec::new(),
        next: 0,
        damaged: 0,
        by: 0.0,
    };
    whole.visit(&mut damaged);
    let mut tried = 0;
    for place in 0..damaged.values.len() {
        for by in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            (damaged.next, damaged.damaged, damaged.by) = (0, place, by);
            let mut new = Measurements::default();
            new.read(Measurements::ROOT, &mut damaged).unwrap();
            if numbers(&new).iter().all(|number| number.is_finite()) {
                continue;
            }
            tried += 1;
            let mut good = Measurements::default();
            let plausible = plausibility_gate(&mut good, &new, &LIMITS);
            assert!(
                numbers(&good).iter().all(|number| number.is_finite()),
                "value {place} is {by}"
            );
            assert_ne!(plausible, ALL, "value {place} is {by}");
        }
    }
    // NaN says that an aircraft does not have it: six outputs, two readings of a battery.
    assert_eq!(tried, 3 * numbers(&whole).len() - 8);
}

/// X-Plane measures the voltage only.
#[test]
fn a_battery_without_a_measured_charge_is_plausible() {
    let mut new = flying(ms(25));
    let battery = Battery {
        voltage_v: Some(12.6),
        charge: None,
    };
    new.battery = Reading::new(battery, ms(25));
    let mut good = flying(ms(0));
    plausibility_gate(&mut good, &new, &LIMITS);
    assert_eq!(good.battery.value.voltage_v, Some(12.6));
}

/// A loop at 60 °/s: over the top roll and heading change by half a turn from
/// one reading to the next.
#[test]
fn a_loop_through_the_vertical_is_plausible() {
    let mut good = flying(ms(0));
    for step in 1..240_i32 {
        let along_deg = 1.5 * f64::from(step);
        let at = ms(25 * i64::from(step));
        let over = along_deg > 90.0 && along_deg < 270.0;
        let half_turn = if over { PI } else { 0.0 };
        let attitude = Attitude {
            roll_rad: half_turn,
            pitch_rad: asin(along_deg.to_radians().sin()),
        };
        let mut new = flying(at);
        new.attitude = Reading::new(attitude, at);
        new.heading_rad = Reading::new(half_turn, at);
        plausibility_gate(&mut good, &new, &LIMITS);
        assert_eq!(good.attitude.taken, at, "{along_deg} deg");
        assert_eq!(good.heading_rad.taken, at, "{along_deg} deg");
    }
}
