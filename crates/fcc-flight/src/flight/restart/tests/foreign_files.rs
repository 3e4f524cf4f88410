//! Files that another user has placed under the names of ours.

use super::*;

/// Opening a pipe would wait for its other end, and following a link would empty
/// its target.
#[test]
fn a_pipe_or_a_link_in_place_of_the_lock_is_reported() {
    let folder = Folder::new(RestartMode::Warm);
    let lock = folder.request.path.with_extension("flight.lock");
    let victim = folder.folder.path().join("victim");
    fs::write(&victim, "kept").unwrap();
    let refused = |word: &str| {
        let (restart, said) = Restart::begin(folder.request.clone());
        let said = said.unwrap();
        assert!(restart.is_none() && said.contains(word), "{said}");
    };
    let made = std::process::Command::new("mkfifo").arg(&lock).status();
    assert!(made.unwrap().success());
    refused("a pipe or a device");
    fs::remove_file(&lock).unwrap();
    std::os::unix::fs::symlink(&victim, &lock).unwrap();
    refused("symbolic link");
    assert_eq!(fs::read(&victim).unwrap(), b"kept");
}

/// Whoever may read the folder could lock the file, of earlier versions open to
/// others: the flight would not be recovered, and another fccd named as the cause.
#[test]
fn who_may_only_read_the_lock_does_not_keep_it() {
    let folder = Folder::new(RestartMode::Warm);
    let lock = folder.request.path.with_extension("flight.lock");
    fs::write(&lock, "").unwrap();
    let reader = File::open(&lock).unwrap();
    reader.lock().unwrap();
    let (restart, said) = Restart::begin(folder.request.clone());
    assert!(restart.is_some() && said.is_none(), "{said:?}");
    let (second, said) = Restart::begin(folder.request.clone());
    assert!(second.is_none());
    assert!(said.unwrap().contains("another fccd uses it"));
}

/// Root opens every file, so as root the other's is a pipe and a link, which are not
/// opened either.
#[test]
fn another_users_file_in_place_of_the_lock_is_not_heeded() {
    const OTHER: u32 = 65_534;
    let folder = Folder::new(RestartMode::Warm);
    let lock = folder.request.path.with_extension("flight.lock");
    let places: [&dyn Fn(); 3] = [
        &|| fs::create_dir(&lock).unwrap(),
        &|| std::os::unix::fs::symlink("/dev/null", &lock).unwrap(),
        &|| {
            let made = std::process::Command::new("mkfifo").arg(&lock).status();
            assert!(made.unwrap().success());
        },
    ];
    for place in places {
        place();
        if std::os::unix::fs::lchown(&lock, Some(OTHER), None).is_err() {
            eprintln!("not tested: only root gives files to others");
            return;
        }
        folder.leave(2, |_| {});
        let (recovered, said) = folder.found();
        let _ = fs::remove_file(&lock).or_else(|_| fs::remove_dir(&lock));
        assert!(recovered && said.contains("recovering it"), "{said}");
        assert!(
            said.contains("user 65534") && said.contains("it is ignored"),
            "{said}"
        );
    }
}
