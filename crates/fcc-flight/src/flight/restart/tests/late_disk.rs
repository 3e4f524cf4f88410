//! A disk that does not answer when the flight begins.

use std::sync::mpsc::{Sender, channel};

use super::*;

/// A restart whose disk answers with what is in the folder once the sender is used.
fn begin(folder: &Folder) -> (Restart, Sender<()>) {
    let (answer, answered) = channel();
    let request = folder.request.clone();
    let (restart, said) = Restart::begin_by(folder.request.clone(), move || {
        let _ = answered.recv();
        found::look(&request)
    });
    assert_eq!(said, None);
    (restart.expect("the flight goes on"), answer)
}

/// Polls until something is said.
fn said(restart: &mut Restart) -> String {
    let (_machine, mut link) = Machine::new(
        Parts {
            timer: Box::new(ManualTimer::new(Duration::from_millis(25)).unwrap()),
            sensors: Vec::new(),
            controller: Autopilot::new(Config::default().autopilot_config()),
            actuators: Vec::new(),
        },
        &LoopConfig::default(),
    )
    .unwrap();
    let began = Instant::now();
    while began.elapsed() < Duration::from_secs(60) {
        if let Some(words) = restart.poll(&mut link.commands, || ()) {
            return words;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("nothing is said");
}

#[test]
fn it_is_said_and_the_flight_is_recovered_when_it_answers() {
    let folder = Folder::new(RestartMode::Warm);
    folder.leave(2, |_| {});
    let (mut restart, answer) = begin(&folder);
    let words = said(&mut restart);
    assert!(
        words.contains("its disk has not answered for 2 s"),
        "{words}"
    );
    answer.send(()).unwrap();
    let words = said(&mut restart);
    assert!(words.contains("recovering it"), "{words}");
    assert!(restart.recovery.is_some() && folder.is_kept());
}

#[test]
fn what_was_flown_meanwhile_is_kept_and_the_interrupted_flight_is_not_recovered() {
    let folder = Folder::new(RestartMode::Warm);
    folder.leave(2, |_| {});
    let before = fs::read(&folder.request.path).unwrap();
    let (mut restart, answer) = begin(&folder);
    let mut pattern = FLOWN;
    pattern.progress.mode = Mode::TimedPattern;
    restart.take(&engaged(&pattern));
    assert_eq!(fs::read(&folder.request.path).unwrap(), before);
    assert!(said(&mut restart).contains("has not answered"));
    answer.send(()).unwrap();
    assert!(said(&mut restart).contains("answers again"));
    assert!(restart.recovery.is_none() && !restart.takes_over_release());
    restart.take(&engaged(&pattern));
    restart.take(&event(EventKind::Panicked));
    restart.end();
    let kept = state_file::read(&folder.request.path).unwrap();
    assert_eq!(kept.map(|saved| saved.resume), Some(pattern));
}
