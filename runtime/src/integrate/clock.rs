//! Time that does not drift.

/// Time as the start plus a compensated sum of steps, or as start + n h at a fixed step.
///
/// Ten million plain additions of 0.1 miss 10⁶ by 1.6·10⁻⁴ (catalogue R8).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clock {
    now: f64,
    carry: f64,
    /// Where counting of equal steps began, and how many there were since.
    origin: f64,
    count: u64,
}

impl Clock {
    /// A clock at t.
    pub fn new(t: f64) -> Self {
        Clock { now: t, carry: 0.0, origin: t, count: 0 }
    }

    /// The time.
    pub fn now(&self) -> f64 {
        self.now
    }

    /// Where an equal step of h would end: origin + (n + 1) h.
    pub fn after_equal_step(&self, h: f64) -> f64 {
        h.mul_add((self.count + 1) as f64, self.origin)
    }

    /// Takes one of several equal steps of h.
    pub fn equal_step(&mut self, h: f64) {
        self.now = self.after_equal_step(h);
        self.count += 1;
        self.carry = 0.0;
    }

    /// Where a step of h would end.
    pub fn after(&self, h: f64) -> f64 {
        self.now + (h + self.carry)
    }

    /// Takes a step of h.
    pub fn step(&mut self, h: f64) {
        let step = h + self.carry;
        let next = self.now + step;
        self.carry = step - (next - self.now);
        self.now = next;
        self.origin = next;
        self.count = 0;
    }

    /// Sets the time exactly, as at a stop time.
    pub fn set(&mut self, t: f64) {
        *self = Clock::new(t);
    }
}
