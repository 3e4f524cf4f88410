//! Requirements of [`ControlAuthority`]. Each is one function, which panics if
//! it is not met.
#![allow(
    clippy::expect_used,
    reason = "every function here is a test: it panics if the requirement is not met"
)]

use std::time::Duration;

use fcc_core::framework::{ControlAuthority, PlantId, Released};

use crate::actuator::{ActuatorBench, Run};

/// An actuator under test whose control is observed from outside the loop as
/// well.
pub trait AuthorityBench: ActuatorBench {
    /// The authority for the plant that the actuator drives.
    fn authority(&self) -> &dyn ControlAuthority;

    /// Releases control from outside, as [`release`](ControlAuthority::release)
    /// does, while the plant runs.
    fn release_from_outside(&mut self, plant: &PlantId) -> Released;
}

/// Nothing is held before the first apply, then the plant, and nothing once a
/// release can no longer be undone by a late write, 10 s after it.
pub fn what_is_held_is_known_outside<B: AuthorityBench>() {
    let mut run = Run::<B>::new();
    assert_eq!(run.bench.authority().held(), None);
    let plant = run.bench.authority().plant().expect("a plant is there");
    for _ in 0..20 {
        run.assert_applies();
        assert_eq!(run.bench.authority().held(), Some(plant));
    }
    assert_eq!(run.release(), Ok(()));
    run.live(400);
    assert_eq!(run.bench.authority().held(), None);
}

/// If permission is required, no control is taken without it.
pub fn without_permission_nothing_is_taken<B: AuthorityBench>() {
    let mut run = Run::<B>::new();
    let plant = run.bench.authority().plant().expect("a plant is there");
    run.bench.authority().require_permission();
    for _ in 0..20 {
        assert!(run.apply().0.is_err());
        assert!(!run.bench.is_held());
        assert_eq!(run.bench.authority().held(), None);
    }
    run.bench.authority().permit(&plant);
    for _ in 0..20 {
        run.assert_applies();
    }
    assert_eq!(run.bench.authority().held(), Some(plant));
}

/// Control is released from outside without the actuator, which may hang, and
/// again if it is released already.
pub fn a_release_from_outside_is_confirmed<B: AuthorityBench>() {
    let mut run = Run::<B>::holding();
    let plant = run.bench.authority().plant().expect("a plant is there");
    for _ in 0..2 {
        let released = run.bench.release_from_outside(&plant);
        assert_eq!(released, Released::Confirmed);
        assert!(!run.bench.is_held());
    }
}

/// A release that is cancelled before it begins sends nothing.
pub fn a_cancelled_release_sends_nothing<B: AuthorityBench>() {
    let mut run = Run::<B>::holding();
    let plant = run.bench.authority().plant().expect("a plant is there");
    let before = run.bench.messages();
    let released = run
        .bench
        .authority()
        .release(&plant, Duration::from_secs(60), &mut || true);
    assert_eq!(released, Ok(Released::Cancelled));
    assert_eq!(run.bench.messages(), before);
    assert!(run.bench.is_held());
}

/// A plant of another adapter is refused.
pub fn a_plant_of_another_kind_is_refused<B: AuthorityBench>() {
    let bench = B::new();
    let other = PlantId::new(format_args!("no plant of this kind")).expect("it is short");
    let released = bench
        .authority()
        .release(&other, Duration::from_secs(60), &mut || false);
    assert!(released.is_err());
    bench.authority().permit(&other);
    assert_eq!(bench.authority().unique(&other), other);
}

/// A plant has one name for all programs.
pub fn the_unique_name_is_its_own<B: AuthorityBench>() {
    let run = Run::<B>::new();
    let authority = run.bench.authority();
    let unique = authority.unique(&authority.plant().expect("a plant is there"));
    assert_eq!(authority.unique(&unique), unique);
    assert!(!unique.as_str().is_empty());
}

/// Unchanged problems are not reported again.
pub fn what_has_not_changed_is_not_reported_again<B: AuthorityBench>() {
    let run = Run::<B>::new();
    let mut reported = Vec::new();
    for _ in 0..20 {
        run.bench
            .authority()
            .report(&mut |words| reported.push(words.to_string()));
    }
    let mut different = reported.clone();
    different.sort();
    different.dedup();
    assert_eq!(reported.len(), different.len(), "{reported:?}");
}
