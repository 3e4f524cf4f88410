//! The order of a file's messages. The recorder writes them in the order in
//! which they came, and numbers them; other programs may write them in any.

use std::vec;

use mcap::records::{MessageHeader, Record};

use super::about::document;
use super::channels::Channels;
use super::document::Document;
use super::raw::{Cut, DamagedBytes, Next, RawReader};
use super::schema::Topic;

/// The most bytes of messages that are sorted: five hours at 40 Hz.
const MAX_SORTED_BYTES: usize = 512 << 20;

/// What a message takes in memory besides its content.
const OVERHEAD_BYTES: usize = size_of::<Stored>();

/// What has to be known of a file before its messages are read.
#[derive(Default)]
pub(super) struct Order {
    /// All of the file's, wherever they are in it.
    pub(super) documents: Vec<Document>,
    /// Whether the messages are in order of log time.
    is_by_time: bool,
    /// Whether they are as the recorder wrote them.
    is_recorders: bool,
    /// Their size.
    bytes: usize,
}

/// A message, or the damage after the one before.
pub(super) struct Stored {
    log_time: u64,
    sequence: u32,
    pub(super) content: Result<(Topic, MessageHeader, Box<[u8]>), DamagedBytes>,
}

/// The messages of a file in order, and where the file is cut off.
pub(super) struct Sorted {
    pub(super) messages: vec::IntoIter<Stored>,
    pub(super) cut: Option<Cut>,
}

impl Order {
    /// Reads a file once.
    pub(super) fn of(mut raw: RawReader) -> Self {
        let mut order = Self {
            is_by_time: true,
            is_recorders: true,
            ..Self::default()
        };
        let mut channels = Channels::default();
        let mut last = None;
        // Where it is cut off, and what is damaged, is found when it is read.
        while let Ok(Next::Record(()) | Next::Damage(_)) = raw.next(|record| {
            if let Some((_, header, data)) = channels.message(&record) {
                let (time, sequence) = last.unwrap_or((0, None));
                order.is_by_time &= time <= header.log_time;
                order.is_recorders &= sequence < Some(header.sequence);
                order.bytes = order.bytes.saturating_add(data.len() + OVERHEAD_BYTES);
                last = Some((header.log_time, Some(header.sequence)));
            } else if let Record::Attachment { header, data, .. } = &record {
                order.documents.extend(document(&header.name, data));
            }
        }) {}
        order
    }

    /// Whether the messages are read in the order in which they are in the
    /// file.
    ///
    /// # Errors
    /// When they would have to be sorted, and are too many.
    pub(super) const fn is_of_file(&self) -> Result<bool, ()> {
        match (self.is_by_time, self.is_recorders) {
            (true, true) => Ok(true),
            _ if self.bytes <= MAX_SORTED_BYTES => Ok(false),
            (true, false) => Ok(true),
            (false, _) => Err(()),
        }
    }
}

impl Sorted {
    /// Reads all messages, and sorts them: by log time, and those of one time
    /// by the recorder's numbers. If a tool has not kept these, a record comes
    /// after the events of its tick, as the recorder writes it. A message that is
    /// in the file twice is read once.
    pub(super) fn read(mut raw: RawReader) -> Self {
        let mut channels = Channels::default();
        let mut messages: Vec<Stored> = Vec::new();
        let cut = loop {
            let content = match raw.next(|record| {
                let (topic, header, data) = channels.message(&record)?;
                Some((topic, header, data.into()))
            }) {
                Ok(Next::Record(Some(message))) => Ok(message),
                Ok(Next::Record(None)) => continue,
                Ok(Next::Damage(damaged)) => Err(damaged),
                Ok(Next::End) => break None,
                Err(cut) => break Some(cut),
            };
            let (log_time, sequence) = match &content {
                Ok((_, header, _)) => (header.log_time, header.sequence),
                Err(_) => messages.last().map_or((0, 0), |m| (m.log_time, m.sequence)),
            };
            messages.push(Stored {
                log_time,
                sequence,
                content,
            });
        };
        let mut numbers: Vec<u32> = messages.iter().filter_map(Stored::number).collect();
        numbers.sort_unstable();
        let are_unique = numbers.is_sorted_by(|one, next| one < next);
        messages.sort_by_key(|message| {
            let is_record = matches!(message.content, Ok((Topic::Record, ..)));
            let is_last = is_record && !are_unique;
            (message.log_time, is_last, message.sequence)
        });
        if numbers.last().is_some_and(|last| *last > 0) {
            // The same message of two files that were merged.
            messages.dedup_by(|one, other| one.is_same(other));
        }
        Self {
            messages: messages.into_iter(),
            cut,
        }
    }
}

impl Stored {
    fn is_same(&self, other: &Self) -> bool {
        match (&self.content, &other.content) {
            (Ok((topic, header, data)), Ok((other_topic, other_header, other_data))) => {
                topic == other_topic
                    && (header.log_time, header.sequence)
                        == (other_header.log_time, other_header.sequence)
                    && data == other_data
            }
            _ => false,
        }
    }

    fn number(&self) -> Option<u32> {
        self.content.is_ok().then_some(self.sequence)
    }
}
