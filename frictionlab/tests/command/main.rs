//! The command as its users call it, one file a subject. One program of tests: each program of its
//! own would be linked to the whole of frictionlab once more.

mod design;
mod destinations;
mod export;
mod features;
mod identify_drive;
mod identify_friction;
mod identify_from_drive;
mod identify_servo;
mod identify_stiction;
mod identify_structure;
mod json;
mod manual;
mod own_recordings;
#[cfg(feature = "ros")]
mod parameter_files;
mod runs;
mod simulate;
mod words;
