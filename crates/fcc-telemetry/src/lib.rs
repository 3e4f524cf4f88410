//! What happened: the records of a flight, its score, a run's timing, and
//! tables of both.
//!
//! Everything here runs outside the loop's thread, on the records that the
//! loop left behind.

#[cfg(feature = "flight")]
mod flight;
#[cfg(feature = "flight")]
mod flight_table;
mod instance;
#[cfg(feature = "live")]
pub mod live;
mod message;
pub mod recording;
#[cfg(feature = "flight")]
pub mod report;
pub mod schema;
#[cfg(feature = "flight")]
mod score;
mod table;
mod telemetry;
mod timing;
pub mod units;

#[cfg(feature = "flight")]
pub use flight::FlightLog;
#[cfg(feature = "flight")]
pub use flight_table::{ScoredBy, flight_table};
pub use instance::{Instance, InstanceError};
pub use message::event_words;
#[cfg(feature = "flight")]
pub use message::{FlightEvent, FlightMessage, FlightRecord, FlightWords};
#[cfg(feature = "flight")]
pub use score::{FlightScore, Leg, LegScore, Sample, ScoreError, score};
pub use table::{recordings_table, timing_table};
pub use telemetry::{RecordWords, Telemetry, Views};
pub use timing::{DeniedRequest, Lateness, Period, Realtime, TimingReport};
