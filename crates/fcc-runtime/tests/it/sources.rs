//! A loop with several sensors: which of them each reading comes from, what the
//! record and the events say of it, and that choosing costs no allocation.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use fcc_conformance::allocator_calls;
use fcc_core::framework::{
    Controller, Flags, Reading, ReadingSet, Sensor, SensorFault, SourceChange, Tick, Time,
};
use fcc_runtime::{EventKind, Link, LoopConfig, Machine, Message, Parts};
use fcc_timer::ManualTimer;

fcc_core::schema! {
    /// What a boat's sensors measure.
    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    struct Measured {
        /// Of the water.
        #[field(1)]
        depth_m: Reading<f64>,
        /// Through the water.
        #[field(2)]
        speed_mps: Reading<f64>,
    }
}

fcc_core::readings!(Measured {
    depth_m: "depth",
    speed_mps: "speed"
});

/// Measures the depth and, if it is a log, the speed: its own number, so that
/// it can be told from others.
struct Scripted {
    number: f64,
    measures_speed: bool,
    sends: Arc<AtomicBool>,
}

impl Sensor<Measured> for Scripted {
    fn sample(&mut self, tick: &Tick, into: &mut Measured) -> Result<(), SensorFault> {
        if !self.sends.load(Ordering::Relaxed) {
            return Err(SensorFault::Silent);
        }
        into.depth_m = Reading::new(self.number, tick.woke);
        if self.measures_speed {
            into.speed_mps = Reading::new(self.number, tick.woke);
        }
        Ok(())
    }

    fn name(&self) -> &'static str {
        "scripted"
    }
}

struct Boat;

impl Controller for Boat {
    type Measurements = Measured;
    type Estimate = ();
    type Setpoints = f64;
    type Outputs = f64;
    type Command = u32;

    fn estimate(&mut self, _: &Tick, _: &Measured) {}

    fn engage_inhibits(&self, _: &Tick, _: &Measured) -> Flags {
        Flags::NONE
    }

    fn faults(&self, _: &Tick, _: &Measured) -> Flags {
        Flags::NONE
    }

    fn flag_name(_: u32) -> &'static str {
        "none"
    }

    fn engage(&mut self, _: &Tick, _: &Measured) {}

    fn control(&mut self, _: &Tick, measured: &Measured) -> f64 {
        measured.depth_m.value
    }

    fn failsafe(&mut self, _: &Tick, _: &Measured) -> f64 {
        0.0
    }

    fn setpoints(&self) -> f64 {
        0.0
    }

    fn outputs_are_valid(&self, outputs: &f64) -> bool {
        outputs.is_finite()
    }
}

struct Bench {
    machine: Machine<Boat>,
    link: Link<Boat>,
    sends: Vec<Arc<AtomicBool>>,
}

impl Bench {
    /// Sensors 0, 1, ..., of which each says whether it measures speed.
    fn new(measure_speed: &[bool]) -> Self {
        let sends: Vec<_> = measure_speed
            .iter()
            .map(|_| Arc::new(AtomicBool::new(true)))
            .collect();
        let sensors = (0_u8..).zip(measure_speed).zip(&sends);
        let sensors = sensors.map(|((number, measures_speed), sends)| {
            let sensor: Box<dyn Sensor<Measured>> = Box::new(Scripted {
                number: number.into(),
                measures_speed: *measures_speed,
                sends: Arc::clone(sends),
            });
            sensor
        });
        let parts = Parts {
            timer: Box::new(ManualTimer::new(Duration::from_millis(25)).unwrap()),
            sensors: sensors.collect(),
            controller: Boat,
            actuators: Vec::new(),
        };
        let (mut machine, link) = Machine::new(parts, &LoopConfig::default()).unwrap();
        machine.start().unwrap();
        Self {
            machine,
            link,
            sends,
        }
    }

    fn set_sending(&self, sensor: usize, sends: bool) {
        self.sends[sensor].store(sends, Ordering::Relaxed);
    }

    /// So many ticks; how old the depth was in each, in ticks, and from which
    /// sensor it came.
    fn depths(&mut self, ticks: usize) -> Vec<(u32, u8)> {
        (0..ticks)
            .map(|_| {
                self.machine.step();
                let record = self.machine.record();
                let depth = record.measurements.depth_m;
                assert_eq!(depth.value, f64::from(depth.source), "the value is its own");
                let age = record.tick.woke.since(depth.taken).as_millis() as u32;
                (age / 25, depth.source)
            })
            .collect()
    }

    fn events(&mut self) -> Vec<EventKind<u32>> {
        std::iter::from_fn(|| self.link.messages.receive())
            .filter_map(|message| match message {
                Message::Event(event) => Some(event.kind),
                Message::Tick(_) => None,
            })
            .collect()
    }
}

fn changed(readings: u64, from: u8, to: u8) -> EventKind<u32> {
    EventKind::SourceChanged(SourceChange {
        readings: ReadingSet::from_bits(readings),
        from,
        to,
    })
}

fn fault(index: u16) -> EventKind<u32> {
    EventKind::SensorFault {
        index,
        fault: SensorFault::Silent,
    }
}

const DEPTH: u64 = 0b01;
const SPEED: u64 = 0b10;

/// 100 ms by default: four ticks of 25 ms are borne, in the fifth the next
/// sensor is taken.
#[test]
fn a_sensor_that_falls_silent_is_replaced_and_taken_back() {
    let mut bench = Bench::new(&[true, true]);
    assert_eq!(bench.depths(3), [(0, 0); 3]);
    bench.set_sending(0, false);
    let fallen = [(1, 0), (2, 0), (3, 0), (4, 0), (0, 1), (0, 1)];
    assert_eq!(bench.depths(6), fallen);
    bench.set_sending(0, true);
    assert_eq!(bench.depths(1), [(0, 0)]);
    assert_eq!(
        bench.events(),
        [
            fault(0),
            changed(DEPTH | SPEED, 0, 1),
            EventKind::SensorRecovered { index: 0 },
            changed(DEPTH | SPEED, 1, 0),
        ]
    );
}

#[test]
fn each_reading_goes_to_the_next_sensor_that_has_it() {
    let mut bench = Bench::new(&[true, false, true]);
    bench.depths(1);
    bench.set_sending(0, false);
    assert_eq!(bench.depths(5).last(), Some(&(0, 1)));
    assert_eq!(bench.machine.record().measurements.speed_mps.source, 2);
    let events = bench.events();
    assert_eq!(
        events,
        [fault(0), changed(DEPTH, 0, 1), changed(SPEED, 0, 2)]
    );
    assert_eq!(
        events[1].description::<Boat>().to_string(),
        "depth: from sensor 1 instead of 0"
    );
}

#[test]
fn where_all_are_silent_the_last_reading_grows_old() {
    let mut bench = Bench::new(&[true, true]);
    bench.depths(1);
    bench.set_sending(1, false);
    bench.depths(1);
    bench.set_sending(0, false);
    assert_eq!(bench.depths(8).last(), Some(&(8, 0)));
    assert_eq!(bench.events(), [fault(1), fault(0)]);
}

#[test]
fn one_sensor_measures_what_it_would_without_any_choice() {
    let mut bench = Bench::new(&[true]);
    bench.depths(2);
    bench.set_sending(0, false);
    assert_eq!(bench.depths(8).last(), Some(&(8, 0)));
    assert_eq!(bench.events(), [fault(0)]);
    let measured = bench.machine.record().measurements;
    assert_eq!(measured.speed_mps.taken, measured.depth_m.taken);
    assert_ne!(measured.depth_m.taken, Time::NEVER);
}

#[test]
fn choosing_among_sixteen_sensors_that_come_and_go_allocates_nothing() {
    let mut bench = Bench::new(&[true; 16]);
    let mut changes = 0;
    for tick in 0..2_000 {
        bench.set_sending(tick / 7 % 16, tick / 112 % 2 == 1);
        let ((), calls) = allocator_calls(|| {
            bench.machine.step();
        });
        assert_eq!(calls, 0, "tick {tick}");
        let is_change = |event: &&EventKind<u32>| matches!(event, EventKind::SourceChanged(_));
        changes += bench.events().iter().filter(is_change).count();
    }
    assert!(changes > 20, "{changes}");
}
