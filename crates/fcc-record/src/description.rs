//! Whether a file is a recording: what precedes its first message.

use fcc_core::framework::Message;
use fcc_telemetry::schema::RecordDescription;
use mcap::records::Record;

use super::about::{About, COLUMNS};
use super::any_plant::AnyMessage;
use super::items::{Channels, Item};
use super::raw::{Cut, Next, RawReader};
use super::schema::{self, Topic};

/// The program that wrote a file.
enum Writer {
    /// This one, in the present format.
    Present,
    /// A version of this one with an earlier format: its name.
    Earlier(String),
    /// Another program.
    Other,
}

/// Why a file is not read.
pub(super) enum Refusal {
    /// It ends before the first message.
    Cut(Cut),
    /// It is not a recording, with the reason.
    Other(String),
}

impl From<String> for Refusal {
    fn from(why: String) -> Self {
        Self::Other(why)
    }
}

const OTHER: &str = "another program wrote it";

/// Reads what precedes the first message.
pub(super) fn read_about(
    mut raw: RawReader,
) -> Result<(About, Option<RecordDescription>), Refusal> {
    enum Content {
        Profile(Writer),
        Flight(bool),
        OwnTopic,
        OwnRecord,
        Other,
        Messages,
    }
    let (mut about, mut columns) = (About::default(), None);
    let (mut is_ours, mut known, mut has_header) = (false, false, false);
    loop {
        let content = raw.next(|record| match &record {
            Record::Header(header) => Content::Profile(match header.profile.as_str() {
                schema::PROFILE => Writer::Present,
                schema::FIRST_PROFILE => Writer::Earlier(header.library.clone()),
                _ => Writer::Other,
            }),
            Record::Metadata(metadata) => {
                Content::Flight(about.take_metadata(&metadata.name, metadata.metadata.clone()))
            }
            Record::Attachment { header, data, .. } => {
                about.take_attachment(&header.name, data);
                if header.name == COLUMNS {
                    let text = String::from_utf8_lossy(data);
                    columns = RecordDescription::from_json(&text).ok();
                }
                Content::Other
            }
            Record::Channel(channel) if channel.topic == Topic::Record.name() => Content::OwnTopic,
            Record::Message { .. } if is_record(&record) => Content::OwnRecord,
            Record::Schema { .. } | Record::Channel(_) | Record::Message { .. } => {
                Content::Messages
            }
            _ => Content::Other,
        });
        let content = match content {
            Err(_) if has_header && !is_ours && !known => return Err(OTHER.to_owned().into()),
            content => content.map_err(Refusal::Cut)?,
        };
        match content {
            Next::Record(Content::Profile(Writer::Earlier(library))) => {
                return Err(format!(
                    "{library} wrote it, in a format older than {}: read it with that version, or \
                     with Foxglove or any other program that reads MCAP",
                    schema::PROFILE
                )
                .into());
            }
            Next::Record(Content::Profile(written)) => {
                has_header = true;
                is_ours = matches!(written, Writer::Present);
            }
            // With all before it damaged.
            Next::Record(Content::OwnTopic | Content::OwnRecord) if !has_header => {
                return Ok((about, columns));
            }
            Next::Record(Content::Flight(taken)) => known |= taken,
            Next::Record(Content::Other) | Next::Damage(_) => {}
            // Either of the two may be damaged.
            Next::Record(Content::OwnTopic | Content::OwnRecord | Content::Messages)
                if is_ours || known =>
            {
                return Ok((about, columns));
            }
            Next::Record(Content::Messages) if !has_header => {}
            Next::End if known => return Ok((about, columns)),
            Next::End if is_ours => {
                return Err("it contains no metadata of a flight".to_owned().into());
            }
            Next::Record(Content::OwnTopic | Content::OwnRecord | Content::Messages)
            | Next::End => {
                return Err(OTHER.to_owned().into());
            }
        }
    }
}

/// Whether it is a record of a loop in the channel that the recorder gives them,
/// whose declaration may be damaged.
fn is_record(record: &Record<'_>) -> bool {
    match Channels::default().item::<AnyMessage>(record, 0) {
        Some(Ok(Item::Message(Message::Tick(record)))) => {
            let tick = record.tick;
            tick.number > 0 && !tick.scheduled.is_never() && !tick.woke.is_never()
        }
        _ => false,
    }
}
