//! The phone's sensors in a flight.

use std::io;

use fcc_flight::config::PhoneSection;
use fcc_flight::flight::{OpenPhone, PhoneHost};
use fcc_phone::{Kind, Phone, PhoneSettings};

/// The phone that the app runs on.
pub(crate) struct AppPhone(pub(crate) Phone);

impl PhoneHost for AppPhone {
    fn open(&mut self, phone: &PhoneSection) -> io::Result<OpenPhone> {
        let (sensor, devices) = self.0.open(&settings(phone))?;
        Ok(OpenPhone {
            sensor: Box::new(sensor),
            devices,
        })
    }
}

fn settings(section: &PhoneSection) -> PhoneSettings {
    let (silent_after, fallback_after) = section.patience();
    let kinds = [
        (Kind::Accelerometer, true),
        (Kind::Gyroscope, true),
        (Kind::Magnetometer, section.magnetometer),
        (Kind::Barometer, section.barometer),
    ];
    PhoneSettings {
        rate_hz: section.rate_hz,
        kinds: kinds
            .into_iter()
            .filter_map(|(kind, is_used)| is_used.then_some(kind))
            .collect(),
        has_position: section.position,
        uses_own_bias: section.own_bias,
        silent_after,
        fallback_after,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_of_the_configuration_are_those_of_the_sensors() {
        assert_eq!(settings(&PhoneSection::default()), PhoneSettings::default());
        let less = PhoneSection {
            barometer: false,
            position: false,
            ..PhoneSection::default()
        };
        let less = settings(&less);
        assert!(!less.kinds.contains(&Kind::Barometer) && !less.has_position);
    }
}
