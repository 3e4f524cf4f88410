//! The state of a flight that is stored, so that it can be continued.

use fcc_core::flight::Resume;

use super::boot_clock::BootInstant;
use super::kept_plan::SavedPlan;
use super::place::SavedPlace;

/// The stored state of a flight.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct Saved {
    /// The time of this state.
    pub(super) at: BootInstant,
    /// A fingerprint of the configuration.
    pub(super) config: u32,
    /// The engage switch.
    pub(super) switch: SavedSwitch,
    /// The number of consecutive recoveries of the flight.
    pub(super) recoveries: u32,
    /// Where the aircraft was.
    pub(super) place: SavedPlace,
    /// The plan that was flown.
    pub(super) plan: SavedPlan,
    /// What was flown.
    pub(super) resume: Resume,
}

/// The engage switch as it was last delivered by its owner.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(super) struct SavedSwitch {
    /// Whether it was on.
    pub(super) on: bool,
    /// The sensor to which it belongs.
    pub(super) source: u8,
}
