//! The bytes behind a document: buffers from files, data URIs or the GLB chunk, and views into
//! them.
//!
//! Cost: one read of each buffer that is there; nothing is copied out of a GLB.

use super::document::Document;
use crate::resolve::read_first;
use crate::uri::{self, Target};
use crate::{Error, Place, Resolver};
use gltf::json::Root;
use gltf::json::buffer::View;
use std::borrow::Cow;

/// All buffers of a document, each at least as long as it claims. `None` for one without bytes,
/// which is an error where it is used: only extensions that are not read have any for it.
pub(crate) struct Buffers<'a> {
    data: Vec<Option<Cow<'a, [u8]>>>,
    /// What is odd about the names of their files.
    pub(crate) warnings: Vec<String>,
}

impl<'a> Buffers<'a> {
    /// Fetches every buffer.
    pub(crate) fn fetch(
        document: &Document<'a>,
        file: &str,
        resolver: &dyn Resolver,
    ) -> Result<Self, Error> {
        let mut data = Vec::with_capacity(document.root.buffers.len());
        let mut warnings = Vec::new();
        for (i, buffer) in document.root.buffers.iter().enumerate() {
            let place = Place::Json(format!("buffers[{i}]"));
            let bytes = match (&buffer.uri, document.binary) {
                (Some(uri), _) => {
                    let target = uri::resolve(uri)
                        .map_err(|what| Error::malformed(file, place.clone(), what))?;
                    let (bytes, oddity) = read_target(target, file, resolver)?;
                    warnings.extend(oddity);
                    Cow::Owned(bytes)
                }
                (None, Some(binary)) if i == 0 => Cow::Borrowed(binary),
                (None, _) => {
                    data.push(None);
                    continue;
                }
            };
            if (bytes.len() as u64) < buffer.byte_length.0 {
                let what =
                    format!("byteLength {}, there are {} bytes", buffer.byte_length.0, bytes.len());
                return Err(Error::malformed(file, place, what));
            }
            data.push(Some(bytes));
        }
        Ok(Self { data, warnings })
    }

    /// Bytes of all buffers together.
    pub(crate) fn total(&self) -> u64 {
        self.data.iter().flatten().map(|b| b.len() as u64).sum()
    }

    /// The bytes of a buffer view.
    pub(crate) fn view(&self, root: &Root, view: usize, file: &str) -> Result<&[u8], Error> {
        let entry = &root.buffer_views[view];
        let Some(buffer) = &self.data[entry.buffer.value()] else {
            if let Some(name) = compression(entry) {
                let what = format!(
                    "bufferViews[{view}] is compressed with {name}, which is not supported"
                );
                return Err(Error::Unsupported { file: file.to_owned(), what });
            }
            let place = Place::Json(format!("buffers[{}]", entry.buffer));
            return Err(Error::malformed(
                file,
                place,
                "neither a uri nor the binary chunk of a GLB",
            ));
        };
        let (start, length) = (entry.byte_offset.map_or(0, |o| o.0), entry.byte_length.0);
        let end = start.checked_add(length).filter(|&end| end <= buffer.len() as u64);
        match end {
            Some(end) => Ok(&buffer[start as usize..end as usize]),
            None => {
                let what = format!(
                    "bytes {start} + {length}, buffer {} has {}",
                    entry.buffer,
                    buffer.len()
                );
                Err(Error::malformed(file, Place::Json(format!("bufferViews[{view}]")), what))
            }
        }
    }
}

/// The extension by which a view's bytes are packed in another buffer; the buffer that it names may
/// lack bytes then.
fn compression(view: &View) -> Option<&'static str> {
    let others = &view.extensions.as_ref()?.others;
    ["EXT_meshopt_compression", "KHR_meshopt_compression"]
        .into_iter()
        .find(|name| others.contains_key(*name))
}

/// The bytes that a URI of a model stands for, and what is odd about the name of the file that has
/// them. A name that is not there is looked for with `/` between folders, as MTL names are, and
/// then by its last part beside the model.
pub(crate) fn read_target(
    target: Target,
    file: &str,
    resolver: &dyn Resolver,
) -> Result<(Vec<u8>, Option<String>), Error> {
    let path = match target {
        Target::Inline(bytes) => return Ok((bytes, None)),
        Target::File(path) => path,
    };
    let slashed = path.replace('\\', "/");
    let bare = slashed.rsplit('/').next().unwrap_or(&slashed).to_owned();
    let mut names = vec![path.clone(), slashed, bare];
    names.dedup();
    match read_first(resolver, &names) {
        Ok(found) => {
            let moved = || format!("there is no `{path}`; `{}` is read", found.name);
            let oddity = found.oddity.or_else(|| (found.name != path).then(moved));
            Ok((found.bytes, oddity.map(|what| format!("{file}: {what}"))))
        }
        Err(why) => {
            Err(Error::Missing { file: file.to_owned(), needed: path, why: why.to_string() })
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::gltf::document::parse;
    use crate::{NoFiles, gltf};
    use vitral_exec::Workers;

    #[test]
    fn a_buffer_without_bytes_matters_where_it_is_used() {
        let load = |rest: &str| {
            let text = format!(
                r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
                "buffers":[{{"byteLength":4000000000}}],"bufferViews":[{{"buffer":0,"byteLength":36}}],
                "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
                "accessors":[{{"componentType":5126,"count":3,"type":"VEC3"{rest}}}]}}"#
            );
            parse(text.as_bytes(), "a.gltf").unwrap();
            gltf::load(text.as_bytes(), "a.gltf", &NoFiles, &Workers::single())
                .map_err(|e| e.to_string())
        };
        assert_eq!(load("").unwrap().meshes[0].triangles.len(), 1);
        let told = "a.gltf: buffers[0]: neither a uri nor the binary chunk of a GLB";
        assert_eq!(load(r#","bufferView":0"#).unwrap_err(), told);
    }
}
