//! The plan of a flight.

/// The pace of time.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Pace {
    /// Real time.
    RealTime,
    /// As fast as possible: each tick follows the last at once.
    Lockstep,
}

/// When a flight is over. One of a given length is also over when it cannot be
/// flown: engaging is refused, the loop enters failsafe, or the wheels touch the ground
/// outside of a take-off and a landing.
#[derive(Clone, Copy, Debug)]
pub enum Length {
    /// When it is stopped.
    Open,
    /// This many seconds after the first engagement, standby after it included.
    Engaged(f64),
    /// When its plan is flown to its end, or so many seconds after the first engagement.
    Flown(f64),
    /// This many seconds after the first tick.
    Whole(f64),
    /// After this many ticks, missed ones included, whatever happens. In lockstep
    /// the last of them is an ordinary one: the loop is not stopped by a command.
    Ticks(u64),
}

/// The plan of a flight.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// The pace of time.
    pub pace: Pace,
    /// When it is over.
    pub length: Length,
}
