//! What is worth a look in a configuration that is accepted.

use super::{Config, DeviceEntry, SensorEntry, XPlaneSection, raw_readings, read};

/// That a flight moves nothing is permitted, and said.
pub(crate) const NO_ACTUATOR: &str =
    "there is no actuator: engaging moves nothing (actuator is an empty list)";

impl Config {
    /// Defaults of a text that the user should know about.
    pub fn remarks(&self, text: &str) -> Vec<String> {
        let places = read::read(text).places;
        let mut remarks = Vec::new();
        if let Some(section) = &self.x_plane
            && !places.has("x-plane.engage_switch")
        {
            remarks.push(format!(
                "x-plane.engage_switch is not given: the engage switch is {}",
                section.engage_switch
            ));
        }
        remarks.extend(raw_readings::without_effect(self, &places));
        remarks.extend(self.remarks_at_start());
        if self.plan.file.is_some() && !self.flies_plan() {
            remarks.push(
                "plan.file has no effect: guidance.mode is another one; choose \"plan\", or fly \
                 with --plan FILE"
                    .to_owned(),
            );
        }
        remarks.extend(self.stick_remark());
        if self.actuators().is_empty() {
            remarks.push(NO_ACTUATOR.to_owned());
        }
        let sensors: Vec<_> = self.sensors().enumerate().collect();
        let most = self.failsafe.sensor_max_age_ms;
        let by_default = |key: &str| if places.has(key) { "" } else { " by default" };
        // After the last there is no other to fall back to.
        for (at, sensor) in sensors.iter().rev().skip(1).rev() {
            let of_x_plane = |section: &XPlaneSection| section.fallback_after_ms;
            let (key, fallback_ms) = match sensor {
                SensorEntry::Simulator(_) => {
                    ("x-plane".to_owned(), self.x_plane.as_ref().map(of_x_plane))
                }
                SensorEntry::XPlane(section) => {
                    (format!("sensor[{at}]"), Some(of_x_plane(section)))
                }
                SensorEntry::ServoBoard(_) => (
                    "servo-board".to_owned(),
                    self.servo_board
                        .as_ref()
                        .map(|section| section.fallback_after_ms),
                ),
                SensorEntry::Device(device) => {
                    let (_, fallback) = device.patience();
                    let after_ms = device.is_board().then_some(fallback.as_millis() as u64);
                    (format!("sensor[{at}]"), after_ms)
                }
            };
            if let Some(fallback_ms) = fallback_ms.filter(|after_ms| *after_ms >= most) {
                remarks.push(format!(
                    "{key}.fallback_after_ms is {fallback_ms}{}, failsafe.sensor_max_age_ms is {most}{}: if this \
                     sensor is lost, failsafe comes before the next sensor is used; choose less",
                    by_default(&format!("{key}.fallback_after_ms")),
                    by_default("failsafe.sensor_max_age_ms")
                ));
            }
        }
        remarks
    }

    /// Where the pilot's stick is read, if it is to take over.
    fn stick_remark(&self) -> Option<String> {
        let threshold = self.engage.stick_takeover?;
        let has_sticks = |sensor: &SensorEntry| match sensor {
            SensorEntry::Device(device) => match &**device {
                DeviceEntry::RcReceiver(section) => section.channels().controls.is_some(),
                _ => false,
            },
            _ => false,
        };
        if self.sensors().any(has_sticks) {
            return None;
        }
        let source = if self.x_planes().next().is_some() {
            "read from X-Plane's sim/joystick/joy_mapped_axis_value[1] to [3], which it has since \
             11.50 and which was not tried with a real one: move the stick once in standby and \
             look at pilot_pitch in the recording"
        } else {
            "and no sensor here reads it: without effect, unless a program supplies it"
        };
        Some(format!(
            "engage.stick_takeover is {threshold}: the pilot's stick takes over, {source}"
        ))
    }
}
