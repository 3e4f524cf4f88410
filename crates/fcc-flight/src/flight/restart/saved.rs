//! The state of a flight that is stored, so that it can be continued.

use fcc_core::flight::Position;
use fcc_fixed_wing::{AutopilotCommand, Resume};
use fcc_guidance::Mode;

use super::boot_clock::BootInstant;

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
    /// The plan that was flown.
    pub(super) plan: SavedPlan,
    /// What was flown.
    pub(super) resume: Resume,
    /// What commands have said besides.
    pub(super) commanded: SavedCommands,
}

/// Which plan was flown.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(super) struct SavedPlan {
    /// The first 64 bits of its hash; 0: none.
    pub(super) hash: u64,
    /// When it was uploaded, s since 1970 (UTC).
    pub(super) uploaded_unix_s: u64,
}

/// What was commanded and is not in the record.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(super) struct SavedCommands {
    /// The last place that was commanded.
    pub(super) go_to: Option<Position>,
    /// Within which time a commander has promised to be heard, s.
    pub(super) promised_s: Option<f64>,
}

impl SavedCommands {
    /// Notes a command; whether it is one of them.
    pub(super) fn note(&mut self, command: &AutopilotCommand) -> bool {
        match *command {
            AutopilotCommand::GoTo(place) => self.go_to = Some(place),
            AutopilotCommand::Heartbeat(within_s) => {
                self.promised_s = (within_s > 0.0).then_some(within_s);
            }
            _ => return false,
        }
        true
    }

    /// The commands that continue a mode.
    pub(super) fn again(self, mode: Mode) -> impl Iterator<Item = AutopilotCommand> {
        let go_to = self.go_to.filter(|_| mode == Mode::GoTo);
        let promise = self.promised_s.map(AutopilotCommand::Heartbeat);
        go_to.map(AutopilotCommand::GoTo).into_iter().chain(promise)
    }
}

/// The engage switch as it was last delivered by its owner.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(super) struct SavedSwitch {
    /// Whether it was on.
    pub(super) on: bool,
    /// The sensor to which it belongs.
    pub(super) source: u8,
}
