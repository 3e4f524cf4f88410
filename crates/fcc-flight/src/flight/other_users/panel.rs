//! The other users who may command, from the configuration.

use std::collections::BTreeSet;
use std::fs;

use nix::unistd::{Group, User, geteuid};

use crate::config::RightsSection;

/// The number of every user whom a user namespace does not have
/// (`user_namespaces(7)`); the same as nobody's.
const UNMAPPED: u32 = 65_534;

/// Who may command: looked up once, so that no later question waits for a
/// directory of users.
#[derive(Debug, Default)]
pub(super) struct Panel {
    users: BTreeSet<u32>,
    groups: BTreeSet<u32>,
    /// This process is in a user namespace that has some of the users only.
    is_partial: bool,
}

impl Panel {
    /// The users and groups of a configuration. Those that do not exist are
    /// reported.
    pub(super) fn of(section: &RightsSection, report: &mut dyn FnMut(String)) -> Self {
        // Root can do everything anyway.
        let map = fs::read_to_string("/proc/self/uid_map").unwrap_or_default();
        let mut panel = Self {
            is_partial: is_partial(&map),
            ..Self::default()
        };
        if panel.is_partial && section.has_commanders() {
            report(
                "rights.commanders: this program is in a namespace of users, and those outside \
                 cannot be told apart and are refused: give the service PrivateUsers=no"
                    .to_owned(),
            );
        }
        panel.users.extend([0, geteuid().as_raw()]);
        for name in &section.commanders {
            match User::from_name(name) {
                Ok(Some(user)) => {
                    panel.users.insert(user.uid.as_raw());
                }
                _ => report(format!("rights.commanders: there is no user {name}")),
            }
        }
        for name in &section.commander_groups {
            let Ok(Some(group)) = Group::from_name(name) else {
                report(format!("rights.commander_groups: there is no group {name}"));
                continue;
            };
            panel.groups.insert(group.gid.as_raw());
            let members = group
                .mem
                .iter()
                .filter_map(|member| User::from_name(member).ok()?);
            panel.users.extend(members.map(|user| user.uid.as_raw()));
        }
        panel
    }

    /// Whether a user may command, with the group of the program.
    pub(super) fn permits(&self, user: u32, group: u32) -> bool {
        let is_unknown = self.is_partial && user == UNMAPPED;
        !is_unknown && (self.users.contains(&user) || self.groups.contains(&group))
    }
}

/// Whether a map of users (`/proc/self/uid_map`) leaves out some of them.
fn is_partial(map: &str) -> bool {
    !map.split_whitespace().eq(["0", "0", "4294967295"])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers of root and nobody are the same on every Linux, and nobody's
    /// group is nogroup (Debian) or nobody.
    #[test]
    fn users_and_groups_are_looked_up_and_unknown_ones_reported() {
        let section = RightsSection {
            commanders: vec!["nobody".to_owned(), "no-such-user".to_owned()],
            commander_groups: vec!["root".to_owned(), "no-such-group".to_owned()],
            ..RightsSection::default()
        };
        let mut reports = Vec::new();
        let mut panel = Panel::of(&section, &mut |report| reports.push(report));
        panel.is_partial = false;
        // In a container there may be one about its users.
        reports.retain(|report: &String| report.contains("there is no"));
        assert_eq!(
            reports,
            [
                "rights.commanders: there is no user no-such-user",
                "rights.commander_groups: there is no group no-such-group"
            ]
        );
        assert!(panel.permits(65_534, 65_534) && panel.permits(12_345, 0));
        assert!(!panel.permits(12_345, 12_345));
        let service = Panel {
            is_partial: is_partial("       998        998          1\n"),
            ..panel
        };
        assert!(!service.permits(65_534, 0) && service.permits(12_345, 0));
        assert!(!is_partial("         0          0 4294967295\n"));
        let empty = Panel::of(&RightsSection::default(), &mut |_| {});
        assert!(empty.permits(geteuid().as_raw(), 12_345) && !empty.permits(12_345, 0));
    }
}
