//! A barometer: another program reads the chip, and sends each pressure in
//! pascals, eight bytes, to a datagram socket.

use std::io::ErrorKind;
use std::os::unix::net::{SocketAddr, UnixDatagram};
use std::time::Duration;

use fcc_conformance::{SensorBench, Ticks, VanishingSource, sensor_conformance};
use fcc_core::flight::Measurements;
use fcc_core::flight::atmosphere::pressure_altitude_m;
use fcc_core::framework::{Reading, Sensor, SensorFault, Tick, Time};

use super::{address, errno};

/// The chip measures 25 times a second: several of its periods.
const SILENT_AFTER: Duration = Duration::from_millis(500);
/// The most datagrams read in one tick: a flood must not lengthen it.
const DATAGRAMS_PER_TICK: usize = 8;
/// What the chip can measure, by its data sheet.
const RANGE_PA: std::ops::RangeInclusive<f64> = 30_000.0..=110_000.0;

struct Barometer {
    socket: UnixDatagram,
    last: Time,
}

impl Barometer {
    fn bind(to: &SocketAddr) -> std::io::Result<Self> {
        let socket = UnixDatagram::bind_addr(to)?;
        socket.set_nonblocking(true)?;
        Ok(Self {
            socket,
            last: Time::NEVER,
        })
    }
}

impl Sensor<Measurements> for Barometer {
    fn sample(&mut self, tick: &Tick, into: &mut Measurements) -> Result<(), SensorFault> {
        let mut result = Ok(());
        for _ in 0..DATAGRAMS_PER_TICK {
            // One byte more than a message, to detect longer ones.
            let mut buffer = [0; 9];
            match self.socket.recv(&mut buffer) {
                Ok(length) => match pressure_pa(buffer.get(..length)) {
                    Some(pressure_pa) => {
                        self.last = tick.woke;
                        into.altitude_m = Reading::new(pressure_altitude_m(pressure_pa), tick.woke);
                    }
                    None => result = Err(SensorFault::Malformed),
                },
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) => {
                    let errno = errno(&error);
                    return Err(SensorFault::Io { errno });
                }
            }
        }
        if self.last.is_never() || tick.woke.since(self.last) > SILENT_AFTER {
            return Err(SensorFault::Silent);
        }
        result
    }

    fn name(&self) -> &'static str {
        "barometer"
    }
}

fn pressure_pa(datagram: Option<&[u8]>) -> Option<f64> {
    let bytes = <[u8; 8]>::try_from(datagram?).ok()?;
    Some(f64::from_le_bytes(bytes)).filter(|pressure_pa| RANGE_PA.contains(pressure_pa))
}

struct Bench {
    barometer: Barometer,
    chip: UnixDatagram,
    at: SocketAddr,
    is_there: bool,
}

impl SensorBench for Bench {
    type Measurements = Measurements;

    fn new() -> Self {
        let at = address();
        Self {
            barometer: Barometer::bind(&at).unwrap(),
            chip: UnixDatagram::unbound().unwrap(),
            at,
            is_there: true,
        }
    }

    fn sensor(&mut self) -> &mut dyn Sensor<Measurements> {
        &mut self.barometer
    }

    fn provide(&mut self) {
        if self.is_there {
            let message = 101_325.0_f64.to_le_bytes();
            self.chip.send_to_addr(&message, &self.at).unwrap();
        }
    }

    fn taken(measured: &Measurements) -> Vec<Time> {
        vec![measured.altitude_m.taken]
    }
}

impl VanishingSource for Bench {
    /// 500 ms at 40 Hz.
    const PATIENCE: usize = 20;

    fn vanish(&mut self) {
        self.is_there = false;
    }

    fn come_back(&mut self) {
        self.is_there = true;
    }
}

sensor_conformance!(barometer: Bench, vanishes);

/// ISO 2533, tables: 89 874.6 Pa at 1,000 m.
#[test]
fn a_pressure_becomes_the_altitude_of_the_standard_atmosphere() {
    let mut bench = Bench::new();
    let mut measured = Measurements::default();
    let message = 89_874.6_f64.to_le_bytes();
    bench.chip.send_to_addr(&message, &bench.at).unwrap();
    let tick = Ticks::default().next_tick();
    let sampled = bench.barometer.sample(&tick, &mut measured);
    assert_eq!(sampled, Ok(()));
    let altitude_m = measured.altitude_m.value;
    assert!((altitude_m - 1_000.0).abs() < 0.1, "{altitude_m} m");
}

#[test]
fn what_cannot_be_a_pressure_is_left_out() {
    let short = 7_u32.to_le_bytes().to_vec();
    let impossible = f64::NAN.to_le_bytes().to_vec();
    for message in [short, impossible, vec![0; 9]] {
        let mut bench = Bench::new();
        let mut measured = Measurements::default();
        bench.provide();
        let tick = Ticks::default().next_tick();
        let first = bench.barometer.sample(&tick, &mut measured);
        assert_eq!(first, Ok(()));
        let before = measured;
        bench.chip.send_to_addr(&message, &bench.at).unwrap();
        let second = bench.barometer.sample(&tick, &mut measured);
        assert_eq!(second, Err(SensorFault::Malformed));
        assert_eq!(measured, before);
    }
}
