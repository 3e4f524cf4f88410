//! How a flight is to go.

/// How fast time passes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Pace {
    /// As it does.
    RealTime,
    /// As fast as the machine can: each tick follows the last at once.
    Lockstep,
}

/// When a flight is over. One of a given length is also over when it cannot be
/// flown: engaging is refused, or the loop falls into failsafe.
#[derive(Clone, Copy, Debug)]
pub enum Length {
    /// When it is told to stop.
    Open,
    /// So many seconds after engaging.
    Engaged(f64),
    /// So many seconds after the first tick.
    Whole(f64),
}

/// How a flight is to go.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// How fast time passes.
    pub pace: Pace,
    /// When it is over.
    pub length: Length,
}
