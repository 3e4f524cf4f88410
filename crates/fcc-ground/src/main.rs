//! `fcc-ground`: the ground station.

use std::process::ExitCode;

fn main() -> ExitCode {
    fcc_ground::run().into()
}
