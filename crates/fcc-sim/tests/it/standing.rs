//! On its wheels with the brakes set the aircraft stands in wind.

use std::time::Duration;

use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, Sensor, Tick, Time};
use fcc_sim::units::{DEGREE_RAD, KNOT_MPS};
use fcc_sim::{Severity, SimConfig, Simulation, Wind};

/// Ticks of 25 ms in half a minute.
const TICKS: u64 = 1_200;

/// The largest bank and pitch in a wind, degrees.
fn stand(from_deg: f64, wind_kt: f64, gusts: Option<Severity>, seed: u64) -> f64 {
    let mut sim = Simulation::new(&SimConfig {
        on_runway: true,
        wind: Wind {
            from_rad: from_deg * DEGREE_RAD,
            speed_mps: wind_kt * KNOT_MPS,
        },
        gusts,
        seed,
        ..SimConfig::default()
    })
    .unwrap();
    let mut most_rad = 0.0_f64;
    for number in 1..TICKS {
        let due = Time::from_nanos(0) + Duration::from_millis(25 * number);
        let tick = Tick {
            number,
            scheduled: due,
            woke: due,
            missed: 0,
            dt_s: 0.025,
        };
        let mut measured = Measurements::default();
        if sim.sensor.sample(&tick, &mut measured).is_err() {
            return f64::INFINITY;
        }
        let braked = Surfaces {
            left_brake: Some(1.0),
            right_brake: Some(1.0),
            ..Surfaces::IDLE
        };
        sim.actuator.apply(&tick, &braked).unwrap();
        let truth = sim.truth.get();
        most_rad = most_rad
            .max(truth.roll_rad.abs())
            .max(truth.pitch_rad.abs());
    }
    most_rad / DEGREE_RAD
}

/// Before, it tipped over in 5 kt from behind: to the air it was falling, and flow from
/// behind had the angle of attack of half a turn.
#[test]
fn it_stands_in_wind_from_anywhere() {
    for from_deg in (0..360).step_by(30) {
        for (wind_kt, gusts) in [(8.0, None), (20.0, Some(Severity::Light))] {
            let most_deg = stand(f64::from(from_deg), wind_kt, gusts, 3);
            assert!(most_deg < 10.0, "{wind_kt} kt from {from_deg}: {most_deg}");
        }
    }
}
