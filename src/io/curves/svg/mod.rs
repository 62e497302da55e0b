//! Curves as `.svg`: y points up in words and down in such files, so it is turned on both ways.

mod pen;
mod read;
mod shapes;
mod style;
mod transform;
mod write;
mod wrong;

pub use read::parse;
pub use write::write;
