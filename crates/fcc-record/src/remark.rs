//! What was recorded beside the loop's own events.

use fcc_core::framework::Time;

/// Text that is not an event of the loop: from the recorder, or about the
/// connection to a simulator.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Remark {
    /// On the loop's clock: the log time of the message before it.
    pub time: Time,
    /// For users.
    pub text: String,
}
