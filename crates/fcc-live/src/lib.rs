//! Live telemetry: each record and event in shared memory, for other programs.
//!
//! The daemon passes the loop's messages to a [`Publisher`], which never waits.
//! Another process, whose thread `fcc-live` puts them into shared memory with
//! iceoryx2, receives them over a socket: whatever programs do to the shared
//! memory ends at most that process, which is started again.
//!
//! ```text
//! daemon ── socket ─► publisher's process ─► its thread ─► shared memory ─► watchers
//!        ◄── commands ──
//! ```
//!
//! Watchers that join, leave, hang or are killed have no effect on the loop's
//! thread. A program that is no flight may publish in a thread of its own.
//!
//! A program opens a [`Watcher`], or for any plant a [`RowWatcher`]; programs in other languages read the same
//! services by the layouts in `proto/layout.md`:
//!
//! | service | what | history |
//! |---|---|---|
//! | `fcc/INSTANCE/info` | [`Info`]: who publishes, in which layout | 1 |
//! | `fcc/INSTANCE/columns/v5` | the columns of a record | 1 |
//! | `fcc/INSTANCE/record/v5` | the record of each tick | 1 |
//! | `fcc/INSTANCE/event/v5` | [`Event`]: what happened once | 64 |
//! | `fcc/INSTANCE/status/v5` | [`Status`]: each second, how the run stands | 1 |
//!
//! Commands are sent the other way: a [`Commander`] uses the service
//! `fcc/INSTANCE/command/v4` and receives the result.
//!
//! The layout of `info` never changes, so that a reader of another version can
//! report what it found. Everything else has a version: [`LAYOUT`].

mod change_limit;
mod command;
mod connected;
mod error;
mod event;
mod info;
mod item;
mod lateness;
mod marks;
mod message;
mod offered;
mod place;
mod private_service;
mod publisher;
mod publisher_process;
mod publishing_thread;
mod relay;
mod row_watcher;
mod services;
mod shared_types;
mod space;
mod status;
mod text;
mod thread;
mod watcher;

pub use command::{
    COMMANDS_VERSION, Command, CommandError, Commandable, CommandableSetpoint, Commander,
    InvalidCommand, OutsideLimits, PendingCommand, PlantLimits, SentCommands, Verdict,
};
#[cfg(fuzzing)]
pub use command::{read_answer, read_request};
pub use error::{PublishError, WatchError};
pub use event::{Event, EventCode};
pub use info::Info;
pub use lateness::{LATENESS_BOUNDS_NS, LatenessCounts};
#[cfg(fuzzing)]
pub use message::read_message;
pub use place::running;
#[cfg(feature = "flight")]
pub use publisher::Publisher;
pub use publisher::PublisherOf;
pub use publisher_process::StartPublisher;
pub use relay::{RelayError, run_publisher};
pub use row_watcher::RowWatcher;
pub use services::{EVENT_HISTORY, MAX_WATCHERS, RECORD_BUFFER};
pub use status::{RecorderState, RecorderStatus, Status};
pub use text::Text;
#[cfg(feature = "flight")]
pub use watcher::Watcher;
pub use watcher::WatcherOf;

/// The version of all layouts except [`Info`]'s. Increase it with every change
/// of one of them, or of a field's meaning.
pub const LAYOUT: u32 = 5;
