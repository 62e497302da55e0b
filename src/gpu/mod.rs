//! The GPU engine: the passes of [`crate::plan::step`] as compute kernels on a borrowed device.
//!
//! The engine owns no device and no queue: it is made from the caller's, needs no feature and only
//! WebGPU's default limits, and waits nowhere but where it reads.

mod backend;
mod buffers;
mod headless;
mod kernels;
pub mod refine;
mod report;
pub mod run;
mod scans;
mod stencil;
mod sweep;
pub mod tessellate;
mod warm;

pub use backend::{Gpu, GpuChunk, derive};
pub use headless::{Headless, Requirement, adapters, adapters_in, is_hardware};
pub use scans::{Bandwidth, Measure, ScanBuffers, Scans};
pub use stencil::Stencil;

use crate::codegen::{self, Tuning};
use crate::plan;

/// What can go wrong on a device.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Plan(#[from] plan::Error),
    #[error("burgeon generated a kernel that naga refuses: {0}")]
    Codegen(#[from] codegen::Error),
    /// A validation error, or memory that the device does not have.
    #[error("{doing}: {message}")]
    Device { doing: &'static str, message: String },
    #[error("{doing}: the device was lost; make a new one and run again")]
    Lost { doing: &'static str },
    /// A buffer of the caller's is too small; nothing was written past its end.
    #[error("{buffer} holds {capacity} modules and {needed} are needed")]
    Capacity { buffer: &'static str, needed: u64, capacity: u64 },
    #[error("{0}")]
    NoAdapter(String),
    /// More room was asked for than the device binds in one piece; nothing was made.
    #[error("the buffer of {buffer} would take {needed} bytes; the device binds {most} at most")]
    Binding { buffer: &'static str, needed: u64, most: u64 },
    /// What expressions read beside a module is bound as one uniform; nothing was made.
    #[error(
        "the values that rules read (params, consts with their lists, numbers of the rules) take {needed} bytes; \
         the device binds {most} of uniforms at most: write shorter lists, or derive on the CPU"
    )]
    Uniforms { needed: u64, most: u64 },
    #[error(transparent)]
    Level(#[from] crate::tessellate::LevelError),
    #[error(transparent)]
    Patches(#[from] crate::tessellate::topology::Error),
    #[error(transparent)]
    Word(#[from] crate::tessellate::word::Error),
    /// Buffers of the caller's that do not hold a slab, or may not be written.
    #[error("{0}")]
    Slab(String),
    #[error(transparent)]
    Mesh(#[from] crate::mesh::TopologyError),
    #[error("{found} positions where the mesh has {expected} vertices")]
    Vertices { found: usize, expected: usize },
    #[error("there are no rules: make the tessellation of a system (Tessellator::of_rules)")]
    NoRules,
    #[error("{found} control points where the patches have {expected}")]
    Points { found: usize, expected: usize },
    #[error(
        "a mesh is read from vertices in the default format: position, normal and uv as interleaved floats"
    )]
    Format,
}

/// The engine: a device, its queue, and the sizes that suit it.
#[derive(Clone, Debug)]
pub struct Engine {
    device: wgpu::Device,
    queue: wgpu::Queue,
    tuning: Tuning,
    edit: Option<codegen::Edit>,
    kept: Option<kernels::Kept>,
}

impl Engine {
    /// An engine on the caller's device.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Engine {
        let tuning = match device.adapter_info().device_type {
            wgpu::DeviceType::Cpu => Tuning::CPU_DRIVER,
            _ => Tuning::GPU,
        };
        Engine::with_tuning(device, queue, tuning)
    }

    /// The same with sizes of the caller's choice; no result depends on them.
    pub fn with_tuning(device: &wgpu::Device, queue: &wgpu::Queue, tuning: Tuning) -> Engine {
        Engine { device: device.clone(), queue: queue.clone(), tuning, edit: None, kept: None }
    }

    /// This engine with other sizes.
    pub fn retuned(&self, tuning: Tuning) -> Engine {
        Engine { tuning, ..self.clone() }
    }

    /// The engine with a kernel broken on purpose: how the tests are tested.
    #[doc(hidden)]
    pub fn with_edit(self, edit: codegen::Edit) -> Engine {
        Engine { edit: Some(edit), ..self }
    }

    /// The engine, which keeps every kernel that it makes, and gives it to all that ask for the same one, to its clones
    /// too: tests make the same kernels hundreds of times.
    #[doc(hidden)]
    pub fn keeping_kernels(self) -> Engine {
        Engine { kept: Some(Default::default()), ..self }
    }

    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }
    pub fn tuning(&self) -> &Tuning {
        &self.tuning
    }

    /// Runs `work` within error scopes: a validation error or a lack of memory becomes an error.
    fn checked<T>(&self, doing: &'static str, work: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
        let filters =
            [wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Validation, wgpu::ErrorFilter::Internal];
        let scopes = filters.map(|f| self.device.push_error_scope(f));
        let result = work();
        // The innermost scope was pushed last.
        let mut found = None;
        for scope in scopes.into_iter().rev() {
            found = pollster::block_on(scope.pop()).or(found);
        }
        match found {
            Some(_) if self.is_lost() => Err(Error::Lost { doing }),
            Some(error) => Err(Error::Device { doing, message: error.to_string() }),
            None => result,
        }
    }

    /// A device tells of its loss through one callback, which is the caller's to set. Without it:
    /// what is made on a lost device is invalid, and using that is an error.
    fn is_lost(&self) -> bool {
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        buffers::staging(self, 16).map_async(wgpu::MapMode::Read, .., |_| {});
        pollster::block_on(scope.pop()).is_some()
    }
}
