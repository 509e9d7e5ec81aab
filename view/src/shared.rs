//! What all connections share.

use std::sync::Arc;

use tokio::sync::Semaphore;

use crate::access::{Token, Tokens};
use crate::{Hub, Origins, Steering};

/// What all connections share.
pub(crate) struct Shared {
    pub(crate) hub: Hub,
    pub(crate) steering: Arc<dyn Steering>,
    pub(crate) origins: Origins,
    pub(crate) tokens: Option<Tokens>,
    pub(crate) name: String,
    /// Differs from start to start.
    pub(crate) session: String,
    pub(crate) viewers: Arc<Semaphore>,
    /// Stands in the addresses of files: who was let in is told it.
    pub(crate) key: Token,
    /// Files that are read at once.
    pub(crate) reading: Arc<Semaphore>,
}
