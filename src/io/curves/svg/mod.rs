//! Curves as `.svg`: y points up in words and down in such files, so it is turned on both ways.

mod read;
mod write;

pub use read::parse;
pub use write::write;
