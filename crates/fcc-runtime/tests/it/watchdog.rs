//! A loop that hangs is seen, and one that does not is left alone.

use crate::bench;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use crate::bench::{Stage, parts};
use fcc_core::framework::{Sensor, SensorFault, Tick};
use fcc_runtime::{HeartbeatReading, Loop, LoopConfig, Parts, WatchdogConfig, watch};
use fcc_timer::TimerKind;

/// Long after a healthy machine would have told.
const PATIENCE: Duration = Duration::from_secs(30);

/// Blocks in tick 3, until it is let go.
struct Blocking(mpsc::Receiver<()>);

impl Sensor<bench::Measured> for Blocking {
    fn sample(&mut self, tick: &Tick, _: &mut bench::Measured) -> Result<(), SensorFault> {
        if tick.number >= 3 {
            let _ = self.0.recv();
        }
        Ok(())
    }

    fn name(&self) -> &'static str {
        "blocking"
    }
}

fn config(hang_after_ms: u64) -> WatchdogConfig {
    WatchdogConfig {
        hang_after: Duration::from_millis(hang_after_ms),
        loop_priority: None,
    }
}

#[test]
fn a_sensor_that_blocks_is_a_hang() {
    let (lost_control, blocked) = mpsc::channel();
    let parts = Parts {
        timer: TimerKind::Timerfd.build(Duration::from_millis(5)).unwrap(),
        sensors: vec![Box::new(Blocking(blocked))],
        ..parts(&Stage::default())
    };
    let (flight_loop, link) = Loop::new(parts, &LoopConfig::default()).unwrap();
    let (seen, hangs) = mpsc::channel();
    watch(link.heartbeat.clone(), &config(200), move |hang| {
        seen.send(hang).unwrap();
    })
    .unwrap();
    let handle = flight_loop.spawn().unwrap();
    let hang = hangs.recv_timeout(PATIENCE).unwrap();
    assert!(hang.silent >= Duration::from_millis(200));
    assert!(matches!(link.heartbeat.read(), HeartbeatReading::Beat(_)));
    // Who watches may leave it alone: it ends when it can.
    link.stop.stop();
    handle.abandon();
    drop(lost_control);
    let begun = std::time::Instant::now();
    while link.heartbeat.read() != HeartbeatReading::Ended {
        assert!(begun.elapsed() < PATIENCE);
        thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn a_loop_that_has_ended_is_not_watched() {
    let parts = Parts {
        timer: TimerKind::Timerfd.build(Duration::from_millis(5)).unwrap(),
        ..parts(&Stage::default())
    };
    let (flight_loop, link) = Loop::new(parts, &LoopConfig::default()).unwrap();
    assert_eq!(link.heartbeat.read(), HeartbeatReading::NotStarted);
    let (seen, hangs) = mpsc::channel();
    watch(link.heartbeat.clone(), &config(2_000), move |hang| {
        let _ = seen.send(hang);
    })
    .unwrap();
    let handle = flight_loop.spawn().unwrap();
    handle.stop();
    handle.join();
    assert_eq!(link.heartbeat.read(), HeartbeatReading::Ended);
    // The watchdog drops its sender as it leaves, and has sent nothing.
    assert_eq!(
        hangs.recv_timeout(PATIENCE),
        Err(mpsc::RecvTimeoutError::Disconnected)
    );
}
