//! Servos whose pulses and heartbeat are kept in memory: what is written, and when.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use fcc_core::flight::Surfaces;
use fcc_core::framework::{Actuator, ActuatorFault, Tick};
use fcc_linux::DeviceError;
use fcc_linux::servo::{
    Drives, HeartbeatLine, PulseOutputs, ServoActuator, ServoBus, ServoChannel, ServoSettings,
    ServoThread,
};
use nix::errno::Errno;

use super::{eventually, surfaces};

/// What was written, in order.
#[derive(Clone, Default)]
struct Written(Arc<Mutex<Vec<f64>>>);

impl PulseOutputs for Written {
    fn write(&mut self, pulses_us: &[Option<f64>]) -> Result<(), DeviceError> {
        self.0.lock().unwrap().extend(pulses_us.iter().flatten());
        Ok(())
    }
}

#[derive(Clone, Default)]
struct Beats(Arc<Mutex<Vec<bool>>>);

impl HeartbeatLine for Beats {
    fn set(&mut self, is_high: bool) -> Result<(), DeviceError> {
        self.0.lock().unwrap().push(is_high);
        Ok(())
    }
}

fn one(settings: ServoSettings) -> (ServoActuator, Written, Beats) {
    let (written, beats) = (Written::default(), Beats::default());
    let bus = (written.clone(), beats.clone());
    let open = move || {
        let (written, beats) = bus.clone();
        Ok(ServoBus {
            outputs: Box::new(written),
            heartbeat: Some(Box::new(beats)),
        })
    };
    let actuator = ServoThread::new("servos", settings).start(open).unwrap();
    let has_begun = written.clone();
    assert!(eventually(|| !has_begun.0.lock().unwrap().is_empty()));
    (actuator, written, beats)
}

fn elevator() -> ServoChannel {
    ServoChannel::new(Drives::Elevator)
}

/// A failsafe throttle is for the silence of a flight, not for an aircraft on the
/// bench: 2,000 us at once, before anybody had engaged.
#[test]
fn a_throttle_is_idle_while_nobody_has_control() {
    let mut settings = ServoSettings::new(vec![ServoChannel {
        failsafe: 1.0,
        ..ServoChannel::new(Drives::Throttle)
    }]);
    settings.silent_after = Duration::from_millis(50);
    let (mut actuator, written, _) = one(settings);
    let last = || written.0.lock().unwrap().last().copied();
    assert_eq!(last(), Some(1_000.0));
    let half = Surfaces {
        throttle: 0.5,
        ..Surfaces::default()
    };
    assert_eq!(actuator.apply(&Tick::default(), &half), Ok(()));
    assert!(eventually(|| last() == Some(2_000.0)), "silent");
    actuator.release().unwrap();
    assert!(eventually(|| last() == Some(1_000.0)));
}

/// 2 of full deflection in a second, so at least half a second from the middle to
/// the end; a step is never more than that of the silence.
#[test]
fn a_slew_limit_makes_small_steps() {
    let mut settings = ServoSettings::new(vec![ServoChannel {
        slew_per_s: Some(2.0),
        ..elevator()
    }]);
    settings.silent_after = Duration::from_millis(100);
    let (mut actuator, written, _) = one(settings);
    let up = Surfaces {
        elevator: 1.0,
        ..Surfaces::default()
    };
    let began = Instant::now();
    assert!(eventually(|| {
        let _ = actuator.apply(&Tick::default(), &up);
        written.0.lock().unwrap().last() == Some(&2_000.0)
    }));
    assert!(
        began.elapsed() >= Duration::from_millis(400),
        "{:?}",
        began.elapsed()
    );
    let written = written.0.lock().unwrap();
    let largest = written
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .fold(0.0, f64::max);
    // 0.1 s x 2 x 500 us.
    assert!(largest <= 100.0 + 1e-9, "{largest}");
}

/// Flaps and brakes stay where they were last written, at first at failsafe; the
/// nose wheel is straight in the air. The gear's failsafe is down.
#[test]
fn what_a_runway_needs_is_left_as_it_is_in_the_air() {
    let drives = [
        Drives::Flaps,
        Drives::LeftBrake,
        Drives::RightBrake,
        Drives::NoseWheel,
        Drives::Gear,
    ];
    let mut channels = drives.map(ServoChannel::new);
    channels[0].failsafe = 0.1;
    let mut settings = ServoSettings::new(channels.to_vec());
    settings.silent_after = Duration::from_secs(600);
    let (mut actuator, written, _) = one(settings);
    let in_the_air = Surfaces::default();
    let rolls_out = Surfaces {
        flaps: Some(0.5),
        left_brake: Some(0.25),
        right_brake: Some(0.75),
        nose_wheel: Some(-1.0),
        gear: Some(0.0),
        ..in_the_air
    };
    for (surfaces, us) in [
        (in_the_air, [1_100.0, 1_000.0, 1_000.0, 1_500.0, 2_000.0]),
        (rolls_out, [1_500.0, 1_250.0, 1_750.0, 1_000.0, 1_000.0]),
        (in_the_air, [1_500.0, 1_250.0, 1_750.0, 1_500.0, 1_000.0]),
    ] {
        assert_eq!(actuator.apply(&Tick::default(), &surfaces), Ok(()));
        assert!(eventually(|| actuator.is_settled()));
        assert!(written.0.lock().unwrap().ends_with(&us), "{us:?}");
    }
    actuator.release().unwrap();
    assert!(eventually(|| actuator.is_settled()));
    let released = [1_100.0, 1_000.0, 1_000.0, 1_500.0, 2_000.0];
    assert!(written.0.lock().unwrap().ends_with(&released));
}

/// The loop does not engage with servos that cannot be opened.
#[test]
fn servos_are_ready_once_they_are_open() {
    let written = Written::default();
    let is_there = Arc::new(AtomicBool::new(false));
    let found = Arc::clone(&is_there);
    let open = move || {
        if found.load(Ordering::Acquire) {
            let outputs = Box::new(written.clone());
            return Ok(ServoBus {
                outputs,
                heartbeat: None,
            });
        }
        Err(DeviceError::Open {
            device: "/nope/pwm".to_owned(),
            source: Errno::ENOENT.into(),
        })
    };
    let settings = ServoSettings::new(vec![elevator()]);
    let servos = ServoThread::new("servos", settings).start(open).unwrap();
    assert!(eventually(|| servos.ready()
        == Err(ActuatorFault::Io {
            errno: Errno::ENOENT as i32
        })));
    is_there.store(true, Ordering::Release);
    assert!(eventually(|| servos.ready().is_ok()));
}

#[test]
fn the_heartbeat_changes_only_while_outputs_come() {
    let mut settings = ServoSettings::new(vec![elevator()]);
    settings.silent_after = Duration::from_secs(600);
    settings.heartbeat_every = Duration::ZERO;
    let (mut actuator, _, beats) = one(settings);
    assert!(beats.0.lock().unwrap().is_empty(), "without control");
    for number in 1..=5 {
        assert_eq!(actuator.apply(&Tick::default(), &surfaces(number)), Ok(()));
        assert!(eventually(|| actuator.is_settled()));
    }
    assert_eq!(*beats.0.lock().unwrap(), [true, false, true, false, true]);
    assert_eq!(actuator.release(), Ok(()));
    assert!(eventually(|| actuator.is_settled()));
    assert_eq!(beats.0.lock().unwrap().last(), Some(&false));
    let after = beats.0.lock().unwrap().len();
    drop(actuator);
    assert_eq!(beats.0.lock().unwrap().len(), after);
}
