//! What happened in a flight: its records and events, what is generated from
//! their declaration, how well the loop kept time, and the score.
//!
//! What is done with them is in crates above, none of which needs another's
//! libraries: `fcc-record` writes and reads files, `fcc-live` shares memory with
//! whoever watches, `fcc-report` makes tables and plots.
//!
//! Everything here runs outside the loop's thread, on the records that the
//! loop left behind.

#[cfg(feature = "flight")]
mod flight;
mod instance;
mod message;
pub mod schema;
#[cfg(feature = "flight")]
mod score;
mod telemetry;
mod timing;
pub mod units;

#[cfg(feature = "flight")]
pub use flight::FlightLog;
pub use instance::{Instance, InstanceError};
pub use message::event_words;
#[cfg(feature = "flight")]
pub use message::{FlightEvent, FlightMessage, FlightRecord, FlightWords};
#[cfg(feature = "flight")]
pub use score::{FlightScore, Leg, LegScore, Sample, ScoreError, ScoredBy, score};
pub use telemetry::{RecordWords, Telemetry};
pub use timing::{DeniedRequest, Lateness, Period, Realtime, TimingReport};
