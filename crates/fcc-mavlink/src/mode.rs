//! Modes, as ground stations show and choose them.

use fcc_telemetry::Command;
use mavlink::dialects::common::{MavModeProperty, MavStandardMode};

use crate::vehicle::{Mode, VehicleState};

/// A row of the table of modes.
#[derive(Debug)]
pub(crate) struct Row {
    pub(crate) mode: Mode,
    pub(crate) name: &'static str,
    /// Main and sub mode of PX4's encoding (`px4_custom_mode.h`), which MAVSDK sends to every
    /// autopilot but `ArduPilot`; 11 and above are those for external modes.
    custom: (u8, u8),
    pub(crate) standard: MavStandardMode,
    /// What makes it this mode; none: it is not for users.
    choose: Option<fn(&VehicleState) -> Command>,
}

use MavStandardMode as Standard;

const NON_STANDARD: Standard = Standard::MAV_STANDARD_MODE_NON_STANDARD;

/// The one table.
#[rustfmt::skip]
pub(crate) static MODES: [Row; 11] = [
    row(Mode::Standby, "Standby", (1, 0), NON_STANDARD, Some(|_| Command::Disengage)),
    row(Mode::Plan, "Mission", (4, 4), Standard::MAV_STANDARD_MODE_MISSION, Some(|_| set("plan_item", 0.0))),
    row(Mode::Loiter, "Hold", (4, 3), NON_STANDARD, Some(|_| set("pause", 1.0))),
    row(Mode::Return, "Return", (4, 5), Standard::MAV_STANDARD_MODE_SAFE_RECOVERY, Some(|_| set("return_home", 1.0))),
    row(Mode::Land, "Land", (4, 6), Standard::MAV_STANDARD_MODE_LAND, Some(|_| set("land", 1.0))),
    row(Mode::Hold, "Cruise", (3, 0), Standard::MAV_STANDARD_MODE_CRUISE, Some(|state| set("heading_rad", state.flight.magnetic_heading_rad))),
    row(Mode::Takeoff, "Takeoff", (4, 2), NON_STANDARD, None),
    row(Mode::GoTo, "Go to", (4, 11), NON_STANDARD, None),
    row(Mode::GoAround, "Go around", (4, 12), NON_STANDARD, None),
    row(Mode::Glide, "Glide", (4, 13), NON_STANDARD, None),
    row(Mode::Pattern, "Pattern", (4, 14), NON_STANDARD, None),
];

const fn row(
    mode: Mode,
    name: &'static str,
    custom: (u8, u8),
    standard: Standard,
    choose: Option<fn(&VehicleState) -> Command>,
) -> Row {
    Row {
        mode,
        name,
        custom,
        standard,
        choose,
    }
}

fn set(name: &str, value: f64) -> Command {
    Command::set([(name, value)])
}

impl Row {
    /// `custom_mode`: main mode in byte 2, sub mode in byte 3.
    pub(crate) fn custom_mode(&self) -> u32 {
        let (main, sub) = self.custom;
        u32::from(main) << 16 | u32::from(sub) << 24
    }

    pub(crate) fn properties(&self) -> MavModeProperty {
        let not_for_users = MavModeProperty::MAV_MODE_PROPERTY_NOT_USER_SELECTABLE;
        let auto = MavModeProperty::MAV_MODE_PROPERTY_AUTO_MODE;
        match (self.choose, self.mode) {
            (_, Mode::Standby) => MavModeProperty::empty(),
            (Some(_), _) => auto,
            (None, _) => auto | not_for_users,
        }
    }

    /// The command that makes it this mode.
    pub(crate) fn command(&self, state: &VehicleState) -> Option<Command> {
        self.choose.map(|choose| choose(state))
    }
}

/// The row of a mode.
pub(crate) fn row_of(mode: Mode) -> &'static Row {
    let found = MODES.iter().find(|row| row.mode == mode);
    // Every mode has one; the first otherwise.
    found.unwrap_or(&MODES[0])
}

/// The row of a `custom_mode`.
pub(crate) fn by_custom_mode(custom_mode: u32) -> Option<&'static Row> {
    MODES.iter().find(|row| row.custom_mode() == custom_mode)
}

/// The row of a standard mode.
pub(crate) fn by_standard_mode(standard: u32) -> Option<&'static Row> {
    let mut standards = MODES.iter().filter(|row| row.standard != NON_STANDARD);
    standards.find(|row| row.standard as u32 == standard)
}
