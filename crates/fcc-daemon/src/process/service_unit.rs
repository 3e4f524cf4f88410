//! The unit of the service as it is installed here: what it prevents of what a
//! configuration asks for.

use std::fs;
use std::path::Path;

use fcc_flight::config::RightsSection;

/// Where systemd looks for units, the first first; then for settings that are
/// added to them (systemd.unit(5)).
const FOLDERS: [&str; 4] = [
    "etc/systemd/system",
    "run/systemd/system",
    "usr/lib/systemd/system",
    "lib/systemd/system",
];
const UNIT: &str = "fccd.service";

/// A remark if users who may command by a configuration cannot, because the
/// service under `root` shows it all users but its own as one.
pub(crate) fn commanders_refused(rights: &RightsSection, root: &Path) -> Option<String> {
    (rights.has_commanders() && hides_users(root)).then(|| {
        "rights.commanders and commander_groups have no effect in the service: PrivateUsers=yes \
         of its unit shows all other users as one, and they are refused; permit them with \
         PrivateUsers=no ([Service], systemctl edit fccd)"
            .to_owned()
    })
}

/// Whether the service is installed, with `PrivateUsers=yes`.
fn hides_users(root: &Path) -> bool {
    let folders = FOLDERS.map(|folder| root.join(folder));
    let unit = folders
        .iter()
        .find_map(|folder| fs::read_to_string(folder.join(UNIT)).ok());
    let Some(unit) = unit else {
        return false;
    };
    // Of two with one name the first counts; all are read in the order of their names.
    let mut added: Vec<_> = Vec::new();
    for folder in &folders {
        let found = fs::read_dir(folder.join(format!("{UNIT}.d")));
        for entry in found.into_iter().flatten().flatten() {
            let name = entry.file_name();
            let is_new = added.iter().all(|(known, _)| *known != name);
            if is_new && entry.path().extension().is_some_and(|end| end == "conf") {
                added.push((name, entry.path()));
            }
        }
    }
    added.sort();
    let added = added
        .iter()
        .filter_map(|(_, path)| fs::read_to_string(path).ok());
    let texts: Vec<_> = std::iter::once(unit).chain(added).collect();
    let given = texts.iter().flat_map(|text| text.lines());
    let mut given = given.filter_map(|line| line.trim().split_once('='));
    let last = given.rfind(|(key, _)| key.trim() == "PrivateUsers");
    let values = ["yes", "true", "on", "1", "self", "identity"];
    last.is_some_and(|(_, value)| values.contains(&value.trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_unit_with_what_is_added_to_it_says_whether_commanders_are_refused() {
        let root = tempfile::tempdir().unwrap();
        let write = |path: &str, text: &str| {
            let path = root.path().join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        let named = RightsSection {
            commanders: vec!["ann".to_owned()],
            ..RightsSection::default()
        };
        let refused = || commanders_refused(&named, root.path());
        assert_eq!(refused(), None);
        let unit = "[Service]\nUser=fccd\nPrivateUsers=yes\nPrivateTmp=no\n";
        write("usr/lib/systemd/system/fccd.service", unit);
        assert!(refused().unwrap().contains("PrivateUsers=no"));
        assert_eq!(
            commanders_refused(&RightsSection::default(), root.path()),
            None
        );
        let own = "etc/systemd/system/fccd.service.d";
        write(
            &format!("{own}/override.conf"),
            "[Service]\nPrivateUsers = no\n",
        );
        assert_eq!(refused(), None);
        write(&format!("{own}/zz.conf"), "[Service]\nPrivateUsers=self\n");
        assert!(refused().is_some());
        // Of this name only the first is read.
        write("run/systemd/system/fccd.service.d/zz.conf", "");
        assert!(refused().is_some());
        write("etc/systemd/system/fccd.service", "[Service]\n");
        fs::remove_file(root.path().join(own).join("zz.conf")).unwrap();
        assert_eq!(refused(), None);
    }
}
