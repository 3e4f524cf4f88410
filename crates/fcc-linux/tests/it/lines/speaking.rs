//! What is said on a line, in both directions.

use std::fs::File;
use std::io::{Read, Write};
use std::os::fd::OwnedFd;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::Instant;

use fcc_core::framework::Time;
use fcc_linux::serial::{
    GnssReceiver, GnssSettings, LineSettings, RcProtocol, SerialLine, configuration,
};
use fcc_linux::{DeviceError, Source};
use nix::pty::openpty;
use nix::unistd::ttyname;

use super::{NAV_PVT, nav_pvt_later_by};
use crate::lines::watched::AT_MOST;

/// The device's end of a line, and its name; the third keeps it open.
pub(super) fn line() -> (File, PathBuf, OwnedFd) {
    let pair = openpty(None, None).unwrap();
    let path = ttyname(&pair.slave).unwrap();
    (pair.master.into(), path, pair.slave)
}

fn receiver(path: PathBuf, now_s: i64) -> GnssReceiver {
    receiver_with(path, move || Time::from_nanos(now_s * 1_000_000_000))
}

pub(super) fn receiver_with(
    path: PathBuf,
    now: impl Fn() -> Time + Send + 'static,
) -> GnssReceiver {
    let line = LineSettings {
        path,
        baud: 38_400,
        has_even_parity: false,
    };
    let settings = GnssSettings {
        line,
        configures: true,
    };
    GnssReceiver::open(&settings, now).unwrap()
}

/// ACK-NAK of CFG-VALSET, encoded by pyubx2.
const REFUSED: [u8; 10] = [0xb5, 0x62, 0x05, 0x00, 0x02, 0x00, 0x06, 0x8a, 0x97, 0xbc];

/// Encoded by pynmea2; a second apart.
const SENTENCES: &str = "\
    $GNGGA,101111.20,4257.00000,N,08752.80000,W,4,14,0.7,217.86,M,-34.4,M,1.0,0000*5B\r\n\
    $GNRMC,101111.20,A,4257.00000,N,08752.80000,W,102.754,166.50,221126,,,R*73\r\n\
    $GNRMC,101112.20,A,4257.00000,N,08752.80000,W,102.754,166.50,221126,,,R*70\r\n\
    $GNGGA,101112.20,4257.00000,N,08752.80000,W,4,14,0.7,220.4,M,-34.4,M,1.0,0000*66\r\n";

#[test]
fn a_receiver_is_configured_and_one_that_refuses_is_used_as_it_is() {
    let (mut device, path, _open) = line();
    let mut receiver = receiver(path, 100);
    device.write_all(&REFUSED).unwrap();
    let Err(DeviceError::Malformed { what, .. }) = receiver.read() else {
        panic!("the refusal is reported");
    };
    assert!(what.starts_with("the receiver refuses a part of the configuration"));
    let expected = configuration().concat();
    let mut sent = vec![0; expected.len()];
    device.read_exact(&mut sent).unwrap();
    assert_eq!(sent, expected);
    device.write_all(SENTENCES.as_bytes()).unwrap();
    let fix = receiver.read().unwrap().unwrap();
    assert_eq!(fix.value.position.altitude_m, 220.4);
    assert_eq!(fix.taken, Time::from_nanos(100_000_000_000));
}

/// What passes messages on is overloaded for 2 s, and then late by as much: the receiver's own
/// time tells. Clocks may differ by 0.05 % at first.
#[test]
fn a_fix_that_comes_late_was_taken_at_the_time_of_its_epoch() {
    let (mut device, path, _open) = line();
    let now_ms = Arc::new(AtomicI64::new(0));
    let clock = now_ms.clone();
    let now = move || Time::from_nanos(clock.load(Ordering::Relaxed) * 1_000_000);
    let mut receiver = receiver_with(path, now);
    for number in 0..40_u32 {
        let late_ms = if number < 20 { 80 } else { 2_080 };
        let epoch_ms = 200 * number;
        now_ms.store(i64::from(epoch_ms) + late_ms, Ordering::Relaxed);
        device.write_all(&nav_pvt_later_by(epoch_ms)).unwrap();
        let taken = receiver.read().unwrap().unwrap().taken;
        let usual = Time::from_nanos((i64::from(epoch_ms) + 80) * 1_000_000);
        let off_ms = (taken - usual).abs() / 1_000_000;
        assert!(off_ms <= 5, "fix {number}: {off_ms} ms");
    }
}

/// What passes messages on hangs, and sends the last one again and again.
#[test]
fn a_fix_that_arrives_again_is_not_used_and_that_is_said() {
    let (mut device, path, _open) = line();
    let mut receiver = receiver(path, 100);
    device.write_all(&NAV_PVT).unwrap();
    assert!(receiver.read().unwrap().is_some());
    assert_eq!(receiver.waits_for(), None);
    for _ in 0..3 {
        device.write_all(&NAV_PVT).unwrap();
        assert_eq!(receiver.read().unwrap(), None);
    }
    let said = receiver.waits_for().unwrap();
    assert!(said.starts_with("its fixes repeat a time"), "{said}");
}

#[test]
fn sentences_beside_ubx_are_not_used() {
    let (mut device, path, _open) = line();
    let mut receiver = receiver(path, 100);
    device.write_all(&NAV_PVT).unwrap();
    assert!(receiver.read().unwrap().is_some());
    device.write_all(SENTENCES.as_bytes()).unwrap();
    assert_eq!(receiver.read().unwrap(), None);
}

#[test]
fn bytes_that_are_not_understood_are_reported() {
    let (mut device, path, _open) = line();
    let mut receiver = receiver(path, 100);
    for piece in 0..60 {
        device.write_all(&[0xf0; 200]).unwrap();
        if let Err(error) = receiver.read() {
            assert!(piece > 40, "10,000 bytes");
            assert!(error.to_string().contains("check `baud`"), "{error}");
            return;
        }
    }
    panic!("not reported");
}

/// A device at USB, which keeps no rate: 4,000,000 baud, the most of a configuration, are 400,000
/// bytes in a second.
#[test]
fn a_line_on_which_bytes_never_end_is_closed() {
    let (mut device, path, _open) = line();
    let mut line = SerialLine::open(&RcProtocol::Crsf.line(path)).unwrap();
    let begun = Instant::now();
    let mut received = 0;
    while begun.elapsed() < AT_MOST {
        device.write_all(&[b'x'; 2_000]).unwrap();
        match line.read(&mut [0; 4_096]) {
            Ok(length) => received += length,
            Err(error) => {
                assert!(received > 400_000, "{received}");
                let said = error.to_string();
                assert!(
                    said.contains("more than 1000000 bytes in a second"),
                    "{said}"
                );
                return;
            }
        }
    }
    panic!("not reported");
}

/// SBUS and CRSF have rates that POSIX does not know.
#[test]
fn a_line_runs_at_any_rate() {
    for (protocol, baud) in [(RcProtocol::Sbus, 100_000), (RcProtocol::Crsf, 420_000)] {
        let (device, path, _open) = line();
        let _line = SerialLine::open(&protocol.line(path)).unwrap();
        let modes = rustix::termios::tcgetattr(&device).unwrap();
        assert_eq!((modes.input_speed(), modes.output_speed()), (baud, baud));
    }
}

#[test]
fn a_line_that_is_missing_or_gone_is_an_error() {
    let missing = SerialLine::open(&RcProtocol::Crsf.line("/dev/no-such-line")).unwrap_err();
    assert!(missing.to_string().starts_with(
        "cannot open /dev/no-such-line: No such file or directory (os error 2); check the path"
    ));
    let (device, path, open) = line();
    let mut line = SerialLine::open(&RcProtocol::Crsf.line(path)).unwrap();
    assert_eq!(line.read(&mut [0; 10]).unwrap(), 0, "silent");
    drop((device, open));
    // A program that another test is just starting may still hold the other end.
    let ended = (0..50)
        .map(|_| line.read(&mut [0; 10]))
        .find(Result::is_err);
    assert!(matches!(ended, Some(Err(DeviceError::Io { .. }))));
}
