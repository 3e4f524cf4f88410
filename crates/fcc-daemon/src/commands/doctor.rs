//! `fccd doctor`: what the machine offers and what it lacks.

use super::print_json;
use crate::cli::DoctorArgs;
use crate::doctor::Diagnosis;
use crate::exit::Exit;

/// Looks at the machine.
pub(super) fn doctor(args: &DoctorArgs) -> Exit {
    let diagnosis = Diagnosis::of(&args.root);
    if args.json {
        let printed = print_json(&diagnosis);
        if printed != Exit::Success {
            return printed;
        }
    } else {
        println!("{}", diagnosis.to_text());
    }
    if diagnosis.lacks_something() {
        Exit::MachineLacks
    } else {
        Exit::Success
    }
}
