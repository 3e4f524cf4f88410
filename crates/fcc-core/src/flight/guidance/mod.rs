//! Guidance: where to go next.

mod pattern;

pub use pattern::{TimedPattern, TimedPatternConfig};

/// The mode that is flown once engaged.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum GuidanceConfig {
    /// Keep what was captured, until commanded otherwise.
    Hold,
    /// The timed pattern of the thesis.
    TimedPattern(TimedPatternConfig),
}

/// What guidance asks of control.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
#[repr(C)]
pub struct Targets {
    /// Indicated airspeed, m/s.
    pub airspeed_mps: f64,
    /// Magnetic heading, rad, counted on through full turns: which way to turn
    /// is said by the number, not guessed from the shorter way. Turns that
    /// pile up while the aircraft cannot keep up never reverse.
    pub heading_rad: f64,
    /// Barometric altitude, m.
    pub altitude_m: f64,
}
