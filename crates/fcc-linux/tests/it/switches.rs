//! A switch on a GPIO line: the requirements of a sensor, with a stand-in for the
//! kernel's line, which is pulled out and put back, and whose contacts bounce.

use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use fcc_conformance::{SensorBench, Ticks, VanishingSource, sensor_conformance};
use fcc_core::flight::Measurements;
use fcc_core::framework::{Sensor, Switch, Tick, Time};
use fcc_linux::gpio::{Debounce, GpioSwitch, LevelLine};
use fcc_linux::{Clock, DeviceError, DeviceSensor, DeviceThread, Sample, Source};
use nix::errno::Errno;
use proptest::prelude::*;

/// What the line shows next; gone when the sender is dropped.
struct Line {
    shown: Receiver<bool>,
    read: Sender<()>,
}

impl LevelLine for Line {
    fn is_active(&mut self) -> Result<bool, DeviceError> {
        let _ = self.read.send(());
        self.shown.recv().map_err(|_| DeviceError::Io {
            device: "/dev/gpiochip0, line 17".into(),
            doing: "reading",
            source: Errno::ENODEV.into(),
        })
    }
}

/// The test's end of it.
struct Contact {
    shown: Sender<bool>,
    read: Receiver<()>,
}

impl Contact {
    /// Shows a level, and waits until it is handed over.
    fn show(&self, is_active: bool) {
        self.shown.send(is_active).unwrap();
        self.read.recv().unwrap();
    }
}

struct Bench {
    sensor: DeviceSensor<Switch>,
    contact: Option<Contact>,
    board: Arc<Mutex<Option<Line>>>,
    clock: Arc<AtomicI64>,
    now: Ticks,
}

impl Bench {
    fn plug_in(&mut self) {
        let ((shown, showing), (read, reading)) = (mpsc::channel(), mpsc::channel());
        *self.board.lock().unwrap() = Some(Line {
            shown: showing,
            read,
        });
        reading.recv().unwrap();
        self.contact = Some(Contact {
            shown,
            read: reading,
        });
    }

    /// Shows levels up to a moment before the next tick, 10 ms apart.
    fn show(&mut self, levels: &[bool]) -> Tick {
        let tick = self.now.next_tick();
        let Some(contact) = &self.contact else {
            return tick;
        };
        for (level, before) in levels.iter().zip((0..levels.len()).rev()) {
            let taken = tick.woke - Duration::from_millis(1 + 10 * before as u64);
            self.clock.store(taken.as_nanos(), Ordering::Relaxed);
            contact.show(*level);
        }
        tick
    }
}

impl SensorBench for Bench {
    type Measurements = Measurements;

    fn new() -> Self {
        let board: Arc<Mutex<Option<Line>>> = Arc::default();
        let (there, clock) = (Arc::clone(&board), Arc::new(AtomicI64::new(0)));
        let shown = Arc::clone(&clock);
        let open = move || {
            let line = there.lock().unwrap().take().ok_or(DeviceError::Open {
                device: "/dev/gpiochip0, line 17".into(),
                source: Errno::ENOENT.into(),
            })?;
            let shown = Arc::clone(&shown);
            let clock = Clock::new(move || Time::from_nanos(shown.load(Ordering::Relaxed)));
            Ok(GpioSwitch::new(line, Duration::from_millis(10), clock))
        };
        let pause = Duration::from_millis(1);
        let sensor = DeviceThread::new("switch")
            .pauses(pause, pause)
            .start(open)
            .unwrap();
        let mut bench = Self {
            sensor,
            contact: None,
            board,
            clock,
            now: Ticks::default(),
        };
        bench.plug_in();
        bench
    }

    fn sensor(&mut self) -> &mut dyn Sensor<Measurements> {
        &mut self.sensor
    }

    /// Two samples are a position.
    fn provide(&mut self) {
        self.show(&[true, true]);
    }

    fn taken(measured: &Measurements) -> Vec<Time> {
        vec![measured.engage_switch.taken]
    }
}

impl VanishingSource for Bench {
    fn vanish(&mut self) {
        if let Some(contact) = self.contact.take() {
            drop(contact.shown);
            // Until the thread has closed its end.
            while !matches!(
                contact.read.recv_timeout(Duration::from_secs(20)),
                Err(RecvTimeoutError::Disconnected)
            ) {}
        }
    }

    fn come_back(&mut self) {
        self.plug_in();
    }
}

sensor_conformance!(gpio_switch: Bench, vanishes);

#[test]
fn the_latest_position_is_the_switchs() {
    let mut bench = Bench::new();
    let mut measured = Measurements::default();
    for (levels, expected) in [
        (&[true, true][..], Switch::On),
        // It bounces, and is on yet.
        (&[false, true, false], Switch::On),
        (&[false, false], Switch::Off),
        (&[true], Switch::Off),
    ] {
        let tick = bench.show(levels);
        bench.sensor.sample(&tick, &mut measured).unwrap();
        assert_eq!(measured.engage_switch.value, expected, "{levels:?}");
    }
}

/// A line that the kernel has: the source says which, and goes on.
#[test]
fn a_line_that_is_gone_ends_the_source() {
    let (shown, showing) = mpsc::channel();
    let line = Line {
        shown: showing,
        read: mpsc::channel().0,
    };
    let mut switch = GpioSwitch::new(line, Duration::ZERO, Clock::default());
    shown.send(true).unwrap();
    let sample: Sample<Switch> = switch.read().unwrap().unwrap();
    assert_eq!(sample.value, Switch::On);
    drop(shown);
    let error = switch.read().unwrap_err().to_string();
    assert!(
        error.starts_with("/dev/gpiochip0, line 17: reading: "),
        "{error}"
    );
}

proptest! {
    /// Whatever a contact does: its position changes only to one that it had for
    /// the whole time, and always to one that it had for so long.
    #[test]
    fn a_position_is_one_that_lasted(levels: Vec<bool>, settles_in in 0_usize..6) {
        let mut debounce = Debounce::new(Duration::from_millis(settles_in as u64));
        let mut before = None;
        for (at, level) in levels.iter().enumerate() {
            let position = debounce.take(Time::from_nanos(at as i64 * 1_000_000), *level);
            let same = levels[..=at].iter().rev().take_while(|one| *one == level).count();
            let has_lasted = same > settles_in;
            let expected = if has_lasted { Some(*level) } else { before };
            prop_assert_eq!(position, expected);
            before = position;
        }
    }
}
