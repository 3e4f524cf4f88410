//! The real gpsd with gpsfake, which plays a receiver.

use std::net::TcpListener;
use std::time::Instant;

use fcc_conformance::RealGpsd;
use fcc_core::flight::GnssFix;
use fcc_linux::gpsd::{Gpsd, GpsdSettings};
use fcc_linux::{DeviceError, Source, monotonic};
use tempfile::TempDir;

use super::gpsd::{assert_near, settings};
use crate::lines::watched::AT_MOST;

/// A gpsd at this port, with its files' folder.
fn start(port: u16) -> (RealGpsd, TempDir) {
    let folder = TempDir::new().unwrap();
    let gpsd = RealGpsd::start(folder.path(), port, |time| {
        [
            format!("GNRMC,{time},A,4257.00000,N,08752.80000,W,102.754,166.50,221126,,,A"),
            format!("GNGGA,{time},4257.00000,N,08752.80000,W,1,14,0.7,220.4,M,-34.4,M,,"),
            "GNGSA,A,3,01,02,03,04,05,06,07,08,09,10,11,12,1.2,0.7,1.0".to_owned(),
        ]
    });
    let gpsd = gpsd.expect("gpsd and gpsd-clients are installed: `make test-rust` does it");
    (gpsd, folder)
}

/// Opens it until it is there, and reads until there is a fix.
fn fix_of(settings: &GpsdSettings) -> (Gpsd, GnssFix) {
    let begun = Instant::now();
    let mut failed = None;
    while begun.elapsed() < AT_MOST {
        let mut gpsd = match Gpsd::open(settings, monotonic) {
            Ok(gpsd) => gpsd,
            Err(error) => {
                failed = Some(error);
                std::thread::sleep(std::time::Duration::from_millis(50));
                continue;
            }
        };
        while begun.elapsed() < AT_MOST {
            match gpsd.read() {
                Ok(Some(sample)) => return (gpsd, sample.value),
                Ok(None) => {}
                Err(error) => {
                    failed = Some(error);
                    break;
                }
            }
        }
    }
    panic!("no fix: {failed:?}");
}

/// What reading it fails with.
fn end_of(gpsd: &mut Gpsd) -> DeviceError {
    let begun = Instant::now();
    while begun.elapsed() < AT_MOST {
        if let Err(error) = gpsd.read() {
            return error;
        }
    }
    panic!("no end");
}

/// Position and altitude are those of the sentences, and 102.754 kt to 166.5° is
/// -51.40 and 12.34 m/s.
#[test]
fn the_real_gpsd_gives_the_fix_of_its_receiver_again_after_it_was_ended() {
    let free = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = free.local_addr().unwrap().port();
    drop(free);
    for _ in 0..2 {
        let real = start(port);
        let (mut gpsd, fix) = fix_of(&settings(port));
        assert_near(fix.position.latitude_rad.to_degrees(), 42.95, 1e-8);
        assert_near(fix.position.longitude_rad.to_degrees(), -87.88, 1e-8);
        assert_eq!(fix.position.altitude_m, 220.4);
        assert_near(fix.velocity.north_mps, -51.40, 0.005);
        assert_near(fix.velocity.east_mps, 12.34, 0.005);
        assert_eq!(fix.velocity.down_mps, 0.0);
        drop(real);
        let ended = end_of(&mut gpsd);
        assert!(matches!(ended, DeviceError::Io { .. }), "{ended}");
        assert!(matches!(
            Gpsd::open(&settings(port), monotonic),
            Err(DeviceError::Open { .. })
        ));
    }
}
