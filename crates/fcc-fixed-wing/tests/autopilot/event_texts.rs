//! The texts of events.

use fcc_core::framework::{EventKind, Stage};
use fcc_fixed_wing::{Autopilot, AutopilotCommand};

fn said(kind: EventKind<AutopilotCommand>) -> String {
    kind.description::<Autopilot>().to_string()
}

/// The length from the first missed deadline to the tick that is served.
#[test]
fn missed_periods_and_overruns_are_counted_in_words() {
    let timer = |took_ns| {
        said(EventKind::Overrun {
            of: Stage::Timer,
            took_ns,
            budget_ns: 25_000_000,
            longest: Stage::Timer,
        })
    };
    assert_eq!(
        timer(970_700_000),
        "the timer woke 970.7 ms late: 38 periods of 25.0 ms were missed"
    );
    assert_eq!(
        timer(25_040_000),
        "the timer woke 25.0 ms late: 1 period of 25.0 ms was missed"
    );
    let over = |count| {
        said(EventKind::OverrunsOver {
            count,
            first: 5,
            last: 7,
        })
    };
    assert_eq!(
        over(1),
        "1 tick overran or was missed up to tick 7; none for a second"
    );
    assert_eq!(
        over(2),
        "2 ticks overran or were missed up to tick 7; none for a second"
    );
}
