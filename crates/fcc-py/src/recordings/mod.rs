//! Recordings: read into numpy, listed, recovered, reported, flown again.

mod files;
mod frame;
mod reading;

pub(crate) use files::{list_recordings, recover, replay, report};
pub(crate) use reading::PyRecording;
