//! What tells friction models apart, computed.
