//! Whether the magnetic field turns as the rates say, or as it would in other axes or in
//! another unit.
//!
//! How a field turns does not tell which of both sensors has the other axes, unless they are of
//! the left hand: those are the gyroscope's. A magnetometer with all three axes reversed turns
//! as one without.

use fcc_core::flight::inertial::Observation;
use nalgebra::Vector3;

use super::sources::Sources;
use super::turns::{Relation, are_in_degrees, in_words, windows};

/// What is wrong with axes, or with the unit of rates.
pub(super) fn wrong(sources: &Sources) -> Option<String> {
    let rates = samples(sources, |observation| match observation {
        Observation::Rates(row) => Some(row),
        _ => None,
    });
    let fields = samples(sources, |observation| match observation {
        Observation::MagneticField(row) => Some(row),
        _ => None,
    });
    let turns = windows(&rates, &fields);
    if are_in_degrees(&turns) {
        return Some(
            "gyroscope: the field of the magnetometer turns as if rates were in °/s: they are in \
             rad/s; are they in °/s?"
                .to_owned(),
        );
    }
    let Relation { rates, is_only_one } =
        Relation::of(&turns).filter(|found| !found.is_as_given())?;
    let given = "give x, y, z forward, right, down";
    if !is_only_one {
        return Some(format!(
            "gyroscope or magnetometer: the field turns as the rates say if the axes of one of \
             both are others than are given, and turns around all three axes would tell which: \
             {given}"
        ));
    }
    if rates.determinant() < 0.0 {
        return Some(format!(
            "gyroscope: the field turns as the rates say if its axes are {}, and not as they are \
             given: {given}",
            in_words(&rates)
        ));
    }
    let turned = rates.transpose();
    Some(format!(
        "gyroscope or magnetometer: the field turns as the rates say if axes are one of gyroscope \
         {}; magnetometer {}; magnetometer {}, and not as they are given; these samples do not \
         tell which: {given}",
        in_words(&rates),
        in_words(&turned),
        in_words(&-turned)
    ))
}

/// The samples of one kind, with their times in s.
fn samples(
    sources: &Sources,
    of: impl Fn(Observation) -> Option<[f64; 3]>,
) -> Vec<(f64, Vector3<f64>)> {
    let events = sources.events.iter();
    events
        .filter_map(|event| {
            let time_s = event.taken.as_nanos() as f64 * 1e-9;
            Some((time_s, of(event.observation)?.into()))
        })
        .collect()
}
