//! The least squares of the elevator's response: mean products, and what a
//! surface position explains of the pitch acceleration.

/// Mean products of a surface position with the motion.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    with_rate: f64,
    with_load: f64,
    with_acceleration: f64,
    square: f64,
}

/// Mean products of the motion with itself.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Motion {
    rate_rate: f64,
    rate_load: f64,
    load_load: f64,
    rate_acceleration: f64,
    load_acceleration: f64,
    acceleration_acceleration: f64,
}

/// What the motion itself explains of the pitch acceleration.
pub(super) struct Explained {
    determinant: f64,
    motion: Motion,
    per_rate: f64,
    per_load: f64,
    pub(super) left: f64,
}

impl Sums {
    /// Of the position.
    pub(super) const fn mean_square(&self) -> f64 {
        self.square
    }

    /// Averages the products with one sample, of which `new` is the share.
    pub(super) fn add(&mut self, position: f64, [rate, load, acceleration]: [f64; 3], new: f64) {
        let mean = |old: &mut f64, product: f64| *old += new * (product - *old);
        mean(&mut self.with_rate, position * rate);
        mean(&mut self.with_load, position * load);
        mean(&mut self.with_acceleration, position * acceleration);
        mean(&mut self.square, position * position);
    }
}

impl Motion {
    /// Averages the products with one sample, of which `new` is the share.
    pub(super) fn add(&mut self, [rate, load, acceleration]: [f64; 3], new: f64) {
        let mean = |old: &mut f64, product: f64| *old += new * (product - *old);
        mean(&mut self.rate_rate, rate * rate);
        mean(&mut self.rate_load, rate * load);
        mean(&mut self.load_load, load * load);
        mean(&mut self.rate_acceleration, rate * acceleration);
        mean(&mut self.load_acceleration, load * acceleration);
        mean(
            &mut self.acceleration_acceleration,
            acceleration * acceleration,
        );
    }

    /// Of the pitch acceleration, by rate and load alone.
    pub(super) fn explains(&self) -> Explained {
        let motion = Self {
            rate_rate: self.rate_rate + TINY,
            load_load: self.load_load + TINY,
            ..*self
        };
        let determinant = motion.rate_rate * motion.load_load - motion.rate_load * motion.rate_load;
        let (per_rate, per_load) =
            motion.solve(determinant, self.rate_acceleration, self.load_acceleration);
        let left = self.acceleration_acceleration
            - per_rate * self.rate_acceleration
            - per_load * self.load_acceleration;
        Explained {
            determinant,
            motion,
            per_rate,
            per_load,
            left,
        }
    }

    fn solve(&self, determinant: f64, with_rate: f64, with_load: f64) -> (f64, f64) {
        (
            (self.load_load * with_rate - self.rate_load * with_load) / determinant,
            (self.rate_rate * with_load - self.rate_load * with_rate) / determinant,
        )
    }
}

/// Keeps the normal equations regular without motion.
const TINY: f64 = 1e-9;

impl Explained {
    /// What is left unexplained with this surface position; all of it if the
    /// elevator would act the wrong way.
    pub(super) fn left_with(&self, sums: &Sums) -> f64 {
        let (rate, load) = self
            .motion
            .solve(self.determinant, sums.with_rate, sums.with_load);
        let own = sums.square + TINY - sums.with_rate * rate - sums.with_load * load;
        let effect = sums.with_acceleration
            - sums.with_rate * self.per_rate
            - sums.with_load * self.per_load;
        if effect > 0.0 && own > 0.0 {
            self.left - effect * effect / own
        } else {
            self.left
        }
    }
}
