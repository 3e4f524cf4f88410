//! A flight by the sensors of a board, which are pulled out and put back: the
//! kernel's folders are stand-ins, everything else is as in `fccd run`.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use fcc_core::framework::{LoopCommand, RecordOf, Time};
use fcc_fixed_wing::Autopilot;
use fcc_flight::config::Config;
use fcc_flight::flight::{Access, FlightTime, Length, Observer, Pace, Plan, Report, assemble, fly};
use tempfile::TempDir;

/// An IMU and a barometer at rest, as the kernel's drivers `inv_mpu6050` and
/// `bmp280` show them.
fn kernel(folder: &Path) {
    let put = |file: &str, text: &str| {
        let path = folder.join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    put("iio:device0/name", "mpu6050\n");
    for (axis, force) in [("x", "0\n"), ("y", "0\n"), ("z", "16384\n")] {
        put(&format!("iio:device0/in_accel_{axis}_raw"), force);
        put(&format!("iio:device0/in_anglvel_{axis}_raw"), "0\n");
    }
    put("iio:device0/in_accel_scale", "0.000598\n");
    put("iio:device0/in_anglvel_scale", "0.001064724\n");
    put("iio:device1/name", "bmp388\n");
    put("iio:device1/in_pressure_input", "95.461000000\n");
}

/// What the flight shows, in this order.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Step {
    /// Both are read, then the barometer is pulled out.
    Read,
    /// That is a fault, with a remark, then it is put back.
    Gone,
    /// It is read again, and said so: the flight ends.
    Back,
    Over,
}

struct Watching {
    folder: PathBuf,
    step: Step,
    latest: Option<RecordOf<Autopilot>>,
    remarks: Arc<Mutex<Vec<String>>>,
    faults_before: u64,
    gone_since: Time,
}

impl Watching {
    fn device(&self) -> (PathBuf, PathBuf) {
        (self.folder.join("iio:device1"), self.folder.join("pulled"))
    }

    fn was_said(&self, words: &str) -> bool {
        let remarks = self.remarks.lock().unwrap();
        remarks.iter().any(|remark| remark.contains(words))
    }
}

impl Observer<Autopilot> for Watching {
    fn record(&mut self, record: &RecordOf<Autopilot>, _: &FlightTime) {
        self.latest = Some(*record);
    }

    fn report(&mut self, report: &Report, _: &FlightTime) {
        if let Report::Remark(words) = report {
            self.remarks.lock().unwrap().push(words.clone());
        }
    }

    fn poll(
        &mut self,
        access: &mut Access<'_, <Autopilot as fcc_core::framework::Controller>::Command>,
    ) {
        let Some(record) = self.latest else { return };
        let measured = record.measurements;
        let pressure = measured.static_pressure_pa;
        let (device, pulled) = self.device();
        match self.step {
            Step::Read => {
                let imu = measured.raw_specific_force;
                if pressure.is_never() || imu.is_never() {
                    return;
                }
                // 16,384 · 0.000598, mounted upside down; 95.461 kPa less 100 Pa.
                assert!((imu.value.z_mps2 + 9.797_632).abs() < 1e-9, "{imu:?}");
                assert!((pressure.value - 95_361.0).abs() < 1e-6, "{pressure:?}");
                fs::rename(device, pulled).unwrap();
                self.faults_before = record.sensor_faults;
                self.step = Step::Gone;
            }
            Step::Gone => {
                let is_noticed = record.sensor_faults > self.faults_before;
                if is_noticed && self.was_said("IIO: ") {
                    fs::rename(pulled, device).unwrap();
                    self.gone_since = pressure.taken;
                    self.step = Step::Back;
                }
            }
            Step::Back => {
                if pressure.taken > self.gone_since && self.was_said("IIO bmp388 is read") {
                    access.commands.send(LoopCommand::Stop).unwrap();
                    self.step = Step::Over;
                }
            }
            Step::Over => {}
        }
    }
}

/// An autopilot is copied from place to place before a flight, and without
/// optimization each copy takes room: a program's first thread has as much.
#[test]
fn a_flight_goes_on_while_a_sensor_is_pulled_out_and_put_back() {
    let flight = std::thread::Builder::new()
        .stack_size(8 << 20)
        .spawn(fly_it);
    flight.unwrap().join().unwrap();
}

fn fly_it() {
    let folder = TempDir::new().unwrap();
    kernel(folder.path());
    let sysfs = folder.path().display();
    let text = format!(
        "actuator = []\n[failsafe]\nsensor_max_age_ms = 250\n\
         [[sensor]]\nkind = \"iio\"\ndevice = \"mpu6050\"\nsysfs = \"{sysfs}\"\n\
         [sensor.calibration.accelerometer]\nmounting = \"forward-left-up\"\n\
         [[sensor]]\nkind = \"iio\"\ndevice = \"bmp388\"\nrate_hz = 50\nsysfs = \"{sysfs}\"\n\
         silent_after_ms = 100\n[sensor.calibration.static_pressure]\nbias_pa = 100\n"
    );
    let config = Config::parse(&text, "test").unwrap();
    let mut assembly = assemble(&config).unwrap();
    let remarks: Arc<Mutex<Vec<String>>> = Arc::default();
    let mut observers = assembly.observers(&config, Pace::RealTime, None);
    observers.push(Box::new(Watching {
        folder: folder.path().to_owned(),
        step: Step::Read,
        latest: None,
        remarks: Arc::clone(&remarks),
        faults_before: 0,
        gone_since: Time::NEVER,
    }));
    let plan = Plan {
        pace: Pace::RealTime,
        // If a step does not come.
        length: Length::Whole(60.0),
    };
    fly(assembly, &config.tick, plan, observers, &mut ()).unwrap();
    let all = remarks.lock().unwrap();
    let at = |words: &str| all.iter().position(|remark| remark.contains(words));
    let pulled = at("in_pressure_input: reading: No such file or directory");
    let absent = at("no device is called \"bmp388\", there is only mpu6050");
    let back = at("IIO bmp388 is read");
    assert!(pulled.or(absent).is_some(), "{all:?}");
    assert!(back > pulled.or(absent), "{all:?}");
}
