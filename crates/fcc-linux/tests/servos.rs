//! Servos: pulses, the files and registers that they are written to, and the
//! requirements of an actuator.
#![allow(
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    reason = "helper functions of tests"
)]

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use embedded_hal::i2c::{ErrorType, I2c, Operation};
use fcc_conformance::{ActuatorBench, VanishingPlant, actuator_conformance};
use fcc_core::flight::Surfaces;
use fcc_core::framework::{Actuator, ActuatorFault, Tick};
use fcc_linux::servo::{
    Drives, HeartbeatLine, Pca9685, Pca9685Settings, PulseOutputs, PwmOutput, Released,
    ServoActuator, ServoBus, ServoChannel, ServoError, ServoSettings, ServoThread, SysfsPwm,
};
use fcc_linux::{DeviceError, DeviceStatus};
use nix::errno::Errno;
use tempfile::TempDir;

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

/// A folder like a chip's in `/sys/class/pwm`, whose outputs are exported.
struct PwmFolder(TempDir);

impl PwmFolder {
    fn new(outputs: u32, period: &str) -> Self {
        let this = Self(TempDir::new().unwrap());
        for number in 0..outputs {
            fs::create_dir(this.output(number)).unwrap();
            for (file, value) in [("period", period), ("duty_cycle", "0"), ("enable", "0")] {
                fs::write(this.output(number).join(file), value).unwrap();
            }
        }
        this
    }

    fn chip(&self) -> PathBuf {
        self.0.path().join("pwmchip0")
    }

    fn output(&self, number: u32) -> PathBuf {
        let chip = self.chip();
        let _ = fs::create_dir(&chip);
        chip.join(format!("pwm{number}"))
    }

    fn has(&self, number: u32, file: &str) -> String {
        fs::read_to_string(self.output(number).join(file)).unwrap_or_default()
    }

    fn outputs(&self, count: u32) -> Vec<PwmOutput> {
        let output = |number| PwmOutput {
            chip: self.chip(),
            number,
        };
        (0..count).map(output).collect()
    }
}

#[test]
fn pulses_are_within_their_ends() {
    let channel = ServoChannel {
        min_us: 1_100.0,
        centre_us: 1_480.0,
        max_us: 1_900.0,
        ..ServoChannel::new(Drives::Aileron)
    };
    for (position, us) in [
        (-1.0, 1_100.0),
        (-0.5, 1_290.0),
        (0.0, 1_480.0),
        (0.5, 1_690.0),
        (1.0, 1_900.0),
    ] {
        assert_eq!(channel.pulse_us(position), us);
    }
    for (position, us) in [(-9.0, 1_100.0), (9.0, 1_900.0), (f64::NAN, 1_480.0)] {
        assert_eq!(channel.pulse_us(position), us);
    }
    let reversed = ServoChannel {
        is_reversed: true,
        ..channel
    };
    assert_eq!(
        [-1.0, 0.0, 1.0].map(|at| reversed.pulse_us(at)),
        [1_900.0, 1_480.0, 1_100.0]
    );
    // A tenth of 420 us; the ends stay.
    let trimmed = ServoChannel {
        trim: 0.1,
        ..channel
    };
    assert_eq!(
        [0.0, 1.0].map(|at| trimmed.pulse_us(at)),
        [1_522.0, 1_900.0]
    );
    let throttle = ServoChannel::new(Drives::Throttle);
    assert_eq!(
        [0.0, 0.25, 1.0].map(|at| throttle.pulse_us(at)),
        [1_000.0, 1_250.0, 2_000.0]
    );
    let reversed = ServoChannel {
        is_reversed: true,
        ..throttle
    };
    assert_eq!(
        [0.0, 0.25, 1.0].map(|at| reversed.pulse_us(at)),
        [2_000.0, 1_750.0, 1_000.0]
    );
}

#[test]
fn an_impossible_channel_is_refused() {
    let channel = ServoChannel::new(Drives::Rudder);
    let pulses = ServoChannel {
        centre_us: 2_100.0,
        ..channel
    };
    assert!(matches!(pulses.validate(), Err(ServoError::Pulses { .. })));
    let failsafe = ServoChannel {
        failsafe: -0.1,
        ..ServoChannel::new(Drives::Throttle)
    };
    assert_eq!(
        failsafe.validate().unwrap_err().to_string(),
        "a failsafe position of -0.1 is out of range: choose 0 to 1"
    );
    let trim = ServoChannel {
        trim: 0.1,
        ..ServoChannel::new(Drives::Throttle)
    };
    assert_eq!(trim.validate(), Err(ServoError::ThrottleTrim));
    assert_eq!(channel.validate(), Ok(()));
}

/// 50 Hz are 20,000,000 ns, 1.5 ms are 1,500,000 (the kernel's unit).
#[test]
fn pulses_are_written_to_the_files_of_pwm() {
    let folder = PwmFolder::new(2, "1000000");
    let mut pwm = SysfsPwm::open(&folder.outputs(2), 50.0).unwrap();
    assert_eq!(folder.has(0, "period"), "20000000");
    assert_eq!(folder.has(0, "enable"), "0");
    pwm.write(&[Some(1_500.0), None]).unwrap();
    assert_eq!(
        (folder.has(0, "duty_cycle"), folder.has(0, "enable")),
        ("1500000".into(), "1".into())
    );
    assert_eq!(folder.has(1, "enable"), "0");
    pwm.write(&[None, Some(900.0)]).unwrap();
    assert_eq!(folder.has(0, "enable"), "0");
    assert_eq!(
        (folder.has(1, "duty_cycle"), folder.has(1, "enable")),
        ("900000".into(), "1".into())
    );
}

/// Two daemons that write one servo, or two entries of a configuration.
#[test]
fn an_output_is_driven_by_one() {
    let folder = PwmFolder::new(2, "1000000");
    let outputs = folder.outputs(2);
    let mut first = SysfsPwm::open(&outputs[1..], 50.0).unwrap();
    first.write(&[Some(1_500.0)]).unwrap();
    let error = SysfsPwm::open(&outputs, 50.0).unwrap_err().to_string();
    assert!(
        error.contains("pwm1/period: another fccd on this machine has it"),
        "{error}"
    );
    assert_eq!(
        folder.has(1, "enable"),
        "1",
        "the other one's start wrote nothing"
    );
    drop(first);
    SysfsPwm::open(&outputs, 50.0).unwrap();
}

#[test]
fn a_pwm_that_is_not_there_is_an_error_with_its_path() {
    let missing = PwmOutput {
        chip: "/sys/class/pwm/pwmchip99".into(),
        number: 0,
    };
    let error = SysfsPwm::open(&[missing], 50.0).unwrap_err().to_string();
    assert!(
        error.starts_with("cannot open /sys/class/pwm/pwmchip99/export: No such file"),
        "{error}"
    );
}

/// The registers of a PCA9685, which another test may look at; none if it is
/// unplugged.
#[derive(Clone, Default, Debug)]
struct Chip(Arc<Mutex<Option<Box<[u8; 256]>>>>);

impl Chip {
    /// As it is after it was switched on: table 4 of the data sheet.
    fn new() -> Self {
        let mut registers = [0; 256];
        (registers[0x00], registers[0x01], registers[0xfe]) = (0x11, 0x04, 0x1e);
        Self(Arc::new(Mutex::new(Some(Box::new(registers)))))
    }

    fn register(&self, at: usize) -> u8 {
        self.0
            .lock()
            .unwrap()
            .as_ref()
            .map_or(0, |registers| registers[at])
    }

    /// On and off, in counts.
    fn counts(&self, output: usize) -> [u16; 2] {
        let at = |at: usize| u16::from_le_bytes([self.register(at), self.register(at + 1)]);
        [at(6 + 4 * output), at(8 + 4 * output)]
    }
}

impl ErrorType for Chip {
    type Error = Refusal;
}

/// `EREMOTEIO`, as the operating system says it.
#[derive(Debug)]
struct Refusal;

impl embedded_hal::i2c::Error for Refusal {
    fn kind(&self) -> embedded_hal::i2c::ErrorKind {
        embedded_hal::i2c::ErrorKind::Other
    }
}

impl fcc_linux::chip::BusError for Refusal {
    fn into_io(self) -> std::io::Error {
        Errno::EREMOTEIO.into()
    }
}

impl I2c for Chip {
    fn transaction(
        &mut self,
        address: u8,
        operations: &mut [Operation<'_>],
    ) -> Result<(), Refusal> {
        let mut chip = self.0.lock().unwrap();
        let registers = chip.as_mut().filter(|_| address == 0x41).ok_or(Refusal)?;
        let mut at = 0;
        for operation in operations {
            match operation {
                Operation::Write([register, values @ ..]) => {
                    at = usize::from(*register);
                    for value in values {
                        // The rate is locked while it is awake (7.3.5).
                        if at != 0xfe || registers[0] & 0x10 != 0 {
                            registers[at] = *value;
                        }
                        at += 1;
                    }
                }
                Operation::Write([]) => {}
                Operation::Read(into) => {
                    into.fill_with(|| {
                        at += 1;
                        registers[at - 1]
                    });
                }
            }
        }
        Ok(())
    }
}

fn pca9685(rate_hz: f64) -> Pca9685Settings {
    Pca9685Settings {
        device: "/dev/i2c-1, address 0x41".into(),
        address: 0x41,
        rate_hz,
        oscillator_hz: 25e6,
        outputs: vec![0, 5],
    }
}

/// The data sheet's example in 7.3.5: 25 MHz and 200 Hz give 1Eh. 50 Hz give 79h,
/// 23.8 and 1,526 Hz the ends, `FFh` and 03h.
#[test]
fn the_prescale_value_is_that_of_the_data_sheet() {
    for (rate_hz, prescale) in [(200.0, 0x1e), (50.0, 0x79), (23.8, 0xff), (1_526.0, 0x03)] {
        let chip = Chip::new();
        Pca9685::open(chip.clone(), pca9685(rate_hz)).unwrap();
        assert_eq!(chip.register(0xfe), prescale, "{rate_hz} Hz");
        assert_eq!(chip.register(0x00), 0x20, "awake, AI");
        assert_eq!(chip.counts(5), [0, 0x1000], "off");
    }
}

/// At 50 Hz the divider is 122: a count is 122/25 MHz = 4.88 µs, so 1,500 µs are
/// 307.4 counts.
#[test]
fn pulses_are_written_to_the_registers_of_a_pca9685() {
    let chip = Chip::new();
    let mut servos = Pca9685::open(chip.clone(), pca9685(50.0)).unwrap();
    servos.write(&[Some(1_500.0), Some(2_000.0)]).unwrap();
    assert_eq!((chip.counts(0), chip.counts(5)), ([0, 307], [0, 410]));
    assert_eq!(chip.counts(1), [0, 0], "not used");
    servos.write(&[None, Some(2_000.0)]).unwrap();
    assert_eq!(chip.counts(0), [0, 0x1000], "off");
}

#[test]
fn a_pca9685_that_does_not_answer_is_an_error() {
    let chip = Chip::default();
    let error = Pca9685::open(chip, pca9685(50.0)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "/dev/i2c-1, address 0x41: writing: Remote I/O error (os error 121); nothing answers \
         there: check wiring, power and address"
    );
    let mut settings = pca9685(50.0);
    settings.outputs = vec![16];
    let error = Pca9685::open(Chip::new(), settings)
        .unwrap_err()
        .to_string();
    assert!(
        error.ends_with("it has no output 16: choose 0 to 15"),
        "{error}"
    );
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
        let bench = Self {
            actuator,
            status,
            folder,
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
