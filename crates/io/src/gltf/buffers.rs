//! The bytes behind a document: buffers from files, data URIs or the GLB chunk, and views into them.
//!
//! Cost: one read of each buffer that is there; nothing is copied out of a GLB.

use super::document::Document;
use crate::uri::{self, Target};
use crate::{Error, Place, Resolver};
use gltf::json::Root;
use std::borrow::Cow;

/// All buffers of a document, each at least as long as it claims.
pub(crate) struct Buffers<'a> {
    data: Vec<Cow<'a, [u8]>>,
}

impl<'a> Buffers<'a> {
    /// Fetches every buffer.
    pub(crate) fn fetch(document: &Document<'a>, file: &str, resolver: &dyn Resolver) -> Result<Self, Error> {
        let mut data = Vec::with_capacity(document.root.buffers.len());
        for (i, buffer) in document.root.buffers.iter().enumerate() {
            let place = Place::Json(format!("buffers[{i}]"));
            let bytes = match (&buffer.uri, document.binary) {
                (Some(uri), _) => {
                    let target = uri::resolve(uri).map_err(|what| Error::malformed(file, place.clone(), what))?;
                    Cow::Owned(read_target(target, file, resolver)?)
                }
                (None, Some(binary)) if i == 0 => Cow::Borrowed(binary),
                (None, _) => return Err(Error::malformed(file, place, "neither a uri nor the binary chunk of a GLB")),
            };
            if (bytes.len() as u64) < buffer.byte_length.0 {
                let what = format!("byteLength {}, there are {} bytes", buffer.byte_length.0, bytes.len());
                return Err(Error::malformed(file, place, what));
            }
            data.push(bytes);
        }
        Ok(Self { data })
    }

    /// Bytes of all buffers together.
    pub(crate) fn total(&self) -> u64 {
        self.data.iter().map(|b| b.len() as u64).sum()
    }

    /// The bytes of a buffer view.
    pub(crate) fn view(&self, root: &Root, view: usize, file: &str) -> Result<&[u8], Error> {
        let entry = &root.buffer_views[view];
        let buffer = &self.data[entry.buffer.value()];
        let (start, length) = (entry.byte_offset.map_or(0, |o| o.0), entry.byte_length.0);
        let end = start.checked_add(length).filter(|&end| end <= buffer.len() as u64);
        match end {
            Some(end) => Ok(&buffer[start as usize..end as usize]),
            None => {
                let what = format!("bytes {start} + {length}, buffer {} has {}", entry.buffer, buffer.len());
                Err(Error::malformed(file, Place::Json(format!("bufferViews[{view}]")), what))
            }
        }
    }
}

/// The bytes that a URI of a model stands for.
pub(crate) fn read_target(target: Target, file: &str, resolver: &dyn Resolver) -> Result<Vec<u8>, Error> {
    match target {
        Target::Inline(bytes) => Ok(bytes),
        Target::File(path) => resolver.read(&path).map_err(|why| Error::Missing {
            file: file.to_owned(),
            needed: path,
            why: why.to_string(),
        }),
    }
}
