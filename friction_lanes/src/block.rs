//! A number for each lane.

/// Lanes of a block: twice the doubles of the widest instructions, so that the processor has something
/// to do while the longest chain of a step ends.
pub const WIDTH: usize = 16;

/// A number for each lane of a block.
pub type Block = [f64; WIDTH];

/// The block that an expression gives, lane by lane. A macro, because what a closure computes is not
/// always built for the widest instructions.
macro_rules! each {
    ($lane:ident => $value:expr) => {{
        let mut block = [0.0; $crate::block::WIDTH];
        for ($lane, value) in block.iter_mut().enumerate() {
            *value = $value;
        }
        block
    }};
}
pub(crate) use each;
