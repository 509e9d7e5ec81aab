//! Experiments, their recorder, figures and report, and the `frictionlab` command built on them.

pub mod report {
    //! The report: pictures and tables as data ([`figure`]) and the page that shows them.
    pub mod figure;
}
