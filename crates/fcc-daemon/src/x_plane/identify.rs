//! `fccd x-plane identify`: how X-Plane's aircraft responds to its controls.

use std::fmt::Write as _;

use fcc_xplane_check::{Identified, identify as carry_out};

use super::terminal::Terminal;
use super::{IdentifyArgs, fail, request};
use crate::exit::Exit;
use crate::output;

/// Measures the responses, and prints gains.
pub(super) fn identify(args: &IdentifyArgs) -> Exit {
    let request = match request(&args.connection, args.files.clone()) {
        Ok(request) => request,
        Err(exit) => return exit,
    };
    let mut terminal = match Terminal::open(false) {
        Ok(terminal) => terminal,
        Err(error) => return fail(&format!("signals cannot be caught: {error}")),
    };
    let result = carry_out(request, &mut terminal);
    drop(terminal);
    match result {
        Ok(found) if args.json => output::json(&found, Exit::Success),
        Ok(found) => output::result(text(&found), Exit::Success),
        Err(error) => fail(&error.to_string()),
    }
}

/// A table as comments, and the lines for the configuration.
fn text(found: &Identified) -> String {
    let mut text = format!(
        "# At {:.0} kt; response to a full deflection, rad/s after 0.6 s, of the throttle m/s\u{b2}:\n",
        found.airspeed_kt
    );
    for response in &found.responses {
        let _ = writeln!(
            text,
            "#   {:<9}{:8.3}   Cessna 172: {:.3}",
            response.control, response.response, response.reference
        );
    }
    text.push_str("# A first guess: check it with `fccd x-plane check --only 9,11`.\n");
    text.push_str(&found.toml());
    text
}
