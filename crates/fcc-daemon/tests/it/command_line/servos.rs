//! Servos of a program that is killed in flight: its release helper, a process of
//! its own, gives them their released pulses. The kernel's files of PWM are a folder.

use std::fs;
use std::path::Path;
use std::process::{Child, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use super::{PATIENCE, fccd};

/// A flight whose process is killed when this is dropped.
struct Flown(Child);

impl Drop for Flown {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn eventually(holds: impl Fn() -> bool) -> bool {
    let begun = Instant::now();
    while begun.elapsed() < PATIENCE {
        if holds() {
            return true;
        }
        thread::sleep(Duration::from_millis(10));
    }
    false
}

/// Duty cycle in ns, and whether it is enabled.
fn output(folder: &Path, number: u32) -> [String; 2] {
    ["duty_cycle", "enable"].map(|file| {
        let path = folder.join(format!("pwm{number}/{file}"));
        fs::read_to_string(path).unwrap_or_default()
    })
}

/// Flies with two servos until both follow, kills the process, and says what the
/// outputs are then.
fn after_a_kill(released: &str, expected: [[&str; 2]; 2]) {
    // In memory, as the kernel's are: a disk that is busy for seconds is a fault of the
    // servos, which releases them.
    let folder = tempfile::tempdir_in("/dev/shm").unwrap();
    for number in 0..2 {
        let path = folder.path().join(format!("pwm{number}"));
        fs::create_dir(&path).unwrap();
        for file in ["period", "duty_cycle", "enable"] {
            fs::write(path.join(file), "0").unwrap();
        }
    }
    let here = folder.path().display();
    let text = format!(
        "[built-in]\nengage_at_s = 1.2\n[[actuator]]\nkind = \"simulator\"\n\
         [[actuator]]\nkind = \"servos\"\npwm = \"{here}\"\nreleased = \"{released}\"\n\
         [[actuator.channel]]\ndrives = \"elevator\"\noutput = 0\nfailsafe = 0.1\n\
         [[actuator.channel]]\ndrives = \"throttle\"\noutput = 1\n"
    );
    fs::write(folder.path().join("fccd.toml"), text).unwrap();
    let words = ["run", "--config", "fccd.toml", "--no-recording", "--quiet"];
    let messages = folder.path().join("messages");
    let process = fccd(folder.path(), &words)
        .args(["--instance", &format!("servos-{released}")])
        .stdout(Stdio::null())
        .stderr(fs::File::create(&messages).unwrap())
        .spawn()
        .unwrap();
    let mut flown = Flown(process);
    // Whatever they follow is not the released pulse to the last nanosecond.
    let follows = |number, released: &str| {
        let [duty, enable] = output(folder.path(), number);
        enable == "1" && !["", "0", released].contains(&duty.as_str())
    };
    let found = || [output(folder.path(), 0), output(folder.path(), 1)];
    assert!(
        eventually(|| follows(0, "1550000") && follows(1, "1000000")),
        "{:?} {}",
        found(),
        fs::read_to_string(&messages).unwrap()
    );
    flown.0.kill().unwrap();
    flown.0.wait().unwrap();
    let is_released = || {
        let [elevator, throttle] = found();
        let is = |found: [String; 2], [duty, enable]: [&str; 2]| {
            found[1] == enable && (enable == "0" || found[0] == duty)
        };
        is(elevator, expected[0]) && is(throttle, expected[1])
    };
    assert!(eventually(is_released), "{:?}", found());
}

/// A tenth of 500 us beyond the middle; idle.
#[test]
fn servos_of_a_killed_program_go_to_failsafe() {
    after_a_kill("failsafe", [["1550000", "1"], ["1000000", "1"]]);
}

#[test]
fn servos_of_a_killed_program_are_switched_off() {
    after_a_kill("off", [["", "0"]; 2]);
}
