//! What a loop that runs the autopilot tells of itself.

use fcc_core::flight::Autopilot;
use fcc_core::framework::{EventKind, EventOf, MessageOf, RecordOf};

/// The record of one tick of a flight.
pub type FlightRecord = RecordOf<Autopilot>;

/// Something that happened in a flight.
pub type FlightEvent = EventOf<Autopilot>;

/// A record or an event of a flight.
pub type FlightMessage = MessageOf<Autopilot>;

/// An event in words, with the names of the parts it speaks of.
pub fn event_words(event: &FlightEvent, sensors: &[String], actuators: &[String]) -> String {
    let name = |names: &[String], index: u16| {
        names
            .get(usize::from(index))
            .cloned()
            .unwrap_or_else(|| index.to_string())
    };
    match event.kind {
        EventKind::SensorFault { index, fault } => {
            format!("sensor {}: {fault}", name(sensors, index))
        }
        EventKind::SensorRecovered { index } => {
            format!("sensor {}: works again", name(sensors, index))
        }
        EventKind::ActuatorFault { index, fault } => {
            format!("actuator {}: {fault}", name(actuators, index))
        }
        EventKind::ActuatorRecovered { index } => {
            format!("actuator {}: works again", name(actuators, index))
        }
        kind => kind.words::<Autopilot>().to_string(),
    }
}

#[cfg(test)]
mod tests {
    use std::mem::{align_of, offset_of, size_of};

    use super::*;

    /// Programs in other languages read the record by its layout: whoever
    /// changes it gives it another version.
    #[test]
    fn the_layout_of_a_record_is_as_written_down() {
        assert_eq!(
            (size_of::<FlightRecord>(), align_of::<FlightRecord>()),
            (536, 8)
        );
        assert_eq!(
            [
                offset_of!(FlightRecord, tick),
                offset_of!(FlightRecord, stages),
                offset_of!(FlightRecord, measurements),
                offset_of!(FlightRecord, setpoints),
                offset_of!(FlightRecord, outputs),
                offset_of!(FlightRecord, sensor_faults),
                offset_of!(FlightRecord, state),
                offset_of!(FlightRecord, engage_inhibits),
                offset_of!(FlightRecord, faults),
                offset_of!(FlightRecord, sent),
            ],
            [0, 40, 88, 384, 432, 464, 512, 520, 524, 528]
        );
    }
}
