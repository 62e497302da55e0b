//! Whether the triangles of a round keep to the budget; else the tolerance is raised by as much as they are
//! too many.

use crate::tessellate::budget::{Budget, MOST_RAISED, raised};

/// Looks at the triangles of the round that ran.
pub fn afford(limit: u32, triangles: u32, budget: &mut Budget) {
    if budget.fits != 0 {
        return;
    }
    budget.triangles = triangles;
    if triangles <= limit {
        budget.fits = 1;
        return;
    }
    let mut more = 1;
    while more < MOST_RAISED && (limit as f32) * raised(more) < triangles as f32 {
        more += 1;
    }
    budget.coarser = (budget.coarser + more).min(MOST_RAISED);
}
