//! Programs that connect without end: who it is.

use std::time::{Duration, Instant};

const SECOND: Duration = Duration::from_secs(1);
/// In a second. Programs that command connect once for each command.
const MOST: u32 = 200;
/// For how long nothing more of it is said.
const QUIET: Duration = Duration::from_secs(60);

/// Counts connections.
#[derive(Debug)]
pub(super) struct Crowd {
    began: Instant,
    connections: u32,
    quiet_until: Option<Instant>,
}

impl Crowd {
    pub(super) fn new() -> Self {
        Self {
            began: Instant::now(),
            connections: 0,
            quiet_until: None,
        }
    }

    /// Takes a connection of this program; what is to be said about it.
    pub(super) fn take(&mut self, user: u32, process: i32, now: Instant) -> Option<String> {
        if now.saturating_duration_since(self.began) >= SECOND {
            (self.began, self.connections) = (now, 0);
        }
        self.connections += 1;
        if self.connections <= MOST || self.quiet_until.is_some_and(|until| now < until) {
            return None;
        }
        self.quiet_until = Some(now + QUIET);
        Some(format!(
            "more than {MOST} programs a second connect to the socket for commands of other users, \
             the last one process {process} of user {user}: commands of others are delayed; end \
             that program"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_connects_without_end_is_said_once_a_minute() {
        let mut crowd = Crowd::new();
        let began = crowd.began;
        // A thousand in each of 90 s.
        let said: Vec<(u64, String)> = (0..90_000)
            .filter_map(|ms| {
                let words = crowd.take(1_001, 4_242, began + Duration::from_millis(ms))?;
                Some((ms, words))
            })
            .collect();
        assert_eq!(
            said.iter().map(|(ms, _)| *ms).collect::<Vec<_>>(),
            [200, 60_200]
        );
        assert!(said[0].1.contains("process 4242 of user 1001"), "{said:?}");
        // A hundred a second are not too many.
        let few = |ms: u64| began + Duration::from_secs(200) + Duration::from_millis(ms);
        assert!((0..5_000).all(|n| crowd.take(0, 1, few(10 * n)).is_none()));
    }
}
