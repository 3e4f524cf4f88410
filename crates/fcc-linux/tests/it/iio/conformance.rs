//! The requirements of a sensor, for a buffer that is pulled out and put back.

use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};
use std::thread;
use std::time::Duration;

use fcc_conformance::{SensorBench, Ticks, VanishingSource, sensor_conformance};
use fcc_core::flight::Measurements;
use fcc_core::framework::{Sensor, Time};
use fcc_linux::iio::{Iio, IioConfig};
use fcc_linux::{Clock, DeviceSensor, DeviceStatus, DeviceThread, RawValues};

use crate::iio::tree::Tree;

struct Bench {
    sensor: DeviceSensor<RawValues>,
    status: DeviceStatus,
    tree: Tree,
    is_there: bool,
    ticks: Ticks,
    now: Arc<AtomicI64>,
}

impl Bench {
    /// Two scans, the second half a millisecond before the tick that comes next.
    fn write_scans(&mut self, mut ticks: Ticks) {
        let woke_ns = ticks.next_tick().woke.as_nanos();
        self.now.store(woke_ns, Ordering::Relaxed);
        let two = [10_500_000, 500_000].map(|before_ns| Tree::scan(woke_ns - before_ns));
        self.tree.write(&two.concat());
    }
}

/// What the thread has to do happens within a moment.
fn wait_until(is_so: impl Fn() -> bool) {
    while !is_so() {
        thread::sleep(Duration::from_millis(1));
    }
}

impl SensorBench for Bench {
    type Measurements = Measurements;

    fn new() -> Self {
        let mut tree = Tree::new();
        tree.mpu6050();
        let now = Arc::new(AtomicI64::new(0));
        let shown = Arc::clone(&now);
        let config = IioConfig {
            clock: Clock::new(move || Time::from_nanos(shown.load(Ordering::Relaxed))),
            ..tree.config("mpu6050", true)
        };
        let pause = Duration::from_millis(1);
        let thread = DeviceThread::new("mpu6050").pauses(pause, pause);
        let status = thread.status();
        let sensor = thread.start(move || Iio::open(&config)).unwrap();
        Self {
            sensor,
            status,
            tree,
            is_there: true,
            ticks: Ticks::default(),
            now,
        }
    }

    fn sensor(&mut self) -> &mut dyn Sensor<Measurements> {
        &mut self.sensor
    }

    fn provide(&mut self) {
        if self.is_there {
            let before = self.sensor.waiting();
            self.write_scans(self.ticks);
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
        self.tree.pull_out();
        self.is_there = false;
        wait_until(|| self.status.trouble().is_some());
    }

    fn come_back(&mut self) {
        self.tree.put_back();
        self.is_there = true;
        self.write_scans(self.ticks);
        wait_until(|| self.status.trouble().is_none());
    }
}

sensor_conformance!(iio: Bench, vanishes);
