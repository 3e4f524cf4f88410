//! The serial line: errors, wrong bits, and the end of the program.

use crate::support;
use crate::support::{Bench, SerialLine, Way, connect};
use fcc_conformance::Ticks;
use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::SensorFault;
use fcc_servo_board::Control;
use fcc_servo_link::{Baud, ServoBoardConfig, open_serial};

const OUTPUTS: Surfaces = Surfaces {
    throttle: 0.5,
    elevator: 0.25,
    aileron: -0.25,
    rudder: 0.125,
    ..Surfaces::IDLE
};

fn flown() -> (Bench<SerialLine>, Ticks) {
    let (mut bench, mut ticks) = (Bench::<SerialLine>::open(), Ticks::default());
    for _ in 0..20 {
        let tick = ticks.next_tick();
        bench.live();
        let _ = bench.sensor.sample(&tick, &mut bench.measured);
        bench.actuator.apply(&tick, &OUTPUTS).unwrap();
    }
    assert!(bench.follows(&OUTPUTS));
    (bench, ticks)
}

#[test]
fn a_corrupt_frame_is_a_fault_once_and_changes_no_reading() {
    let (mut bench, mut ticks) = flown();
    let before = bench.measured;
    bench.way.write(b"\x00\x09no frame\x00");
    support::wait_until("it is counted", || bench.way.status.corrupt() == 1);
    let mut sample = |bench: &mut Bench<SerialLine>| {
        let tick = ticks.next_tick();
        bench.sensor.sample(&tick, &mut bench.measured)
    };
    assert_eq!(sample(&mut bench), Err(SensorFault::Malformed));
    assert_eq!(bench.measured, before);
    assert_eq!(sample(&mut bench), Ok(()));
}

/// A device at USB keeps no rate of a line: what it sends without end is not read, and
/// what the loop sends is still written.
#[test]
fn of_a_flood_the_rest_is_dropped_and_surfaces_are_still_written() {
    let (mut bench, mut ticks) = flown();
    let flood = [b'x'; 1_000];
    let mut master = bench.way.master.as_ref().unwrap().try_clone().unwrap();
    let mut sent = 0;
    let began = std::time::Instant::now();
    while bench.way.status.floods() < 10 && began.elapsed().as_secs() < 60 {
        match std::io::Write::write(&mut master, &flood) {
            Ok(length) => sent += length,
            Err(_) => std::thread::sleep(std::time::Duration::from_micros(200)),
        }
    }
    assert!(bench.way.status.floods() >= 10);
    // Ten times 100,000 bytes were read, and the kernel's buffer was emptied as often.
    assert!(sent > 1_000_000, "{sent}");
    let written = bench.way.status.written();
    for _ in 0..3 {
        bench.actuator.apply(&ticks.next_tick(), &OUTPUTS).unwrap();
    }
    support::wait_until("surfaces are written", || {
        let _ = std::io::Write::write(&mut master, &flood);
        bench.way.status.written() > written
    });
    let sampled = bench.sensor.sample(&ticks.next_tick(), &mut bench.measured);
    assert_eq!(sampled, Err(SensorFault::Malformed));
}

/// The end of a program waits until the release is written.
#[test]
fn a_release_at_the_end_arrives() {
    let (bench, _) = flown();
    let Bench {
        mut way,
        mut board,
        sensor,
        actuator,
        now_ms,
        ..
    } = bench;
    drop(actuator);
    drop(sensor);
    for (from, message) in way.received() {
        let _ = board.receive(now_ms, from, &message);
    }
    assert_eq!(board.control(), Control::Free);
}

#[test]
fn a_lost_line_is_a_fault_of_both_until_it_is_back() {
    let (mut bench, mut ticks) = flown();
    bench.way.pull();
    for _ in 0..3 {
        let tick = ticks.next_tick();
        let sampled = bench.sensor.sample(&tick, &mut Measurements::default());
        assert!(
            matches!(sampled, Err(SensorFault::Io { .. })),
            "{sampled:?}"
        );
        bench.actuator.apply(&tick, &OUTPUTS).unwrap_err();
    }
    bench.way.put_back();
    let tick = ticks.next_tick();
    bench.actuator.apply(&tick, &OUTPUTS).unwrap();
}

#[test]
fn a_line_that_cannot_be_opened_is_named_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ttyBOARD");
    let config = ServoBoardConfig::default();
    let message = |path| {
        let opened = open_serial(&config, path, Baud::B115200);
        opened.unwrap_err().to_string()
    };
    let missing = message(&path);
    assert!(missing.contains("ttyBOARD: No such file"), "{missing}");
    assert!(missing.contains("plug the board in"), "{missing}");
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    let no_line = message(&file);
    assert!(no_line.contains("choose a serial line"), "{no_line}");
    let _master = connect(&path);
    let _open = open_serial(&config, &path, Baud::B57600).unwrap();
    let taken = message(&path);
    assert!(taken.contains("another program has it"), "{taken}");
}
