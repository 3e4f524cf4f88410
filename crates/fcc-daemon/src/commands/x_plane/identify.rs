//! `fccd x-plane identify`: how X-Plane's aircraft responds to its controls.

use std::fmt::Write as _;

use fcc_core::framework::{PlantId, TakeoverNotice};
use fcc_xplane_check::{FlownBy, Identified, IdentifyError, identify as carry_out};

use super::terminal::Terminal;
use super::{Failure, not_begun, request};
use crate::cli::x_plane::IdentifyArgs;
use crate::exit::Exit;
use crate::output;
use crate::process::{Mark, Notice, is_flown, start_helper};

/// Measures the responses, and prints gains.
pub(super) fn identify(args: &IdentifyArgs) -> Result<Exit, Failure> {
    let (request, config) = request(&args.connection, args.files.clone())?;
    let mut terminal = Terminal::open(false)?;
    let by = if args.by_hand {
        FlownBy::Person
    } else {
        FlownBy::Daemon
    };
    // They tell others of the controls that the measurement itself has taken, if this
    // process is killed, or X-Plane has not confirmed their release.
    let notice = Notice::of_this_process();
    let _helper = start_helper(&config, notice, None);
    let mut mark = Mark::of(&config, args.by_hand);
    let mut held = |plant: Option<PlantId>| {
        if let Some(plant) = plant {
            let number = notice.number().wrapping_add(1);
            let is_free = mark.set(&plant, number);
            if is_free {
                notice.taking(&plant);
            }
            is_free
        } else {
            notice.release(notice.number());
            mark.remove(notice.number());
            true
        }
    };
    let flown = |plant: &PlantId| is_flown(&config, plant);
    let result = carry_out(request, by, &mut terminal, &mut held, &flown);
    drop(terminal);
    let found = result.map_err(|error| match error {
        IdentifyError::NotBegun(error) => not_begun(&error),
        error => Failure::new(error),
    })?;
    Ok(if args.json {
        output::json(&found, Exit::Success)
    } else {
        output::result(text(&found), Exit::Success)
    })
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
