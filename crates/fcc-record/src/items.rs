//! Reads a recording item by item: memory does not grow with the file, unless
//! its messages have to be sorted.

use std::collections::VecDeque;

use fcc_core::framework::Tick;

use super::channels::{self, Channels};
use super::damage::Damage;
use super::document::Document;
use super::end::End;
use super::item::{Item, RecordedMessage};
use super::order::Sorted;
use super::raw::{DamagedBytes, Next, RawReader};

/// The most items that are held back until it is known which ticks are missing
/// before them.
const MAX_HELD_BACK: usize = 1_024;

/// Where items come from.
pub(super) enum Source {
    /// From the file, in its order.
    File(Box<RawReader>, Channels),
    /// From memory.
    Sorted(Sorted),
}

/// The records, events and remarks of a recording. Damage is skipped, and
/// reported in its place.
pub struct Items<M> {
    source: Source,
    clock_offset_ns: i64,
    /// The statistics in the file.
    end: Option<End>,
    being_written: bool,
    last_tick: Option<Tick>,
    /// Ticks and events that were read, and whether there was damage.
    ticks: u64,
    events: u64,
    is_damaged: bool,
    /// Damage after which no tick was read yet.
    damage: Option<Damage>,
    /// Items read after it.
    held_back: VecDeque<Item<M>>,
    finished: bool,
    cut: Option<String>,
}

impl<M: RecordedMessage> Items<M> {
    pub(super) fn new(
        documents: Vec<Document>,
        source: Source,
        clock_offset_ns: i64,
        end: Option<End>,
        being_written: bool,
    ) -> Self {
        Self {
            source,
            clock_offset_ns,
            end,
            being_written,
            last_tick: None,
            ticks: 0,
            events: 0,
            is_damaged: false,
            damage: None,
            held_back: documents.into_iter().map(Item::Document).collect(),
            finished: false,
            cut: None,
        }
    }

    /// Where and why reading ended before the end of the recording; none while
    /// there is more to read, and for a finished file.
    pub fn cut(&self) -> Option<&str> {
        self.cut.as_deref()
    }

    /// Bytes read so far, of [`Recording::bytes`](super::Recording::bytes).
    pub const fn bytes_read(&self) -> u64 {
        match &self.source {
            Source::File(raw, _) => raw.bytes_read(),
            Source::Sorted(_) => 0,
        }
    }

    fn read(&mut self) -> Option<Result<Item<M>, DamagedBytes>> {
        let offset_ns = self.clock_offset_ns;
        let cut = loop {
            let item = match &mut self.source {
                Source::File(raw, channels) => {
                    match raw.next(|record| channels.item(&record, offset_ns)) {
                        Err(cut) => break Some(cut),
                        Ok(Next::End) => break None,
                        Ok(Next::Damage(damaged)) => return Some(Err(damaged)),
                        Ok(Next::Record(item)) => item.map(|item| (raw.last_bytes(), item)),
                    }
                }
                Source::Sorted(sorted) => match sorted.messages.next() {
                    None => break sorted.cut.take(),
                    Some(message) => match message.content {
                        Err(damaged) => return Some(Err(damaged)),
                        Ok((topic, header, data)) => {
                            channels::item(topic, &header, &data, offset_ns)
                                .map(|item| (0..0, item))
                        }
                    },
                },
            };
            if let Some((bytes, item)) = item {
                return Some(item.map_err(|why| DamagedBytes {
                    bytes,
                    why,
                    messages: true,
                }));
            }
        };
        self.cut = cut.map(|cut| cut.of_file(self.being_written).to_string());
        None
    }

    /// Takes an item; returns it if nothing has to come before it.
    fn take(&mut self, read: Option<Result<Item<M>, DamagedBytes>>) -> Option<Item<M>> {
        match read {
            Some(Ok(item)) => {
                let tick = match &item {
                    Item::Message(message) => {
                        self.events += u64::from(message.tick().is_none());
                        message.tick().copied()
                    }
                    _ => None,
                };
                if tick.is_some() || self.held_back.len() >= MAX_HELD_BACK {
                    self.locate_damage(tick.as_ref());
                }
                self.ticks += u64::from(tick.is_some());
                self.last_tick = tick.or(self.last_tick);
                if self.damage.is_none() && self.held_back.is_empty() {
                    return Some(item);
                }
                self.held_back.push_back(item);
            }
            Some(Err(damaged)) => {
                self.is_damaged = true;
                match &mut self.damage {
                    Some(damage) => damage.join(&damaged),
                    None => self.damage = Some(Damage::of(damaged)),
                }
            }
            None => {
                self.finished = true;
                self.cut = self.cut.take().or_else(|| self.left_out());
                self.locate_damage(None);
            }
        }
        None
    }

    /// What another program has left out of a file without damage, by the statistics in it.
    fn left_out(&self) -> Option<String> {
        let end = self.end.as_ref().filter(|_| !self.is_damaged)?;
        let missing = |all: u64, read: u64, what: &str| {
            let missing = all.checked_sub(read).filter(|missing| *missing > 0)?;
            Some(format!("copied without {missing} of its {all} {what}"))
        };
        missing(end.ticks, self.ticks, "ticks")
            .or_else(|| missing(end.events, self.events, "events; commands are events"))
    }

    fn locate_damage(&mut self, next: Option<&Tick>) {
        if let Some(mut damage) = self.damage.take() {
            // The statistics of the end do not apply to a gap in the middle.
            let end = self
                .end
                .as_ref()
                .filter(|_| next.is_some() || self.finished);
            damage.locate(self.last_tick.as_ref(), next, end);
            self.held_back.push_front(Item::Damage(damage));
        }
    }
}

impl<M: RecordedMessage> Iterator for Items<M> {
    type Item = Item<M>;

    fn next(&mut self) -> Option<Item<M>> {
        loop {
            if self.damage.is_none()
                && let Some(item) = self.held_back.pop_front()
            {
                return Some(item);
            }
            if self.finished {
                return None;
            }
            let read = self.read();
            if let Some(item) = self.take(read) {
                return Some(item);
            }
        }
    }
}

/// The records and events of a recording.
pub struct Messages<M> {
    items: Items<M>,
    damages: Vec<Damage>,
}

impl<M: RecordedMessage> Messages<M> {
    pub(super) const fn new(items: Items<M>) -> Self {
        Self {
            items,
            damages: Vec::new(),
        }
    }

    /// As [`Items::cut`].
    pub fn cut(&self) -> Option<&str> {
        self.items.cut()
    }

    /// Damage found so far.
    pub fn damages(&self) -> &[Damage] {
        &self.damages
    }

    pub(super) fn into_damages(self) -> Vec<Damage> {
        self.damages
    }

    /// As [`Items::bytes_read`].
    pub const fn bytes_read(&self) -> u64 {
        self.items.bytes_read()
    }
}

impl<M: RecordedMessage> Iterator for Messages<M> {
    type Item = M;

    fn next(&mut self) -> Option<M> {
        for item in self.items.by_ref() {
            match item {
                Item::Message(message) => return Some(message),
                Item::Damage(damage) => self.damages.push(damage),
                Item::Remark(_) | Item::Document(_) => {}
            }
        }
        None
    }
}
