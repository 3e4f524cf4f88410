//! A flight with a satellite receiver on a line, which is pulled out and put back,
//! and with servos: the line is a pseudo-terminal, and the folder of PWM a
//! stand-in.
#![cfg(test)]

use std::fs::{self, File};
use std::io::Write;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use fcc_core::flight::Autopilot;
use fcc_core::framework::{Controller, LoopCommand, RecordOf, State, Time};
use fcc_flight::config::Config;
use fcc_flight::flight::{Access, FlightTime, Length, Observer, Pace, Plan, Report, assemble, fly};
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

/// A new line under a name, and the receiver's end of it.
fn plug_in(folder: &Path) -> File {
    let pair = openpty(None, None).unwrap();
    let path = folder.join("gnss");
    let _ = fs::remove_file(&path);
    symlink(ttyname(&pair.slave).unwrap(), path).unwrap();
    pair.master.into()
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
    receiver: Option<File>,
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
            let _ = receiver.write(&NAV_PVT);
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
                    .any(|remark| remark.starts_with("GNSS receiver: ")) =>
            {
                assert_eq!(record.state, State::Engaged);
                self.gone_since = fix.taken;
                self.receiver = Some(plug_in(&self.folder));
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

/// An autopilot is copied from place to place before a flight, and without
/// optimization each copy takes room: a program's first thread has as much.
#[test]
fn a_flight_goes_on_without_its_receiver_and_leaves_the_servos_in_failsafe() {
    let flight = std::thread::Builder::new()
        .stack_size(8 << 20)
        .spawn(fly_it);
    flight.unwrap().join().unwrap();
}

fn fly_it() {
    let folder = TempDir::new().unwrap();
    for output in 0..2 {
        let path = folder.path().join(format!("pwm{output}"));
        fs::create_dir(&path).unwrap();
        for file in ["period", "duty_cycle", "enable"] {
            fs::write(path.join(file), "0").unwrap();
        }
    }
    let receiver = plug_in(folder.path());
    let here = folder.path().display();
    let text = format!(
        "[built-in]\n[[sensor]]\nkind = \"gnss-serial\"\npath = \"{here}/gnss\"\n\
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
