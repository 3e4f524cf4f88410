//! Measurements from what a minimal X-Plane on the loopback interface sends.

use std::net::{SocketAddrV4, UdpSocket};
use std::time::Duration;

use crate::support::bench::{Bench, close};
use crate::support::{FLIGHT_TIME, FakeXPlane, OVERRIDE_JOYSTICK, P, SWITCH, free_port};
use fcc_core::flight::PlantState;
use fcc_core::framework::{ControlAuthority, SensorFault, Switch};
use fcc_xplane::{
    DataRows, Input, Released, RowsVersion, Simulator, XPlane, XPlaneAuthority, XPlaneConfig,
};

const KNOT_MPS: f64 = 1.852 / 3.6;

#[test]
fn everything_subscribed_arrives_in_si_units() {
    let mut bench = Bench::new();
    bench.settle();
    assert_eq!(bench.simulator.position_hz.as_deref(), Some("20"));
    bench.simulator.position = [-122.309_308_12, 47.463_620_45, 1_234.5];
    bench.watch().unwrap();

    let (m, now) = (&bench.measurements, bench.ticks.now);
    close(m.attitude.value.pitch_rad.to_degrees(), 2.5);
    close(m.attitude.value.roll_rad.to_degrees(), -20.0);
    close(m.heading_rad.value.to_degrees(), 270.0);
    assert!((m.body_rates.value.roll_radps - 0.01).abs() < 1e-8);
    assert!((m.body_rates.value.pitch_radps + 0.02).abs() < 1e-8);
    assert!((m.body_rates.value.yaw_radps - 0.03).abs() < 1e-8);
    // 100 kt are 185.2 km/h; 3000 ft are 914.4 m.
    close(m.airspeed_mps.value, 185.2 / 3.6);
    close(m.altitude_m.value, 914.4);
    close(m.angle_of_attack_rad.value.to_degrees(), 3.0);
    // South and up there are north and down here.
    close(m.velocity.value.north_mps, -4.0);
    close(m.velocity.value.east_mps, -50.0);
    close(m.velocity.value.down_mps, -1.0);
    // Not accelerated: one g, whatever the attitude.
    let f = m.specific_force.value;
    close(f.x_mps2.hypot(f.y_mps2).hypot(f.z_mps2), 9.80665);
    // A millimetre of latitude is 1e-8 deg and must be preserved.
    assert!((m.position.value.latitude_rad.to_degrees() - 47.463_620_45).abs() < 1e-12);
    assert!((m.position.value.longitude_rad.to_degrees() + 122.309_308_12).abs() < 1e-12);
    close(m.position.value.altitude_m, 1_234.5);
    assert_eq!(m.engage_switch.value, Switch::Off);
    assert_eq!(m.plant.value.state, PlantState::Running);
    for taken in [
        m.attitude.taken,
        m.heading_rad.taken,
        m.body_rates.taken,
        m.specific_force.taken,
        m.airspeed_mps.taken,
        m.altitude_m.taken,
        m.angle_of_attack_rad.taken,
        m.position.taken,
        m.velocity.taken,
        m.engage_switch.taken,
        m.plant.taken,
    ] {
        assert_eq!(taken, now);
    }
    assert_eq!(bench.status.version(), Some(115_501));
    assert_eq!(bench.status.on_ground(), Some(false));
    assert_eq!(bench.status.trouble(), None);
}

#[test]
fn a_simulator_is_reached_by_ipv6_and_by_its_name() {
    let mut ipv6 = Bench::on(FakeXPlane::at("[::1]:0"), |_| {});
    let mut named = Bench::with(|config| {
        let Simulator::At(address) = config.simulator else {
            panic!("it has an address");
        };
        config.simulator = format!("localhost:{}", address.port()).parse().unwrap();
    });
    for bench in [&mut ipv6, &mut named] {
        bench.settle();
        bench.fly().unwrap();
        assert_eq!(bench.status.simulator(), Some(bench.simulator.address()));
        assert_eq!(bench.status.held_at(), Some(bench.simulator.address()));
        close(bench.measurements.altitude_m.value, 914.4);
        bench.simulator.listen();
        drop(bench.actuator.take());
        bench.assert_released();
    }
}

#[test]
fn controls_held_over_ipv6_are_released_from_outside() {
    let mut bench = Bench::on(FakeXPlane::at("[::1]:0"), |_| {});
    bench.settle();
    bench.fly().unwrap();
    let simulator = bench.simulator.address();
    let releases = std::thread::spawn(move || {
        XPlane::release_and_wait(&XPlaneConfig::default(), simulator, Duration::from_secs(10))
    });
    while !releases.is_finished() {
        bench.simulator.live(0.025);
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(releases.join().unwrap().unwrap(), Released::Confirmed);
}

#[test]
fn the_configured_switch_engages() {
    let mut bench = Bench::with(|config| config.engage_switch = "my/plugin/engage[2]".into());
    bench.simulator.set("my/plugin/engage[2]", 1.0);
    bench.settle();
    assert_eq!(bench.measurements.engage_switch.value, Switch::On);
    assert!(
        !bench
            .simulator
            .subscribed
            .values()
            .any(|path| path == SWITCH)
    );
}

/// 1,000 fill the socket's buffer several times.
#[test]
fn what_others_send_is_not_delivered() {
    let mut bench = Bench::new();
    bench.settle();
    bench.simulator.listen();
    let speed = format!("{P}indicated_airspeed");
    bench.simulator.set(&speed, 400.0);
    let client = bench.simulator.client.unwrap();
    assert!(client.ip().is_loopback());
    // The whole of 127.0.0.0/8 is this machine on Linux.
    let foreigner = UdpSocket::bind("127.0.0.2:0").unwrap();
    let flood = |sender: &UdpSocket, frame: &[u8]| {
        for _ in 0..1_000 {
            sender.send_to(frame, client).unwrap();
        }
    };
    flood(&foreigner, &bench.simulator.frame());
    bench.simulator.set(&speed, 50.0);
    bench.watch().unwrap();
    close(bench.measurements.airspeed_mps.value, 50.0 * KNOT_MPS);
    assert_eq!(bench.status.counts().foreign, 0);
    assert_eq!(bench.status.counts().discarded, 0);
    // Another port of the simulator's machine is left out by the kernel once the
    // thread that reports has found that the simulator's is known.
    let other = UdpSocket::bind("127.0.0.1:0").unwrap();
    let authority = XPlaneAuthority::of(bench.status.clone(), &bench.simulator.config());
    authority.report(&mut |_| {});
    flood(&other, &bench.simulator.frame());
    bench.simulator.set(&speed, 60.0);
    bench.watch().unwrap();
    close(bench.measurements.airspeed_mps.value, 60.0 * KNOT_MPS);
    assert_eq!(bench.status.counts().foreign, 0);
    assert_eq!(bench.status.counts().discarded, 0);
}

#[test]
fn a_tick_reads_as_many_datagrams_as_configured_and_leaves_none() {
    let mut bench = Bench::with(|config| config.datagrams_per_tick = 5);
    bench.settle();
    let before = bench.status.counts();
    for _ in 0..12 {
        bench.simulator.send_frame();
    }
    bench.sample().unwrap();
    let counts = bench.status.counts();
    assert_eq!(counts.received - before.received, 5);
    assert_eq!(counts.discarded - before.discarded, 7);
    // What arrives after that is read in the next tick, and nothing older.
    bench.simulator.set(&format!("{P}indicated_airspeed"), 50.0);
    bench.simulator.send_frame();
    bench.sample().unwrap();
    close(bench.measurements.airspeed_mps.value, 92.6 / 3.6);
}

#[test]
fn lost_duplicated_and_reordered_datagrams_change_nothing() {
    let mut bench = Bench::new();
    bench.settle();
    let mut held_back: Option<Vec<u8>> = None;
    for frame in 0..2_000_u32 {
        bench.simulator.listen();
        let time = bench.simulator.value(FLIGHT_TIME) + 0.025;
        bench.simulator.set(FLIGHT_TIME, time);
        let datagram = bench.simulator.frame();
        match frame % 50 {
            7 => {}
            21 => held_back = Some(datagram),
            33 => {
                bench.simulator.send(&datagram);
                bench.simulator.send(&datagram);
            }
            _ => {
                bench.simulator.send(&datagram);
                if let Some(old) = held_back.take() {
                    bench.simulator.send(&old);
                }
            }
        }
        let before = bench.measurements.plant.value.time_s;
        bench.sample().unwrap();
        let plant = bench.measurements.plant.value;
        assert!(plant.time_s >= before, "time went back in frame {frame}");
        assert_eq!(plant.state, PlantState::Running, "frame {frame}");
        assert!(
            bench.ticks.now.since(bench.measurements.attitude.taken) <= Duration::from_millis(25)
        );
    }
    assert_eq!(bench.status.counts().late, 40);
    assert_eq!(bench.status.counts().malformed, 0);
}

#[test]
fn a_cut_datagram_is_reported_and_left_out() {
    let mut bench = Bench::new();
    bench.settle();
    let before = bench.measurements;
    let frame = bench.simulator.frame();
    bench.simulator.send(&frame[..frame.len() - 3]);
    assert_eq!(bench.sample(), Err(SensorFault::Malformed));
    assert_eq!(bench.measurements, before);
    assert_eq!(bench.status.counts().malformed, 1);
}

#[test]
fn rows_of_data_output_give_all_measurements() {
    let free = free_port();
    let mut bench = Bench::with(|config| {
        config.local_port = free;
        config.input = Input::Data(DataRows::of(RowsVersion::XPlane12));
    });
    bench.settle();
    // Only what has no row is subscribed.
    let subscribed: Vec<_> = bench.simulator.subscribed.values().cloned().collect();
    assert!(subscribed.iter().any(|path| path == SWITCH));
    assert!(subscribed.iter().any(|path| path == OVERRIDE_JOYSTICK));
    let of_position = subscribed.iter().filter(|path| path.starts_with(P));
    let only = format!("{P}y_agl");
    assert_eq!(of_position.collect::<Vec<_>>(), [&only]);
    assert!(!subscribed.iter().any(|path| path == FLIGHT_TIME));

    let mut datagram = b"DATA*".to_vec();
    datagram.extend(17_i32.to_le_bytes());
    for column in [5.0_f32, 10.0, 95.0, 90.0, -999.0, -999.0, -999.0, -999.0] {
        datagram.extend(column.to_le_bytes());
    }
    let to = SocketAddrV4::new([127, 0, 0, 1].into(), free);
    bench.simulator.sender.send_to(&datagram, to).unwrap();
    bench.sample().unwrap();
    close(
        bench.measurements.attitude.value.roll_rad.to_degrees(),
        10.0,
    );
    close(bench.measurements.heading_rad.value.to_degrees(), 90.0);
}

#[test]
fn the_pilots_axes_are_read_only_if_configured() {
    let axis = |number| format!("sim/joystick/joy_mapped_axis_value[{number}]");
    for wanted in [true, false] {
        let mut bench = Bench::with(|config| config.pilot_controls = wanted);
        for (number, value) in [(1, 0.5), (2, -0.25), (3, 0.125)] {
            bench.simulator.set(&axis(number), value);
        }
        bench.settle();
        bench.watch().unwrap();
        let read = bench.measurements.pilot_controls;
        assert_eq!(!read.is_never(), wanted);
        if wanted {
            assert_eq!(
                [read.value.pitch, read.value.roll, read.value.yaw],
                [0.5, -0.25, 0.125]
            );
            assert_eq!(read.taken, bench.ticks.now);
        }
    }
}
