//! The requirements of a sensor, for a chip that is pulled out and put back.

use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};
use std::thread;
use std::time::Duration;

use fcc_conformance::{SensorBench, Ticks, VanishingSource, sensor_conformance};
use fcc_core::flight::Measurements;
use fcc_core::framework::{Sensor, Time};
use fcc_linux::chip::ChipSource;
use fcc_linux::chip::icm42688::Icm42688;
use fcc_linux::{Clock, DeviceSensor, DeviceStatus, DeviceThread, RawValues};

use crate::chips::board::{Board, NoDelay};
use crate::chips::inertial::{fill, packet};

struct Bench {
    sensor: DeviceSensor<RawValues>,
    status: DeviceStatus,
    board: Board,
    ticks: Ticks,
    now: Arc<AtomicI64>,
}

fn wait_until(is_so: impl Fn() -> bool) {
    while !is_so() {
        thread::sleep(Duration::from_millis(1));
    }
}

impl Bench {
    fn fill(&self, mut ticks: Ticks) {
        let now = ticks.next_tick().woke - Duration::from_millis(1);
        self.now.store(now.as_nanos(), Ordering::Relaxed);
        fill(&self.board, &[packet([0, 0, 2_048], [0; 3])]);
    }
}

impl SensorBench for Bench {
    type Measurements = Measurements;

    fn new() -> Self {
        let board = Board::with(&[(0x75, 0x47)]);
        // What is in the FIFO is there once.
        board.state().cleared_by_reading = Some(0x2F);
        let now = Arc::new(AtomicI64::new(0));
        let shown = Arc::clone(&now);
        let clock = Clock::new(move || Time::from_nanos(shown.load(Ordering::Relaxed)));
        let pause = Duration::from_millis(1);
        let thread = DeviceThread::new("ICM-42688").pauses(pause, pause);
        let status = thread.status();
        let on_board = board.clone();
        let open = move || {
            let chip = Icm42688::new(on_board.spi(0), &mut NoDelay)?;
            Ok(ChipSource::new(chip, 1_000.0, clock.clone()))
        };
        let sensor = thread.start(open).unwrap();
        // Until it is set up.
        wait_until(|| board.state().registers.contains_key(&0x4B));
        Self {
            sensor,
            status,
            board,
            ticks: Ticks::default(),
            now,
        }
    }

    fn sensor(&mut self) -> &mut dyn Sensor<Measurements> {
        &mut self.sensor
    }

    fn provide(&mut self) {
        if !self.board.state().is_gone {
            let before = self.sensor.waiting();
            self.fill(self.ticks);
            wait_until(|| self.sensor.waiting() > before);
        }
        self.ticks.next_tick();
    }

    fn taken(measured: &Measurements) -> Vec<Time> {
        vec![
            measured.raw_specific_force.taken,
            measured.raw_body_rates.taken,
        ]
    }
}

impl VanishingSource for Bench {
    fn vanish(&mut self) {
        self.board.state().is_gone = true;
        wait_until(|| self.status.trouble().is_some());
    }

    fn come_back(&mut self) {
        // Without its settings.
        let mut state = self.board.state();
        state.registers.clear();
        state.registers.insert(0x75, 0x47);
        state.is_gone = false;
        drop(state);
        wait_until(|| self.board.state().registers.contains_key(&0x4B));
        self.fill(self.ticks);
        wait_until(|| self.status.trouble().is_none());
    }
}

sensor_conformance!(icm42688: Bench, vanishes);
