//! The kernel's drivers, with a stand-in for their folders.

mod conformance;
mod properties;
mod tree;

use fcc_core::framework::Time;
use fcc_linux::iio::{Iio, IioConfig, Quantity};
use fcc_linux::probe::{self, Found};
use fcc_linux::{DeviceError, RawValues, Sample, Source, monotonic};

use tree::Tree;

fn read(config: &IioConfig) -> Sample<RawValues> {
    let mut device = Iio::open(config).unwrap();
    device.read().unwrap().unwrap()
}

fn refused(config: &IioConfig) -> String {
    Iio::open(config).unwrap_err().to_string()
}

/// 1 g is 16,384, and 10 °/s are 328 (PS-MPU-6000A-00 rev 3.4, sections 6.1 and
/// 6.2: 32.8 LSB/(°/s) at ±1000 °/s); the kernel's scales have three and six digits.
fn assert_values(values: &RawValues) {
    let [x, y, z] = values.specific_force_mps2.unwrap();
    assert!(x == 0.0 && y == 0.0 && (z - 9.80665).abs() < 0.01, "{z}");
    let [p, q, r] = values.rates_radps.unwrap();
    assert!(
        (p.to_degrees() - 10.0).abs() < 0.01 && q == 0.0 && r == 0.0,
        "{p}"
    );
    assert_eq!(values.air_temperature_k, None, "it is the chip's own");
}

#[test]
fn values_are_read_from_files() {
    let mut tree = Tree::new();
    tree.mpu6050();
    let before = monotonic();
    let sample = read(&tree.config("mpu6050", false));
    assert_values(&sample.value);
    assert!(sample.taken >= before && sample.taken <= monotonic());
}

/// 1 Pa is 0.001 kPa, 1 gauss 100 µT; a thermometer alone measures the air's
/// temperature: 15 °C.
#[test]
fn the_kernels_units_become_si() {
    let tree = Tree::new();
    tree.put("iio:device2/name", "bmp388");
    tree.put("iio:device2/in_pressure_input", "101.325000000");
    tree.put("iio:device2/in_temp_input", "21000");
    let values = read(&tree.config("bmp388", true)).value;
    assert!((values.static_pressure_pa.unwrap() - 101_325.0).abs() < 1e-6);
    assert_eq!(values.air_temperature_k, None);
    let pitot = IioConfig {
        is_differential: true,
        ..tree.config("bmp388", true)
    };
    let values = read(&pitot).value;
    assert_eq!(values.static_pressure_pa, None);
    assert!((values.differential_pressure_pa.unwrap() - 101_325.0).abs() < 1e-6);

    tree.put("iio:device3/name", "compass");
    tree.put("iio:device3/label", "wing");
    for (axis, raw) in [("x", "1000"), ("y", "0"), ("z", "-500")] {
        tree.put(&format!("iio:device3/in_magn_{axis}_raw"), raw);
        tree.put(&format!("iio:device3/in_magn_{axis}_scale"), "0.0005");
    }
    tree.put("iio:device3/in_mount_matrix", "0, 1, 0; -1, 0, 0; 0, 0, 1");
    let [x, y, z] = read(&tree.config("wing", true)).value.field_ut.unwrap();
    assert!(x == 0.0 && (y + 50.0).abs() < 1e-9 && (z + 25.0).abs() < 1e-9);

    tree.put("iio:device4/name", "thermometer");
    tree.put("iio:device4/in_temp_raw", "150");
    tree.put("iio:device4/in_temp_offset", "90");
    tree.put("iio:device4/in_temp_scale", "62.5");
    let values = read(&tree.config("iio:device4", true)).value;
    assert!((values.air_temperature_k.unwrap() - 288.15).abs() < 1e-9);
}

#[test]
fn a_buffer_is_set_up_started_and_stopped() {
    let mut tree = Tree::new();
    tree.mpu6050();
    let mut device = Iio::open(&tree.config("mpu6050", true)).unwrap();
    for (file, text) in [
        ("buffer/enable", "1"),
        ("current_timestamp_clock", "monotonic"),
        ("sampling_frequency", "200"),
        ("trigger/current_trigger", "mpu6050-dev0"),
        ("scan_elements/in_accel_z_en", "1"),
        ("scan_elements/in_timestamp_en", "1"),
        ("scan_elements/in_temp_en", "0"),
    ] {
        assert_eq!(tree.got(&format!("iio:device0/{file}")), text, "{file}");
    }
    assert_eq!(device.read().unwrap(), None, "nothing yet");
    // The mean of two scans, of which the second comes in two parts.
    let at = monotonic().as_nanos() - 1_000_000;
    tree.write(&Tree::scan(at));
    let (begin, end) = (Tree::scan(at + 500_000), Tree::scan(at + 500_000));
    tree.write(&begin[..10]);
    let first = device.read().unwrap().unwrap();
    assert_eq!(first.taken, Time::from_nanos(at));
    assert_values(&first.value);
    tree.write(&end[10..]);
    tree.write(&Tree::scan(at + 1_000_000));
    let mean = device.read().unwrap().unwrap();
    assert_eq!(
        (mean.taken, mean.value.samples),
        (Time::from_nanos(at + 750_000), 2)
    );
    assert_values(&mean.value);
    drop(device);
    assert_eq!(tree.got("iio:device0/buffer/enable"), "0");
}

#[test]
fn time_stamps_of_another_clock_are_refused() {
    let mut tree = Tree::new();
    tree.mpu6050();
    let mut device = Iio::open(&tree.config("mpu6050", true)).unwrap();
    // 2026, on the wall's clock.
    tree.write(&Tree::scan(1_790_000_000_000_000_000));
    let error = device.read().unwrap_err();
    assert!(matches!(error, DeviceError::Malformed { .. }), "{error}");
    assert!(error.to_string().contains("monotonic"), "{error}");
}

#[test]
fn a_device_that_is_gone_is_an_error() {
    let mut tree = Tree::new();
    tree.mpu6050();
    let mut device = Iio::open(&tree.config("mpu6050", true)).unwrap();
    tree.pull_out();
    let error = device.read().unwrap_err();
    assert!(
        error.to_string().contains("nothing answers there"),
        "{error}"
    );
}

/// Of two devices with one name each is given by its number.
#[test]
fn what_the_kernel_has_is_found() {
    let mut tree = Tree::new();
    tree.mpu6050();
    tree.put("iio:device1/name", "bmp388");
    tree.put("iio:device1/in_pressure_input", "101.3");
    tree.put("iio:device1/in_temp_input", "21000");
    tree.put("iio:device2/name", "an ADC");
    tree.put("iio:device10/name", "bmp388");
    tree.put("iio:device10/in_pressure_input", "101.3");
    let found = probe::devices(&tree.config("", true).roots);
    let entries: Vec<_> = found.iter().filter_map(Found::entry).collect();
    let of = |device: &str| format!("[[sensor]]\nkind = \"iio\"\ndevice = \"{device}\"\n");
    assert_eq!(
        entries,
        [of("mpu6050"), of("iio:device1"), of("iio:device10")]
    );
    let Found::Iio { quantities, .. } = &found[0] else {
        panic!("{found:?}");
    };
    assert_eq!(
        quantities,
        &[Quantity::Acceleration, Quantity::AngularVelocity]
    );
}

/// A device that is broken is shown, with what is wrong; a name that a configuration
/// cannot hold is not written into it.
#[test]
fn what_the_kernel_has_and_cannot_be_used_is_found() {
    let tree = Tree::new();
    tree.put("iio:device0/name", "bmp\"388");
    tree.put("iio:device0/in_pressure_input", "101.3");
    tree.put("iio:device1/name", "mpu6050");
    for axis in ["x", "y", "z"] {
        tree.put(&format!("iio:device1/in_accel_{axis}_raw"), "0");
    }
    tree.put("iio:device1/in_accel_scale", "nan");
    let found = probe::devices(&tree.config("", true).roots);
    let entries: Vec<_> = found.iter().map(Found::entry).collect();
    let by_number = "[[sensor]]\nkind = \"iio\"\ndevice = \"iio:device0\"\n";
    assert_eq!(entries, [Some(by_number.to_owned()), None]);
    let Some(Found::Unreadable { why, .. }) = found.last() else {
        panic!("{found:?}");
    };
    assert!(
        why.ends_with("iio:device1/in_accel_scale: is no number"),
        "{why}"
    );
}

#[test]
fn what_cannot_be_opened_is_explained() {
    let mut tree = Tree::new();
    let nothing = refused(&tree.config("mpu6050", true));
    assert!(
        nothing.ends_with("by an overlay of the device tree (docs/boards.md)"),
        "{nothing}"
    );
    tree.mpu6050();
    let other = refused(&tree.config("bmp388", true));
    assert!(
        other.ends_with("no device is called \"bmp388\", there is only mpu6050"),
        "{other}"
    );
    tree.put("iio:device1/name", "mpu6050");
    let two = refused(&tree.config("mpu6050", true));
    assert!(
        two.ends_with("called \"mpu6050\": give one of iio:device0, iio:device1"),
        "{two}"
    );
    let adc = refused(&tree.config("iio:device1", true));
    assert!(adc.contains("it measures none of acceleration"), "{adc}");
    tree.put("iio:device0/in_accel_scale", "nan");
    let scale = refused(&tree.config("iio:device0", true));
    assert!(
        scale.ends_with("iio:device0/in_accel_scale: is no number"),
        "{scale}"
    );
    tree.put("iio:device0/in_accel_scale", "0");
    let scale = refused(&tree.config("iio:device0", true));
    assert!(
        scale.contains("the scale of in_accel_x (in_accel_scale) is missing or not above 0"),
        "{scale}"
    );
    tree.put("iio:device0/in_accel_scale", "0.000598");
    let axis = tree.sysfs("iio:device0/in_anglvel_x_raw");
    std::fs::rename(&axis, axis.with_extension("gone")).unwrap();
    let lost = refused(&tree.config("iio:device0", true));
    assert!(
        lost.contains("it has in_anglvel_y and in_anglvel_z but not in_anglvel_x_raw"),
        "{lost}"
    );
    std::fs::rename(axis.with_extension("gone"), axis).unwrap();
    tree.put("iio:device0/in_mount_matrix", "1, 0, 0; 0, 1, 0; 0, 0, -1");
    let mirrored = refused(&tree.config("iio:device0", true));
    assert!(mirrored.contains("is no rotation"), "{mirrored}");
    tree.put("iio:device0/in_mount_matrix", "1, 0, 0; 0, 1, 0; 0, 0, 1");
    tree.put("iio:device0/scan_elements/in_accel_x_type", "le:f32/32>>0");
    let stored = refused(&tree.config("iio:device0", true));
    assert!(
        stored.contains("in_accel_x is stored as \"le:f32/32>>0\""),
        "{stored}"
    );
    tree.put("trigger3/name", "another");
    tree.put("iio:device0/scan_elements/in_accel_x_type", "be:s16/16>>0");
    let trigger = refused(&tree.config("iio:device0", true));
    assert!(trigger.contains("it needs a trigger"), "{trigger}");
}
