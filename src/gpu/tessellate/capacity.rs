//! How much room a frame has.

use crate::tessellate::passes::Status;

/// Room for a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Capacity {
    /// Cells of all levels: 44 bytes each.
    pub nodes: u32,
    pub vertices: u32,
    /// Three a triangle; each triangle takes 4 bytes more for its cell.
    pub indices: u32,
    /// Modules of the longest word on the way, where rules are derived with the frame; else no matter.
    pub modules: u32,
}

impl Capacity {
    /// For about so many vertices: a third more nodes, twice as many triangles, and words of as many modules.
    pub fn for_vertices(vertices: u32) -> Capacity {
        let nodes = vertices.saturating_add(vertices / 3).saturating_add(64);
        Capacity { nodes, vertices, indices: vertices.saturating_mul(6), modules: vertices }
    }

    /// For what a frame wanted.
    pub fn of(status: &Status) -> Capacity {
        Capacity {
            nodes: status.nodes,
            vertices: status.vertices,
            indices: status.indices,
            modules: status.modules,
        }
    }

    /// For what a frame wanted, and no less of anything than it had. Where nodes or modules were too few it is not
    /// known how many there would have been, so twice as many are taken at least.
    pub fn grown(status: &Status) -> Capacity {
        // What comes behind something that found no room is not counted.
        let grown = |needed: u32, there: u32| match needed > there {
            true => needed.max(there.saturating_mul(2)),
            false => there,
        };
        Capacity {
            nodes: grown(status.nodes, status.node_capacity),
            vertices: status.vertices.max(status.vertex_capacity),
            indices: status.indices.max(status.index_capacity),
            modules: grown(status.modules, status.module_capacity),
        }
    }

    /// Half as much again of everything: for what grows from frame to frame, so that not each frame wants new room.
    pub fn half_more(self) -> Capacity {
        let more = |n: u32| n.saturating_add(n / 2);
        Capacity {
            nodes: more(self.nodes),
            vertices: more(self.vertices),
            indices: more(self.indices),
            modules: more(self.modules),
        }
    }
}
