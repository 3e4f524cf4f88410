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
}
