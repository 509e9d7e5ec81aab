//! The 2017 thesis on drives subject to friction (A. C. Nnaji): its tables and examples, with its
//! printed figures beside ours. No other folder knows its chapters.
//!
//! * [`friction_tables`]: tables 4.2 to 4.16, of identified models.
//! * [`example_5_4`]: the example of section 5.4.
//! * [`rig`]: the simulations of section 6.5.
//! * [`matrix`]: every model as plant under every model as observer.
//! * [`compensation_tables`]: its tables of compensation.

pub mod compensation_tables;
pub mod example_5_4;
pub mod friction_tables;
pub mod matrix;
pub mod rig;

use experiment_runner::run::{Appendix, Beside};

/// What a program shows of the thesis beside its own results, where `--thesis-tables` asks for it.
pub const BESIDE: Beside = Beside {
    run: Some(Appendix {
        rig_seconds: compensation_tables::rig_seconds,
        compute: compensation_tables::appended,
    }),
    friction: Some(friction_tables::blocks),
};
