use super::*;

const KT: f64 = 0.514_444;
const DT_S: f64 = 0.1;

/// The wind triangle of FAA-H-8083-25B, chapter 16: a wind of 40 kt from 045° and a true
/// airspeed of 120 kt on the heading 076° give a ground speed of 88 kt on the track 090°.
const WIND_KT: f64 = 40.0;
const WIND_FROM_DEG: f64 = 45.0;
const AIRSPEED_KT: f64 = 120.0;

fn over_ground(heading_deg: f64, variation_deg: f64) -> OverGround {
    let (heading, from) = (heading_deg.to_radians(), WIND_FROM_DEG.to_radians());
    OverGround {
        north_mps: KT * (AIRSPEED_KT * cos(heading) - WIND_KT * cos(from)),
        east_mps: KT * (AIRSPEED_KT * sin(heading) - WIND_KT * sin(from)),
        heading_rad: (heading_deg - variation_deg).to_radians(),
        sqrt_density: 1.0,
        ..OverGround::default()
    }
}

/// Legs of 60 s with turns of 90° at 3 °/s, then 60 s on the heading of the handbook.
fn flown(reads: f64, variation_deg: f64) -> Wind {
    let mut wind = Wind::new();
    for tick in 0..3_600 {
        let at_s = f64::from(tick) * DT_S;
        let turned_deg = 90.0 * libm::floor(at_s / 90.0) + (3.0 * (at_s % 90.0)).min(90.0);
        let read = over_ground(76.0 + turned_deg, variation_deg);
        wind.step(&read, Some((reads * KT * AIRSPEED_KT, 0.0)), DT_S);
    }
    wind
}

#[test]
fn the_triangle_is_that_of_the_handbook() {
    let read = over_ground(76.0, 0.0);
    assert!((hypot(read.north_mps, read.east_mps) / KT - 88.0).abs() < 0.5);
    assert!((libm::atan2(read.east_mps, read.north_mps).to_degrees() - 90.0).abs() < 0.5);
}

/// Whatever the variation, 12° west to 20° east.
#[test]
fn the_wind_and_the_airspeed_follow_from_turns() {
    for variation_deg in [-12.0, 0.0, 20.0] {
        let wind = flown(1.0, variation_deg);
        let [north, east, ..] = wind.x;
        assert!((hypot(north, east) / KT - WIND_KT).abs() < 1.0);
        let (mps, sd_mps) = wind
            .airspeed_mps(&over_ground(76.0, variation_deg))
            .unwrap();
        assert!((mps / KT - AIRSPEED_KT).abs() < 1.0, "{}", mps / KT);
        assert!(sd_mps < 2.0);
    }
}

/// The error of the sensor over its airspeed, and its standard deviation.
fn scale(wind: &Wind) -> (f64, f64) {
    (wind.x[2], sqrt(wind.covariance[2][2]))
}

/// A sensor that reads 10 % too much or too little.
#[test]
fn the_error_of_the_sensor_follows_from_turns() {
    for reads in [1.1, 0.9] {
        let wind = flown(reads, 0.0);
        let (error, sd) = scale(&wind);
        assert!((error - (1.0 / reads - 1.0)).abs() < 0.02, "{error}");
        assert!(error.abs() > 3.5 * sd, "{error} {sd}");
    }
}

/// Without a turn it may as well be the wind.
#[test]
fn the_error_of_the_sensor_is_uncertain_in_straight_flight() {
    let mut wind = Wind::new();
    for tick in 0..3_000 {
        let reads = 1.0 + 0.1 * f64::from(tick) / 3_000.0;
        wind.step(
            &over_ground(76.0, 0.0),
            Some((reads * KT * AIRSPEED_KT, 0.0)),
            DT_S,
        );
    }
    let (error, sd) = scale(&wind);
    assert!(error.abs() < 3.5 * sd, "{error} {sd}");
}
