//! A curve that follows its control points: [`Stencils`] on a device, one dispatch a frame.

use super::kernels::{self, Binding, Bound, Kernel};
use super::{Engine, Error, buffers, warm};
use crate::affine::Stencils;
use crate::codegen;
use wgpu::BufferUsages;

/// A table of stencils, the control points, and the curve that comes of them.
///
/// Write control points ([`Stencil::set`], or a kernel of your own into [`Stencil::control`]), record a frame
/// ([`Stencil::encode`]), and draw [`Stencil::curve`] as a strip of [`Stencil::len`] vertices. Recording
/// allocates nothing, reads nothing back and waits for nothing.
#[derive(Debug)]
pub struct Stencil {
    engine: Engine,
    kernel: Kernel,
    group: wgpu::BindGroup,
    control: wgpu::Buffer,
    curve: wgpu::Buffer,
    columns: usize,
    len: u32,
}

/// What the kernel is told of the table; a uniform of 16 bytes.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Shape {
    count: u32,
    columns: u32,
    reserved: [u32; 2],
}

impl Stencil {
    /// Compiles the kernel and uploads the table.
    ///
    /// # Errors
    /// [`Error::Binding`] for a table or a curve larger than the device binds; what the device says.
    pub fn new(engine: &Engine, table: &Stencils) -> Result<Stencil, Error> {
        let make =
            |label: &'static str, bytes: usize, usage| buffers::make(engine, label, bytes as u64, usage);
        engine.checked("preparing a table of stencils", || {
            let shader = codegen::stencil_edited(&engine.tuning, engine.edit.as_ref())?;
            let bound = [Bound::Slot, Bound::Read, Bound::Read, Bound::Read, Bound::Written];
            let kernel = Kernel::with_bindings(engine, &shader, &bound, &["stencil"]);
            let (rows, weights) = (table.rows(), table.weights());
            let storage = BufferUsages::STORAGE;
            let shape_buffer = make("burgeon stencil shape", size_of::<Shape>(), BufferUsages::UNIFORM)?;
            let row_buffer = make("burgeon stencil rows", size_of_val(rows), storage)?;
            let weight_buffer = make("burgeon stencil weights", size_of_val(weights), storage)?;
            let control =
                make("burgeon control points", table.columns() * 16, storage | BufferUsages::VERTEX)?;
            let curve = make("burgeon curve", table.len() * 16, storage | BufferUsages::VERTEX)?;
            let shape =
                Shape { count: table.len() as u32, columns: table.columns() as u32, reserved: [0; 2] };
            engine.queue.write_buffer(&shape_buffer, 0, bytemuck::bytes_of(&shape));
            engine.queue.write_buffer(&row_buffer, 0, bytemuck::cast_slice(rows));
            engine.queue.write_buffer(&weight_buffer, 0, bytemuck::cast_slice(weights));
            let bindings = [&shape_buffer, &row_buffer, &weight_buffer, &control, &curve].map(Binding::whole);
            let group = kernel.bind(engine, &bindings);
            Ok(Stencil {
                engine: engine.clone(),
                kernel,
                group,
                control,
                curve,
                columns: table.columns(),
                len: table.len() as u32,
            })
        })
    }

    /// Writes all control points: x, y, z and w, which is 1 but for rational curves.
    ///
    /// # Errors
    /// [`Error::Points`] if they are not as many as the table has columns.
    pub fn set(&self, control: &[[f32; 4]]) -> Result<(), Error> {
        if control.len() != self.columns {
            return Err(Error::Points { found: control.len(), expected: self.columns });
        }
        self.engine.queue.write_buffer(&self.control, 0, bytemuck::cast_slice(control));
        Ok(())
    }

    /// Has the driver compile the kernel, and waits for it; else it may in the first frame.
    ///
    /// # Errors
    /// What the device says.
    pub fn warm_up(&self) -> Result<(), Error> {
        warm::warm(&self.engine, |encoder| self.encode(encoder))
    }

    /// Records one dispatch: the curve of the control points as they then are.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("burgeon stencil"),
            timestamp_writes: None,
        });
        let groups = kernels::groups(self.len.into(), self.engine.tuning.workgroup);
        self.kernel.record(&mut pass, &self.group, &[groups]);
    }

    /// The control points, a vec4 each: storage that kernels and copies may write, and vertices.
    pub fn control(&self) -> &wgpu::Buffer {
        &self.control
    }

    /// The curve, a vec4 a point: vertices, storage, and a source of copies.
    pub fn curve(&self) -> &wgpu::Buffer {
        &self.curve
    }

    /// Points of the curve.
    pub fn len(&self) -> u32 {
        self.len
    }

    /// No point.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The curve on the host. Waits for all that was submitted.
    ///
    /// # Errors
    /// [`Error::Lost`], or what the device says.
    pub fn read(&self) -> Result<Vec<[f32; 4]>, Error> {
        buffers::read(&self.engine, "reading a curve", &self.curve, u64::from(self.len) * 16)
    }
}
