//! What frames say of themselves, known to the host when it comes, without waiting.

use super::{Engine, buffers};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

/// Two buffers that take turns to carry a status to the host.
pub(super) struct Report<T> {
    carriers: [Carrier; 2],
    last: Arc<Mutex<Option<T>>>,
}

struct Carrier {
    buffer: wgpu::Buffer,
    /// On its way, or recorded and not yet submitted.
    busy: Arc<AtomicBool>,
}

/// Frees a carrier when its message has come, or its encoder was dropped.
struct Free(Arc<AtomicBool>);

impl Drop for Free {
    fn drop(&mut self) {
        self.0.store(false, Ordering::Release);
    }
}

impl<T: bytemuck::Pod + Send> Report<T> {
    const BYTES: u64 = size_of::<T>() as u64;

    pub fn new(engine: &Engine) -> Report<T> {
        let carrier = || Carrier {
            buffer: buffers::staging(engine, Self::BYTES),
            busy: Arc::new(AtomicBool::new(false)),
        };
        Report { carriers: [carrier(), carrier()], last: Arc::new(Mutex::new(None)) }
    }

    /// Records that the status is to be told; not if both carriers are under way.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder, status: &wgpu::Buffer) {
        let free = |c: &&Carrier| !c.busy.swap(true, Ordering::AcqRel);
        let Some(carrier) = self.carriers.iter().find(free) else { return };
        encoder.copy_buffer_to_buffer(status, 0, &carrier.buffer, 0, Self::BYTES);
        let (free, last, buffer) = (Free(carrier.busy.clone()), self.last.clone(), carrier.buffer.clone());
        encoder.map_buffer_on_submit(&carrier.buffer, wgpu::MapMode::Read, .., move |mapped| {
            if mapped.is_ok() {
                if let Ok(view) = buffer.get_mapped_range(..)
                    && let Ok(mut last) = last.lock()
                {
                    *last = Some(bytemuck::pod_read_unaligned(&view));
                }
                buffer.unmap();
            }
            drop(free);
        });
    }

    pub fn last(&self) -> Option<T> {
        *self.last.lock().ok()?
    }
}
