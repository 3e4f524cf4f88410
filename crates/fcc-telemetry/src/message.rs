//! Text for events, and the types of a flight's messages.

use fcc_core::framework::{Controller, EventKind, EventOf, Readings, SourceChange};

#[cfg(feature = "flight")]
pub use of_flights::{FlightEvent, FlightMessage, FlightRecord};

#[cfg(feature = "flight")]
mod of_flights {
    use fcc_core::framework::{EventOf, MessageOf, RecordOf};
    use fcc_fixed_wing::Autopilot;
    use fcc_multicopter::Multicopter;

    use crate::telemetry::Telemetry;
    use crate::units::{AVIATION, Shown};

    /// The record of one tick of a flight.
    pub type FlightRecord = RecordOf<Autopilot>;

    /// An event of a flight.
    pub type FlightEvent = EventOf<Autopilot>;

    /// A record or an event of a flight.
    pub type FlightMessage = MessageOf<Autopilot>;

    impl Telemetry for Multicopter {}

    impl Telemetry for Autopilot {
        const UNITS: &'static [Shown] = AVIATION;
    }
}

/// An event as text, with the names of its sensors and actuators.
pub fn describe_event<C: Controller>(
    event: &EventOf<C>,
    sensors: &[String],
    actuators: &[String],
) -> String {
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
        EventKind::SourceChanged(SourceChange { readings, from, to }) => {
            let names = readings
                .iter()
                .map(|bit| C::Measurements::NAMES.get(bit as usize));
            let names: Vec<_> = names.flatten().copied().collect();
            let (from, to) = (name(sensors, from.into()), name(sensors, to.into()));
            format!("{}: from {to} instead of {from}", names.join(", "))
        }
        kind => kind.description::<C>().to_string(),
    }
}
