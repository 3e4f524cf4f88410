//! A board's configuration.

use crate::surfaces::Surfaces;
use crate::value::ENGAGE_SWITCH;

/// A board's configuration.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct BoardConfig {
    /// The dataref of the engage switch: that of the computer's configuration.
    pub engage_switch: &'static str,
    /// After this long without a write of the surfaces, the computer is lost and
    /// the servos go to [`failsafe`](Self::failsafe), ms. 200 by default: at 40
    /// writes a second, seven in a row were lost.
    pub failsafe_after_ms: u32,
    /// Where the servos go then: centred and idle by default.
    pub failsafe: Surfaces,
    /// The interval between two replies, ms. 20 by default. Values are sent
    /// together, at most once in each interval.
    pub reply_every_ms: u32,
}

impl Default for BoardConfig {
    fn default() -> Self {
        Self {
            engage_switch: ENGAGE_SWITCH,
            failsafe_after_ms: 200,
            failsafe: Surfaces::default(),
            reply_every_ms: 20,
        }
    }
}
