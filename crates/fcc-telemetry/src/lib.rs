//! Records and events of a flight, what is generated from their declaration,
//! commands from outside, timing statistics, and the score.
//!
//! The crates above use them independently of one another: `fcc-record` writes
//! and reads files, `fcc-live` shares memory with other programs, `fcc-report`
//! makes tables and plots.
//!
//! All of it runs outside the loop's thread.

#[cfg(feature = "flight")]
mod altitude;
mod command;
pub mod file_lock;
#[cfg(feature = "flight")]
mod flight;
mod instance;
mod message;
#[cfg(feature = "flight")]
mod pattern_scorer;
mod printable;
mod quantity;
mod run_folder;
pub mod schema;
#[cfg(feature = "flight")]
mod score;
mod station_link;
mod telemetry;
mod timing;
pub mod units;

#[cfg(feature = "flight")]
pub use altitude::ShownAltitude;
pub use command::{
    Command, Commandable, CommandableSetpoint, InvalidCommand, OutsideLimits, PendingCommand,
    PlantLimits, SentCommands, Verdict,
};
pub use fcc_timer::not_started;
pub use instance::{Instance, InstanceError};
pub use message::describe_event;
#[cfg(feature = "flight")]
pub use message::{FlightEvent, FlightMessage, FlightRecord};
#[cfg(feature = "flight")]
pub use pattern_scorer::PatternScorer;
pub use printable::{printable, printable_json};
pub use quantity::RecordedQuantity;
pub use run_folder::RunFolder;
#[cfg(feature = "flight")]
pub use score::{FlightScore, Leg, LegScore, Sample, ScoreError, ScoredBy, score};
pub use station_link::StationLink;
pub use telemetry::Telemetry;
pub use timing::{Denial, Lateness, Period, Realtime, TimingReport, expiry_of};
