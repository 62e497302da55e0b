//! Scan and compaction by themselves, and the kernels that measure a device.

use super::buffers::{self};
use super::kernels::{self, Binding, Kernel};
use super::{Engine, Error};
use crate::codegen;
use crate::plan::columns::Stored;
use crate::plan::step::{Column, Extent, Pass};

/// Prefix sums and stream compaction over u32 on a device, for tests and benches.
pub struct Scans {
    engine: Engine,
    kernels: [Kernel; 2],
    extent: wgpu::Buffer,
}

/// Buffers of one scan or compaction.
pub struct ScanBuffers {
    pub source: wgpu::Buffer,
    pub out: wgpu::Buffer,
    pub sums: wgpu::Buffer,
    count: u64,
    group: wgpu::BindGroup,
}

/// Which of the two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    Scan,
    /// The indices of the elements that equal this.
    Compact {
        wanted: u32,
    },
}

impl Scans {
    pub fn new(engine: &Engine) -> Result<Scans, Error> {
        engine.checked("compiling scan and compact", || {
            let shaders = codegen::scans(engine.tuning(), engine.edit.as_ref())?;
            let kernel = |pass: Pass, shader| {
                let row = pass.row();
                Kernel::new(engine, shader, &row.bindings().collect::<Vec<_>>(), row.entries)
            };
            Ok(Scans {
                kernels: [kernel(Pass::Scan, &shaders[0]), kernel(Pass::Compact, &shaders[1])],
                extent: uniform(engine),
                engine: engine.clone(),
            })
        })
    }

    fn kernel(&self, what: Measure) -> &Kernel {
        match what {
            Measure::Scan => &self.kernels[0],
            Measure::Compact { .. } => &self.kernels[1],
        }
    }

    /// Uploads `source`.
    pub fn prepare(&self, what: Measure, source: &[u32]) -> Result<ScanBuffers, Error> {
        let engine = &self.engine;
        engine.checked("preparing a scan", || {
            let count = source.len() as u64;
            let tiles = count.div_ceil(engine.tuning.tile() as u64);
            let buffer = |label, bytes: u64| buffers::storage(engine, label, bytes);
            let (input, out) =
                (buffer("burgeon scan source", count * 4)?, buffer("burgeon scan out", count * 4 + 4)?);
            let sums = buffer("burgeon scan sums", tiles * 4 + 4)?;
            engine.queue.write_buffer(&input, 0, bytemuck::cast_slice(source));
            let wanted = if let Measure::Compact { wanted } = what { wanted } else { 0 };
            let extent = Extent { count: count as u32, wanted, ..Extent::default() };
            engine.queue.write_buffer(&self.extent, 0, bytemuck::bytes_of(&extent));
            let extent = Binding::new(&self.extent, size_of::<Extent>() as u64);
            let whole = |b: &'_ wgpu::Buffer| b.size();
            let group = self.kernel(what).bind(
                engine,
                &[
                    extent,
                    Binding::new(&input, whole(&input)),
                    Binding::new(&out, whole(&out)),
                    Binding::new(&sums, whole(&sums)),
                ],
            );
            Ok(ScanBuffers { source: input, out, sums, count, group })
        })
    }

    /// Runs it and waits. The buffers must be those that were prepared last.
    pub fn run(&self, what: Measure, buffers: &ScanBuffers) -> Result<(), Error> {
        let groups = kernels::scan_groups(buffers.count, self.engine.tuning.tile());
        run_and_wait(&self.engine, self.kernel(what), &buffers.group, &groups)
    }

    /// What came of it: the offsets with the total behind them, or the indices.
    pub fn read(&self, what: Measure, buffers: &ScanBuffers) -> Result<Vec<u32>, Error> {
        let tiles = buffers.count.div_ceil(self.engine.tuning.tile() as u64);
        let sums = buffers::read::<u32>(&self.engine, "reading a scan", &buffers.sums, tiles * 4 + 4)?;
        let total = sums[tiles as usize];
        match what {
            Measure::Scan if buffers.count == 0 => Ok(vec![total]),
            Measure::Scan => {
                buffers::read(&self.engine, "reading a scan", &buffers.out, buffers.count * 4 + 4)
            }
            Measure::Compact { .. } if total == 0 => Ok(Vec::new()),
            Measure::Compact { .. } => {
                buffers::read(&self.engine, "reading a compaction", &buffers.out, total as u64 * 4)
            }
        }
    }
}

fn uniform(engine: &Engine) -> wgpu::Buffer {
    engine.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("burgeon extent"),
        size: size_of::<Extent>() as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

fn run_and_wait(
    engine: &Engine,
    kernel: &Kernel,
    group: &wgpu::BindGroup,
    groups: &[[u32; 2]],
) -> Result<(), Error> {
    engine.checked("running a kernel", || {
        let mut encoder = engine
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("burgeon measure") });
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("burgeon measure"),
                timestamp_writes: None,
            });
            kernel.record(&mut pass, group, groups);
        }
        engine.queue.submit([encoder.finish()]);
        match engine.device.poll(wgpu::PollType::wait_indefinitely()) {
            Ok(_) => Ok(()),
            Err(_) => Err(Error::Lost { doing: "running a kernel" }),
        }
    })
}

/// The copy and expand kernels over `count` vec4 read: what the device's memory gives.
pub struct Bandwidth {
    engine: Engine,
    kernels: [Kernel; 2],
    groups: [wgpu::BindGroup; 2],
    count: u64,
}

impl Bandwidth {
    /// Buffers for `count` vec4 in and `growth` times as many out: 1 to copy, 4 to expand.
    pub fn new(engine: &Engine, count: u64, growth: u64) -> Result<Bandwidth, Error> {
        engine.checked("preparing the copy kernel", || {
            let shaders = codegen::measures(engine.tuning())?;
            let bindings = [
                (Column::Extent, false),
                (Column::Before(Stored::Nets), false),
                (Column::After(Stored::Nets), true),
            ];
            let kernels = [
                Kernel::new(engine, &shaders[0], &bindings, &["copy"]),
                Kernel::new(engine, &shaders[1], &bindings, &["expand"]),
            ];
            let extent = uniform(engine);
            let counts = Extent { count: count as u32, ..Extent::default() };
            engine.queue.write_buffer(&extent, 0, bytemuck::bytes_of(&counts));
            let source = buffers::storage(engine, "burgeon copy source", count * 16)?;
            let out = buffers::storage(engine, "burgeon copy out", growth * count * 16)?;
            let bound = [
                Binding::new(&extent, size_of::<Extent>() as u64),
                Binding::new(&source, count * 16),
                Binding::new(&out, growth * count * 16),
            ];
            let groups = [kernels[0].bind(engine, &bound), kernels[1].bind(engine, &bound)];
            Ok(Bandwidth { engine: engine.clone(), kernels, groups, count })
        })
    }

    /// Copies and waits: reads and writes 16 bytes an element.
    pub fn copy(&self) -> Result<(), Error> {
        self.run(0)
    }
    /// Expands and waits: reads 16 and writes 64 bytes an element.
    pub fn expand(&self) -> Result<(), Error> {
        self.run(1)
    }

    fn run(&self, which: usize) -> Result<(), Error> {
        let groups = [kernels::groups(self.count, self.engine.tuning.workgroup)];
        run_and_wait(&self.engine, &self.kernels[which], &self.groups[which], &groups)
    }
}
