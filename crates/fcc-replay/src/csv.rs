//! Both runs, tick by tick, as a table.

use std::io::{self, Write};

use fcc_core::framework::Record;
use fcc_core::framework::schema::Schema;
use fcc_telemetry::Telemetry;

use crate::outputs::TickPair;
use crate::quantity::Quantity;

/// Writes a line per tick: time, tick, both states, and every quantity as
/// recorded and with the other configuration; empty if nothing was commanded.
pub struct Csv<W: Write> {
    out: W,
    quantities: Vec<Quantity>,
    tick: TickPair,
}

impl<W: Write> Csv<W> {
    /// Writes the header of a table for this controller.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn begin<C: Telemetry>(mut out: W) -> io::Result<Self> {
        out.write_all(b"time_s,tick,state_recorded,state_other")?;
        let quantities = Quantity::all::<C>();
        for quantity in &quantities {
            for whose in ["recorded", "other"] {
                write!(out, ",{} {whose}", quantity.name)?;
                if !quantity.unit.is_empty() {
                    write!(out, " ({})", quantity.unit)?;
                }
            }
        }
        out.write_all(b"\n")?;
        Ok(Self {
            out,
            quantities,
            tick: TickPair::default(),
        })
    }

    /// Writes a tick.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn take<M: Schema, E: Schema, S: Schema, O: Schema>(
        &mut self,
        recorded: &Record<M, E, S, O>,
        other: &Record<M, E, S, O>,
    ) -> io::Result<()> {
        let since_ns = self.tick.take(recorded, other);
        write!(
            self.out,
            "{},{},{},{}",
            since_ns as f64 * 1e-9,
            recorded.tick.number,
            recorded.state,
            other.state
        )?;
        for quantity in &self.quantities {
            for (sent, values) in [
                (recorded.sent, &self.tick.recorded),
                (other.sent, &self.tick.other),
            ] {
                if sent {
                    write!(self.out, ",{}", quantity.of(values))?;
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
