//! Says which host names are looked up, if that takes long: a name server that does not
//! answer is waited for before anything else is said.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// One that answers does so within a tenth of this.
pub(super) const LONG: Duration = Duration::from_secs(2);

/// Does `work`, which looks up these names; says so after `long`.
pub(super) fn looking_up<T>(
    names: &[String],
    long: Duration,
    say: impl FnOnce(String) + Send + 'static,
    work: impl FnOnce() -> T,
) -> T {
    if names.is_empty() {
        return work();
    }
    let words = format!(
        "still waits for the address of {}: the name server has not answered; give the IP address \
         instead (x-plane.simulator, servo-board.address), or look at the network and \
         /etc/resolv.conf",
        names.join(", ")
    );
    let (working, done) = channel::<()>();
    // Without a thread it is not said.
    let _ = thread::Builder::new().spawn(move || {
        if done.recv_timeout(long) == Err(RecvTimeoutError::Timeout) {
            say(words);
        }
    });
    let result = work();
    drop(working);
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_said_while_it_is_looked_up_for_long() {
        let names = ["sim.lan:49000".to_owned()];
        let (tell, told) = channel();
        let say = move |words| tell.send(words).unwrap();
        let words = looking_up(&names, Duration::from_millis(10), say, || {
            told.recv_timeout(Duration::from_secs(60)).unwrap()
        });
        assert!(words.contains("the address of sim.lan:49000"), "{words}");
        assert!(words.contains("give the IP address"), "{words}");
    }

    #[test]
    fn of_a_name_that_is_found_nothing_is_said() {
        let (tell, told) = channel::<String>();
        let say = move |words| tell.send(words).unwrap();
        let names = ["localhost:49000".to_owned()];
        assert_eq!(looking_up(&names, Duration::from_secs(60), say, || 7), 7);
        // The thread has ended, and with it its end of the channel.
        assert!(told.recv().is_err());
    }
}
