//! Whether a file is a recording, and what is known of its flight. Ours begins
//! with that; other programs may write it behind the messages.

use fcc_core::framework::Message;
use fcc_telemetry::schema::RecordDescription;
use mcap::records::{Metadata, Record};

use super::about::{About, COLUMNS, CONFIG, RECORDING};
use super::any_plant::AnyMessage;
use super::channels::Channels;
use super::end::{END, End};
use super::item::Item;
use super::raw::{Cut, Next, RawReader};
use super::schema::{self, PACKAGE, Topic};
use super::summary::Summary;

/// What is known of the flight of a file.
#[derive(Default)]
pub(super) struct Description {
    pub(super) about: About,
    pub(super) columns: Option<RecordDescription>,
    /// Its statistics, if the whole file was looked through.
    pub(super) end: Option<End>,
    /// Whether several parts of a recording were merged into it.
    pub(super) is_merged: bool,
}

/// Why a file is not read.
pub(super) enum Refusal {
    /// It ends before the first message.
    Cut(Cut),
    /// It is not a recording, with the reason.
    Other(String),
}

const OTHER: &str = "another program wrote it";

/// Reads what is known of the flight: up to the first message, or the whole file
/// if it is not complete there, or may be followed by more.
pub(super) fn describe(
    mut raw: RawReader,
    summary: Option<&Summary>,
    has_end: bool,
) -> Result<Description, Refusal> {
    let refuse = |why: &str| Err(Refusal::Other(why.to_owned()));
    let mut search = Search::default();
    let may_be_followed = summary.is_some_and(|index| !has_end || index.recordings > 1);
    let is_foreign = summary.is_some_and(|index| index.is_foreign);
    let cut = loop {
        match raw.next(|record| search.take(&record)) {
            Ok(Next::Record(()) | Next::Damage(_)) => {}
            Ok(Next::End) => break None,
            Err(cut) => break Some(cut),
        }
        if let Some(library) = &search.earlier {
            return refuse(&format!(
                "{library} wrote it, in a format older than {}: read it with that version, or \
                 with Foxglove or any other program that reads MCAP",
                schema::PROFILE
            ));
        }
        if search.has_messages && is_foreign && !search.is_ours() {
            return refuse(OTHER);
        }
        if search.is_complete() && !may_be_followed {
            return Ok(search.found);
        }
    };
    if !search.others.is_empty() {
        let first = search.found.about.started();
        let others = search.others.join(", ");
        return refuse(&format!(
            "several recordings are merged in it, begun {first}, {others}: read the files that it \
             was made of"
        ));
    }
    match cut {
        _ if search.is_ours() && search.has_messages => Ok(search.found),
        None if search.is_known => Ok(search.found),
        None if search.is_ours() => refuse("it contains no metadata of a flight"),
        Some(cut) if search.is_ours() || !search.has_header => Err(Refusal::Cut(cut)),
        _ => refuse(OTHER),
    }
}

#[expect(clippy::struct_excessive_bools, reason = "each is found by itself")]
#[derive(Default)]
struct Search {
    found: Description,
    has_header: bool,
    /// Whether the header says that the file is ours.
    has_profile: bool,
    /// The program that wrote it in an earlier format.
    earlier: Option<String>,
    /// Whether there is metadata of ours: the header may be damaged, or written
    /// by another program.
    is_known: bool,
    has_config: bool,
    /// The schema of our records, and whether a topic has it.
    schema: Option<u16>,
    has_topic: bool,
    /// Whether there are messages, or declarations of them.
    has_messages: bool,
    /// Begin of each other recording that was merged into the file.
    others: Vec<String>,
    ends: usize,
}

impl Search {
    const fn is_ours(&self) -> bool {
        self.has_profile || self.is_known || self.has_topic
    }

    /// Whether all is found with which a recording of ours begins.
    const fn is_complete(&self) -> bool {
        self.has_messages
            && self.has_config
            && self.found.about.part > 0
            && self.found.columns.is_some()
    }

    fn take(&mut self, record: &Record<'_>) {
        match record {
            Record::Header(header) => {
                self.has_header = true;
                self.has_profile |= header.profile == schema::PROFILE;
                if header.profile == schema::FIRST_PROFILE {
                    self.earlier = Some(header.library.clone());
                }
            }
            Record::Metadata(metadata) => self.metadata(metadata),
            Record::Attachment { header, data, .. } => {
                self.found.about.take_attachment(&header.name, data);
                self.has_config |= header.name == CONFIG;
                if header.name == COLUMNS {
                    let text = String::from_utf8_lossy(data);
                    self.found.columns = RecordDescription::from_json(&text).ok();
                }
            }
            Record::Schema { header, .. } => {
                self.has_messages |= self.has_header;
                if header.name == format!("{PACKAGE}.Record") {
                    self.schema = Some(header.id);
                }
            }
            Record::Channel(channel) => {
                let is_named = channel.topic == Topic::Record.name();
                let is_ours = !self.has_header || self.schema == Some(channel.schema_id);
                self.has_topic |= is_named && is_ours;
                self.has_messages |= self.has_header || self.has_topic;
            }
            Record::Message { .. } if self.has_header || self.has_topic => self.has_messages = true,
            // With all before it damaged.
            Record::Message { .. } if is_record(record) => {
                (self.has_topic, self.has_messages) = (true, true);
            }
            _ => {}
        }
    }

    fn metadata(&mut self, metadata: &Metadata) {
        let Metadata { name, metadata } = metadata;
        let about = &mut self.found.about;
        if name == END {
            self.ends += 1;
            self.found.end = (self.ends == 1).then(|| End::from_fields(metadata));
        } else if name == RECORDING && about.part > 0 {
            let mut other = About::default();
            other.take_metadata(name, metadata.clone());
            if other.clock_offset_ns != about.clock_offset_ns {
                self.others.push(other.started());
            } else if other.part != about.part {
                self.found.is_merged = true;
                about.part = about.part.min(other.part);
            }
        } else {
            self.is_known |= about.take_metadata(name, metadata.clone());
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
