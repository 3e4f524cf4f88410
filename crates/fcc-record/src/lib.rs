//! Recordings: writes, lists, recovers and reads them.
//!
//! A recording is an [MCAP](https://mcap.dev) file with protobuf messages of
//! the schemas in `proto/`: one message per tick, one per event, and the
//! well-known messages that Foxglove and `PlotJuggler` display without
//! configuration. It begins with what is known of the flight ([`About`], the
//! configuration) and ends with its statistics ([`End`]).
//!
//! ```text
//! the flight ─► Recorder ─► channel ─► its own thread ─► Disk
//!                 never waits            flush and sync every 0.7 s
//! ```
//!
//! Guarantees:
//!
//! - Every number decodes to the bits that were recorded.
//! - A killed process or a loss of power costs at most the last second: every
//!   0.7 s the buffered messages are written as whole chunks and synced. An
//!   ordinary sequential reader reads such a file up to its end; [`recover`]
//!   finishes it.
//! - Damage inside a file is detected by checksums. Readers report the bytes
//!   and ticks ([`Damage`]) and continue after it.
//! - Messages for which the disk is too slow are dropped, counted, and reported
//!   in the file as
//!   [`NotRecorded`](fcc_core::framework::EventKind::NotRecorded) with the
//!   first and last tick. A full disk stops the recording and not the flight;
//!   recording is tried again every ten seconds, and the next file reports the
//!   gap.
//! - Messages are in order of their log time: the wall clock at the start plus
//!   the loop's monotonic time since, which never jumps. The difference between
//!   the two is the clock offset in [`About`].
//!
//! The measured cost of compression: see [`Compression`].

mod about;
mod any_plant;
mod channels;
mod chunk;
mod damage;
mod description;
mod disk;
mod document;
mod end;
mod file;
mod folder;
mod foxglove;
mod framing;
mod item;
mod items;
mod list;
mod listed;
#[cfg(test)]
#[path = "tests/locks.rs"]
mod lock_tests;
mod lost;
mod name;
mod opening;
mod order;
mod outlet;
mod output;
mod parse;
mod part;
mod raw;
mod reader;
mod record_messages;
mod recorded;
mod recorder;
mod recover;
mod remark;
mod schema;
mod settings;
mod status;
mod summary;
mod utc;
#[cfg(feature = "flight")]
mod views;
mod wire;
mod writing;

pub use about::About;
pub use any_plant::{AnyPlantMessage, Unread};
pub use damage::Damage;
pub use disk::{Disk, DiskFile, FileSystem, is_same_file, unless_left};
pub use document::Document;
pub use end::End;
pub use item::{Item, RecordedMessage};
pub use items::{Items, Messages};
pub use list::{Entry, Wholeness, entry, files, glance};
pub use listed::Listed;
pub use opening::{create_anew, create_folder, open_lock, read_file, read_own_file};
pub use output::{create_output, may_be_output, write_output, write_plan};
pub use reader::{OpenError, Recording, Verified};
pub use record_messages::RecordMessages;
pub use recorded::{Recorded, TopicOf, Views};
#[cfg(feature = "flight")]
pub use recorder::Recorder;
pub use recorder::RecorderOf;
pub use recover::{RecoverError, Recovered, recover};
pub use remark::Remark;
pub use schema::{PACKAGE, messages};
pub use settings::{Compression, RecorderSettings, RecordingPace};
pub use status::{Notice, RecorderStatus};
pub use utc::timestamp;
#[cfg(feature = "flight")]
pub use views::FoxgloveViews;
