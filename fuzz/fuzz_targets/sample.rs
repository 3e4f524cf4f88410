//! A whole sensor and actuator: ticks with any datagrams, from the simulator or
//! another host, and beacons; only valid measurements result.
#![no_main]

use std::collections::VecDeque;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::sync::Mutex;
use std::time::Duration;

use arbitrary::Arbitrary;
use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, Sensor, Tick, Time};
use fcc_xplane::{
    DataRows, Errno, Input, Output, Port, RowsVersion, Simulator, XPlane, XPlaneConfig,
};

const SIMULATOR: SocketAddr = SocketAddr::new(IpAddr::V4(Ipv4Addr::new(10, 0, 0, 1)), 49_000);
const STRANGER: SocketAddr = SocketAddr::new(IpAddr::V4(Ipv4Addr::new(10, 0, 0, 2)), 49_000);

#[derive(Arbitrary, Debug)]
struct Flight {
    by_rows: Option<u8>,
    by_beacon: bool,
    write_rows: bool,
    ticks: Vec<Step>,
}

#[derive(Arbitrary, Debug)]
struct Step {
    /// Up to 16 s after the previous tick.
    later_ns: u32,
    datagrams: Vec<(bool, Message)>,
    beacons: Vec<Vec<u8>>,
    surfaces: Option<[f64; 4]>,
    release: bool,
}

#[derive(Arbitrary, Debug)]
enum Message {
    Bytes(Vec<u8>),
    Values(Vec<(i8, f32)>),
    Rows(Vec<(i8, [f32; 8])>),
    Place([f64; 3], [f32; 10]),
}

impl Message {
    fn datagram(&self) -> Vec<u8> {
        match self {
            Self::Bytes(bytes) => bytes.clone(),
            Self::Values(pairs) => {
                let pairs = pairs.iter().flat_map(|(index, value)| {
                    [i32::from(*index).to_le_bytes(), value.to_le_bytes()]
                });
                [b"RREF,".to_vec(), pairs.flatten().collect()].concat()
            }
            Self::Rows(rows) => {
                let rows = rows.iter().flat_map(|(index, columns)| {
                    let index = i32::from(*index).to_le_bytes();
                    std::iter::once(index).chain(columns.map(f32::to_le_bytes))
                });
                [b"DATA*".to_vec(), rows.flatten().collect()].concat()
            }
            Self::Place(place, rest) => {
                let place = place.iter().flat_map(|field| field.to_le_bytes());
                let rest = rest.iter().flat_map(|field| field.to_le_bytes());
                [b"RPOS4".to_vec(), place.chain(rest).collect()].concat()
            }
        }
    }
}

/// Shared with the sensor, which owns its port.
#[derive(Default)]
struct Script(Mutex<VecDeque<(Vec<u8>, SocketAddr)>>);

struct Scripted(std::sync::Arc<Script>);

impl Port for Scripted {
    fn receive(&self, into: &mut [u8]) -> Result<Option<(usize, SocketAddr)>, Errno> {
        let next = self.0.0.lock().expect("one thread").pop_front();
        Ok(next.map(|(datagram, from)| {
            let length = datagram.len().min(into.len());
            into[..length].copy_from_slice(&datagram[..length]);
            (length, from)
        }))
    }

    fn send(&self, datagram: &[u8], _: SocketAddr) -> Result<(), Errno> {
        assert!(matches!(datagram.len(), 7..=11 | 77 | 413 | 509));
        Ok(())
    }
}

libfuzzer_sys::fuzz_target!(|flight: Flight| {
    let version = match flight.by_rows {
        None => None,
        Some(0..=85) => Some(RowsVersion::XPlane9),
        Some(86..=170) => Some(RowsVersion::XPlane10),
        Some(_) => Some(RowsVersion::XPlane12),
    };
    let config = XPlaneConfig {
        simulator: match flight.by_beacon {
            true => Simulator::Beacon,
            false => Simulator::At(SIMULATOR),
        },
        local_port: 49_005,
        input: version.map_or(Input::Rref, |version| Input::Data(DataRows::of(version))),
        output: match flight.write_rows {
            true => Output::Data,
            false => Output::Dref,
        },
        ..XPlaneConfig::default()
    };
    let (wire, air) = <(std::sync::Arc<Script>, std::sync::Arc<Script>)>::default();
    let beacons = flight.by_beacon.then(|| Scripted(air.clone()));
    let (mut sensor, mut actuator) =
        XPlane::over(&config, Scripted(wire.clone()), beacons).expect("a valid configuration");

    let mut measurements = Measurements::default();
    let mut now = Time::from_nanos(0);
    for (number, step) in (0..).zip(&flight.ticks) {
        now = now + Duration::from_nanos(u64::from(step.later_ns) * 4);
        for (ours, message) in &step.datagrams {
            let from = if *ours { SIMULATOR } else { STRANGER };
            let mut queue = wire.0.lock().expect("one thread");
            queue.push_back((message.datagram(), from));
        }
        for beacon in &step.beacons {
            let mut queue = air.0.lock().expect("one thread");
            queue.push_back((beacon.clone(), SIMULATOR));
        }
        let tick = Tick {
            number,
            scheduled: now,
            woke: now,
            missed: 0,
            dt_s: 0.025,
        };
        let _ = sensor.sample(&tick, &mut measurements);
        assert_sane(&measurements);
        if let Some([throttle, elevator, aileron, rudder]) = step.surfaces {
            let surfaces = Surfaces {
                throttle,
                elevator,
                aileron,
                rudder,
                ..Surfaces::IDLE
            };
            let _ = actuator.apply(&tick, &surfaces);
        }
        if step.release {
            let _ = actuator.release();
        }
    }
});

fn assert_sane(m: &Measurements) {
    use std::f64::consts::{FRAC_PI_2, PI, TAU};
    assert!(m.attitude.value.pitch_rad.abs() <= FRAC_PI_2);
    assert!(m.attitude.value.roll_rad.abs() <= PI);
    assert!((0.0..TAU).contains(&m.heading_rad.value));
    assert!(m.position.value.latitude_rad.abs() <= FRAC_PI_2);
    assert!(m.position.value.longitude_rad.abs() <= PI);
    for value in [
        m.body_rates.value.roll_radps,
        m.body_rates.value.pitch_radps,
        m.body_rates.value.yaw_radps,
        m.specific_force.value.x_mps2,
        m.specific_force.value.y_mps2,
        m.specific_force.value.z_mps2,
        m.airspeed_mps.value,
        m.altitude_m.value,
        m.angle_of_attack_rad.value,
        m.position.value.altitude_m,
        m.velocity.value.north_mps,
        m.velocity.value.east_mps,
        m.velocity.value.down_mps,
        m.plant.value.time_s,
    ] {
        assert!(value.is_finite());
    }
}
