//! Buffers to be used again, and reading back.

use super::{Engine, Error};
use std::sync::mpsc;
use wgpu::BufferUsages;

/// A buffer from the pool; it may be larger than what was asked for.
#[derive(Clone, Debug)]
pub struct Pooled {
    pub buffer: wgpu::Buffer,
}

/// Storage buffers that are not in use. wgpu fills the bound range of a fresh buffer with zeros on
/// first use, at a fraction of the memory's speed, so buffers are kept for the next step.
#[derive(Debug, Default)]
pub struct Pool {
    free: Vec<wgpu::Buffer>,
}

/// Buffers kept at most: two chunks in, out and finished, and the columns of a step.
const KEPT: usize = 16;

impl Pool {
    /// A storage buffer of at least `bytes`.
    ///
    /// # Errors
    /// As [`make`].
    pub fn take(&mut self, engine: &Engine, label: &'static str, bytes: u64) -> Result<Pooled, Error> {
        let bytes = bytes.max(16).next_multiple_of(16);
        let fits = |b: &wgpu::Buffer| b.size() >= bytes && b.size() <= 2 * bytes.max(1 << 16);
        let smallest =
            (0..self.free.len()).filter(|&i| fits(&self.free[i])).min_by_key(|&i| self.free[i].size());
        let buffer = match smallest {
            Some(i) => self.free.swap_remove(i),
            None => storage(engine, label, rounded(bytes, &engine.device.limits()))?,
        };
        Ok(Pooled { buffer })
    }

    /// Back to the pool. What was recorded with it runs before whatever is recorded later.
    pub fn give(&mut self, pooled: Pooled) {
        self.free.push(pooled.buffer);
        if self.free.len() > KEPT {
            let least = (0..self.free.len()).min_by_key(|&i| self.free[i].size()).unwrap_or(0);
            self.free.swap_remove(least);
        }
    }
}

/// Some more than asked for, so that buffers of steps of nearly one size serve each other.
fn rounded(bytes: u64, limits: &wgpu::Limits) -> u64 {
    let step = (bytes.next_power_of_two() / 8).max(256);
    bytes.next_multiple_of(step).min(most_bytes(limits, BufferUsages::STORAGE)).max(bytes)
}

/// Bytes of the largest buffer of this usage. Storage is bound whole; uniforms may be slots of a larger buffer.
fn most_bytes(limits: &wgpu::Limits, usage: BufferUsages) -> u64 {
    match usage.contains(BufferUsages::STORAGE) {
        true => limits.max_buffer_size.min(limits.max_storage_buffer_binding_size),
        false => limits.max_buffer_size,
    }
}

/// A buffer of at least so many bytes, which can be copied both ways: every one whose size depends on the rules, the
/// axiom or the caller.
///
/// # Errors
/// [`Error::Binding`] where the device binds less.
pub fn make(
    engine: &Engine,
    label: &'static str,
    bytes: u64,
    usage: BufferUsages,
) -> Result<wgpu::Buffer, Error> {
    let size = bytes.max(16).next_multiple_of(16);
    let most = most_bytes(&engine.device.limits(), usage);
    if size > most {
        return Err(Error::Binding { buffer: label, needed: size, most });
    }
    Ok(engine.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: usage | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    }))
}

/// One that kernels read and write.
///
/// # Errors
/// As [`make`].
pub fn storage(engine: &Engine, label: &'static str, bytes: u64) -> Result<wgpu::Buffer, Error> {
    make(engine, label, bytes, BufferUsages::STORAGE)
}

/// A uniform of these words, bound whole.
///
/// # Errors
/// [`Error::Uniforms`] where the device binds less.
pub fn uniform(engine: &Engine, label: &'static str, words: &[u32]) -> Result<wgpu::Buffer, Error> {
    let bytes = 4 * words.len() as u64;
    fits_uniform(engine, bytes)?;
    let buffer = make(engine, label, bytes, BufferUsages::UNIFORM)?;
    engine.queue.write_buffer(&buffer, 0, bytemuck::cast_slice(words));
    Ok(buffer)
}

/// # Errors
/// [`Error::Uniforms`] where the device binds fewer bytes of uniforms.
pub fn fits_uniform(engine: &Engine, bytes: u64) -> Result<(), Error> {
    let most = engine.device.limits().max_uniform_buffer_binding_size;
    match bytes > most {
        true => Err(Error::Uniforms { needed: bytes, most }),
        false => Ok(()),
    }
}

/// Where results are mapped for the host.
pub fn staging(engine: &Engine, bytes: u64) -> wgpu::Buffer {
    engine.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("burgeon staging"),
        size: bytes,
        usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// Waits for all that was submitted and hands the staging buffer's first `bytes` to `look`.
pub fn mapped<T>(
    engine: &Engine,
    doing: &'static str,
    staging: &wgpu::Buffer,
    bytes: u64,
    look: impl FnOnce(&[u8]) -> T,
) -> Result<T, Error> {
    let (send, receive) = mpsc::channel();
    staging.map_async(wgpu::MapMode::Read, 0..bytes, move |result| {
        // Nobody listens only if the wait below has failed.
        let _ = send.send(result.is_ok());
    });
    let waited = engine.device.poll(wgpu::PollType::wait_indefinitely());
    if waited.is_err() || !receive.try_recv().unwrap_or(false) {
        return Err(Error::Lost { doing });
    }
    let view = staging.get_mapped_range(0..bytes).map_err(|_| Error::Lost { doing })?;
    let result = look(&view);
    drop(view);
    staging.unmap();
    Ok(result)
}

/// Pieces in which large buffers are read.
const PIECE: u64 = 64 << 20;

/// The first `bytes` of a buffer, as values of `T`.
pub fn read<T: bytemuck::Pod>(
    engine: &Engine,
    doing: &'static str,
    buffer: &wgpu::Buffer,
    bytes: u64,
) -> Result<Vec<T>, Error> {
    read_from(engine, doing, buffer, 0, bytes)
}

/// So many bytes of a buffer from `start` on.
pub fn read_from<T: bytemuck::Pod>(
    engine: &Engine,
    doing: &'static str,
    buffer: &wgpu::Buffer,
    start: u64,
    bytes: u64,
) -> Result<Vec<T>, Error> {
    engine.checked(doing, || {
        let mut values = Vec::with_capacity(bytes as usize / size_of::<T>());
        let staging = staging(engine, bytes.clamp(16, PIECE));
        let mut at = 0;
        while at < bytes {
            let piece = PIECE.min(bytes - at);
            let label = wgpu::CommandEncoderDescriptor { label: Some("burgeon read") };
            let mut encoder = engine.device.create_command_encoder(&label);
            encoder.copy_buffer_to_buffer(buffer, start + at, &staging, 0, piece);
            engine.queue.submit([encoder.finish()]);
            mapped(engine, doing, &staging, piece, |bytes| {
                values.extend(bytes.chunks_exact(size_of::<T>()).map(bytemuck::pod_read_unaligned::<T>));
            })?;
            at += piece;
        }
        Ok(values)
    })
}
