//! A recording as two tables for spreadsheets: `records.csv`, `events.csv`.
//!
//! Numbers are as recorded, in SI, with the unit in the column's name, and
//! read back to the very same bits. What was never measured is empty.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io;
use std::path::Path;

use fcc_core::framework::{Message, Reading, Time};

use super::origin::Origin;
use crate::recording::Remark;
use crate::{FlightEvent, FlightMessage, FlightRecord, event_words};

/// Writes the messages of a flight into two CSV files.
pub struct CsvFolder {
    records: csv::Writer<File>,
    events: csv::Writer<File>,
    origin: Origin,
    cell: String,
}

/// Bytes that are gathered before they are written.
const BUFFER_BYTES: usize = 1 << 18;

impl CsvFolder {
    /// Makes the folder if need be, and in it `records.csv` and `events.csv`,
    /// in the place of those that may be there.
    ///
    /// # Errors
    /// When the folder or a file cannot be made or written.
    pub fn create(folder: &Path, origin: &Origin) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        let open = |name: &str| -> io::Result<_> {
            Ok(csv::WriterBuilder::new()
                .buffer_capacity(BUFFER_BYTES)
                .from_writer(File::create(folder.join(name))?))
        };
        let mut records = open("records.csv")?;
        records.write_record(COLUMNS.iter().map(|(name, _)| name))?;
        let mut events = open("events.csv")?;
        events.write_record(["tick", "time_ns", "event"])?;
        Ok(Self {
            records,
            events,
            origin: origin.clone(),
            cell: String::new(),
        })
    }

    /// Writes a message.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn take(&mut self, message: &FlightMessage) -> io::Result<()> {
        match message {
            Message::Tick(record) => self.take_record(record),
            Message::Event(event) => self.take_event(event),
        }
    }

    /// Writes words that are no event of the loop, as an event of no tick.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn take_remark(&mut self, remark: &Remark) -> io::Result<()> {
        self.cell.clear();
        Cell::at(remark.time).write(&mut self.cell);
        self.events
            .write_record(["", self.cell.as_str(), remark.text.as_str()])?;
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

    fn take_record(&mut self, record: &FlightRecord) -> io::Result<()> {
        for (_, column) in COLUMNS {
            self.cell.clear();
            column(record).write(&mut self.cell);
            self.records.write_field(&self.cell)?;
        }
        self.records.write_record(None::<&[u8]>)?;
        Ok(())
    }

    fn take_event(&mut self, event: &FlightEvent) -> io::Result<()> {
        self.cell.clear();
        Cell::at(event.time).write(&mut self.cell);
        self.events.write_record([
            event.tick.to_string(),
            self.cell.clone(),
            event_words(event, &self.origin.sensors, &self.origin.actuators),
        ])?;
        Ok(())
    }
}

/// What is in a cell.
enum Cell {
    Nothing,
    Count(u64),
    Nanos(i64),
    Number(f64),
    Text(&'static str),
}

impl Cell {
    fn at(time: Time) -> Self {
        if time.is_never() {
            Self::Nothing
        } else {
            Self::Nanos(time.as_nanos())
        }
    }

    fn read<T: Copy>(reading: &Reading<T>, value: impl Fn(T) -> f64) -> Self {
        if reading.is_never() {
            Self::Nothing
        } else {
            Self::Number(value(reading.value))
        }
    }

    fn write(&self, cell: &mut String) {
        // Writing to a string does not fail.
        let _ = match self {
            Self::Nothing => Ok(()),
            Self::Count(count) => write!(cell, "{count}"),
            Self::Nanos(nanos) => write!(cell, "{nanos}"),
            Self::Number(number) => write!(cell, "{number}"),
            Self::Text(text) => write!(cell, "{text}"),
        };
    }
}

type Column = fn(&FlightRecord) -> Cell;

/// In the order of the record.
const COLUMNS: [(&str, Column); 71] = [
    ("tick", |r| Cell::Count(r.tick.number)),
    ("scheduled_ns", |r| Cell::at(r.tick.scheduled)),
    ("woke_ns", |r| Cell::at(r.tick.woke)),
    ("lateness_ns", |r| {
        Cell::Nanos(r.tick.woke - r.tick.scheduled)
    }),
    ("missed", |r| Cell::Count(r.tick.missed)),
    ("dt_s", |r| Cell::Number(r.tick.dt_s)),
    ("sensors_time_ns", |r| Cell::Count(r.stages.sensors_ns)),
    ("navigation_time_ns", |r| {
        Cell::Count(r.stages.navigation_ns)
    }),
    ("guidance_time_ns", |r| Cell::Count(r.stages.guidance_ns)),
    ("control_time_ns", |r| Cell::Count(r.stages.control_ns)),
    ("actuators_time_ns", |r| Cell::Count(r.stages.actuators_ns)),
    ("total_time_ns", |r| Cell::Count(r.stages.total_ns)),
    ("pitch_rad", |r| {
        Cell::read(&r.measurements.attitude, |v| v.pitch_rad)
    }),
    ("roll_rad", |r| {
        Cell::read(&r.measurements.attitude, |v| v.roll_rad)
    }),
    ("attitude_taken_ns", |r| {
        Cell::at(r.measurements.attitude.taken)
    }),
    ("heading_rad", |r| {
        Cell::read(&r.measurements.heading_rad, |v| v)
    }),
    ("heading_taken_ns", |r| {
        Cell::at(r.measurements.heading_rad.taken)
    }),
    ("roll_rate_radps", |r| {
        Cell::read(&r.measurements.body_rates, |v| v.roll_radps)
    }),
    ("pitch_rate_radps", |r| {
        Cell::read(&r.measurements.body_rates, |v| v.pitch_radps)
    }),
    ("yaw_rate_radps", |r| {
        Cell::read(&r.measurements.body_rates, |v| v.yaw_radps)
    }),
    ("body_rates_taken_ns", |r| {
        Cell::at(r.measurements.body_rates.taken)
    }),
    ("specific_force_x_mps2", |r| {
        Cell::read(&r.measurements.specific_force, |v| v.x_mps2)
    }),
    ("specific_force_y_mps2", |r| {
        Cell::read(&r.measurements.specific_force, |v| v.y_mps2)
    }),
    ("specific_force_z_mps2", |r| {
        Cell::read(&r.measurements.specific_force, |v| v.z_mps2)
    }),
    ("specific_force_taken_ns", |r| {
        Cell::at(r.measurements.specific_force.taken)
    }),
    ("airspeed_mps", |r| {
        Cell::read(&r.measurements.airspeed_mps, |v| v)
    }),
    ("airspeed_taken_ns", |r| {
        Cell::at(r.measurements.airspeed_mps.taken)
    }),
    ("altitude_m", |r| {
        Cell::read(&r.measurements.altitude_m, |v| v)
    }),
    ("altitude_taken_ns", |r| {
        Cell::at(r.measurements.altitude_m.taken)
    }),
    ("angle_of_attack_rad", |r| {
        Cell::read(&r.measurements.angle_of_attack_rad, |v| v)
    }),
    ("angle_of_attack_taken_ns", |r| {
        Cell::at(r.measurements.angle_of_attack_rad.taken)
    }),
    ("latitude_rad", |r| {
        Cell::read(&r.measurements.position, |v| v.latitude_rad)
    }),
    ("longitude_rad", |r| {
        Cell::read(&r.measurements.position, |v| v.longitude_rad)
    }),
    ("position_altitude_m", |r| {
        Cell::read(&r.measurements.position, |v| v.altitude_m)
    }),
    ("position_taken_ns", |r| {
        Cell::at(r.measurements.position.taken)
    }),
    ("north_mps", |r| {
        Cell::read(&r.measurements.velocity, |v| v.north_mps)
    }),
    ("east_mps", |r| {
        Cell::read(&r.measurements.velocity, |v| v.east_mps)
    }),
    ("down_mps", |r| {
        Cell::read(&r.measurements.velocity, |v| v.down_mps)
    }),
    ("velocity_taken_ns", |r| {
        Cell::at(r.measurements.velocity.taken)
    }),
    ("measured_throttle", |r| {
        Cell::read(&r.measurements.surfaces, |v| v.throttle)
    }),
    ("measured_elevator", |r| {
        Cell::read(&r.measurements.surfaces, |v| v.elevator)
    }),
    ("measured_aileron", |r| {
        Cell::read(&r.measurements.surfaces, |v| v.aileron)
    }),
    ("measured_rudder", |r| {
        Cell::read(&r.measurements.surfaces, |v| v.rudder)
    }),
    ("surfaces_taken_ns", |r| {
        Cell::at(r.measurements.surfaces.taken)
    }),
    ("engage_switch", |r| {
        Cell::read(&r.measurements.engage_switch, |v| f64::from(v as u8))
    }),
    ("engage_switch_taken_ns", |r| {
        Cell::at(r.measurements.engage_switch.taken)
    }),
    ("plant_time_s", |r| {
        Cell::read(&r.measurements.plant, |v| v.time_s)
    }),
    ("plant_state", |r| {
        Cell::read(&r.measurements.plant, |v| f64::from(v.state as u8))
    }),
    ("plant_taken_ns", |r| Cell::at(r.measurements.plant.taken)),
    ("desired_airspeed_mps", |r| {
        Cell::Number(r.setpoints.airspeed_mps)
    }),
    ("desired_heading_rad", |r| {
        Cell::Number(r.setpoints.heading_rad)
    }),
    ("desired_altitude_m", |r| {
        Cell::Number(r.setpoints.altitude_m)
    }),
    ("desired_roll_rad", |r| Cell::Number(r.setpoints.roll_rad)),
    ("desired_climb_rate_mps", |r| {
        Cell::Number(r.setpoints.climb_rate_mps)
    }),
    ("desired_pitch_rad", |r| Cell::Number(r.setpoints.pitch_rad)),
    ("commanded_throttle", |r| Cell::Number(r.outputs.throttle)),
    ("commanded_elevator", |r| Cell::Number(r.outputs.elevator)),
    ("commanded_aileron", |r| Cell::Number(r.outputs.aileron)),
    ("commanded_rudder", |r| Cell::Number(r.outputs.rudder)),
    ("sent", |r| Cell::Count(u64::from(r.sent))),
    ("state", |r| Cell::Text(state(r))),
    ("state_cause", |r| Cell::Count(u64::from(r.state.cause()))),
    ("state_flags", |r| {
        Cell::Count(u64::from(r.state.flags().bits()))
    }),
    ("engage_inhibits", |r| {
        Cell::Count(u64::from(r.engage_inhibits.bits()))
    }),
    ("faults", |r| Cell::Count(u64::from(r.faults.bits()))),
    ("sensor_faults", |r| Cell::Count(r.sensor_faults)),
    ("actuator_faults", |r| Cell::Count(r.actuator_faults)),
    ("records_dropped", |r| Cell::Count(r.records_dropped)),
    ("overruns", |r| Cell::Count(r.overruns)),
    ("page_faults", |r| Cell::Count(r.page_faults)),
    ("early_wake_ns", |r| Cell::Count(r.early_wake_ns)),
];

fn state(record: &FlightRecord) -> &'static str {
    use fcc_core::framework::State;
    match record.state.state() {
        State::Standby => "standby",
        State::Engaged => "engaged",
        State::Failsafe(_) => "failsafe",
        State::Stopped => "stopped",
    }
}
