//! Devices that two entries of a configuration use: the second could not be opened.

use fcc_linux::chip::Wiring;
use fcc_linux::gpio::GpioPin;

use super::{ActuatorEntry, Config, DeviceEntry};

/// Reports each entry whose device an earlier one has.
pub(super) fn check(config: &Config, report: &mut impl FnMut(&[&str], String)) {
    let mut taken: Vec<(String, String)> = Vec::new();
    for (entry, device) in devices(config) {
        match taken.iter().find(|(_, other)| *other == device) {
            Some((first, _)) => {
                let message = format!("uses {device}, as {first} does: give each its own");
                report(&[&entry], message);
            }
            None => taken.push((entry, device)),
        }
    }
}

/// Each entry with a device that it has to itself.
fn devices(config: &Config) -> Vec<(String, String)> {
    let mut all = Vec::new();
    let board = config.servo_board.as_ref();
    if let Some(line) = board.and_then(|board| board.serial.as_ref()) {
        all.push(("servo-board".to_owned(), line.display().to_string()));
    }
    for (at, device) in config.devices() {
        let uses = match device {
            DeviceEntry::Chip(section) => match section.to_linux().wiring {
                Wiring::I2c { path, address } => format!("{} {address:#04x}", path.display()),
                Wiring::Spi { path } => path.display().to_string(),
            },
            DeviceEntry::Iio(section) => {
                format!("{} {}", section.sysfs.display(), section.device)
            }
            // That there is one phone is said of its own.
            DeviceEntry::Phone(_) => continue,
            DeviceEntry::GnssSerial(section) => section.path.display().to_string(),
            DeviceEntry::RcReceiver(section) => section.path.display().to_string(),
            DeviceEntry::GpioSwitch(section) if section.line.is_none() => continue,
            DeviceEntry::GpioSwitch(section) => shown(&section.pin()),
            // It serves many, but the same fixes.
            DeviceEntry::Gpsd(section) => section.source(),
        };
        // What is missing is said of its own.
        if !uses.is_empty() {
            all.push((format!("sensor[{at}]"), uses));
        }
    }
    for (at, entry) in config.actuators().iter().enumerate() {
        let ActuatorEntry::Servos(section) = entry else {
            continue;
        };
        let mut takes = |device: String| all.push((format!("actuator[{at}]"), device));
        if let Some(heartbeat) = &section.heartbeat {
            takes(shown(&heartbeat.pin()));
        }
        if let Some(bus) = &section.pca9685 {
            takes(format!("{} {:#04x}", bus.display(), section.address));
            continue;
        }
        // Those of one entry are checked with it.
        let mut outputs = section.pwm_outputs();
        outputs.sort_by(|a, b| (&a.chip, a.number).cmp(&(&b.chip, b.number)));
        outputs.dedup();
        for output in outputs {
            takes(format!(
                "{} output {}",
                output.chip.display(),
                output.number
            ));
        }
    }
    all
}

fn shown(pin: &GpioPin) -> String {
    format!("{} line {}", pin.chip.display(), pin.line)
}

#[cfg(test)]
mod tests {
    use crate::config::Config;

    fn refused(text: &str) -> Vec<String> {
        let error = Config::parse(text, "f").unwrap_err().to_string();
        error.lines().map(str::to_owned).collect()
    }

    #[test]
    fn a_device_of_two_entries_is_reported() {
        let sensor = |keys: &str| format!("[[sensor]]\n{keys}\n");
        let servos = |keys: &str| {
            format!(
                "[[actuator]]\nkind = \"servos\"\n{keys}\n\
                 [[actuator.channel]]\ndrives = \"elevator\"\noutput = 0\n"
            )
        };
        let simulator = "[[actuator]]\nkind = \"simulator\"\n";
        for (entries, expected) in [
            (
                // 0x76 is the usual address.
                sensor("kind = \"bmp388\"") + &sensor("kind = \"bmp388\"\naddress = 0x76"),
                "f:3: sensor[1]: uses /dev/i2c-1 0x76, as sensor[0] does: give each its own",
            ),
            (
                sensor("kind = \"icm42688\"\nspi = \"/dev/spidev0.0\"")
                    + &sensor("kind = \"bmp388\"\nspi = \"/dev/spidev0.0\""),
                "f:4: sensor[1]: uses /dev/spidev0.0, as sensor[0] does: give each its own",
            ),
            (
                sensor("kind = \"gnss-serial\"\npath = \"/dev/ttyS1\"")
                    + &sensor("kind = \"rc-receiver\"\npath = \"/dev/ttyS1\""),
                "f:4: sensor[1]: uses /dev/ttyS1, as sensor[0] does: give each its own",
            ),
            (
                sensor("kind = \"gpsd\"")
                    + &sensor("kind = \"gpsd\"\naddress = \"127.0.0.1:2947\""),
                "f:3: sensor[1]: uses gpsd at localhost:2947, all its receivers, as sensor[0] \
                 does: give each its own",
            ),
            (
                sensor("kind = \"gpsd\"\naddress = \"[::1]:2947\"\ndevice = \"/dev/ttyACM0\"")
                    + &sensor("kind = \"gpsd\"\ndevice = \"/dev/ttyACM0\""),
                "f:5: sensor[1]: uses gpsd at localhost:2947, /dev/ttyACM0, as sensor[0] does: \
                 give each its own",
            ),
            (
                sensor("kind = \"gpio-switch\"\nline = 17")
                    + simulator
                    + &servos("pwm = \"/p\"\nheartbeat = { line = 17 }"),
                "f:6: actuator[1]: uses /dev/gpiochip0 line 17, as sensor[0] does: give each its \
                 own",
            ),
            (
                simulator.to_owned() + &servos("pwm = \"/p\"") + &servos("pwm = \"/p\""),
                "f:9: actuator[2]: uses /p output 0, as actuator[1] does: give each its own",
            ),
        ] {
            assert_eq!(refused(&format!("{entries}[built-in]\n")), [expected]);
        }
    }

    #[test]
    fn devices_of_their_own_and_receivers_of_one_gpsd_are_accepted() {
        let text = "[built-in]\n[[sensor]]\nkind = \"bmp388\"\n\
                    [[sensor]]\nkind = \"bmp388\"\naddress = 0x77\n\
                    [[sensor]]\nkind = \"bmp388\"\ni2c = \"/dev/i2c-2\"\n\
                    [[sensor]]\nkind = \"gpsd\"\ndevice = \"/dev/ttyACM0\"\n\
                    [[sensor]]\nkind = \"gpsd\"\ndevice = \"/dev/ttyACM1\"\n\
                    [[sensor]]\nkind = \"gpsd\"\naddress = \"board.local:2947\"\n";
        Config::parse(text, "f").unwrap();
    }
}
