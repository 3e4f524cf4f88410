//! Why a sensor of airspeed is excluded.

/// What is wrong with an excluded airspeed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum DoubtReason {
    /// It rises with height as an altimeter does: the total pressure is
    /// trapped, so its dynamic pressure changes by -dp = ρ g dh (FAA-H-8083-15B,
    /// chapter 5, blocked pitot tube and drain).
    BlockedTube,
    /// It contradicts the speed over the ground in a take-off.
    Ground,
    /// It is too high.
    TooHigh,
    /// It is too low.
    TooLow,
}

/// An excluded sensor of airspeed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Doubt {
    /// The number of the sensor.
    pub(crate) source: u8,
    pub(crate) reason: DoubtReason,
}
