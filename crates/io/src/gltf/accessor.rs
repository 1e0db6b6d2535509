//! Typed arrays out of buffers, with every bound checked before a byte is read or an array is made.
//!
//! An accessor says where its elements lie (a view, an offset, a stride), what they are (components
//! of 1 to 4 bytes, perhaps normalised integers) and which of them a sparse list replaces. Without
//! a view all elements are zero.
//!
//! In:   an accessor's index and the range of elements that is wanted. Out: the elements as `f32`
//!       or `u32`.
//! Cost: linear in the range. Memory: at most 4 bytes for each component that the file holds; an
//! accessor without bytes may claim no more elements than the buffers have bytes (or 65536).
//! Source: [glTF 2.0], section 3.6.2.

use super::buffers::Buffers;
use crate::{Error, Place};
use gltf::json::Root;
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::validation::Checked;
use std::ops::Range;

/// Elements that an accessor without bytes may have, whatever the size of the file.
const FREE_ZEROS: u64 = 65_536;

/// A document with its bytes.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub(crate) root: &'a Root,
    pub(crate) buffers: &'a Buffers<'a>,
    pub(crate) file: &'a str,
}

/// What integers stand for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Integers {
    /// What the accessor's `normalized` says.
    AsDeclared,
    /// `0..=1` or `-1..=1`, as the attribute's definition demands.
    Normalized,
}

/// A checked accessor.
struct Layout<'a> {
    elements: Option<Elements<'a>>,
    sparse: Option<Sparse<'a>>,
    component: ComponentType,
    normalized: bool,
}

/// Where elements lie: element `i` starts at `i * stride`.
#[derive(Clone, Copy)]
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
}

/// Elements that replace others.
struct Sparse<'a> {
    indices: Elements<'a>,
    index_type: ComponentType,
    values: Elements<'a>,
    count: usize,
}

impl<'a> Source<'a> {
    /// An error at a JSON path.
    pub(crate) fn error(&self, path: impl Into<String>, what: impl Into<String>) -> Error {
        Error::malformed(self.file, Place::Json(path.into()), what)
    }

    /// Number of elements; an error if there is nothing that could hold them.
    pub(crate) fn count(&self, index: usize) -> Result<usize, Error> {
        let accessor = &self.root.accessors[index];
        let limit = self.buffers.total().max(FREE_ZEROS);
        if accessor.count.0 > limit {
            let what = format!(
                "count {}, the buffers have {} bytes in all",
                accessor.count.0,
                self.buffers.total()
            );
            return Err(self.error(format!("accessors[{index}]"), what));
        }
        Ok(accessor.count.0 as usize)
    }

    /// The shape of the elements.
    pub(crate) fn shape(&self, index: usize) -> Option<Type> {
        match self.root.accessors[index].type_ {
            Checked::Valid(shape) => Some(shape),
            Checked::Invalid => None,
        }
    }

    /// Elements `range` as vectors of `N` floats. `user` is the JSON path that names the accessor,
    /// for messages.
    pub(crate) fn floats<const N: usize>(
        &self,
        index: usize,
        range: Range<usize>,
        integers: Integers,
        user: &str,
    ) -> Result<Vec<[f32; N]>, Error> {
        let layout = self.layout(index, N, user)?;
        let normalized = layout.normalized || integers == Integers::Normalized;

        // Convert elements to floats; normalized integers span 0 to 1, or -1 to 1 with a sign.
        let read = |elements: Elements<'_>, range: Range<usize>| -> Vec<[f32; N]> {
            match (layout.component, normalized) {
                (ComponentType::F32, _) => elements.convert(range, f32::from_le_bytes),
                (ComponentType::U32, _) => {
                    elements.convert(range, |b| u32::from_le_bytes(b) as f32)
                }
                (ComponentType::U16, false) => {
                    elements.convert(range, |b| f32::from(u16::from_le_bytes(b)))
                }
                (ComponentType::U16, true) => {
                    elements.convert(range, |b| f32::from(u16::from_le_bytes(b)) / 65535.0)
                }
                (ComponentType::I16, false) => {
                    elements.convert(range, |b| f32::from(i16::from_le_bytes(b)))
                }
                (ComponentType::I16, true) => elements
                    .convert(range, |b| (f32::from(i16::from_le_bytes(b)) / 32767.0).max(-1.0)),
                (ComponentType::U8, false) => elements.convert(range, |b: [u8; 1]| f32::from(b[0])),
                (ComponentType::U8, true) => {
                    elements.convert(range, |b: [u8; 1]| f32::from(b[0]) / 255.0)
                }
                (ComponentType::I8, false) => {
                    elements.convert(range, |b| f32::from(i8::from_le_bytes(b)))
                }
                (ComponentType::I8, true) => {
                    elements.convert(range, |b| (f32::from(i8::from_le_bytes(b)) / 127.0).max(-1.0))
                }
            }
        };

        // Read the dense elements, zero where there are none, and put the sparse ones over them.
        let base = layout.elements.map(|e| read(e, range.clone()));
        let out = base.unwrap_or_else(|| vec![[0.0; N]; range.len()]);
        self.with_sparse(index, &layout, range, out, read)
    }

    /// Elements `range` as vectors of `N` unsigned integers.
    pub(crate) fn unsigned<const N: usize>(
        &self,
        index: usize,
        range: Range<usize>,
        user: &str,
    ) -> Result<Vec<[u32; N]>, Error> {
        let layout = self.layout(index, N, user)?;
        if !matches!(layout.component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32)
        {
            return Err(self.error(
                user,
                format!("accessor {index} has components that are not unsigned integers"),
            ));
        }
        let read = |elements: Elements<'_>, range: Range<usize>| {
            elements.unsigned::<N>(range, layout.component)
        };
        let base = layout.elements.map(|e| read(e, range.clone()));
        let out = base.unwrap_or_else(|| vec![[0; N]; range.len()]);
        self.with_sparse(index, &layout, range, out, read)
    }

    /// Puts the sparse elements in their places.
    fn with_sparse<T: Copy>(
        &self,
        index: usize,
        layout: &Layout<'_>,
        range: Range<usize>,
        mut out: Vec<T>,
        read: impl Fn(Elements<'_>, Range<usize>) -> Vec<T>,
    ) -> Result<Vec<T>, Error> {
        let Some(sparse) = &layout.sparse else { return Ok(out) };
        let places = sparse.indices.unsigned::<1>(0..sparse.count, sparse.index_type);
        let values = read(sparse.values, 0..sparse.count);
        let count = self.root.accessors[index].count.0;
        for (&[place], value) in places.iter().zip(values) {
            if u64::from(place) >= count {
                let path = format!("accessors[{index}].sparse.indices");
                return Err(
                    self.error(path, format!("index {place}, the accessor has {count} elements"))
                );
            }
            if range.contains(&(place as usize)) {
                out[place as usize - range.start] = value;
            }
        }
        Ok(out)
    }

    /// Checks that all that the accessor claims lies inside its views.
    fn layout(&self, index: usize, components: usize, user: &str) -> Result<Layout<'a>, Error> {
        // Check the type of the elements.
        let accessor = &self.root.accessors[index];
        let path = format!("accessors[{index}]");
        let (Checked::Valid(shape), Checked::Valid(component)) =
            (accessor.type_, accessor.component_type.as_ref())
        else {
            return Err(self.error(path, "unknown type or componentType"));
        };
        let component = component.0;
        if shape.multiplicity() != components {
            let what = format!(
                "accessor {index} has {} components an element, {components} are needed",
                shape.multiplicity()
            );
            return Err(self.error(user, what));
        }

        // Find the elements in their view.
        let count = self.count(index)?;
        let size = components * component.size();
        let offset = accessor.byte_offset.map_or(0, |o| o.0);
        let elements = match accessor.buffer_view {
            Some(view) => Some(self.elements(&path, view.value(), offset, count, size, true)?),
            None => None,
        };

        // Find the sparse elements that replace some of them.
        let sparse = match &accessor.sparse {
            None => None,
            Some(s) => {
                let path = format!("{path}.sparse");
                let Checked::Valid(index_type) = s.indices.component_type.as_ref() else {
                    return Err(self.error(path, "unknown componentType of the indices"));
                };
                if s.count.0 > count as u64 {
                    return Err(self.error(
                        path,
                        format!("count {}, the accessor has {count} elements", s.count.0),
                    ));
                }
                let (n, index_size) = (s.count.0 as usize, index_type.0.size());
                let at = |view: usize, offset: u64, size| {
                    self.elements(&path, view, offset, n, size, false)
                };
                Some(Sparse {
                    indices: at(
                        s.indices.buffer_view.value(),
                        s.indices.byte_offset.0,
                        index_size,
                    )?,
                    index_type: index_type.0,
                    values: at(s.values.buffer_view.value(), s.values.byte_offset.0, size)?,
                    count: n,
                })
            }
        };
        Ok(Layout { elements, sparse, component, normalized: accessor.normalized })
    }

    /// `count` elements of `size` bytes in a view, from `offset` on.
    fn elements(
        &self,
        path: &str,
        view: usize,
        offset: u64,
        count: usize,
        size: usize,
        strided: bool,
    ) -> Result<Elements<'a>, Error> {
        let bytes = self.buffers.view(self.root, view, self.file)?;
        let stride =
            self.root.buffer_views[view].byte_stride.filter(|_| strided).map_or(size, |s| s.0);
        if stride < size {
            return Err(self
                .error(path, format!("elements of {size} bytes, the view's stride is {stride}")));
        }
        let needed = match count {
            0 => Some(0),
            n => (n as u64 - 1).checked_mul(stride as u64).and_then(|b| b.checked_add(size as u64)),
        };
        let available = (bytes.len() as u64).checked_sub(offset);
        match (needed, available) {
            (Some(needed), Some(available)) if needed <= available => {
                Ok(Elements { bytes: &bytes[offset as usize..], stride })
            }
            _ => {
                let what = format!(
                    "{count} elements, {stride} bytes apart from byte {offset} on, bufferView {view} has {} bytes",
                    bytes.len()
                );
                Err(self.error(path, what))
            }
        }
    }
}

impl Elements<'_> {
    /// Reads `N` components of `S` bytes of each element.
    fn convert<const N: usize, const S: usize, T: Copy + Default>(
        self,
        range: Range<usize>,
        value: impl Fn([u8; S]) -> T,
    ) -> Vec<[T; N]> {
        let one = |bytes: &[u8]| {
            let mut element = [T::default(); N];
            for (component, raw) in element.iter_mut().zip(bytes.as_chunks::<S>().0) {
                *component = value(*raw);
            }
            element
        };
        if self.stride == N * S {
            // Without gaps the bytes are walked in one go.
            return self.bytes[range.start * self.stride..range.end * self.stride]
                .chunks_exact(N * S)
                .map(one)
                .collect();
        }
        range.map(|i| one(&self.bytes[i * self.stride..][..N * S])).collect()
    }

    fn unsigned<const N: usize>(
        self,
        range: Range<usize>,
        component: ComponentType,
    ) -> Vec<[u32; N]> {
        match component {
            ComponentType::U8 | ComponentType::I8 => {
                self.convert(range, |b: [u8; 1]| u32::from(b[0]))
            }
            ComponentType::U16 | ComponentType::I16 => {
                self.convert(range, |b| u32::from(u16::from_le_bytes(b)))
            }
            ComponentType::U32 | ComponentType::F32 => self.convert(range, u32::from_le_bytes),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NoFiles;
    use crate::gltf::document::parse;

    /// Runs `f` on a document with the given accessors over the 12 bytes 0, 1, ..., 11.
    fn with<R>(accessors: &str, views: &str, f: impl FnOnce(Source<'_>) -> R) -> R {
        let text = format!(
            r#"{{"asset":{{"version":"2.0"}},"accessors":[{accessors}],"bufferViews":[{views}],
            "buffers":[{{"byteLength":12,"uri":"data:;base64,AAECAwQFBgcICQoL"}}]}}"#
        );
        let document = parse(text.as_bytes(), "a.gltf").unwrap();
        let buffers = Buffers::fetch(&document, "a.gltf", &NoFiles).unwrap();
        f(Source { root: &document.root, buffers: &buffers, file: "a.gltf" })
    }

    const WHOLE: &str = r#"{"buffer":0,"byteLength":12}"#;

    #[test]
    fn strided_and_normalised() {
        let accessor = r#"{"bufferView":0,"byteOffset":1,"componentType":5121,"count":3,"type":"VEC2","normalized":true}"#;
        let view = r#"{"buffer":0,"byteLength":12,"byteStride":4}"#;
        with(accessor, view, |s| {
            let read = s.floats::<2>(0, 1..3, Integers::AsDeclared, "x").unwrap();
            assert_eq!(read, [[5.0 / 255.0, 6.0 / 255.0], [9.0 / 255.0, 10.0 / 255.0]]);
        });
    }

    #[test]
    fn sparse_elements_replace_zeros() {
        let accessor = r#"{"componentType":5121,"count":9,"type":"SCALAR","sparse":{"count":2,
            "indices":{"bufferView":0,"byteOffset":2,"componentType":5121},"values":{"bufferView":0,"byteOffset":10}}}"#;
        with(accessor, WHOLE, |s| {
            assert_eq!(s.unsigned::<1>(0, 0..5, "x").unwrap(), [[0], [0], [10], [11], [0]]);
        });
    }

    #[test]
    fn nothing_is_read_beyond_the_view() {
        let count = |n: u64, offset: u64| {
            let accessor = format!(
                r#"{{"bufferView":0,"byteOffset":{offset},"componentType":5125,"count":{n},"type":"SCALAR"}}"#
            );
            with(&accessor, WHOLE, |s| s.unsigned::<1>(0, 0..0, "x").map_err(|e| e.to_string()))
        };
        assert!(count(3, 0).is_ok() && count(0, 12).is_ok());
        for (n, offset) in [(4, 0), (3, 1), (0, 13), (1, u64::MAX), (u64::MAX, 0), (4000, 0)] {
            assert!(
                count(n, offset).unwrap_err().starts_with("a.gltf: accessors[0]"),
                "{n} from {offset}"
            );
        }
        let zeros = r#"{"componentType":5126,"count":4294967295,"type":"VEC4"}"#;
        with(zeros, WHOLE, |s| assert!(s.count(0).unwrap_err().to_string().contains("4294967295")));
    }
}
