//! Recordings of our own and of other people, through the command and through other readers.

mod emps;
mod emps_structure;
mod identify;
mod recover_bag;
mod rosbags;
mod servo_logs;
mod strangers;
