//! The server against viewers that are strangers: whose page asks, who has which token, and what
//! floods, huge frames, many sockets and half-open ones cost.

mod access;
mod flooding;
mod speaking;
mod stranger;
