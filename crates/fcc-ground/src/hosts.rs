//! By which names the station may be addressed.

use std::net::SocketAddr;

/// The names by which browsers may address the station.
#[derive(Clone, Debug)]
pub(crate) struct Hosts(Vec<String>);

impl Hosts {
    /// Further names, besides the address at which a request arrives, with this port.
    pub(crate) fn new(names: &[String], port: u16) -> Self {
        let names = names.iter().map(|name| name.to_ascii_lowercase());
        let with_port = |name: String| match port {
            80 => name,
            port => format!("{name}:{port}"),
        };
        Self(names.map(with_port).collect())
    }

    /// Whether a request that arrived `at` an address may name this host.
    pub(crate) fn permit(&self, host: &str, at: SocketAddr) -> bool {
        // A name that was rebound is no address.
        let own =
            |host: &str| host == at.to_string() || (at.port() == 80 && host == at.ip().to_string());
        let localhost = || match at.port() {
            80 => host == "localhost",
            port => host.strip_prefix("localhost:") == Some(&port.to_string()),
        };
        own(host)
            || (at.ip().is_loopback() && localhost())
            || self.0.iter().any(|known| known == host)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_has_to_be_exactly_one_of_the_stations() {
        let names = ["Board.local".to_owned()];
        let permits = |host: &str, at: &str| {
            let at: SocketAddr = at.parse().unwrap();
            Hosts::new(&names, at.port()).permit(host, at)
        };
        for (host, at) in [
            ("127.0.0.1:8460", "127.0.0.1:8460"),
            ("localhost:8460", "127.0.0.1:8460"),
            ("[::1]:8460", "[::1]:8460"),
            ("192.168.1.5:8460", "192.168.1.5:8460"),
            ("board.local:8460", "192.168.1.5:8460"),
            ("board.local", "192.168.1.5:80"),
            ("192.168.1.5", "192.168.1.5:80"),
        ] {
            assert!(permits(host, at), "{host} at {at}");
        }
        for (host, at) in [
            ("", "127.0.0.1:8460"),
            ("127.0.0.1", "127.0.0.1:8460"),
            ("127.0.0.1:8461", "127.0.0.1:8460"),
            ("127.0.0.1:8460.evil.example", "127.0.0.1:8460"),
            ("evil.example:8460", "127.0.0.1:8460"),
            ("localhost.evil.example:8460", "127.0.0.1:8460"),
            ("localhost:8460", "192.168.1.5:8460"),
            ("board.local:8461", "192.168.1.5:8460"),
            ("xboard.local:8460", "192.168.1.5:8460"),
        ] {
            assert!(!permits(host, at), "{host} at {at}");
        }
    }
}
