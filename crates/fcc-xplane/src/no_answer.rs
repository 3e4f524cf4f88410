//! Why X-Plane does not answer, and what to do, in words.

use core::fmt;
use std::io;
use std::net::SocketAddr;

/// Why nothing arrives, as far as it is known.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Why {
    /// Nothing of that machine arrives at all.
    NothingArrives,
    /// It answered before.
    Stopped,
    /// Other datagrams of that machine arrive.
    DoesNotHear,
    /// Its beacon arrives: it listens on this port.
    Announced(u16),
    /// No program listens on the port.
    PortClosed,
    /// Nothing can be sent there, or another machine reports that nothing arrives: the
    /// operating system's number, as of no route.
    Unreachable(i32),
}

/// A silence as text: what is known, and what to do.
pub(crate) struct InWords {
    pub(crate) simulator: SocketAddr,
    /// The port that is received on here, if it is known.
    pub(crate) local_port: Option<u16>,
    pub(crate) why: Why,
}

/// X-Plane 12's setting, which is off at first.
const INCOMING: &str = "in X-Plane 12 switch on Settings > Network > Accept incoming connections";

impl fmt::Display for InWords {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let at = self.simulator;
        let (ip, port) = (at.ip(), at.port());
        match self.why {
            Why::NothingArrives => {
                write!(
                    f,
                    "X-Plane at {at} does not answer, and nothing else of that machine arrives \
                     here. Check that it runs there and has a flight loaded; {INCOMING}; let UDP \
                     port {port} through the firewall of its machine"
                )?;
                self.own_firewall(f)
            }
            Why::Stopped => write!(
                f,
                "X-Plane at {at} does not answer any more: it loads, hangs or has ended, or the \
                 network is interrupted. Nothing needs to be done here: it is asked each second."
            ),
            Why::DoesNotHear => write!(
                f,
                "X-Plane at {at} does not answer, although other datagrams of that machine arrive: \
                 X-Plane does not hear this program. There, {INCOMING}, and let UDP port {port} \
                 through the firewall of its machine."
            ),
            Why::Announced(listens) if listens != port => write!(
                f,
                "X-Plane at {at} does not answer: it announces that it listens on UDP port \
                 {listens}. Set x-plane.simulator to \"{}\"; {INCOMING}.",
                SocketAddr::new(ip, listens)
            ),
            Why::Announced(_) => {
                write!(
                    f,
                    "X-Plane at {at} does not answer, although it runs: it announces itself. Most \
                     likely X-Plane does not hear this program: {INCOMING}, and let UDP port {port} \
                     through the firewall of its machine"
                )?;
                self.own_firewall(f)
            }
            Why::PortClosed => write!(
                f,
                "X-Plane at {at} does not answer: no program listens on UDP port {port} of that \
                 machine. Start X-Plane; if it runs, look up the port on which it receives in \
                 Settings > Network, and set x-plane.simulator to it."
            ),
            Why::Unreachable(errno) => write!(
                f,
                "X-Plane at {at} cannot be reached: {}. That is the network's, not X-Plane's: \
                 check the cable or the Wi-Fi (`ip addr`, `ip route get {ip}`), a firewall of this \
                 machine, and the address in x-plane.simulator.",
                io::Error::from_raw_os_error(errno)
            ),
        }
    }
}

impl InWords {
    /// Where a firewall may be in between: the line that lets the answers in.
    fn own_firewall(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ip = self.simulator.ip();
        match self.local_port {
            Some(port) if !ip.is_loopback() => write!(
                f,
                ". If all of that is so, a firewall of this machine drops the answers: sudo ufw \
                 allow proto udp from {ip} to any port {port} (others: docs/troubleshooting.md, \
                 Ports and firewalls)."
            ),
            _ => f.write_str("."),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(at: &str, why: Why) -> String {
        let simulator = at.parse().unwrap();
        let local_port = Some(49_071);
        InWords {
            simulator,
            local_port,
            why,
        }
        .to_string()
    }

    #[test]
    fn a_firewall_of_this_machine_is_named_with_the_line_that_opens_it() {
        let there = text("192.168.1.20:49000", Why::NothingArrives);
        let line = "sudo ufw allow proto udp from 192.168.1.20 to any port 49071";
        assert!(there.contains(line), "{there}");
        assert!(there.contains("Accept incoming connections"));
        let here = text("127.0.0.1:49000", Why::NothingArrives);
        assert!(!here.contains("ufw"), "{here}");
        // Its datagrams arrive, so no firewall of this machine is suspected.
        let unheard = text("192.168.1.20:49000", Why::DoesNotHear);
        assert!(!unheard.contains("ufw"), "{unheard}");
        // Numbers and texts of Linux (errno(3)).
        for (errno, says) in [(101, "Network is unreachable"), (113, "No route to host")] {
            let cut = text("192.168.1.20:49000", Why::Unreachable(errno));
            assert!(cut.contains(&format!("cannot be reached: {says}")), "{cut}");
            assert!(!cut.contains("does not answer"), "{cut}");
        }
        let moved = text("192.168.1.20:49000", Why::Announced(49_010));
        assert!(moved.contains("\"192.168.1.20:49010\""), "{moved}");
    }
}
