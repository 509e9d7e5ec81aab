//! Friction parameters from recordings: conditioning, least squares, uncertainty.
