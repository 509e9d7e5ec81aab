//! A value that moves to its target in equal steps.

/// A ramp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ramp {
    value: f64,
    target: f64,
    /// Cycles left.
    left: u32,
}

impl Ramp {
    /// At its target already.
    pub(crate) const fn at(value: f64) -> Self {
        Self { value, target: value, left: 0 }
    }

    /// From `value` to `target` in so many cycles.
    pub(crate) const fn new(value: f64, target: f64, cycles: u32) -> Self {
        Self { value, target, left: cycles }
    }

    #[inline]
    pub(crate) const fn value(&self) -> f64 {
        self.value
    }

    #[inline]
    pub(crate) fn advance(&mut self) {
        if self.left > 0 {
            self.value += (self.target - self.value) / f64::from(self.left);
            self.left -= 1;
            if self.left == 0 {
                self.value = self.target;
            }
        }
    }

    /// Where it is going, at once.
    pub(crate) const fn finish(&mut self) {
        (self.value, self.left) = (self.target, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_moves_in_equal_steps_and_stays() {
        let mut ramp = Ramp::new(1.0, 3.0, 4);
        let values: Vec<f64> = (0..6)
            .map(|_| {
                ramp.advance();
                ramp.value()
            })
            .collect();
        assert_eq!(values, [1.5, 2.0, 2.5, 3.0, 3.0, 3.0]);
    }
}
