//! Finding X-Plane by its beacon, before a loop runs and while it does.

mod support;

use std::net::{SocketAddrV4, UdpSocket};
use std::time::Duration;

use fcc_core::framework::{Actuator, ActuatorFault};
use fcc_xplane::{DiscoverError, Simulator, Trouble, XPlane, XPlaneConfig, discover};
use support::bench::{Bench, SURFACES};
use support::free_port;

/// A beacon, typed from the layout.
fn beacon(port: u16, host: u8, role: u8) -> Vec<u8> {
    let mut datagram = b"BECN\0\x01\x02".to_vec();
    datagram.extend([host, 0, 0, 0]);
    datagram.extend([0x2d, 0xc3, 0x01, 0x00]); // 115501
    datagram.extend([role, 0, 0, 0]);
    datagram.extend(port.to_le_bytes());
    datagram.extend(b"cockpit\0");
    datagram
}

/// A loopback address in place of the multicast group.
fn beacon_address() -> SocketAddrV4 {
    SocketAddrV4::new([127, 0, 0, 1].into(), free_port())
}

#[test]
fn a_port_that_is_taken_is_refused_with_what_to_do() {
    let taken = UdpSocket::bind("0.0.0.0:0").unwrap();
    let config = XPlaneConfig {
        local_port: taken.local_addr().unwrap().port(),
        ..XPlaneConfig::default()
    };
    let message = XPlane::open(&config).map(|_| ()).unwrap_err().to_string();
    assert!(message.contains("choose another local_port"), "{message}");
}

#[test]
fn a_beacon_finds_the_simulator_while_running() {
    let group = beacon_address();
    let mut bench = Bench::with(|config| {
        config.simulator = Simulator::Beacon;
        config.beacon = group;
    });
    let tick = bench.ticks.next();
    let actuator = bench.actuator.as_mut().unwrap();
    assert_eq!(
        actuator.apply(&tick, &SURFACES),
        Err(ActuatorFault::NotConnected)
    );
    for _ in 0..40 {
        let _ = bench.sample();
    }
    assert_eq!(bench.status.trouble(), Some(Trouble::NoBeacon));

    let port = bench.simulator.address().port();
    let announce = |datagram: &[u8]| {
        bench.simulator.socket.send_to(datagram, group).unwrap();
    };
    announce(&beacon(1, 2, 1)); // Plane Maker
    announce(&beacon(2, 1, 2)); // an external visual
    announce(&beacon(port, 1, 1));
    let _ = bench.sample();
    assert_eq!(bench.status.simulator(), Some(bench.simulator.address()));
    bench.settle();
    assert!(!bench.measurements.attitude.is_never());

    // Another simulator's beacon changes nothing while this one sends.
    bench
        .simulator
        .socket
        .send_to(&beacon(4_242, 1, 1), group)
        .unwrap();
    bench.watch().unwrap();
    assert_eq!(bench.status.simulator(), Some(bench.simulator.address()));

    // Restarted: its beacon renews the subscriptions at once.
    bench.simulator.listen();
    bench.simulator.restart();
    for _ in 0..41 {
        let _ = bench.sample();
    }
    bench
        .simulator
        .socket
        .send_to(&beacon(port, 1, 1), group)
        .unwrap();
    let silent_since = bench.measurements.attitude.taken;
    for _ in 0..8 {
        let _ = bench.watch();
    }
    assert!(bench.measurements.attitude.taken > silent_since);
}

#[test]
fn discovery_waits_for_a_simulator_that_computes_a_flight() {
    let group = beacon_address();
    let announcer = std::thread::spawn(move || {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        for _ in 0..40 {
            for datagram in [beacon(1, 2, 1), beacon(49_000, 1, 1)] {
                // The port is not open yet, or no longer.
                let _ = socket.send_to(&datagram, group);
            }
            std::thread::sleep(Duration::from_millis(5));
        }
    });
    let found = discover(group, Duration::from_secs(10)).unwrap();
    assert_eq!(found.address.to_string(), "127.0.0.1:49000");
    assert_eq!(found.version, 115_501);
    assert_eq!(found.computer, "cockpit");
    announcer.join().unwrap();
}

#[test]
fn discovery_times_out_and_says_what_to_do() {
    let error = discover(beacon_address(), Duration::from_millis(20)).unwrap_err();
    assert!(matches!(error, DiscoverError::NotFound { .. }));
    assert!(error.to_string().contains("start X-Plane"));
}
