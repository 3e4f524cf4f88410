//! The controller of JSBSim's F450 as a process, for a plant of another program in lockstep.
//!
//! Arguments: the age of its measurements, s, and when it steps by 5 m to the north, s. For each
//! tick of 2.5 ms it reads [`IN`] numbers from standard input (64-bit, little-endian): roll, pitch
//! and heading, rad; turn rates about x, y, z, rad/s; specific force along x, y, z, m/s²;
//! latitude and longitude, rad; altitude, m; velocity north, east, down, m/s. It writes the
//! speeds of four motors. It engages after 4 s and hovers at 10 m.

use std::error::Error;
use std::io::{Read, Write};

use fcc_core::flight::{
    Attitude, BodyRates, Measurements, Motors, Position, SpecificForce, Velocity,
};
use fcc_core::framework::{Controller, Reading, Tick, Time};
use fcc_multicopter::{Airframe, Command, GoTo, Item, Multicopter, MulticopterConfig};

/// Numbers of a measurement.
const IN: usize = 15;
const PERIOD_S: f64 = 0.002_5;
const ENGAGES_S: f64 = 4.0;

static PLAN: [Item; 2] = [Item::TakeOff(10.0), Item::Hover(1e9)];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Result<Vec<f64>, _> =
        std::env::args().skip(1).map(|word| word.parse()).collect();
    let [latency_s, step_s] = arguments?[..] else {
        return Err("give the latency and the time of the step, s".into());
    };
    let mut multicopter = Multicopter::new(&MulticopterConfig {
        airframe: Airframe {
            // Full thrust is 3.7 times the weight; 63 % of a speed in 0.1 s.
            rotor_thrust_n: 12.7,
            motor_lag_s: 0.1,
            thrust_curve: 0.566,
            ..Airframe::default()
        },
        period_s: PERIOD_S,
        latency_s,
        plan: &PLAN,
        ..MulticopterConfig::default()
    })?;
    let (mut input, mut output) = (std::io::stdin().lock(), std::io::stdout().lock());
    let mut bytes = [0; 8 * IN];
    let mut number = 0;
    while input.read_exact(&mut bytes).is_ok() {
        number += 1;
        let time_s = number as f64 * PERIOD_S;
        let woke = Time::from_nanos((time_s * 1e9) as i64);
        let tick = Tick {
            number,
            scheduled: woke,
            woke,
            missed: 0,
            dt_s: PERIOD_S,
        };
        let measured = measurements(&bytes, woke);
        multicopter.estimate(&tick, &measured);
        if (time_s - ENGAGES_S).abs() < 0.5 * PERIOD_S {
            multicopter.engage(&tick, &measured);
        }
        if (time_s - step_s).abs() < 0.5 * PERIOD_S {
            multicopter.command(&Command::GoTo(GoTo {
                north_m: 5.0,
                height_m: 10.0,
                ..GoTo::default()
            }));
        }
        let motors = if time_s > ENGAGES_S {
            multicopter.control(&tick, &measured)
        } else {
            Motors::default()
        };
        for speed in motors.speeds().iter().take(4) {
            output.write_all(&speed.unwrap_or(0.0).to_le_bytes())?;
        }
        output.flush()?;
    }
    Ok(())
}

fn measurements(bytes: &[u8; 8 * IN], taken: Time) -> Measurements {
    let (numbers, _) = bytes.as_chunks::<8>();
    let mut numbers = numbers.iter().map(|number| f64::from_le_bytes(*number));
    let mut next = || numbers.next().unwrap_or_default();
    Measurements {
        attitude: Reading::new(
            Attitude {
                roll_rad: next(),
                pitch_rad: next(),
            },
            taken,
        ),
        heading_rad: Reading::new(next(), taken),
        body_rates: Reading::new(
            BodyRates {
                roll_radps: next(),
                pitch_radps: next(),
                yaw_radps: next(),
            },
            taken,
        ),
        specific_force: Reading::new(
            SpecificForce {
                x_mps2: next(),
                y_mps2: next(),
                z_mps2: next(),
            },
            taken,
        ),
        position: Reading::new(
            Position {
                latitude_rad: next(),
                longitude_rad: next(),
                altitude_m: next(),
            },
            taken,
        ),
        velocity: Reading::new(
            Velocity {
                north_mps: next(),
                east_mps: next(),
                down_mps: next(),
            },
            taken,
        ),
        ..Measurements::default()
    }
}
