//! A flight with a satellite receiver, which is pulled out and put back, and with
//! servos: on a line, which is a pseudo-terminal, and by the real gpsd, to which
//! gpsfake plays a receiver. The folder of PWM is a stand-in. Also a calibration that
//! reads such a receiver.

use std::fs::{self, File};
use std::io::Write;
use std::net::TcpListener;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use fcc_conformance::RealGpsd;
use fcc_core::framework::{Controller, LoopCommand, RecordOf, State, Tick, Time};
use fcc_fixed_wing::Autopilot;
use fcc_flight::calibrate::{CalibrationKind, CalibrationSession, Extent};
use fcc_flight::config::Config;
use fcc_flight::flight::{Access, FlightTime, Length, Observer, Pace, Plan, Report, assemble, fly};
use fcc_linux::monotonic;
use nix::pty::openpty;
use nix::unistd::ttyname;
use tempfile::TempDir;

/// UBX-NAV-PVT encoded by pyubx2: latitude 42.95, longitude -87.88, 220.4 m above
/// mean sea level.
const NAV_PVT: [u8; 100] = [
    0xb5, 0x62, 0x01, 0x07, 0x5c, 0x00, 0x15, 0xcd, 0x5b, 0x07, 0xea, 0x07, 0x0b, 0x16, 0x01, 0x02,
    0x03, 0x07, 0x14, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x03, 0x01, 0x00, 0x0e, 0x80, 0x93,
    0x9e, 0xcb, 0x60, 0xa6, 0x99, 0x19, 0x90, 0xd6, 0x02, 0x00, 0xf0, 0x5c, 0x03, 0x00, 0xb0, 0x04,
    0x00, 0x00, 0x34, 0x08, 0x00, 0x00, 0x38, 0x37, 0xff, 0xff, 0x39, 0x30, 0x00, 0x00, 0x14, 0xf6,
    0xff, 0xff, 0x7d, 0xce, 0x00, 0x00, 0x0f, 0x0f, 0xfe, 0x00, 0x6e, 0x00, 0x00, 0x00, 0x9f, 0x86,
    0x01, 0x00, 0x8c, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x2d, 0x8b,
];

/// How the receiver is connected.
#[derive(Clone, Copy)]
enum Way {
    Line,
    /// By gpsd at this port.
    Gpsd(u16),
}

/// [`NAV_PVT`] of so many times 25 ms later: the time of week from byte 6 on, and the
/// checksum of RFC 1145 over all between the first two bytes and itself.
fn nav_pvt(later: u32) -> [u8; 100] {
    let mut message = NAV_PVT;
    let week_ms = u32::from_le_bytes(message[6..10].try_into().unwrap());
    message[6..10].copy_from_slice(&(week_ms + 25 * later).to_le_bytes());
    let sums = message[2..98].iter().fold((0_u8, 0_u8), |(a, b), byte| {
        let a = a.wrapping_add(*byte);
        (a, b.wrapping_add(a))
    });
    message[98..].copy_from_slice(&[sums.0, sums.1]);
    message
}

/// A receiver that is connected until this is dropped.
enum Receiver {
    /// And how often it spoke.
    Line(File, u32),
    Gpsd {
        _gpsd: RealGpsd,
    },
}

impl Way {
    /// The sensor's entry, without its calibration.
    fn entry(self, folder: &Path) -> String {
        match self {
            Self::Line => format!(
                "kind = \"gnss-serial\"\npath = \"{}/gnss\"\n",
                folder.display()
            ),
            Self::Gpsd(port) => format!("kind = \"gpsd\"\naddress = \"localhost:{port}\"\n"),
        }
    }

    /// What a remark of it begins with.
    const fn name(self) -> &'static str {
        match self {
            Self::Line => "GNSS receiver: ",
            Self::Gpsd(_) => "gpsd: ",
        }
    }

    fn plug_in(self, folder: &Path) -> Receiver {
        match self {
            // A new line under the same name, and the receiver's end of it.
            Self::Line => {
                let pair = openpty(None, None).unwrap();
                let path = folder.join("gnss");
                let _ = fs::remove_file(&path);
                symlink(ttyname(&pair.slave).unwrap(), path).unwrap();
                Receiver::Line(pair.master.into(), 0)
            }
            Self::Gpsd(port) => {
                // The same place as in [`NAV_PVT`].
                let gpsd = RealGpsd::start(folder, port, |time| {
                    [
                        format!("GNRMC,{time},A,4257.00000,N,08752.80000,W,0.3,,221126,,,A"),
                        format!(
                            "GNGGA,{time},4257.00000,N,08752.80000,W,1,14,0.7,220.4,M,-34.4,M,,"
                        ),
                    ]
                });
                Receiver::Gpsd {
                    _gpsd: gpsd
                        .expect("gpsd and gpsd-clients are installed: `make test-rust` does it"),
                }
            }
        }
    }
}

impl Receiver {
    /// gpsd's receiver speaks by itself.
    fn speak(&mut self) {
        if let Self::Line(line, spoken) = self {
            let _ = line.write(&nav_pvt(*spoken));
            *spoken += 1;
        }
    }
}

fn duty(folder: &Path, output: u32) -> String {
    fs::read_to_string(folder.join(format!("pwm{output}/duty_cycle"))).unwrap_or_default()
}

/// What the flight shows, in this order.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Step {
    /// There is a fix.
    Fix,
    /// The built-in aircraft's switch engages, and the servos follow: the receiver is
    /// pulled out.
    Follow,
    /// Its fix is old, and a remark says why, while the autopilot flies on: it is
    /// put back.
    Gone,
    /// There is a fix again: the flight ends.
    Back,
    Over,
}

struct Watching {
    folder: PathBuf,
    way: Way,
    receiver: Option<Receiver>,
    step: Step,
    latest: Option<RecordOf<Autopilot>>,
    remarks: Arc<Mutex<Vec<String>>>,
    gone_since: Time,
    reached: Arc<Mutex<Step>>,
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

    fn poll(&mut self, access: &mut Access<'_, <Autopilot as Controller>::Command>) {
        if let Some(receiver) = &mut self.receiver {
            receiver.speak();
        }
        let Some(record) = self.latest else { return };
        let fix = record.measurements.gnss;
        self.step = match self.step {
            Step::Fix if !fix.is_never() => {
                assert_eq!(fix.value.position.altitude_m, 220.4);
                Step::Follow
            }
            // Whatever they follow is not the middle to the last nanosecond.
            Step::Follow
                if record.state == State::Engaged
                    && !["1500000", ""].contains(&duty(&self.folder, 0).as_str())
                    && !["1000000", ""].contains(&duty(&self.folder, 1).as_str()) =>
            {
                self.receiver = None;
                Step::Gone
            }
            Step::Gone
                if self
                    .remarks
                    .lock()
                    .unwrap()
                    .iter()
                    .any(|remark| remark.starts_with(self.way.name())) =>
            {
                assert_eq!(record.state, State::Engaged);
                self.gone_since = fix.taken;
                self.receiver = Some(self.way.plug_in(&self.folder));
                Step::Back
            }
            Step::Back if fix.taken > self.gone_since => {
                access.commands.send(LoopCommand::Stop).unwrap();
                Step::Over
            }
            step => step,
        };
        *self.reached.lock().unwrap() = self.step;
    }
}

#[test]
fn a_flight_goes_on_without_its_receiver_and_leaves_the_servos_in_failsafe() {
    in_a_thread(Way::Line);
}

#[test]
fn a_flight_goes_on_without_gpsd() {
    let free = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = free.local_addr().unwrap().port();
    drop(free);
    in_a_thread(Way::Gpsd(port));
}

/// An autopilot is copied from place to place before a flight, and without
/// optimization each copy takes room: a program's first thread has as much.
fn in_a_thread(way: Way) {
    let flight = std::thread::Builder::new()
        .stack_size(8 << 20)
        .spawn(move || fly_it(way));
    flight.unwrap().join().unwrap();
}

fn fly_it(way: Way) {
    let folder = TempDir::new().unwrap();
    for output in 0..2 {
        let path = folder.path().join(format!("pwm{output}"));
        fs::create_dir(&path).unwrap();
        for file in ["period", "duty_cycle", "enable"] {
            fs::write(path.join(file), "0").unwrap();
        }
    }
    let receiver = way.plug_in(folder.path());
    let entry = way.entry(folder.path());
    let here = folder.path().display();
    let text = format!(
        "[built-in]\n[[sensor]]\n{entry}\
         [[actuator]]\nkind = \"simulator\"\n[[actuator]]\nkind = \"servos\"\npwm = \"{here}\"\n\
         [[actuator.channel]]\ndrives = \"elevator\"\noutput = 0\nfailsafe = 0.1\n\
         [[actuator.channel]]\ndrives = \"throttle\"\noutput = 1\n"
    );
    let config = Config::parse(&text, "test").unwrap();
    let mut assembly = assemble(&config).unwrap();
    let (remarks, reached) = (Arc::default(), Arc::new(Mutex::new(Step::Fix)));
    let mut observers = assembly.observers(&config, Pace::RealTime, None);
    observers.push(Box::new(Watching {
        folder: folder.path().to_owned(),
        way,
        receiver: Some(receiver),
        step: Step::Fix,
        latest: None,
        remarks: Arc::clone(&remarks),
        gone_since: Time::NEVER,
        reached: Arc::clone(&reached),
    }));
    let plan = Plan {
        pace: Pace::RealTime,
        // If a step does not come.
        length: Length::Whole(60.0),
    };
    let outcome = fly(assembly, &config.tick, plan, observers, &mut ());
    assert!(outcome.is_ok());
    assert_eq!(*reached.lock().unwrap(), Step::Over, "{:?}", remarks.lock());
    // A tenth of 500 us beyond the middle; idle.
    assert_eq!(duty(folder.path(), 0), "1550000");
    assert_eq!(duty(folder.path(), 1), "1000000");
}

/// The strength of the earth's field, by which a magnetometer is calibrated, is that
/// of the place where the receiver is.
#[test]
fn a_magnetometer_is_calibrated_where_the_receiver_is() {
    assert_eq!(place_in("magnetometer", ""), Some(220.4));
    // What is not asked for is not opened.
    let given = "magnetic_field_ut = [21.1, 0.0, 45.3]\n";
    assert_eq!(place_in("magnetometer", given), None);
    assert_eq!(place_in("accelerometer", ""), None);
}

/// The altitude of the fix that a calibration of this kind has after a second.
fn place_in(kind: &str, navigation: &str) -> Option<f64> {
    let kind = CalibrationKind::ALL
        .into_iter()
        .find(|one| one.name() == kind);
    let folder = TempDir::new().unwrap();
    for (file, content) in [
        ("name", "unit"),
        ("in_accel_x_raw", "0"),
        ("in_accel_y_raw", "0"),
        ("in_accel_z_raw", "-10"),
        ("in_magn_x_raw", "20"),
        ("in_magn_y_raw", "0"),
        ("in_magn_z_raw", "45"),
    ] {
        let path = folder.path().join("iio:device0").join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, content).unwrap();
    }
    for (file, scale) in [("in_accel_scale", "0.980665"), ("in_magn_scale", "0.01")] {
        fs::write(folder.path().join("iio:device0").join(file), scale).unwrap();
    }
    let mut receiver = Way::Line.plug_in(folder.path());
    let receiver_entry = Way::Line.entry(folder.path());
    let sysfs = folder.path().display();
    let text = format!(
        "actuator = []\n[navigation]\nmethod = \"kalman\"\n{navigation}[calibration]\n\
         file = \"{sysfs}/none.toml\"\n\
         [[sensor]]\nkind = \"iio\"\ndevice = \"unit\"\nsysfs = \"{sysfs}\"\n\
         [sensor.calibration.accelerometer]\nbias_mps2 = [0.0, 0.0, 0.1]\n\
         rotation_deg = [0.0, 1.0, 0.0]\n[[sensor]]\n{receiver_entry}"
    );
    let config = Config::parse(&text, "test").unwrap();
    let extent = Extent::Whole;
    let mut session =
        CalibrationSession::open(&config, kind.unwrap(), extent, None, None, 0).unwrap();
    for number in 1..=40 {
        receiver.speak();
        std::thread::sleep(Duration::from_millis(25));
        let now = monotonic();
        let tick = Tick {
            number,
            scheduled: now,
            woke: now,
            dt_s: 0.025,
            ..Tick::default()
        };
        session.tick(&tick).unwrap();
    }
    let fix = session.measured().unwrap().gnss;
    (!fix.is_never()).then_some(fix.value.position.altitude_m)
}
