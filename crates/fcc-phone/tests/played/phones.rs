//! Good phones and bad ones.

use std::time::Duration;

use fcc_core::flight::Measurements;
use fcc_core::framework::{SensorFault, Time};
use fcc_device::{Clock, monotonic};
use fcc_phone::{Accuracy, Clocks, Kind, PhoneSettings, PositionReport, StampClock};
use serde_json::json;

use crate::fake::{
    ACCELEROMETER, BAROMETER, CALIBRATED_GYROSCOPE, CALIBRATED_MAGNETOMETER, GYROSCOPE,
    MAGNETOMETER, Played,
};

/// `ENODEV`.
const NO_DEVICE: SensorFault = SensorFault::Io { errno: 19 };

#[test]
fn a_phone_at_rest_is_measured_in_its_axes() {
    let mut phone = Played::new("rest", &[]);
    phone.until("all are read", |_, sampled| sampled.is_ok());
    let measured = &phone.measured;
    let force = measured.raw_specific_force.value;
    assert_eq!((force.x_mps2, force.y_mps2), (0.0, 0.0));
    assert!((force.z_mps2 - 9.81).abs() < 1e-6);
    assert!((measured.raw_body_rates.value.pitch_radps - 0.02).abs() < 1e-8);
    let field = measured.magnetic_field.value;
    assert_eq!((field.x_ut, field.y_ut, field.z_ut), (0.0, 20.0, -45.0));
    assert_eq!(measured.static_pressure_pa.value, 101_325.0);
    assert!(
        phone
            .devices
            .iter()
            .all(|(_, status)| status.trouble().is_none())
    );
}

/// 100 Hz are asked of all; the barometer can do 25. Jitter and latency are in no
/// stamp.
#[test]
fn rates_are_asked_for_and_measured_whatever_the_jitter() {
    let jitter = json!({"values": [0.0, 0.0, 9.81], "jitter_us": 15_000, "latency_us": 20_000});
    let mut phone = Played::new("jitter", &[(ACCELEROMETER, jitter)]);
    phone.until("rates are known", |phone, _| {
        let of = |kind| phone.health(kind).measured_hz;
        of(Kind::Accelerometer).is_some() && of(Kind::Barometer).is_some()
    });
    let accelerometer = phone.health(Kind::Accelerometer);
    assert_eq!(accelerometer.asked_hz, Some(100.0));
    assert!((accelerometer.measured_hz.unwrap() - 100.0).abs() < 1.0);
    assert!(accelerometer.is_uncalibrated);
    assert_eq!(accelerometer.name, "jitter of type 35");
    let barometer = phone.health(Kind::Barometer);
    assert_eq!(barometer.asked_hz, Some(25.0));
    assert!((barometer.measured_hz.unwrap() - 25.0).abs() < 1.0);
}

/// For 0.2 s in each 0.7 s it gives nothing: older readings, and no fault.
#[test]
fn a_gap_is_an_older_reading_and_no_fault() {
    let gaps = json!({"values": [0.01, 0.02, 0.03], "gap_ms": [700, 200]});
    let mut phone = Played::new("gaps", &[(GYROSCOPE, gaps)]);
    phone.until("all are read", |_, sampled| sampled.is_ok());
    let (mut is_old, mut returned) = (false, 0);
    phone.until("two gaps", |phone, sampled| {
        assert_eq!(sampled, Ok(()), "{:?}", phone.trouble(Kind::Gyroscope));
        let age = monotonic().since(phone.measured.raw_body_rates.taken);
        let was_old = std::mem::replace(&mut is_old, age > Duration::from_millis(150));
        returned += u32::from(was_old && !is_old);
        returned == 2
    });
}

#[test]
fn a_sensor_that_stalls_is_a_fault_and_is_opened_anew() {
    let mut phone = Played::new("stall", &[]);
    phone.until("all are read", |_, sampled| sampled.is_ok());
    phone.tell(MAGNETOMETER, &json!({"is_stalled": true}));
    phone.until("silence", |_, sampled| sampled == Err(SensorFault::Silent));
    phone.until("the reason", |phone, _| {
        phone
            .trouble(Kind::Magnetometer)
            .contains("has given nothing for 1 s")
    });
    // The others are read.
    let gyroscope = phone.measured.raw_body_rates.taken;
    assert!(monotonic().since(gyroscope) < Duration::from_secs(5));
    phone.tell(MAGNETOMETER, &json!({"values": [1.0, 2.0, 3.0]}));
    phone.until("it is back", |phone, sampled| {
        sampled.is_ok() && phone.measured.magnetic_field.value.y_ut == 2.0
    });
    assert_eq!(phone.trouble(Kind::Magnetometer), "");
}

/// The time of the day.
#[test]
fn a_wrong_clock_is_a_fault_and_gives_nothing() {
    let day = json!({"values": [0.0, 0.0, 9.81], "ahead_ns": 1_800_000_000_000_000_000_i64});
    let mut phone = Played::new("day", &[(ACCELEROMETER, day)]);
    phone.until("the reason", |phone, sampled| {
        let is_named = phone
            .trouble(Kind::Accelerometer)
            .contains("of no known clock");
        is_named && sampled.is_err()
    });
    assert_eq!(phone.measured, Measurements::default());
}

/// A phone that has slept for an hour: two sensors stamp on one clock, one on the
/// other.
#[test]
fn stamps_of_either_clock_are_times_of_the_loop() {
    const SLEPT: Duration = Duration::from_secs(3_600);
    let clocks = Clocks {
        monotonic: Clock::default(),
        boottime: Clock::new(|| monotonic() + SLEPT),
    };
    let ahead = SLEPT.as_nanos() as i64;
    let told = [
        (
            ACCELEROMETER,
            json!({"values": [0.0, 0.0, 9.81], "ahead_ns": ahead}),
        ),
        (GYROSCOPE, json!({"values": [0.1], "ahead_ns": ahead})),
    ];
    let settings = PhoneSettings {
        has_position: false,
        ..PhoneSettings::default()
    };
    let mut phone = Played::with("clocks", &told, &settings, clocks);
    phone.until("all are read", |_, sampled| sampled.is_ok());
    let clock = |kind| phone.health(kind).clock.unwrap();
    assert_eq!(clock(Kind::Accelerometer), StampClock::Boottime);
    assert_eq!(clock(Kind::Gyroscope), StampClock::Boottime);
    assert_eq!(clock(Kind::Magnetometer), StampClock::Monotonic);
    for taken in [
        phone.measured.raw_specific_force.taken,
        phone.measured.magnetic_field.taken,
    ] {
        assert!(monotonic().since(taken) < Duration::from_secs(5));
    }
}

#[test]
fn a_phone_without_a_barometer_gives_nothing_unless_it_is_left_out() {
    let told = [(BAROMETER, json!({"is_there": false}))];
    let mut phone = Played::new("no barometer", &told);
    phone.until("the reason", |phone, sampled| {
        phone
            .trouble(Kind::Barometer)
            .ends_with("this phone has none")
            && sampled == Err(NO_DEVICE)
    });
    phone.until("the others", |phone, _| {
        phone.health(Kind::Gyroscope).measured_hz.is_some()
    });
    assert_eq!(phone.sample(), Err(NO_DEVICE));
    assert_eq!(phone.measured, Measurements::default(), "nothing engages");
    let settings = PhoneSettings {
        kinds: vec![Kind::Accelerometer, Kind::Gyroscope, Kind::Magnetometer],
        has_position: false,
        ..PhoneSettings::default()
    };
    let mut phone = Played::with("no barometer", &told, &settings, Clocks::default());
    phone.until("all are read", |_, sampled| sampled.is_ok());
    assert!(phone.measured.static_pressure_pa.is_never());
}

/// Half of what a loop at 40 Hz needs; and one that refuses altogether.
#[test]
fn a_sensor_that_is_too_slow_or_refuses_is_not_used() {
    let told = [
        (GYROSCOPE, json!({"rate_hz": 20.0})),
        (ACCELEROMETER, json!({"refuses": true})),
    ];
    let mut phone = Played::new("slow", &told);
    phone.until("the reason", |phone, _| {
        phone
            .trouble(Kind::Gyroscope)
            .contains("20.0 events a second, of 100")
    });
    let refused = phone.trouble(Kind::Accelerometer);
    assert!(refused.contains("refuses 100 events a second"), "{refused}");
    assert_eq!(phone.sample(), Err(NO_DEVICE));
    assert_eq!(phone.measured, Measurements::default());
}

#[test]
fn the_bias_that_the_phone_has_at_first_is_subtracted_and_kept() {
    let biased = |bias: f64| json!({"values": [0.5, 0.0, 0.0, bias, 0.0, 0.0]});
    let mut phone = Played::new("bias", &[(GYROSCOPE, biased(0.25))]);
    let roll = |phone: &Played| phone.measured.raw_body_rates.value.roll_radps;
    phone.until("all are read", |_, sampled| sampled.is_ok());
    assert_eq!(roll(&phone), 0.25);
    // The phone changes its mind in flight.
    phone.tell(
        GYROSCOPE,
        &json!({"values": [0.75, 0.0, 0.0, 0.5, 0.0, 0.0]}),
    );
    phone.until("another value", |phone, _| roll(phone) > 0.45);
    assert!(roll(&phone) <= 0.5, "{}", roll(&phone));
    let settings = PhoneSettings {
        uses_own_bias: false,
        has_position: false,
        ..PhoneSettings::default()
    };
    let told = [(GYROSCOPE, biased(0.25))];
    let mut phone = Played::with("bias", &told, &settings, Clocks::default());
    phone.until("all are read", |_, sampled| sampled.is_ok());
    assert_eq!(phone.measured.raw_body_rates.value.roll_radps, 0.5);
}

/// A phone with calibrated kinds alone says how much it trusts them.
#[test]
fn without_uncalibrated_kinds_the_others_are_used_and_their_accuracy_is_shown() {
    let field = |status: i8| json!({"values": [0.0, 20.0, -45.0], "status": status});
    let told = [
        (GYROSCOPE, json!({"is_there": false})),
        (CALIBRATED_GYROSCOPE, json!({"values": [0.1, 0.2, 0.3]})),
        (MAGNETOMETER, json!({"is_there": false})),
        (CALIBRATED_MAGNETOMETER, field(3)),
    ];
    let mut phone = Played::new("calibrated", &told);
    phone.until("all are read", |_, sampled| sampled.is_ok());
    assert!(!phone.health(Kind::Gyroscope).is_uncalibrated);
    assert!((phone.measured.raw_body_rates.value.yaw_radps - 0.3).abs() < 1e-7);
    assert_eq!(
        phone.health(Kind::Magnetometer).accuracy,
        Some(Accuracy::High)
    );
    phone.tell(CALIBRATED_MAGNETOMETER, &field(0));
    phone.until("the change", |phone, _| {
        phone.health(Kind::Magnetometer).accuracy == Some(Accuracy::Unreliable)
    });
    assert_eq!(phone.sample(), Ok(()));
}

#[test]
fn positions_of_the_app_are_fixes() {
    let mut phone = Played::with(
        "position",
        &[],
        &PhoneSettings::default(),
        Clocks::default(),
    );
    phone.until("no position is a fault", |phone, sampled| {
        !phone.measured.raw_body_rates.is_never() && sampled == Err(SensorFault::Silent)
    });
    let mut altitude_m = 500.0;
    phone.until("a fix", |phone, sampled| {
        altitude_m += 0.1;
        phone.handle.positions().send(PositionReport {
            elapsed_realtime_ns: boottime().as_nanos(),
            latitude_deg: 48.0,
            longitude_deg: 11.0,
            altitude_m,
            speed_mps: 20.0,
            bearing_deg: Some(0.0),
            ..PositionReport::default()
        });
        sampled.is_ok() && !phone.measured.gnss.is_never()
    });
    let fix = phone.measured.gnss.value;
    assert!((fix.position.latitude_rad - 48.0_f64.to_radians()).abs() < 1e-12);
    assert!((fix.velocity.north_mps - 20.0).abs() < 1e-9);
    assert!(fix.velocity.down_mps < 0.0, "it climbs");
}

fn boottime() -> Time {
    Clocks::default().boottime.now()
}
