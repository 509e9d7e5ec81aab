//! The built command from outside: runs, their reports, exit codes, and input of every kind.

mod exit_codes;
mod from_outside;
mod fuzz;
mod report_browser;
mod report_layout;
mod resume;
mod run;
