//! The requirements of a sensor, for a phone whose events are fed one by one.

use std::sync::Arc;
use std::sync::atomic::{AtomicI64, AtomicU32, Ordering};
use std::thread;
use std::time::Duration;

use fcc_conformance::{SensorBench, Ticks, VanishingSource, sensor_conformance};
use fcc_core::flight::Measurements;
use fcc_core::framework::{Sensor, Time};
use fcc_device::Clock;
use fcc_phone::{Clocks, Kind, Phone, PhoneHandle, PhoneSensor, PhoneSettings};
use serde_json::json;

use crate::fake::{ACCELEROMETER, GYROSCOPE, tell};

const MS: i64 = 1_000_000;
/// The last of its first events, which are not given.
const BEGAN_NS: i64 = 1_000_000 * MS;

struct Bench {
    package: String,
    sensor: PhoneSensor,
    ticks: Ticks,
    now: Arc<AtomicI64>,
    is_there: bool,
}

impl Bench {
    fn feed(&self, stamp_ns: i64) {
        self.now.store(stamp_ns.max(BEGAN_NS), Ordering::Relaxed);
        for of_type in [ACCELEROMETER, GYROSCOPE] {
            // Another one each time, that a sensor can measure.
            let values = [(stamp_ns % 10_000_000_000) as f64 * 1e-9, 0.0, 9.81];
            let event = json!({"stamp_ns": stamp_ns, "values": values});
            tell(&self.package, of_type, "event", &event);
        }
    }
}

/// What the threads have to do happens within a moment.
fn wait_until(is_so: impl Fn() -> bool) {
    while !is_so() {
        thread::sleep(Duration::from_millis(1));
    }
}

fn are_open(handle: &PhoneHandle) -> bool {
    handle.sensors().iter().all(|of| of.asked_hz.is_some())
}

impl SensorBench for Bench {
    type Measurements = Measurements;

    fn new() -> Self {
        static LAST: AtomicU32 = AtomicU32::new(0);
        let package = format!("conformance {}", LAST.fetch_add(1, Ordering::Relaxed));
        for of_type in [ACCELEROMETER, GYROSCOPE] {
            tell(&package, of_type, "sensor", &json!({"is_fed": true}));
        }
        let now = Arc::new(AtomicI64::new(BEGAN_NS));
        let shown = Arc::clone(&now);
        let clock = Clock::new(move || Time::from_nanos(shown.load(Ordering::Relaxed)));
        let clocks = Clocks {
            monotonic: clock.clone(),
            boottime: clock,
        };
        let phone = Phone::with_clocks(&package, clocks);
        let settings = PhoneSettings {
            kinds: vec![Kind::Accelerometer, Kind::Gyroscope],
            has_position: false,
            ..PhoneSettings::default()
        };
        let (sensor, _) = phone.open(&settings).unwrap();
        let bench = Self {
            package,
            sensor,
            ticks: Ticks::default(),
            now,
            is_there: true,
        };
        let handle = phone.handle();
        wait_until(|| are_open(&handle));
        // One more, and clock and rate are known.
        for number in -19..=0 {
            bench.feed(BEGAN_NS + number * 10 * MS);
        }
        bench
    }

    fn sensor(&mut self) -> &mut dyn Sensor<Measurements> {
        &mut self.sensor
    }

    fn provide(&mut self) {
        let mut ticks = self.ticks;
        let woke_ns = ticks.next_tick().woke.as_nanos();
        if self.is_there {
            let before = self.sensor.waiting();
            self.feed(woke_ns - MS);
            wait_until(|| self.sensor.waiting() >= before + 2);
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
    /// 500 ms.
    const PATIENCE: usize = 21;

    fn vanish(&mut self) {
        self.is_there = false;
    }

    fn come_back(&mut self) {
        self.is_there = true;
    }
}

sensor_conformance!(phone: Bench, vanishes);
