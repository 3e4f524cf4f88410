//! A recording as two tables for spreadsheets: `records.csv`, `events.csv`.
//!
//! Numbers are as recorded, in SI, with the unit in the column's name; they
//! parse back to the same bits. A field without a measurement is empty.

use std::fs::File;
use std::io;
use std::marker::PhantomData;
use std::path::Path;

use fcc_core::framework::{Controller, EventOf, Message, MessageOf, RecordOf, Time};

use super::origin::Origin;
use fcc_record::{Remark, create_folder, create_output};
use fcc_telemetry::describe_event;
use fcc_telemetry::schema::{Row, header};

/// Writes the messages of a flight into two CSV files.
pub struct CsvFolder<C> {
    of: PhantomData<fn() -> C>,
    records: csv::Writer<File>,
    events: csv::Writer<File>,
    origin: Origin,
    row: Row,
}

/// The files in the folder.
pub const TABLES: [&str; 2] = ["records.csv", "events.csv"];

/// Bytes in the buffer before they are written.
const BUFFER_BYTES: usize = 1 << 18;

impl<C: Controller> CsvFolder<C> {
    /// Creates the folder if it is missing, and in it the [`TABLES`]. Existing files of these names are replaced.
    ///
    /// # Errors
    /// When the folder or a file cannot be made or written, or a file is the
    /// recording.
    pub fn create(folder: &Path, origin: &Origin, recording: &Path) -> io::Result<Self> {
        create_folder(folder)?;
        let open = |name: &str| -> io::Result<_> {
            Ok(csv::WriterBuilder::new()
                .buffer_capacity(BUFFER_BYTES)
                .from_writer(create_output(&folder.join(name), &[recording])?))
        };
        let [records, events] = TABLES;
        let mut records = open(records)?;
        records.write_record(header::<RecordOf<C>>())?;
        let mut events = open(events)?;
        events.write_record(["tick", "time_ns", "event"])?;
        Ok(Self {
            of: PhantomData,
            records,
            events,
            origin: origin.clone(),
            row: Row::default(),
        })
    }

    /// Writes a message.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn take(&mut self, message: &MessageOf<C>) -> io::Result<()> {
        match message {
            Message::Tick(record) => self.take_record(record),
            Message::Event(event) => self.take_event(event),
        }
    }

    /// Writes a remark as an event without a tick.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn take_remark(&mut self, remark: &Remark) -> io::Result<()> {
        self.events
            .write_record(["", &instant(remark.time), &remark.text])?;
        Ok(())
    }

    /// Ends both files.
    ///
    /// # Errors
    /// When what is left cannot be written.
    pub fn finish(mut self) -> io::Result<()> {
        self.records.flush()?;
        self.events.flush()
    }

    fn take_record(&mut self, record: &RecordOf<C>) -> io::Result<()> {
        self.row.take(record);
        for cell in self.row.cells() {
            self.records.write_field(cell)?;
        }
        self.records.write_record(None::<&[u8]>)?;
        Ok(())
    }

    fn take_event(&mut self, event: &EventOf<C>) -> io::Result<()> {
        self.events.write_record([
            event.tick.to_string(),
            instant(event.time),
            describe_event::<C>(event, &self.origin.sensors, &self.origin.actuators),
        ])?;
        Ok(())
    }
}

/// An instant; empty if there is none.
fn instant(time: Time) -> String {
    if time.is_never() {
        String::new()
    } else {
        time.as_nanos().to_string()
    }
}
