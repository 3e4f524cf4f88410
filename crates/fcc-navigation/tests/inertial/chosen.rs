//! The readings of several sets of sensors, chosen as the loop does it.

use std::time::Duration;

use fcc_core::flight::Measurements;
use fcc_core::framework::{Preference, Preferred, ReadingSet, Readings, Time};
use fcc_navigation::inertial::RawNavigation;

/// What is chosen of what the sets give, each fresh for so long.
pub(crate) fn chosen(
    now: Time,
    given: &[Measurements],
    fresh_for: Duration,
    navigation: &mut RawNavigation,
) -> Measurements {
    let preferred: Vec<Preferred> = (0_u8..)
        .zip(given)
        .map(|(set, measured)| {
            navigation.observe_sensor(set, measured);
            Preferred {
                fresh_for,
                plausible: navigation.permitted(set, ReadingSet::ALL),
            }
        })
        .collect();
    let by = Preference {
        now,
        sensors: &preferred,
        reading: 0,
        of_one_sensor: ReadingSet::NONE,
    };
    let mut measured = given[0];
    for (set, own) in (1_u8..).zip(&given[1..]) {
        measured.choose(own, set, &by);
    }
    measured
}
