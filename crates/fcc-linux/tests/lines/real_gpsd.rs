//! The real gpsd with gpsfake, which plays a receiver.

use std::fs;
use std::net::TcpListener;
use std::process::{Child, Command, Stdio};
use std::time::Instant;

use fcc_core::flight::GnssFix;
use fcc_linux::gpsd::{Gpsd, GpsdSettings};
use fcc_linux::{DeviceError, Source, monotonic};
use tempfile::TempDir;

use super::gpsd::{assert_near, settings};
use crate::watched::AT_MOST;

/// A second of a receiver: a sentence with its checksum, the exclusive or of what
/// is between `$` and `*`.
fn second(number: u32) -> String {
    let sentence = |text: String| {
        let sum = text.bytes().fold(0, |sum, byte| sum ^ byte);
        format!("${text}*{sum:02X}\r\n")
    };
    [
        format!("GNRMC,1011{number:02}.00,A,4257.00000,N,08752.80000,W,102.754,166.50,221126,,,A"),
        format!("GNGGA,1011{number:02}.00,4257.00000,N,08752.80000,W,1,14,0.7,220.4,M,-34.4,M,,"),
        "GNGSA,A,3,01,02,03,04,05,06,07,08,09,10,11,12,1.2,0.7,1.0".to_owned(),
    ]
    .map(sentence)
    .concat()
}

/// gpsfake, with the gpsd that it starts.
struct Real {
    gpsfake: Child,
    port: u16,
    log: TempDir,
}

impl Real {
    fn start(port: u16) -> Self {
        let log = TempDir::new().unwrap();
        let path = log.path().join("receiver.nmea");
        let seconds: String = (0..60).map(second).collect();
        fs::write(&path, format!("# a receiver\n{seconds}")).unwrap();
        Self {
            gpsfake: Self::gpsfake(port, &path),
            port,
            log,
        }
    }

    /// gpsd ends with it, at SIGTERM.
    fn gpsfake(port: u16, log: &std::path::Path) -> Child {
        Command::new("gpsfake")
            .args(["--nowait", "--quiet", "--cycle", "0.02", "--port"])
            .arg(port.to_string())
            .arg(log)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("gpsd and gpsd-clients are installed: `make test-rust` does it")
    }

    fn end(&mut self) {
        let pid = nix::unistd::Pid::from_raw(self.gpsfake.id().cast_signed());
        let _ = nix::sys::signal::kill(pid, nix::sys::signal::Signal::SIGTERM);
        let _ = self.gpsfake.wait();
    }

    fn again(&mut self) {
        self.gpsfake = Self::gpsfake(self.port, &self.log.path().join("receiver.nmea"));
    }
}

impl Drop for Real {
    fn drop(&mut self) {
        self.end();
    }
}

/// Opens it until it is there, and reads until there is a fix.
fn fix_of(settings: &GpsdSettings) -> (Gpsd, GnssFix) {
    let begun = Instant::now();
    while begun.elapsed() < AT_MOST {
        let Ok(mut gpsd) = Gpsd::open(settings, monotonic) else {
            std::thread::sleep(std::time::Duration::from_millis(50));
            continue;
        };
        while let Ok(read) = gpsd.read() {
            if let Some(sample) = read {
                return (gpsd, sample.value);
            }
        }
    }
    panic!("no fix");
}

/// Position and altitude are those of the sentences, and 102.754 kt to 166.5° is
/// -51.40 and 12.34 m/s.
#[test]
fn the_real_gpsd_gives_the_fix_of_its_receiver_again_after_it_was_ended() {
    let free = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = free.local_addr().unwrap().port();
    drop(free);
    let mut real = Real::start(port);
    for is_last in [false, true] {
        let (mut gpsd, fix) = fix_of(&settings(port));
        assert_near(fix.position.latitude_rad.to_degrees(), 42.95, 1e-8);
        assert_near(fix.position.longitude_rad.to_degrees(), -87.88, 1e-8);
        assert_eq!(fix.position.altitude_m, 220.4);
        assert_near(fix.velocity.north_mps, -51.40, 0.005);
        assert_near(fix.velocity.east_mps, 12.34, 0.005);
        assert_eq!(fix.velocity.down_mps, 0.0);
        real.end();
        let ended = loop {
            if let Err(error) = gpsd.read() {
                break error;
            }
        };
        assert!(matches!(ended, DeviceError::Io { .. }), "{ended}");
        assert!(matches!(
            Gpsd::open(&settings(port), monotonic),
            Err(DeviceError::Open { .. })
        ));
        if !is_last {
            real.again();
        }
    }
}
