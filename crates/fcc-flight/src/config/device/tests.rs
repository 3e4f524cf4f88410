use std::time::Duration;

use fcc_linux::chip::{ChipKind, Wiring};

use super::DeviceEntry;
use crate::config::{Config, SensorEntry};

fn lines(text: &str) -> Vec<String> {
    let error = Config::parse(text, "test").unwrap_err().to_string();
    error.lines().map(str::to_owned).collect()
}

#[test]
fn a_chip_has_the_usual_wiring() {
    let text = "actuator = []\n[[sensor]]\nkind = \"icm42688\"\nspi = \"/dev/spidev0.0\"\n\
                [[sensor]]\nkind = \"bmp388\"\nfallback_after_ms = 200\n\
                [sensor.calibration.static_pressure]\nbias_pa = 30\n";
    let config = Config::parse(text, "test").unwrap();
    let found: Vec<_> = config.sensors().filter_map(SensorEntry::device).collect();
    let [
        DeviceEntry::Chip(imu),
        barometer @ DeviceEntry::Chip(section),
    ] = found[..]
    else {
        panic!("{found:?}");
    };
    let spi = Wiring::Spi {
        path: "/dev/spidev0.0".into(),
    };
    assert_eq!((imu.kind, imu.to_linux().wiring), (ChipKind::Icm42688, spi));
    let i2c = Wiring::I2c {
        path: "/dev/i2c-1".into(),
        address: 0x76,
    };
    assert_eq!(section.to_linux().wiring, i2c);
    let (silent, fallback) = barometer.patience();
    assert_eq!(
        (silent, fallback),
        (Duration::from_millis(500), Duration::from_millis(200))
    );
    let bias = barometer
        .calibration()
        .unwrap()
        .to_core()
        .unwrap()
        .static_pressure
        .bias;
    assert_eq!(bias, 30.0);
    let written = config.to_toml().unwrap();
    let again = Config::parse(&written, "again").unwrap();
    assert_eq!(again.to_toml().unwrap(), written);
}

#[test]
fn an_error_is_reported_with_its_line_and_what_to_do() {
    let begin = "actuator = []\n[[sensor]]\nkind = ";
    for (keys, expected) in [
        (
            "\"icm42688\"\naddress = 0x50\n",
            "test:4: sensor[0].address: is 0x50: ICM-42688-P has 0x68 or 0x69",
        ),
        (
            "\"bmp180\"\nspi = \"/dev/spidev0.0\"\n",
            "test:4: sensor[0].spi: is given, and BMP180 has no SPI: give i2c",
        ),
        (
            "\"bmp388\"\nspi = \"/dev/spidev0.0\"\ni2c = \"/dev/i2c-1\"\n",
            "test:5: sensor[0].i2c: is given together with spi: keep one bus",
        ),
        (
            "\"sdp3x\"\nrange_psi = 1\n",
            "test:4: sensor[0].range_psi: is a key of \"ms4525do\" alone: remove it",
        ),
        (
            "\"ms4525do\"\nrange_psi = 1000\n",
            "test:4: sensor[0].range_psi: is 1000: choose 0.1 to 150",
        ),
        (
            "\"qmc5883l\"\nsilent_after_ms = 1\n",
            "test:4: sensor[0].silent_after_ms: is 1: choose 50 to 60000",
        ),
        (
            "\"mpu6050\"\n[sensor.calibration.gyroscope]\nbias_degps = [0, 0, 99]\n",
            "test:5: sensor[0].calibration.gyroscope.bias_degps[2]: is 99: choose -50 to 50",
        ),
        (
            "\"iio\"\n",
            "test:2: sensor[0].device: is missing: give the name of the device, `fccd probe` \
             lists them",
        ),
    ] {
        assert_eq!(lines(&format!("{begin}{keys}")), [expected]);
    }
}

#[test]
fn raw_readings_alone_do_not_engage() {
    let text = "actuator = []\n[[sensor]]\nkind = \"mpu6050\"\n";
    let remarks = |text: &str| Config::parse(text, "test").unwrap().remarks(text);
    let about_raw =
        |remark: &String| remark.starts_with("the sensors of a board give raw readings");
    assert!(remarks(text).iter().any(about_raw));
    let kalman = text.replace(
        "[[sensor]]",
        "[navigation]\nmethod = \"kalman\"\n[[sensor]]",
    );
    assert!(!remarks(&kalman).iter().any(about_raw));
}
