//! The standard atmosphere against the tables of ISO 2533:1975 (and of the
//! U.S. Standard Atmosphere 1976, the same to 20 km), and airspeeds against
//! another program.

use fcc_sim::atmosphere::Air;
use fcc_sim::units::{FOOT_M, KNOT_MPS};

fn assert_close(value: f64, table: f64, tolerance: f64, what: &str) {
    assert!(
        (value - table).abs() <= tolerance,
        "{what}: {value}, in the table {table}"
    );
}

/// Geopotential altitude m, temperature K, pressure Pa, density kg/m³.
#[test]
fn the_standard_atmosphere_agrees_with_the_tables() {
    for (altitude_m, temperature, pressure, density) in [
        (-1_000.0, 294.650, 113_929.0, 1.347_0),
        (0.0, 288.150, 101_325.0, 1.225_0),
        (1_000.0, 281.650, 89_874.6, 1.111_6),
        (5_000.0, 255.650, 54_019.9, 0.736_116),
        (11_000.0, 216.650, 22_632.1, 0.363_918),
        (15_000.0, 216.650, 12_044.6, 0.193_674),
        (20_000.0, 216.650, 5_474.89, 0.088_034_9),
    ] {
        let air = Air::at(altitude_m);
        assert_close(air.temperature_k, temperature, 1e-3, "temperature");
        assert_close(air.pressure_pa, pressure, 6e-6 * pressure, "pressure");
        assert_close(air.density_kgpm3, density, 6e-5 * density, "density");
    }
}

/// ICAO Doc 7488 in feet: 3,000 ft, 8,000 ft.
#[test]
fn the_standard_atmosphere_agrees_with_the_table_in_feet() {
    let air = Air::at(3_000.0 * FOOT_M);
    assert_close(air.pressure_pa, 90_812.0, 1.0, "pressure at 3,000 ft");
    assert_close(air.density_kgpm3, 1.121_0, 5e-5, "density at 3,000 ft");
    let air = Air::at(8_000.0 * FOOT_M);
    assert_close(air.pressure_pa, 75_262.0, 2.0, "pressure at 8,000 ft");
    assert_close(
        air.density_ratio(),
        0.786_0,
        5e-5,
        "density ratio at 8,000 ft",
    );
}

#[test]
fn the_speed_of_sound_agrees_with_the_tables() {
    assert_close(Air::at(0.0).sound_mps(), 340.294, 1e-3, "sea level");
    assert_close(Air::at(11_000.0).sound_mps(), 295.070, 1e-3, "11 km");
}

/// True, calibrated and equivalent airspeed in kt, as JSBSim 1.3.3 has them;
/// its altitude is geometric, hence the tolerance.
#[test]
fn airspeeds_are_those_of_another_program() {
    for (altitude_ft, true_kt, calibrated_kt, equivalent_kt, tolerance_kt) in [
        (3_000.0, 104.50, 100.00, 99.967, 0.02),
        (10_000.0, 200.00, 172.53, 171.88, 0.05),
        (36_089.0, 458.89, 265.53, 250.42, 0.6),
    ] {
        let air = Air::at(altitude_ft * FOOT_M);
        let true_mps = true_kt * KNOT_MPS;
        let calibrated = air.indicated_mps(true_mps) / KNOT_MPS;
        assert_close(calibrated, calibrated_kt, tolerance_kt, "calibrated");
        let equivalent = air.equivalent_mps(true_mps) / KNOT_MPS;
        assert_close(equivalent, equivalent_kt, tolerance_kt, "equivalent");
    }
}

#[test]
fn airspeeds_convert_and_back() {
    let air = Air::at(3_000.0 * FOOT_M);
    let true_mps = air.true_of_indicated_mps(100.0 * KNOT_MPS);
    assert_close(true_mps / KNOT_MPS, 104.50, 0.02, "true");
    assert_close(air.indicated_mps(true_mps) / KNOT_MPS, 100.0, 1e-9, "back");
    assert_close(Air::at(0.0).indicated_mps(60.0), 60.0, 1e-9, "sea level");
}

#[test]
fn beyond_the_limits_the_air_is_constant_and_finite() {
    assert_eq!(Air::at(1e9), Air::at(20_000.0));
    assert_eq!(Air::at(-1e9), Air::at(-5_000.0));
}
