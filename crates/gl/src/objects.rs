//! Objects that contexts may share.

use crate::names::NameRange;
pub use crate::names::Names;
use crate::pixels::{RenderbufferHandle, SamplerHandle, TextureHandle};
pub use crate::vertices::{Buffer, BufferHandle, List, ListNames};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// The object store of one or more contexts.
#[derive(Debug, Default)]
pub struct Shared {
    /// Where names of objects are taken from.
    pub(crate) names: NameRange,
    /// Buffer objects.
    pub buffers: Mutex<Names<BufferHandle>>,
    /// Display lists.
    pub lists: Mutex<ListNames>,
    /// Labels of shared objects.
    pub(crate) labels: Mutex<crate::api::Labels>,
    /// Texture objects by name.
    pub(crate) textures: Mutex<Names<TextureHandle>>,
    /// Renderbuffer objects by name.
    pub(crate) renderbuffers: Mutex<Names<RenderbufferHandle>>,
    /// Sampler objects.
    pub(crate) samplers: Mutex<Names<SamplerHandle>>,
    /// Fences of `ARB_sync`.
    pub(crate) fences: Mutex<crate::api::Fences>,
    /// Grows when an image that a framebuffer may have attached gets new storage.
    pub(crate) storage_epoch: AtomicU64,
}

impl Shared {
    /// An empty store, whose names differ from those of other stores: see `names.rs`. A default
    /// store begins with 1.
    pub fn with_own_names() -> Self {
        let names = NameRange::next();
        Self {
            names,
            fences: Mutex::new(crate::api::Fences::after(names.first() as usize - 1)),
            ..Self::default()
        }
    }

    /// Tells all contexts that attached images may have new storage.
    pub(crate) fn storage_changed(&self) {
        self.storage_epoch.fetch_add(1, Ordering::Relaxed);
    }
}
