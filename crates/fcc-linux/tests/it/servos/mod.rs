//! Servos: pulses, the files and registers that they are written to, and the
//! requirements of an actuator.

mod authority;
mod chip;
mod pulses;
mod pwm_folder;
mod written;

use std::fs;
use std::thread;
use std::time::{Duration, Instant};

use fcc_conformance::{ActuatorBench, VanishingPlant, actuator_conformance};
use fcc_core::flight::Surfaces;
use fcc_core::framework::{Actuator, ActuatorFault, Tick};
use fcc_linux::DeviceStatus;
use fcc_linux::servo::{
    Drives, PwmOutput, Released, ServoActuator, ServoAuthority, ServoBus, ServoChannel,
    ServoSettings, ServoThread, SysfsPwm,
};
use nix::errno::Errno;
use pwm_folder::PwmFolder;

/// No test waits as long as this, unless something is wrong.
const AT_MOST: Duration = Duration::from_secs(20);

fn eventually(mut holds: impl FnMut() -> bool) -> bool {
    let until = Instant::now() + AT_MOST;
    while Instant::now() < until {
        if holds() {
            return true;
        }
        thread::sleep(Duration::from_millis(1));
    }
    false
}

const OPPOSITE: ServoChannel = ServoChannel {
    is_reversed: true,
    ..ServoChannel::new(Drives::Aileron)
};

fn settings(released: Released) -> ServoSettings {
    let channels = vec![
        ServoChannel::new(Drives::Elevator),
        ServoChannel::new(Drives::Aileron),
        OPPOSITE,
        ServoChannel::new(Drives::Throttle),
    ];
    ServoSettings {
        released,
        // Never, in a test that may be suspended.
        silent_after: Duration::from_secs(600),
        ..ServoSettings::new(channels)
    }
}

fn surfaces(number: u32) -> Surfaces {
    let share = f64::from(number % 7 + 1) / 8.0;
    Surfaces {
        throttle: share,
        elevator: -share,
        aileron: share,
        ..Surfaces::default()
    }
}

fn pwm_servos(settings: ServoSettings, folder: &PwmFolder) -> (ServoActuator, DeviceStatus) {
    let outputs = folder.outputs(4);
    let thread = ServoThread::new("servos", settings).pause(Duration::from_millis(1));
    let status = thread.status();
    let open = move || {
        Ok(ServoBus {
            outputs: Box::new(SysfsPwm::open(&outputs, 50.0)?),
            heartbeat: None,
        })
    };
    let actuator = thread.start(open).unwrap();
    (actuator, status)
}

/// Servos at the files of a PWM, and their chip, which may vanish.
struct PwmBench<const OFF: bool> {
    actuator: ServoActuator,
    status: DeviceStatus,
    folder: PwmFolder,
    authority: ServoAuthority,
}

impl<const OFF: bool> PwmBench<OFF> {
    fn settle(&self) {
        assert!(eventually(|| self.actuator.is_settled()));
    }

    fn pulses(&self) -> [String; 4] {
        [0, 1, 2, 3].map(|number| match self.folder.has(number, "enable").as_str() {
            "1" => self.folder.has(number, "duty_cycle"),
            _ => "off".into(),
        })
    }
}

impl<const OFF: bool> ActuatorBench for PwmBench<OFF> {
    type Outputs = Surfaces;

    fn new() -> Self {
        let folder = PwmFolder::new(4, "0");
        let released = if OFF {
            Released::Off
        } else {
            Released::Failsafe
        };
        let (mut actuator, status) = pwm_servos(settings(released), &folder);
        assert!(eventually(|| actuator
            .apply(&Tick::default(), &surfaces(0))
            .is_ok()));
        actuator.release().unwrap();
        let authority = authority::of(&actuator, &folder, &settings(released));
        let bench = Self {
            actuator,
            status,
            folder,
            authority,
        };
        bench.settle();
        bench
    }

    fn actuator(&mut self) -> &mut dyn Actuator<Surfaces> {
        &mut self.actuator
    }

    fn outputs(number: u32) -> Surfaces {
        surfaces(number)
    }

    fn live(&mut self, _: &Tick) {
        self.settle();
    }

    fn is_held(&mut self) -> bool {
        self.settle();
        let released = if OFF {
            ["off"; 4]
        } else {
            ["1500000", "1500000", "1500000", "1000000"]
        };
        self.pulses() != released
    }

    fn follows(&mut self, outputs: &Surfaces) -> bool {
        self.settle();
        let us = |us: f64| format!("{:.0}", us * 1e3);
        self.pulses()
            == [
                us(1_500.0 + 500.0 * outputs.elevator),
                us(1_500.0 + 500.0 * outputs.aileron),
                us(1_500.0 - 500.0 * outputs.aileron),
                us(1_000.0 + 1_000.0 * outputs.throttle),
            ]
    }
}

impl<const OFF: bool> VanishingPlant for PwmBench<OFF> {
    const PATIENCE: usize = 2;
    const BACK_AFTER: usize = 2;

    fn vanish(&mut self) {
        self.settle();
        fs::rename(self.folder.chip(), self.folder.0.path().join("away")).unwrap();
    }

    fn come_back(&mut self) {
        fs::rename(self.folder.0.path().join("away"), self.folder.chip()).unwrap();
        // Until the thread has opened it, and the last order holds.
        self.settle();
        assert!(eventually(|| self.status.trouble().is_none()));
    }
}

actuator_conformance!(servos_that_hold_failsafe: PwmBench<false>, vanishes);
actuator_conformance!(servos_that_are_switched_off: PwmBench<true>, vanishes);

/// The loop hangs, or its process was ended.
#[test]
fn without_the_loop_servos_go_to_failsafe() {
    let folder = PwmFolder::new(4, "0");
    let mut settings = settings(Released::Off);
    settings.silent_after = Duration::from_millis(50);
    settings.channels[0].failsafe = 0.2;
    let (mut actuator, _) = pwm_servos(settings, &folder);
    assert!(eventually(|| actuator
        .apply(&Tick::default(), &surfaces(3))
        .is_ok()));
    let elevator = || (folder.has(0, "duty_cycle"), folder.has(0, "enable"));
    assert!(eventually(|| elevator() == ("1600000".into(), "1".into())));
    // It is back.
    assert_eq!(actuator.apply(&Tick::default(), &surfaces(3)), Ok(()));
    assert!(eventually(|| elevator().0 == "1600000"), "silent again");
    drop(actuator);
    assert_eq!(elevator().1, "0", "released when it ends");
}

#[test]
fn outputs_that_are_not_there_are_a_fault() {
    let thread = ServoThread::new("servos", settings(Released::Failsafe));
    let status = thread.status();
    let missing = vec![PwmOutput {
        chip: "/sys/class/pwm/pwmchip99".into(),
        number: 0,
    }];
    let open = move || {
        Ok(ServoBus {
            outputs: Box::new(SysfsPwm::open(&missing, 50.0)?),
            heartbeat: None,
        })
    };
    let mut actuator = thread.start(open).unwrap();
    assert!(eventually(|| status.trouble().is_some()));
    let fault = actuator.apply(&Tick::default(), &surfaces(0));
    assert_eq!(
        fault,
        Err(ActuatorFault::Io {
            errno: Errno::ENOENT as i32
        })
    );
    let trouble = status.trouble().unwrap();
    assert!(
        trouble.starts_with("cannot open /sys/class/pwm/pwmchip99/export"),
        "{trouble}"
    );
}
