//! Friction models.
