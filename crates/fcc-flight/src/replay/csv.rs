//! Both flights, tick by tick, for other tools.

use std::io::{self, Write};

use fcc_telemetry::FlightRecord;

use super::deviation::Quantity;

/// Writes a line a tick: time, tick, both states, and every quantity as
/// recorded and as the other configuration has it; empty where nothing was
/// commanded.
pub struct Csv<W: Write> {
    out: W,
    began_ns: Option<i64>,
}

impl<W: Write> Csv<W> {
    /// Writes the header.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn begin(mut out: W) -> io::Result<Self> {
        out.write_all(b"time_s,tick,state_recorded,state_other")?;
        for quantity in &Quantity::ALL {
            for whose in ["recorded", "other"] {
                write!(out, ",{} {whose} ({})", quantity.name, quantity.unit)?;
            }
        }
        out.write_all(b"\n")?;
        Ok(Self {
            out,
            began_ns: None,
        })
    }

    /// Writes a tick.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn take(&mut self, recorded: &FlightRecord, other: &FlightRecord) -> io::Result<()> {
        let at_ns = recorded.tick.scheduled.as_nanos();
        let began_ns = *self.began_ns.get_or_insert(at_ns);
        write!(
            self.out,
            "{},{},{},{}",
            at_ns.saturating_sub(began_ns) as f64 * 1e-9,
            recorded.tick.number,
            recorded.state,
            other.state
        )?;
        for quantity in &Quantity::ALL {
            for record in [recorded, other] {
                if record.sent {
                    write!(self.out, ",{}", quantity.of(record))?;
                } else {
                    self.out.write_all(b",")?;
                }
            }
        }
        self.out.write_all(b"\n")
    }

    /// Ends the file.
    ///
    /// # Errors
    /// When what is left cannot be written.
    pub fn finish(mut self) -> io::Result<()> {
        self.out.flush()
    }
}
