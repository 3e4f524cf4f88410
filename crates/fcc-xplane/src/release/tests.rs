//! When a release counts as over without a confirmation.

use super::*;

/// A firewall that rejects what it does not let through reports the same as a
/// machine on which no program has the port; and a simulator or a relay that lives
/// may close its port for a while.
#[test]
fn only_this_machine_knows_that_the_program_at_the_port_has_ended() {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    let closed = socket.local_addr().unwrap();
    let mut sockets = UdpSockets::sending_from(closed.ip());
    sockets.look();
    let alive = sockets.program_at(closed.port());
    assert!(alive.is_some());
    drop(socket);
    let mut child = std::process::Command::new("sleep")
        .arg("60")
        .spawn()
        .unwrap();
    let ended = Program::of(child.id());
    assert!(ended.is_some());
    child.kill().unwrap();
    child.wait().unwrap();
    let config = XPlaneConfig::default();
    for (is_here, program, expected) in [
        (true, ended, Released::Unreachable),
        (true, alive, Released::Refused),
        (true, None, Released::Refused),
        (false, ended, Released::Refused),
    ] {
        let expecting = Expected {
            program,
            ..Expected::default()
        };
        let mut conversation = Conversation::open(&config, closed, expecting, None).unwrap();
        if !is_here {
            conversation.sockets = None;
        }
        let mut controls = Controls::new(&config).unwrap();
        let within = Duration::from_secs(5);
        let released = retry_until_released(&mut conversation, &mut controls, within, || false);
        assert_eq!(released, expected, "{program:?}");
    }
}
