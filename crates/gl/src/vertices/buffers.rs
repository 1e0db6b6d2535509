//! Buffer objects.
//!
//! The bytes are shared and copied on write. Each change gives the buffer a version that no buffer
//! ever had, so that what was built from it is known to be stale. While a buffer is mapped its
//! bytes are with the client.

use super::client;
use crate::memory::{ClientMemory, can_have};
use crate::names::Names;
use crate::{Context, enums};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A buffer object.
#[derive(Debug)]
pub struct Buffer {
    /// The data store; empty while mapped.
    pub bytes: Arc<Vec<u8>>,
    /// `BUFFER_USAGE`.
    pub usage: u32,
    /// `BUFFER_ACCESS`.
    pub access: u32,
    /// Differs after every change, and between buffers.
    pub version: u64,
    mapping: Option<Mapping>,
}

/// A mapped data store.
#[derive(Debug)]
struct Mapping {
    /// Where the whole store lies.
    address: usize,
    /// Size of the store.
    size: usize,
    /// The part that was asked for.
    offset: usize,
    length: usize,
    /// Access bits.
    flags: u32,
}

/// The largest data store. More is out of memory, so that a wild size does no harm.
const MAX_SIZE: usize = 1 << 31;

/// A buffer object as its name, bindings and arrays have it. Whatever has it keeps the object, even
/// without the name.
#[derive(Clone, Debug)]
pub struct BufferHandle {
    /// Its name; 0 is no buffer.
    pub name: u32,
    id: u64,
    buffer: Option<Arc<Mutex<Buffer>>>,
}

/// Names are reused, buffers are not.
impl PartialEq for BufferHandle {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

impl BufferHandle {
    /// No buffer.
    pub const NONE: Self = Self { name: 0, id: 0, buffer: None };

    pub(crate) fn new(name: u32) -> Self {
        Self { name, id: new_version(), buffer: Some(Arc::default()) }
    }

    /// Whether it is no buffer.
    pub fn is_none(&self) -> bool {
        self.id == 0
    }

    /// Differs between buffers; 0 is no buffer.
    pub(crate) fn id(&self) -> u64 {
        self.id
    }

    /// The same, for comparisons alone: it does not keep the object.
    pub(crate) fn mark(&self) -> Self {
        Self { buffer: None, ..*self }
    }

    /// The object.
    pub(crate) fn lock(&self) -> Option<MutexGuard<'_, Buffer>> {
        Some(self.buffer.as_ref()?.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

type Refusal = (u32, &'static str);

const MAPPED: Refusal = (enums::INVALID_OPERATION, "the buffer is mapped");
const OUT_OF_RANGE: Refusal = (enums::INVALID_VALUE, "the range does not lie within the buffer");
const NOT_THERE: Refusal = (enums::INVALID_VALUE, "the data are not in the client's memory");

fn new_version() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(1);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

impl Default for Buffer {
    fn default() -> Self {
        Self {
            bytes: Arc::default(),
            usage: enums::STATIC_DRAW,
            access: enums::READ_WRITE,
            version: new_version(),
            mapping: None,
        }
    }
}

impl Buffer {
    /// Whether the client has the data store.
    pub fn is_mapped(&self) -> bool {
        self.mapping.is_some()
    }

    /// `BUFFER_SIZE`.
    pub fn size(&self) -> usize {
        self.mapping.as_ref().map_or(self.bytes.len(), |mapping| mapping.size)
    }

    fn range(&self, offset: isize, size: isize) -> Result<std::ops::Range<usize>, Refusal> {
        let start = usize::try_from(offset).map_err(|_| OUT_OF_RANGE)?;
        let size = usize::try_from(size).map_err(|_| OUT_OF_RANGE)?;
        let end = start.checked_add(size).filter(|end| *end <= self.size()).ok_or(OUT_OF_RANGE)?;
        Ok(start..end)
    }

    fn set_data(
        &mut self,
        memory: &dyn ClientMemory,
        size: isize,
        data: usize,
        usage: u32,
    ) -> Result<(), Refusal> {
        const TOO_LARGE: Refusal = (enums::OUT_OF_MEMORY, "the data store is too large");
        if !matches!(usage, enums::STREAM_DRAW..=enums::STREAM_COPY
            | enums::STATIC_DRAW..=enums::STATIC_COPY
            | enums::DYNAMIC_DRAW..=enums::DYNAMIC_COPY)
        {
            return Err((enums::INVALID_ENUM, "usage is not one of buffers"));
        }
        let size = usize::try_from(size).map_err(|_| (enums::INVALID_VALUE, "size is negative"))?;
        if size > MAX_SIZE || !can_have(size) {
            return Err(TOO_LARGE);
        }
        let bytes = if data == 0 {
            vec![0; size]
        } else {
            client::bytes(memory, data, size).ok_or(NOT_THERE)?
        };
        self.release(memory);
        *self = Self { bytes: Arc::new(bytes), usage, ..Self::default() };
        Ok(())
    }

    fn set_part(
        &mut self,
        memory: &dyn ClientMemory,
        offset: isize,
        size: isize,
        data: usize,
    ) -> Result<(), Refusal> {
        let range = self.range(offset, size)?;
        if self.is_mapped() {
            return Err(MAPPED);
        }
        if range.is_empty() {
            return Ok(());
        }
        if Arc::strong_count(&self.bytes) > 1 && !can_have(self.bytes.len()) {
            return Err((
                enums::OUT_OF_MEMORY,
                "draws that wait need the data, and there is no memory for a copy",
            ));
        }
        self.version = new_version();
        let there = data != 0 && memory.read(data, &mut Arc::make_mut(&mut self.bytes)[range]);
        if there { Ok(()) } else { Err(NOT_THERE) }
    }

    fn get_part(
        &mut self,
        memory: &dyn ClientMemory,
        offset: isize,
        size: isize,
        data: usize,
    ) -> Result<(), Refusal> {
        let range = self.range(offset, size)?;
        if self.is_mapped() {
            return Err(MAPPED);
        }
        let there = range.is_empty() || data != 0 && memory.write(data, &self.bytes[range]);
        if there { Ok(()) } else { Err(NOT_THERE) }
    }

    fn map(
        &mut self,
        memory: &dyn ClientMemory,
        offset: usize,
        length: usize,
        flags: u32,
    ) -> Result<usize, Refusal> {
        if self.is_mapped() {
            return Err(MAPPED);
        }
        let bytes = Arc::unwrap_or_clone(std::mem::take(&mut self.bytes));
        let size = bytes.len();
        let address = memory.map(bytes);
        self.mapping = Some(Mapping { address, size, offset, length, flags });
        self.access = match flags & (enums::MAP_READ_BIT | enums::MAP_WRITE_BIT) {
            enums::MAP_READ_BIT => enums::READ_ONLY,
            enums::MAP_WRITE_BIT => enums::WRITE_ONLY,
            _ => enums::READ_WRITE,
        };
        Ok(address + offset)
    }

    fn map_range(
        &mut self,
        memory: &dyn ClientMemory,
        offset: isize,
        length: isize,
        flags: u32,
    ) -> Result<usize, Refusal> {
        use enums::{
            MAP_FLUSH_EXPLICIT_BIT, MAP_INVALIDATE_BUFFER_BIT, MAP_INVALIDATE_RANGE_BIT,
            MAP_READ_BIT, MAP_UNSYNCHRONIZED_BIT, MAP_WRITE_BIT,
        };
        let careless =
            MAP_INVALIDATE_RANGE_BIT | MAP_INVALIDATE_BUFFER_BIT | MAP_UNSYNCHRONIZED_BIT;

        // Check the range and the access bits.
        let range = self.range(offset, length)?;
        if flags & !(MAP_READ_BIT | MAP_WRITE_BIT | MAP_FLUSH_EXPLICIT_BIT | careless) != 0 {
            return Err((enums::INVALID_VALUE, "access has unknown bits"));
        }
        let refused = |why| Err((enums::INVALID_OPERATION, why));
        if range.is_empty() {
            return refused("length is 0");
        }
        if flags & (MAP_READ_BIT | MAP_WRITE_BIT) == 0 {
            return refused("access neither reads nor writes");
        }
        if flags & MAP_READ_BIT != 0 && flags & careless != 0 {
            return refused("what is read may not be invalidated");
        }
        if flags & MAP_FLUSH_EXPLICIT_BIT != 0 && flags & MAP_WRITE_BIT == 0 {
            return refused("only what is written can be flushed");
        }

        // Map the range.
        self.map(memory, range.start, range.len(), flags)
    }

    fn unmap(&mut self, memory: &dyn ClientMemory) -> Result<bool, Refusal> {
        let Some(mapping) = self.mapping.take() else {
            return Err((enums::INVALID_OPERATION, "the buffer is not mapped"));
        };
        let bytes = memory.unmap(mapping.address).filter(|bytes| bytes.len() == mapping.size);
        let kept = bytes.is_some();
        self.bytes = Arc::new(bytes.unwrap_or_else(|| vec![0; mapping.size]));
        if mapping.flags & enums::MAP_WRITE_BIT != 0 || !kept {
            self.version = new_version();
        }
        Ok(kept)
    }

    fn flush(&self, offset: isize, length: isize) -> Result<(), Refusal> {
        let Some(mapping) =
            self.mapping.as_ref().filter(|m| m.flags & enums::MAP_FLUSH_EXPLICIT_BIT != 0)
        else {
            return Err((
                enums::INVALID_OPERATION,
                "the buffer is not mapped for explicit flushes",
            ));
        };
        let range = self.range(offset, length)?;
        if range.end > mapping.length { Err(OUT_OF_RANGE) } else { Ok(()) }
    }

    /// Takes the data store back from the client and drops it.
    fn release(&mut self, memory: &dyn ClientMemory) {
        if let Some(mapping) = self.mapping.take() {
            memory.unmap(mapping.address);
        }
    }

    /// Replaces the bytes of a data store that is not mapped.
    pub(crate) fn replace(&mut self, bytes: Arc<Vec<u8>>) {
        (self.bytes, self.version) = (bytes, new_version());
    }

    fn parameter(&self, pname: u32) -> Result<i32, Refusal> {
        let number = |value: usize| value.try_into().unwrap_or(i32::MAX);
        let mapping = self.mapping.as_ref();
        Ok(match pname {
            enums::BUFFER_SIZE => number(self.size()),
            enums::BUFFER_USAGE => self.usage as i32,
            enums::BUFFER_ACCESS => self.access as i32,
            enums::BUFFER_MAPPED => self.is_mapped().into(),
            enums::BUFFER_ACCESS_FLAGS => mapping.map_or(0, |m| m.flags as i32),
            enums::BUFFER_MAP_OFFSET => mapping.map_or(0, |m| number(m.offset)),
            enums::BUFFER_MAP_LENGTH => mapping.map_or(0, |m| number(m.length)),
            _ => return Err((enums::INVALID_ENUM, "pname is not a parameter of buffers")),
        })
    }
}

impl Context {
    pub(crate) fn buffers(&self) -> MutexGuard<'_, Names<BufferHandle>> {
        self.shared.buffers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether a buffer still has its name.
    pub(crate) fn is_named(&self, buffer: &BufferHandle) -> bool {
        self.buffers().get(&buffer.name).is_some_and(|named| named.as_ref() == Some(buffer))
    }

    fn buffer_binding(&mut self, call: &str, target: u32) -> Option<&mut BufferHandle> {
        match target {
            enums::ARRAY_BUFFER => Some(&mut self.client.array_buffer),
            enums::ELEMENT_ARRAY_BUFFER => Some(&mut self.client.element_buffer),
            enums::COPY_READ_BUFFER => Some(&mut self.client.copy_buffers[0]),
            enums::COPY_WRITE_BUFFER => Some(&mut self.client.copy_buffers[1]),
            enums::PIXEL_PACK_BUFFER => Some(&mut self.client.pack.buffer),
            enums::PIXEL_UNPACK_BUFFER => Some(&mut self.client.unpack.buffer),
            _ => {
                self.record_error(
                    enums::INVALID_ENUM,
                    call,
                    &format!("target {target:#x} has no buffers"),
                );
                None
            }
        }
    }

    /// Works on the buffer bound to `target`; records what stands against it.
    fn with_buffer<R>(
        &mut self,
        call: &str,
        target: u32,
        work: impl FnOnce(&mut Buffer, &dyn ClientMemory) -> Result<R, Refusal>,
    ) -> Option<R> {
        if self.refused_inside_begin(call) {
            return None;
        }
        let bound = self.buffer_binding(call, target)?.clone();
        let result = match bound.lock() {
            Some(mut buffer) => work(&mut buffer, &*self.memory),
            None => Err((enums::INVALID_OPERATION, "no buffer is bound")),
        };
        result.map_err(|(error, why)| self.record_error(error, call, why)).ok()
    }

    /// `glBindBuffer`.
    pub fn bind_buffer(&mut self, target: u32, buffer: u32) {
        if self.refused_inside_begin("glBindBuffer") {
            return;
        }
        const CALL: &str = "glBindBuffer";
        if self.buffer_binding(CALL, target).is_none() {
            return;
        }
        let new = || BufferHandle::new(buffer);
        let handle = match buffer {
            0 => BufferHandle::NONE,
            name => self.buffers().entry(name).or_default().get_or_insert_with(new).clone(),
        };
        if let Some(binding) = self.buffer_binding(CALL, target) {
            *binding = handle;
        }
    }

    /// `glGenBuffers`.
    pub fn gen_buffers(&mut self, n: i32, buffers: usize) {
        self.give_names("glGenBuffers", n, buffers, |c, n| {
            c.shared.names.generate(&mut c.buffers(), n)
        });
    }

    /// `glDeleteBuffers`.
    pub fn delete_buffers(&mut self, n: i32, buffers: usize) {
        for name in self.doomed_names("glDeleteBuffers", n, buffers) {
            let removed = self.buffers().remove(&name).flatten();
            if let Some(handle) = removed {
                // Whoever still has it finds its data.
                if let Some(mut buffer) = handle.lock() {
                    buffer.unmap(&*self.memory).ok();
                }
                self.forget_buffer(&handle);
            }
        }
    }

    /// `glIsBuffer`.
    pub fn is_buffer(&mut self, buffer: u32) -> u8 {
        if self.refused_inside_begin("glIsBuffer") {
            return 0;
        }
        u8::from(matches!(self.buffers().get(&buffer), Some(Some(_))))
    }

    /// `glBufferData`.
    pub fn buffer_data(&mut self, target: u32, size: isize, data: usize, usage: u32) {
        self.with_buffer("glBufferData", target, |buffer, memory| {
            buffer.set_data(memory, size, data, usage)
        });
    }

    /// `glBufferSubData`.
    pub fn buffer_sub_data(&mut self, target: u32, offset: isize, size: isize, data: usize) {
        self.with_buffer("glBufferSubData", target, |buffer, memory| {
            buffer.set_part(memory, offset, size, data)
        });
    }

    /// `glGetBufferSubData`.
    pub fn get_buffer_sub_data(&mut self, target: u32, offset: isize, size: isize, data: usize) {
        self.with_buffer("glGetBufferSubData", target, |buffer, memory| {
            buffer.get_part(memory, offset, size, data)
        });
    }

    /// `glCopyBufferSubData`.
    pub fn copy_buffer_sub_data(
        &mut self,
        read: u32,
        write: u32,
        read_offset: isize,
        write_offset: isize,
        size: isize,
    ) {
        const CALL: &str = "glCopyBufferSubData";
        if self.refused_inside_begin(CALL) {
            return;
        }

        // Read from the bytes as they are when the call is made.
        let Some(source) = self.buffer_binding(CALL, read).map(|b| b.id) else { return };
        let Some(target) = self.buffer_binding(CALL, write).map(|b| b.id) else { return };
        let part = self.with_buffer(CALL, read, |buffer, _| {
            let range = buffer.range(read_offset, size)?;
            match buffer.is_mapped() {
                true => Err(MAPPED),
                false => Ok((buffer.bytes.clone(), range)),
            }
        });
        let Some((bytes, from)) = part else { return };

        // Check the target range, then copy.
        self.with_buffer(CALL, write, |buffer, _| {
            let to = buffer.range(write_offset, size)?;
            if buffer.is_mapped() {
                return Err(MAPPED);
            }
            if source == target && from.start < to.end && to.start < from.end {
                return Err((enums::INVALID_VALUE, "the ranges overlap"));
            }
            if !from.is_empty() {
                buffer.version = new_version();
                if source == target {
                    drop(bytes);
                    Arc::make_mut(&mut buffer.bytes).copy_within(from, to.start);
                } else {
                    Arc::make_mut(&mut buffer.bytes)[to].copy_from_slice(&bytes[from]);
                }
            }
            Ok(())
        });
    }

    /// `glMapBuffer`: the address, or 0.
    pub fn map_buffer(&mut self, target: u32, access: u32) -> usize {
        let flags = match access {
            enums::READ_ONLY => Ok(enums::MAP_READ_BIT),
            enums::WRITE_ONLY => Ok(enums::MAP_WRITE_BIT),
            enums::READ_WRITE => Ok(enums::MAP_READ_BIT | enums::MAP_WRITE_BIT),
            _ => Err((enums::INVALID_ENUM, "access is not one of buffers")),
        };
        let map = |buffer: &mut Buffer, memory: &dyn ClientMemory| {
            buffer.map(memory, 0, buffer.size(), flags?)
        };
        self.with_buffer("glMapBuffer", target, map).unwrap_or(0)
    }

    /// `glMapBufferRange`: the address, or 0.
    pub fn map_buffer_range(
        &mut self,
        target: u32,
        offset: isize,
        length: isize,
        access: u32,
    ) -> usize {
        let map = |buffer: &mut Buffer, memory: &dyn ClientMemory| {
            buffer.map_range(memory, offset, length, access)
        };
        self.with_buffer("glMapBufferRange", target, map).unwrap_or(0)
    }

    /// `glFlushMappedBufferRange`.
    pub fn flush_mapped_buffer_range(&mut self, target: u32, offset: isize, length: isize) {
        self.with_buffer("glFlushMappedBufferRange", target, |buffer, _| {
            buffer.flush(offset, length)
        });
    }

    /// `glUnmapBuffer`: whether the data are still good.
    pub fn unmap_buffer(&mut self, target: u32) -> u8 {
        self.with_buffer("glUnmapBuffer", target, |buffer, memory| buffer.unmap(memory))
            .is_some_and(|good| good)
            .into()
    }

    /// `glGetBufferParameteriv`.
    pub fn get_buffer_parameteriv(&mut self, target: u32, pname: u32, params: usize) {
        self.with_buffer("glGetBufferParameteriv", target, |buffer, memory| {
            let value = buffer.parameter(pname)?;
            let there = params != 0 && memory.write(params, &value.to_ne_bytes());
            if there { Ok(()) } else { Err(NOT_THERE) }
        });
    }

    /// `glGetBufferPointerv`.
    pub fn get_buffer_pointerv(&mut self, target: u32, pname: u32, params: usize) {
        self.with_buffer("glGetBufferPointerv", target, |buffer, memory| {
            if pname != enums::BUFFER_MAP_POINTER {
                return Err((enums::INVALID_ENUM, "pname is not a pointer of buffers"));
            }
            let address =
                buffer.mapping.as_ref().map_or(0, |mapping| mapping.address + mapping.offset);
            let there = params != 0 && memory.write(params, &address.to_ne_bytes());
            if there { Ok(()) } else { Err(NOT_THERE) }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{BASE, context};
    use super::*;

    const TARGET: u32 = enums::ARRAY_BUFFER;

    fn read(c: &Context, address: usize, len: usize) -> Vec<u8> {
        client::bytes(&*c.memory, address, len).unwrap()
    }

    #[test]
    fn data_go_in_and_out() {
        let mut c = context();
        c.buffer_data(TARGET, 4, BASE, enums::STATIC_DRAW);
        assert_eq!(std::mem::take(&mut c.error), enums::INVALID_OPERATION);
        c.gen_buffers(2, BASE);
        assert_eq!((read(&c, BASE, 8), c.is_buffer(1)), (vec![1, 0, 0, 0, 2, 0, 0, 0], 0));
        c.bind_buffer(TARGET, 1);
        c.buffer_data(TARGET, 8, BASE, enums::STATIC_DRAW);
        let version = |c: &Context| c.client.array_buffer.lock().unwrap().version;
        let before = version(&c);
        c.buffer_sub_data(TARGET, 2, 4, BASE + 4);
        c.get_buffer_sub_data(TARGET, 0, 8, BASE + 100);
        assert_eq!(read(&c, BASE + 100, 8), [1, 0, 2, 0, 0, 0, 0, 0]);
        assert_ne!(version(&c), before);
        assert_eq!((c.error, c.is_buffer(1)), (0, 1));
        c.buffer_sub_data(TARGET, 6, 4, BASE);
        assert_eq!(std::mem::take(&mut c.error), enums::INVALID_VALUE);
        c.buffer_data(TARGET, isize::MAX, 0, enums::STATIC_DRAW);
        assert_eq!(std::mem::take(&mut c.error), enums::OUT_OF_MEMORY);
        c.delete_buffers(1, BASE);
        assert_eq!((c.client.array_buffer.name, c.is_buffer(1)), (0, 0));
    }

    #[test]
    fn mapped_data_are_with_the_client() {
        let mut c = context();
        c.bind_buffer(TARGET, 9);
        c.buffer_data(TARGET, 8, 0, enums::STREAM_DRAW);
        let flags = enums::MAP_WRITE_BIT | enums::MAP_FLUSH_EXPLICIT_BIT;
        let address = c.map_buffer_range(TARGET, 4, 4, flags);
        assert!(c.memory.write(address, &[5; 4]));
        c.flush_mapped_buffer_range(TARGET, 0, 4);
        c.get_buffer_parameteriv(TARGET, enums::BUFFER_SIZE, BASE);
        assert_eq!((c.error, read(&c, BASE, 4)), (0, vec![8, 0, 0, 0]));
        c.flush_mapped_buffer_range(TARGET, 1, 4);
        assert_eq!(std::mem::take(&mut c.error), enums::INVALID_VALUE);
        assert_eq!(c.map_buffer(TARGET, enums::READ_ONLY), 0);
        c.get_buffer_sub_data(TARGET, 0, 1, BASE);
        assert_eq!(std::mem::take(&mut c.error), enums::INVALID_OPERATION);
        assert_eq!(c.unmap_buffer(TARGET), 1);
        assert_eq!(*c.client.array_buffer.lock().unwrap().bytes, [0, 0, 0, 0, 5, 5, 5, 5]);
        assert_eq!((c.unmap_buffer(TARGET), c.error), (0, enums::INVALID_OPERATION));
    }

    #[test]
    fn a_mapping_can_be_asked_for() {
        let mut c = context();
        c.bind_buffer(TARGET, 9);
        c.buffer_data(TARGET, 8, 0, enums::STREAM_DRAW);
        let ask = |c: &mut Context| {
            [enums::BUFFER_MAP_OFFSET, enums::BUFFER_MAP_LENGTH, enums::BUFFER_ACCESS_FLAGS].map(
                |pname| {
                    c.get_buffer_parameteriv(TARGET, pname, BASE);
                    u32::from(read(c, BASE, 4)[0])
                },
            )
        };
        assert_eq!(ask(&mut c), [0; 3]);
        let flags = enums::MAP_WRITE_BIT | enums::MAP_UNSYNCHRONIZED_BIT;
        c.map_buffer_range(TARGET, 3, 4, flags);
        assert_eq!(ask(&mut c), [3, 4, flags]);
        c.unmap_buffer(TARGET);
        assert_eq!(ask(&mut c), [0; 3]);
        c.map_buffer(TARGET, enums::READ_WRITE);
        assert_eq!(ask(&mut c), [0, 8, enums::MAP_READ_BIT | enums::MAP_WRITE_BIT]);
        assert_eq!(c.error, enums::NO_ERROR);
    }
}
