//! `[rights]`: with whose rights a flight runs.

use serde::{Deserialize, Serialize};

/// `[rights]`.
#[derive(Clone, PartialEq, Eq, Debug, Default, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct RightsSection {
    /// The user as whom a flight continues that was started as root. Default:
    /// fccd, the user of the package's service, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub user: Option<String>,
    /// Users who may command in addition to the daemon's own and root.
    pub commanders: Vec<String>,
    /// The same, of groups: their members when the flight begins.
    pub commander_groups: Vec<String>,
}

impl RightsSection {
    /// Whether any other user may command.
    pub const fn has_commanders(&self) -> bool {
        !self.commanders.is_empty() || !self.commander_groups.is_empty()
    }
}
