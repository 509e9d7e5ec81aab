//! The built command from outside: runs, their reports, and input of every kind. What drives a device
//! in real time has programs of its own, beside which nothing else runs.

mod from_outside;
mod fuzz;
mod report_browser;
mod report_layout;
mod report_pictures;
mod run;
