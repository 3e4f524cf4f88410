//! The terminal: keys, redrawing, and leaving it as it was.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use fcc_telemetry::Instance;
use fcc_telemetry::live::Watcher;
use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{self, Event as Input, KeyCode, KeyEventKind, KeyModifiers};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

use super::picture::Picture;
use super::screen;

/// Time between pictures: often enough for an attitude, seldom enough for a
/// small board and a slow line.
const REDRAW_EVERY: Duration = Duration::from_millis(67);
/// How long nothing may come before it is asked whether the daemon is gone.
const SILENCE: Duration = Duration::from_secs(1);

/// Shows a flight until somebody presses `q`.
pub(super) fn watch(instance: &Instance, watcher: Watcher) -> io::Result<()> {
    let told_to_end = Arc::new(AtomicBool::new(false));
    for signal in [SIGTERM, SIGINT, SIGHUP] {
        signal_hook::flag::register(signal, Arc::clone(&told_to_end))?;
    }
    // From here on a panic restores the terminal before it is printed.
    let mut terminal = ratatui::try_init().inspect_err(|_| ratatui::restore())?;
    let shown = show(&mut terminal, instance, watcher, &told_to_end);
    ratatui::try_restore()?;
    shown
}

fn show(
    terminal: &mut DefaultTerminal,
    instance: &Instance,
    watcher: Watcher,
    told_to_end: &AtomicBool,
) -> io::Result<()> {
    let mut picture = Picture::new(&watcher);
    let mut watcher = Some(watcher);
    let mut heard = Instant::now();
    while !told_to_end.load(Ordering::Relaxed) {
        let next = Instant::now() + REDRAW_EVERY;
        match watcher.as_mut().map(|watcher| picture.update(watcher)) {
            Some(Ok(true)) => heard = Instant::now(),
            Some(Ok(false)) if heard.elapsed() < SILENCE => {}
            Some(Ok(false)) if watcher.as_ref().is_some_and(Watcher::is_alive) => {
                heard = Instant::now();
            }
            Some(Ok(false) | Err(_)) => {
                picture.ended = true;
                watcher = None;
                heard = Instant::now();
            }
            // Perhaps it is started again.
            None if heard.elapsed() >= SILENCE => {
                heard = Instant::now();
                if let Ok(found) = Watcher::open(instance) {
                    picture = Picture::new(&found);
                    watcher = Some(found);
                }
            }
            None => {}
        }
        terminal.draw(|frame| screen::draw(frame, instance, &picture))?;
        while event::poll(next.saturating_duration_since(Instant::now()))? {
            match event::read()? {
                Input::Key(key) if key.kind == KeyEventKind::Press => match key.code {
                    KeyCode::Char('q') | KeyCode::Esc => return Ok(()),
                    KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => {
                        return Ok(());
                    }
                    _ => {}
                },
                // The new size shows at once.
                Input::Resize(..) => break,
                _ => {}
            }
        }
    }
    Ok(())
}
