//! Names of objects.

/// Names in use and their objects. `None`: the name was generated but nothing has been bound to it.
pub type Names<T> = std::collections::BTreeMap<u32, Option<T>>;
