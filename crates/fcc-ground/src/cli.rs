//! The command line.

use std::net::{IpAddr, SocketAddr};
use std::path::PathBuf;

use clap::{Parser, ValueEnum};
use fcc_telemetry::Instance;

use crate::exit::EXIT_CODES;
use crate::mavlink::MavlinkLink;

/// What one `--mavlink` gives.
pub type MavlinkLinks = std::sync::Arc<[MavlinkLink]>;

fn mavlink_links(text: &str) -> Result<MavlinkLinks, String> {
    match text {
        "usual" => Ok(MavlinkLink::usual().into()),
        link => Ok([link.parse::<MavlinkLink>()?].into()),
    }
}

/// As what the vehicle presents itself to MAVLink stations.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub enum MavlinkIdentity {
    /// An autopilot that they do not know.
    Generic,
    /// PX4.
    Px4,
}

/// The ground station: serves a page with map, flight plan, flight and recordings.
#[derive(Parser, Clone, Debug)]
#[allow(
    clippy::struct_excessive_bools,
    reason = "each is a switch of the command line"
)]
#[command(name = "fcc-ground", version, after_help = EXIT_CODES)]
pub struct Cli {
    /// Address and port to listen on; another one than loopback is reachable by everybody
    /// on that network
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8460")]
    pub listen: SocketAddr,
    /// A further name of this machine by which browsers may address it; may be given several
    /// times
    #[arg(long = "host", value_name = "NAME")]
    pub hosts: Vec<String>,
    /// The configuration of a daemon, for its checks, limits and plan; may be given several
    /// times, one for each telemetry.instance
    #[arg(long = "config", value_name = "FILE")]
    pub configs: Vec<PathBuf>,
    /// The folder of recordings [default: that of the first configuration, or recordings]
    #[arg(long, value_name = "DIR")]
    pub recordings: Option<PathBuf>,
    /// The folder of drafts, uploaded plans and the token [default: the folder of the service,
    /// or ~/.local/state/fcc-ground]
    #[arg(long, value_name = "DIR")]
    pub state: Option<PathBuf>,
    /// The program `fccd`, for the doctor's findings
    #[arg(long, value_name = "FILE", default_value = "fccd")]
    pub fccd: PathBuf,
    /// The daemons of the configurations are started again when they are stopped: a plan that
    /// is uploaded in standby is written into their plan.file, and they are stopped
    #[arg(long)]
    pub restarts: bool,
    /// Send the newest records to Foxglove, too: the line with the link says where
    #[arg(long)]
    pub foxglove: bool,
    /// MAVLink
    #[command(flatten)]
    pub mavlink: MavlinkArgs,
    /// A map in one file, made by `pmtiles`
    #[arg(long, value_name = "FILE.pmtiles")]
    pub map: Option<PathBuf>,
    /// Whose map it is, shown on the map
    #[arg(
        long,
        value_name = "TEXT",
        default_value = "© OpenStreetMap contributors"
    )]
    pub map_attribution: String,
    /// Replace the token: links from before permit no changes any more
    #[arg(long)]
    pub new_token: bool,
    /// Print the status line as JSON
    #[arg(long)]
    pub json: bool,
}

/// MAVLink for other ground stations.
#[derive(clap::Args, Clone, Debug)]
pub struct MavlinkArgs {
    /// Speak MAVLink to other ground stations: on this link, or without one by UDP to ports
    /// 14550 and 14540 of this machine; may be given several times. A link is
    /// udp:ADDRESS:PORT, udpin:ADDRESS:PORT, tcpin:ADDRESS:PORT or serial:DEVICE:BAUD, and
    /// behind it ,rate=N (bytes per second) and ,high-latency
    #[arg(
        long = "mavlink",
        value_name = "LINK",
        num_args = 0..=1,
        default_missing_value = "usual",
        value_parser = mavlink_links
    )]
    pub links: Vec<MavlinkLinks>,
    /// The number of the vehicle as a MAVLink system
    #[arg(long = "mavlink-system", value_name = "N", requires = "links", default_value = "1", value_parser = clap::value_parser!(u8).range(1..))]
    pub system: u8,
    /// As what the vehicle presents itself: px4 for stations that offer modes only to
    /// autopilots that they know
    #[arg(
        long = "mavlink-identity",
        value_name = "KIND",
        default_value = "generic"
    )]
    pub identity: MavlinkIdentity,
    /// The key of signatures, 64 hexadecimal digits: nothing unsigned is read then
    #[arg(long = "mavlink-key", value_name = "FILE", requires = "links")]
    pub key: Option<PathBuf>,
    /// A machine whose frames links that listen read; may be given several times
    #[arg(long = "mavlink-allow", value_name = "ADDRESS", requires = "links")]
    pub allow: Vec<IpAddr>,
    /// The daemon that MAVLink stations see [default: that of the first configuration]
    #[arg(long = "mavlink-instance", value_name = "NAME", requires = "links")]
    pub instance: Option<Instance>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
        let cli = Cli::parse_from(["fcc-ground"]);
        assert!(cli.listen.ip().is_loopback());
        assert!(cli.mavlink.links.is_empty());
        // Without a link it would have no effect.
        assert!(Cli::try_parse_from(["fcc-ground", "--mavlink-key", "key"]).is_err());
        let cli = Cli::parse_from(["fcc-ground", "--mavlink", "--json"]);
        assert_eq!(cli.mavlink.links.concat(), MavlinkLink::usual());
    }
}
