//! Prints how the built-in aircraft is trimmed over airspeed and altitude:
//! angle of attack, elevator, throttle, thrust, lift over drag.
//!
//!     cargo run -p fcc-sim --example trim_table

#![expect(clippy::print_stdout, reason = "all that it does is to print")]

use fcc_sim::units::{DEGREE_RAD, FOOT_M, KNOT_MPS};
use fcc_sim::{Airframe, trim};

fn main() {
    let airframe = Airframe::SKYHAWK;
    println!("altitude  indicated     true    alpha  elevator  throttle  thrust   L/D");
    println!("      ft         kt       kt      deg       deg               N        ");
    for altitude_ft in [0.0, 3_000.0, 8_000.0] {
        for indicated_kt in [50.0, 60.0, 70.0, 80.0, 90.0, 100.0, 110.0, 120.0] {
            print!("{altitude_ft:8.0}  {indicated_kt:9.0}");
            match trim(&airframe, indicated_kt * KNOT_MPS, altitude_ft * FOOT_M) {
                Ok(trim) => println!(
                    "  {:7.1}  {:7.2}  {:8.2}  {:8.3}  {:6.0}  {:4.1}",
                    trim.true_airspeed_mps / KNOT_MPS,
                    trim.alpha_rad / DEGREE_RAD,
                    trim.elevator_rad / DEGREE_RAD,
                    trim.throttle,
                    trim.thrust_n,
                    airframe.weight_n() / trim.thrust_n,
                ),
                Err(error) => println!("  {error}"),
            }
        }
    }
}
