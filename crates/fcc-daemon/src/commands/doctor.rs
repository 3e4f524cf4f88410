//! `fccd doctor`: what the machine offers and what it lacks.

use crate::cli::DoctorArgs;
use crate::doctor::Diagnosis;
use crate::exit::Exit;
use crate::output;

/// Looks at the machine.
pub(super) fn doctor(args: &DoctorArgs) -> Exit {
    let diagnosis = Diagnosis::of(&args.root);
    let exit = if diagnosis.lacks_something() {
        Exit::MachineLacks
    } else {
        Exit::Success
    };
    if args.json {
        output::json(&diagnosis, exit)
    } else {
        output::result(diagnosis.to_text(), exit)
    }
}
