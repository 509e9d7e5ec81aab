//! Statistics: quantiles, means and scatter, Student's factor, straight lines. The whole workspace
//! takes them from here, so that one word has one definition.
//!
//! * [`quantile`] interpolates between the ordered values: definition 7 of Hyndman and Fan (1996,
//!   The American Statistician 50, 361). [`Quartiles`] are three of them.
//! * [`nearest_rank`] is a value that occurred: definition 1 of the same.
//! * [`upper_median`] is the value in the middle, of an even number the upper of the two.
//! * [`Sample`] is the mean and the scatter of a sample, [`RunningSample`] the same for values that
//!   are not kept.
//! * [`student_95`] leads from a standard error to a 95 % interval, [`rank_of_95`] from a sample to
//!   the interval of its median.
//! * [`line`](fn@line) is the least-squares line.

mod line;
mod order;
mod sample;
mod student;

pub use line::{Line, line};
pub use order::{Quartiles, nearest_rank, quantile, rank_of_95, sorted, upper_median};
pub use sample::{RunningSample, Sample, root_mean_square};
pub use student::{student_95, student_95_of};
