//! The beginning of a frame: of a tolerance that was raised as much is given back as the triangles of the
//! frame before leave room for.

use crate::tessellate::budget::{Budget, raised};

/// Gives back what there is room for; all of it without a budget.
pub fn begin(limit: u32, budget: &mut Budget) {
    let mut back = budget.coarser;
    if limit != 0 {
        // With some room to spare, or the next frame takes it back.
        back = 0;
        while back < budget.coarser && budget.triangles as f32 * (raised(back + 1) * 1.125) <= limit as f32 {
            back += 1;
        }
    }
    budget.coarser -= back;
    budget.fits = 0;
}
