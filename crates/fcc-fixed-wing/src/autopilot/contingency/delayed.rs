//! A condition that begins and ends after it has lasted.

/// Whether a condition is on.
#[derive(Clone, Copy, Debug, Default)]
pub(in super::super) struct Delayed {
    pub(super) is_on: bool,
    /// For how long it has been otherwise, s.
    otherwise_s: f64,
}

impl Delayed {
    /// It is not on.
    pub(super) const OFF: Self = Self {
        is_on: false,
        otherwise_s: 0.0,
    };

    /// `dt_s` seconds pass in which it is on or not.
    pub(super) fn step(&mut self, is_on: bool, after_s: f64, dt_s: f64) {
        if is_on == self.is_on {
            self.otherwise_s = 0.0;
            return;
        }
        self.otherwise_s += dt_s;
        if self.otherwise_s >= after_s {
            self.is_on = is_on;
            self.otherwise_s = 0.0;
        }
    }

    /// It is on now.
    pub(super) const fn begin(&mut self) {
        self.is_on = true;
        self.otherwise_s = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A voltage that sags for 2 s under a climb is not low after 3 s; then it is, and no
    /// longer 3 s after it is good again.
    #[test]
    fn it_is_on_after_its_time() {
        let mut watch = Delayed::default();
        let mut on = std::vec::Vec::new();
        for second in 0..20 {
            let is_below = (2..4).contains(&second) || (6..12).contains(&second);
            watch.step(is_below, 3.0, 1.0);
            if watch.is_on {
                on.push(second);
            }
        }
        assert_eq!(on, (8..14).collect::<std::vec::Vec<_>>());
    }
}
