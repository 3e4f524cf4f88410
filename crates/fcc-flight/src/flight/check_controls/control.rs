//! The controls that are moved, and where each has to go.

use fcc_core::flight::Surfaces;

use crate::config::{ActuatorEntry, Config, DrivesChoice};

/// A control.
pub(super) struct Control {
    pub(super) name: &'static str,
    drives: DrivesChoice,
    put: fn(&mut Surfaces, f64),
    read: fn(&Surfaces) -> Option<f64>,
    /// What is asked with a positive, and with a negative deflection.
    positive: &'static str,
    negative: Option<&'static str>,
}

/// All but the landing gear, on which the aircraft stands.
const CONTROLS: [Control; 8] = [
    Control {
        name: "elevator",
        drives: DrivesChoice::Elevator,
        put: |to, at| to.elevator = at,
        read: |at| Some(at.elevator),
        positive: "did the elevator's trailing edge go UP?",
        negative: Some("did the elevator's trailing edge go DOWN?"),
    },
    Control {
        name: "aileron",
        drives: DrivesChoice::Aileron,
        put: |to, at| to.aileron = at,
        read: |at| Some(at.aileron),
        positive: "did the trailing edge of the RIGHT aileron go UP, and of the left one down?",
        negative: Some(
            "did the trailing edge of the RIGHT aileron go DOWN, and of the left one up?",
        ),
    },
    Control {
        name: "rudder",
        drives: DrivesChoice::Rudder,
        put: |to, at| to.rudder = at,
        read: |at| Some(at.rudder),
        positive: "did the rudder's trailing edge go to the RIGHT, seen from behind?",
        negative: Some("did the rudder's trailing edge go to the LEFT, seen from behind?"),
    },
    Control {
        name: "nose wheel",
        drives: DrivesChoice::NoseWheel,
        put: |to, at| to.nose_wheel = Some(at),
        read: |at| at.nose_wheel,
        positive: "did the nose wheel's front edge go to the RIGHT?",
        negative: Some("did the nose wheel's front edge go to the LEFT?"),
    },
    Control {
        name: "flaps",
        drives: DrivesChoice::Flaps,
        put: |to, at| to.flaps = Some(at),
        read: |at| at.flaps,
        positive: "did the flaps go DOWN on both sides?",
        negative: None,
    },
    Control {
        name: "left brake",
        drives: DrivesChoice::LeftBrake,
        put: |to, at| to.left_brake = Some(at),
        read: |at| at.left_brake,
        positive: "does the LEFT wheel brake?",
        negative: None,
    },
    Control {
        name: "right brake",
        drives: DrivesChoice::RightBrake,
        put: |to, at| to.right_brake = Some(at),
        read: |at| at.right_brake,
        positive: "does the RIGHT wheel brake?",
        negative: None,
    },
    Control {
        name: "throttle",
        drives: DrivesChoice::Throttle,
        put: |to, at| to.throttle = at,
        read: |at| Some(at.throttle),
        positive: "did the throttle go towards FULL?",
        negative: None,
    },
];

impl Control {
    /// Those that servos of a configuration drive; other actuators take the three surfaces and
    /// the throttle.
    pub(super) fn of(config: &Config, throttle: bool) -> Vec<Self> {
        let mut driven = Vec::new();
        for actuator in config.actuators() {
            match actuator {
                ActuatorEntry::Servos(section) => {
                    driven.extend(section.channels.iter().map(|channel| channel.drives));
                }
                ActuatorEntry::Simulator(_) | ActuatorEntry::ServoBoard(_) => driven.extend([
                    DrivesChoice::Elevator,
                    DrivesChoice::Aileron,
                    DrivesChoice::Rudder,
                    DrivesChoice::Throttle,
                ]),
            }
        }
        let is_checked = |one: &Self| {
            driven.contains(&one.drives) && (throttle || one.drives != DrivesChoice::Throttle)
        };
        CONTROLS.into_iter().filter(is_checked).collect()
    }

    /// 1 and -1, as far as it goes there, and what is asked.
    pub(super) fn sides(&self) -> impl Iterator<Item = (f64, &'static str)> + use<> {
        let negative = self.negative.map(|question| (-1.0, question));
        [(1.0, self.positive)].into_iter().chain(negative)
    }

    /// The outputs with this one there and all others centred.
    pub(super) fn at(&self, at: f64) -> Surfaces {
        let mut outputs = Surfaces::IDLE;
        (self.put)(&mut outputs, at);
        outputs
    }

    pub(super) fn read(&self, measured: &Surfaces) -> Option<f64> {
        (self.read)(measured)
    }
}
