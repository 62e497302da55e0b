//! Where the next level begins: behind the nodes of the one that was split.

use super::Trees;

/// Moves on to the level that was just made.
pub fn advance(trees: &mut Trees) {
    trees.level = trees.children.len();
}
