//! What the field of a parameter holds.

/// What a parameter's field can hold: one number, a list with one number an element, or a whole
/// number.
pub trait Value {
    /// Calls `f` with every number.
    fn each(&self, f: &mut dyn FnMut(f64));

    /// Multiplies every number by `factor`. Whole numbers are rounded.
    fn scale(&mut self, factor: f64);

    /// Becomes `value`; false for a list, which one number does not determine.
    fn set(&mut self, value: f64) -> bool;

    /// The number at `index` becomes `value`; false if there is none. A parameter that is no list
    /// has the index 0 only.
    fn set_at(&mut self, index: usize, value: f64) -> bool {
        index == 0 && self.set(value)
    }
}

macro_rules! number {
    ($($number:ty),+) => {
        $(
            impl Value for $number {
                fn each(&self, f: &mut dyn FnMut(f64)) {
                    f(f64::from(*self));
                }
                fn scale(&mut self, factor: f64) {
                    *self = (f64::from(*self) * factor) as Self;
                }
                fn set(&mut self, value: f64) -> bool {
                    *self = value as Self;
                    true
                }
            }
        )+
    };
}

number!(f32, f64);

impl Value for u32 {
    fn each(&self, f: &mut dyn FnMut(f64)) {
        f(f64::from(*self));
    }
    fn scale(&mut self, factor: f64) {
        // A float becomes a whole number by saturation: nothing overflows.
        *self = (f64::from(*self) * factor + 0.5) as u32;
    }
    fn set(&mut self, value: f64) -> bool {
        *self = (value + 0.5) as u32;
        true
    }
}
