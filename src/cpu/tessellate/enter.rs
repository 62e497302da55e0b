//! The table in which the leaves of a word are found.

use crate::tessellate::lattice::Node;
use crate::tessellate::word::Table;

/// The table of these leaves.
pub fn enter(leaves: &[Node]) -> Table {
    Table::new(leaves)
}
