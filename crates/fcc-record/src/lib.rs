//! A flight in a file: the recorder that writes it, and the reader.
//!
//! A recording is an [MCAP](https://mcap.dev) file with protobuf messages of
//! the schemas in `proto/`: one message per tick, one per event, and beside
//! them the well-known messages that let Foxglove and `PlotJuggler` show a
//! flight with no set-up. It begins with all that is known of the flight
//! ([`About`], the configuration) and ends with an account of it ([`End`]).
//!
//! ```text
//! who flies ─► Recorder ─► channel ─► its own thread ─► Disk
//!              never waits            one flush and sync a second
//! ```
//!
//! What a file promises:
//!
//! - Every number decodes to the very bits that were recorded.
//! - A killed process or a lost power supply costs at most the last second:
//!   before one is over, what has gathered is written as whole chunks and
//!   synced.
//!   An ordinary sequential reader reads such a file up to its cut;
//!   [`recover`] makes it a finished file.
//! - What is damaged inside a file is noticed by its checksums. Readers pass
//!   over it, say which bytes and which ticks that is ([`Damage`]), and go on
//!   behind it.
//! - What the disk is too slow for is dropped, counted, and told in the file
//!   as [`NotRecorded`](fcc_core::framework::EventKind::NotRecorded) with its
//!   span. A disk that is full stops the recording and not the flight; it is
//!   tried again every ten seconds, and the gap stands in the file that follows.
//! - Messages are in order of their log time, which is the wall clock at the
//!   start plus the loop's monotonic time since: it never jumps. What to add
//!   to a time of the loop to get there is the clock offset in [`About`].
//!
//! What compression costs was measured: see [`Compression`].

mod about;
mod chunk;
mod crash;
mod damage;
mod disk;
mod end;
mod file;
mod folder;
mod foxglove;
mod framing;
mod items;
mod list;
mod lost;
mod name;
mod outlet;
mod parse;
mod part;
mod raw;
mod reader;
mod recorded;
mod recorder;
mod recover;
mod schema;
mod settings;
mod status;
mod summary;
mod utc;
#[cfg(feature = "flight")]
mod views;
mod wire;
mod writing;

pub use about::{About, Realtime};
pub use crash::repair_last;
pub use damage::Damage;
pub use disk::{Disk, DiskFile, FileSystem, is_being_written};
pub use end::End;
pub use items::{Item, Items, Messages, RecordedMessage, Remark};
pub use list::{Entry, Wholeness, entry, files, glance};
pub use reader::{OpenError, Recording, Verified};
pub use recorded::{Recorded, Views};
#[cfg(feature = "flight")]
pub use recorder::Recorder;
pub use recorder::RecorderOf;
pub use recover::{RecoverError, Recovered, recover};
pub use schema::{PACKAGE, messages};
pub use settings::{Compression, RecorderSettings, RecordingPace};
pub use status::{News, RecorderStatus};
#[cfg(feature = "flight")]
pub use views::FoxgloveViews;
