//! What happened: the records of a flight, its score, a run's timing, and
//! tables of both.
//!
//! Everything here runs outside the loop's thread, on the records that the
//! loop left behind.

mod flight;
mod instance;
#[cfg(feature = "live")]
pub mod live;
mod message;
pub mod recording;
pub mod report;
pub mod schema;
mod score;
mod table;
mod timing;
pub mod units;

pub use flight::FlightLog;
pub use instance::{Instance, InstanceError};
pub use message::{FlightEvent, FlightMessage, FlightRecord, FlightWords, event_words};
pub use score::{FlightScore, Leg, LegScore, Sample, ScoreError, score};
pub use table::{flight_table, recordings_table, timing_table};
pub use timing::{DeniedRequest, Lateness, Period, Realtime, TimingReport};
