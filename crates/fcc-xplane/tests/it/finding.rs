//! Finding X-Plane by its beacon, before a loop runs and while it does.

use std::net::{SocketAddrV4, UdpSocket};
use std::process::Command;
use std::time::Duration;

use crate::support::bench::{Bench, SURFACES};
use crate::support::{FakeXPlane, P, free_port};
use fcc_core::framework::{Actuator, ActuatorFault, ControlAuthority};
use fcc_xplane::{
    DiscoverError, Simulator, Trouble, XPlane, XPlaneAuthority, XPlaneConfig, discover,
};

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

const ALONE: [&str; 3] = ["--user", "--map-root-user", "--net"];

/// A phone's Wi-Fi, or a cable that is plugged in later. Where a user may not have a
/// network of his own (unshare(1)), this cannot be tested.
#[test]
fn a_network_that_comes_after_the_start_carries_beacons() {
    let unshare = || {
        let mut command = Command::new("unshare");
        command.args(ALONE);
        command
    };
    let permitted = unshare().arg("ip").arg("link").output();
    if !permitted.is_ok_and(|tried| tried.status.success()) {
        println!("not tested: no network of its own is permitted here, or there is no ip(8)");
        return;
    }
    let test = ["--exact", "finding::in_a_network_of_its_own", "--ignored"];
    let this = std::env::current_exe().unwrap();
    let status = unshare().arg(this).args(test).status().unwrap();
    assert!(status.success());
}

#[test]
#[ignore = "changes the network: run by the test above, in one of its own"]
fn in_a_network_of_its_own() {
    let ip = |words: &str| {
        let status = Command::new("ip").args(words.split(' ')).status().unwrap();
        assert!(status.success(), "{words}");
    };
    ip("link set lo up");
    let mut bench = Bench::with(|config| config.simulator = Simulator::Beacon);
    let config = XPlaneConfig {
        simulator: Simulator::Beacon,
        ..XPlaneConfig::default()
    };
    let authority = XPlaneAuthority::of(bench.status.clone(), &config);
    let _ = bench.sample();
    ip("link add v0 type veth peer name v1");
    ip("address add 192.168.7.2/24 dev v0");
    ip("link set v1 up");
    ip("link set v0 up");
    ip("route add 224.0.0.0/4 dev v0");
    let sender = UdpSocket::bind("192.168.7.2:0").unwrap();
    let heard = (0..20).any(|_| {
        authority.report(&mut |_| {});
        sender
            .send_to(&beacon(49_000, 1, 1), config.beacon)
            .unwrap();
        let _ = bench.sample();
        bench.status.simulator() == Some("192.168.7.2:49000".parse().unwrap())
    });
    assert!(heard);
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

/// It may hang, and return with its controls held.
#[test]
fn another_simulator_is_not_flown_before_the_first_is_released() {
    let group = beacon_address();
    let mut bench = Bench::with(|config| {
        config.simulator = Simulator::Beacon;
        config.beacon = group;
    });
    let mut other = FakeXPlane::new();
    let announcer = UdpSocket::bind("127.0.0.1:0").unwrap();
    let announce = |port| announcer.send_to(&beacon(port, 1, 1), group).unwrap();
    let (flown, waits) = (bench.simulator.address(), other.address());
    announce(flown.port());
    bench.settle();
    for _ in 0..40 {
        bench.fly().unwrap();
    }
    let answers = bench.status.reply_port();
    // It hangs; the loop releases, and that is not confirmed.
    let _ = bench.actuator.as_mut().unwrap().release();
    let authority = XPlaneAuthority::of(bench.status.clone(), &bench.simulator.config());
    let mut reports = Vec::new();
    for _ in 0..100 {
        announce(waits.port());
        let _ = bench.sample();
        authority.report(&mut |text| reports.push(text.to_string()));
        assert_eq!(bench.status.simulator(), Some(flown));
        assert!(authority.held().is_some());
    }
    let kept = format!("at {waits}: X-Plane at {flown} is kept until it confirms the release");
    let says = |text: &String| text.contains(&kept);
    assert_eq!(
        reports.iter().filter(|text| says(text)).count(),
        1,
        "{reports:?}"
    );
    // It returns, and confirms; for 5 s more a late write may undo that.
    for _ in 0..240 {
        bench.watch().unwrap();
        authority.report(&mut |text| reports.push(text.to_string()));
    }
    assert!(
        reports
            .iter()
            .any(|text| text.contains("confirmed the release")),
        "{reports:?}"
    );
    assert_eq!(authority.held(), None);
    // It hangs again: now the other one is flown, at the same address.
    for _ in 0..40 {
        let _ = bench.sample();
    }
    announce(waits.port());
    let _ = bench.sample();
    assert_eq!(bench.status.simulator(), Some(waits));
    // What the first one sends when it returns is not the other's.
    bench
        .simulator
        .set(&format!("{P}indicated_airspeed"), 400.0);
    other.set(&format!("{P}indicated_airspeed"), 60.0);
    for _ in 0..80 {
        bench.simulator.send_frame();
        let _ = bench.sample();
    }
    assert!(bench.measurements.airspeed_mps.value < 60.0);
    for _ in 0..80 {
        other.live(0.025);
        bench.simulator.send_frame();
        let _ = bench.sample();
        // The kernel's filter follows.
        authority.report(&mut |_| {});
    }
    assert!((bench.measurements.airspeed_mps.value - 60.0 * 1.852 / 3.6).abs() < 1e-6);
    assert_ne!(bench.status.reply_port(), answers);
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
