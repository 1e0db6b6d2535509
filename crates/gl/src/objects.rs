//! Objects that contexts may share.

pub use crate::vertices::{Buffer, List, ListNames};
use std::sync::Mutex;

/// Names in use and their objects. `None`: the name was generated but nothing has been bound to it.
pub type Names<T> = std::collections::BTreeMap<u32, Option<T>>;

/// The object store of one or more contexts.
#[derive(Debug, Default)]
pub struct Shared {
    /// Buffer objects.
    pub buffers: Mutex<Names<Buffer>>,
    /// Display lists.
    pub lists: Mutex<ListNames>,
    /// Labels of shared objects.
    pub(crate) labels: Mutex<crate::api::Labels>,
}
