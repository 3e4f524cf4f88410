//! When a release counts as over without a confirmation.

use super::*;

/// A firewall that rejects what it does not let through reports the same as a
/// machine on which no program has the port; and a simulator or a relay that lives
/// may close its port for a while.
#[test]
fn a_port_that_no_program_has_is_no_confirmation() {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    let closed = socket.local_addr().unwrap();
    drop(socket);
    let config = XPlaneConfig::default();
    let expected = Expected::default();
    let mut conversation = Conversation::open(&config, closed, expected, None).unwrap();
    let mut controls = Controls::new(&config).unwrap();
    let within = Duration::from_secs(2);
    let released = retry_until_released(&mut conversation, &mut controls, within, || false);
    assert_eq!(released, Released::Refused);
}
