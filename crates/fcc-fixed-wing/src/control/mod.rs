//! Control: surfaces and throttle.
//!
//! Three loops, coupled where the aircraft couples them:
//! - [`HeadingLoop`]: heading → turn rate → bank → roll rate → aileron, with
//!   the rudder keeping the turn coordinated;
//! - [`AltitudeLoop`]: altitude → climb rate → pitch → pitch rate → elevator,
//!   compensated for bank;
//! - [`AirspeedLoop`]: airspeed → throttle, compensated for climb and bank.
//!
//! In an upset the recovery flies instead of them, until the aircraft is
//! level again.
//!
//! An [`Envelope`] limits the outer loops' commands to the inner ones. Gains
//! apply at a reference airspeed; a surface's effect grows with dynamic
//! pressure, so they are scaled by [`Schedule`].

use fcc_core::blocks::{AntiWindup, PidConfig};

mod airspeed;
mod altitude;
mod elevator_response;
mod elevator_trim;
mod envelope;
mod glide;
mod heading;
mod load;
mod oscillation;
mod play_inverse;
mod recovery;
mod schedule;
mod speed_limits;
mod upset;

pub use airspeed::{AirspeedConfig, AirspeedLoop, ThrottleDemand};
pub use altitude::{AltitudeConfig, AltitudeLoop, PitchCommand};
pub use elevator_response::ElevatorResponse;
pub use elevator_trim::{ElevatorTrim, Trimming};
pub use envelope::Envelope;
pub use heading::{HeadingConfig, HeadingLoop, Lateral};
pub use oscillation::{LEAST_PACE, OscillationMonitor};
pub use play_inverse::PlayInverse;
pub(crate) use recovery::{Change, Recovery, RecoveryInputs};
pub use schedule::Schedule;
pub use speed_limits::{PitchLimits, SpeedLimits};
pub use upset::{Motion, UpsetDetector};

/// The largest bank for which a turn's load and rate are computed, rad.
const MAX_TURN_BANK_RAD: f64 = 1.05;

/// A controller of a surface: without gains, output -1..=1.
const SURFACE: PidConfig = PidConfig {
    kp: 0.0,
    ki: 0.0,
    kd: 0.0,
    derivative_tau_s: 0.0,
    output_min: -1.0,
    output_max: 1.0,
    output_rate_per_s: f64::INFINITY,
    anti_windup: AntiWindup::Clamping,
};
