//! The same seed gives the same flight, to the last bit, on every machine.

use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, Sensor, Tick};
use fcc_sim::{Channels, SensorConfig, Severity, SimConfig, Simulation};

fn rough_config(seed: u64) -> SimConfig {
    SimConfig {
        gusts: Some(Severity::Moderate),
        sensors: SensorConfig {
            noise: Channels::TYPICAL_NOISE,
            delay_ms: 30,
            ..SensorConfig::default()
        },
        seed,
        ..SimConfig::default()
    }
}

/// FNV-1a over the bits of every measured number of 10,000 ticks, with the
/// controls moving.
fn hash_of_a_flight(seed: u64) -> u64 {
    let mut sim = Simulation::new(&rough_config(seed)).unwrap();
    let mut measured = Measurements::default();
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for number in 0..10_000 {
        let tick = Tick {
            number,
            dt_s: 0.025,
            ..Tick::default()
        };
        sim.sensor.sample(&tick, &mut measured).unwrap();
        for value in [
            measured.attitude.value.pitch_rad,
            measured.attitude.value.roll_rad,
            measured.heading_rad.value,
            measured.body_rates.value.roll_radps,
            measured.body_rates.value.pitch_radps,
            measured.body_rates.value.yaw_radps,
            measured.specific_force.value.x_mps2,
            measured.specific_force.value.y_mps2,
            measured.specific_force.value.z_mps2,
            measured.airspeed_mps.value,
            measured.altitude_m.value,
            measured.angle_of_attack_rad.value,
            measured.position.value.latitude_rad,
            measured.position.value.longitude_rad,
            measured.velocity.value.down_mps,
        ] {
            for byte in value.to_bits().to_le_bytes() {
                hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
            }
        }
        // Level the wings, and add an oscillation.
        let stir = if (number / 40).is_multiple_of(2) {
            0.05
        } else {
            -0.05
        };
        let surfaces = Surfaces {
            throttle: 0.8,
            elevator: stir,
            aileron: (-measured.attitude.value.roll_rad).clamp(-1.0, 1.0),
            rudder: -stir,
            ..Surfaces::IDLE
        };
        sim.actuator.apply(&tick, &surfaces).unwrap();
    }
    hash
}

/// The number is the same on every machine, optimised or not. It changes with
/// the model, and must then be updated.
#[test]
fn a_seed_is_a_flight_to_the_last_bit() {
    const FLIGHT_OF_SEED_1: u64 = 0xd777_431f_b3a1_62f9;
    let flight = hash_of_a_flight(1);
    assert_eq!(flight, hash_of_a_flight(1));
    assert_ne!(flight, hash_of_a_flight(2));
    assert_eq!(flight, FLIGHT_OF_SEED_1, "{flight:#018x}");
}
