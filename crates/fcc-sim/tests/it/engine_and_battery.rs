//! The engine's speed and the battery against handbooks.

use fcc_core::flight::Surfaces;
use fcc_sim::atmosphere::Air;
use fcc_sim::electrical::{Battery, Electrical};
use fcc_sim::propeller::{running_radps, stopped_radps};
use fcc_sim::units::{FOOT_M, KNOT_MPS};
use fcc_sim::{Aircraft, Airframe, SimConfig};

const HORSEPOWER_W: f64 = 745.7;
/// 2,700 rpm, rad/s.
const RATED_RADPS: f64 = 282.743;

fn rpm(throttle: f64, airspeed_kt: f64, air: &Air) -> f64 {
    let propulsion = Airframe::SKYHAWK.propulsion;
    running_radps(&propulsion, throttle, airspeed_kt * KNOT_MPS, air) * 9.549_297
}

/// Handbook of the 172N, of the same power and propeller: 2,280 to 2,400 rpm with full
/// throttle and the brakes set.
#[test]
fn at_rest_full_throttle_is_in_the_handbooks_range() {
    let found = rpm(1.0, 0.0, &Air::at(0.0));
    assert!((2_280.0..=2_400.0).contains(&found), "{found} rpm");
}

/// Handbook of the 172P, section 1: rated at 2,700 rpm, 123 kt at sea level.
#[test]
fn at_its_fastest_it_turns_with_its_rated_speed() {
    let found = rpm(1.0, 123.0, &Air::at(0.0));
    assert!((found / 2_700.0 - 1.0).abs() < 0.01, "{found} rpm");
}

/// Handbook of the 172P, section 5, sample problem: 6,000 ft and 20 °C above standard,
/// 2,500 rpm: 66 % of 160 hp, 112 kt.
#[test]
fn in_cruise_it_turns_as_in_the_handbook() {
    let standard = Air::at(6_000.0 * FOOT_M);
    let temperature_k = standard.temperature_k + 20.0;
    let air = Air {
        temperature_k,
        density_kgpm3: standard.density_kgpm3 * standard.temperature_k / temperature_k,
        ..standard
    };
    let propulsion = Airframe::SKYHAWK.propulsion;
    let torque_nm = 0.66 * 160.0 * HORSEPOWER_W / (2_500.0 / 9.549_297);
    let full_nm = 160.0 * HORSEPOWER_W / RATED_RADPS;
    let throttle = torque_nm / (full_nm * fcc_sim::aerodynamics::torque_ratio(&propulsion, &air));
    let found = rpm(throttle, 112.0, &air);
    assert!((found / 2_500.0 - 1.0).abs() < 0.03, "{found} rpm");
}

/// With the throttle closed it idles, and turns faster the faster it flies; without its
/// engine the propeller stands at 60 kt.
#[test]
fn an_engine_that_has_stopped_turns_slower_than_one_that_idles() {
    let air = Air::at(900.0);
    assert!((rpm(0.0, 0.0, &air) - 650.0).abs() < 0.01);
    let propulsion = Airframe::SKYHAWK.propulsion;
    let stopped_rpm =
        |airspeed_kt: f64| stopped_radps(&propulsion, airspeed_kt * KNOT_MPS, &air) * 9.549_297;
    assert_eq!(stopped_rpm(60.0), 0.0);
    for airspeed_kt in [80.0, 100.0, 120.0] {
        assert!(stopped_rpm(airspeed_kt) + 300.0 < rpm(0.0, airspeed_kt, &air));
    }
}

/// 12.75 Ah at 15 A are 51 minutes.
#[test]
fn without_the_alternator_the_battery_is_empty_after_its_capacity() {
    let mut battery = Battery::new(Electrical {
        alternator_stops_at_s: Some(60.0),
        ..Electrical::default()
    });
    let mut fly = |from_s: u32, to_s: u32| {
        for second in from_s..to_s {
            battery.step(1.0, f64::from(second), RATED_RADPS);
        }
        (battery.voltage_v(), battery.charge())
    };
    assert_eq!(fly(0, 60), (28.0, 1.0));
    let (full_v, _) = fly(60, 61);
    // Of 24 V, below the 28 of the alternator.
    assert!((24.0..26.0).contains(&full_v), "{full_v} V");
    let (half_v, half) = fly(61, 60 + 51 * 30);
    assert!((half - 0.5).abs() < 1e-9, "{half}");
    assert!(half_v < full_v);
    let (low_v, low) = fly(60 + 51 * 30, 60 + 51 * 60 - 1);
    assert!(low > 0.0 && low < 0.001, "{low}");
    assert!(low_v > 0.0 && low_v < half_v);
    assert_eq!(fly(60 + 51 * 60 - 1, 60 + 51 * 60 + 1), (0.0, 0.0));
}

/// Half a battery takes half an hour, and only while the engine turns.
#[test]
fn the_alternator_charges_the_battery() {
    let mut battery = Battery::new(Electrical {
        charge: 0.4,
        ..Electrical::default()
    });
    for second in 0..1_800 {
        battery.step(1.0, f64::from(second), RATED_RADPS);
    }
    assert!(
        (battery.charge() - 0.9).abs() < 1e-9,
        "{}",
        battery.charge()
    );
    battery.step(1.0, 1_800.0, 0.0);
    assert!(battery.charge() < 0.9 && battery.voltage_v() < 26.0);
}

/// The thrust is that of a closed throttle, whatever is commanded, and not before.
#[test]
fn an_engine_stops_when_it_is_configured_to() {
    let mut aircraft = Aircraft::new(&SimConfig {
        engine_stops_at_s: Some(5.0),
        ..SimConfig::default()
    })
    .unwrap();
    let full = Surfaces {
        throttle: 1.0,
        ..Surfaces::default()
    };
    for _ in 0..180 {
        aircraft.step(&full, 0.025);
    }
    assert!(aircraft.deflections().throttle > 0.9);
    assert!(aircraft.engine_speed_radps() > 0.85 * RATED_RADPS);
    assert_eq!(aircraft.battery().voltage_v(), 28.0);
    let fast_mps = aircraft.truth().true_airspeed_mps;
    for _ in 0..400 {
        aircraft.step(&full, 0.025);
    }
    assert_eq!(aircraft.deflections().throttle, 0.0);
    assert!(aircraft.engine_speed_radps() < 0.35 * RATED_RADPS);
    assert!(aircraft.battery().voltage_v() < 26.0);
    assert!(aircraft.truth().true_airspeed_mps < fast_mps);
}
