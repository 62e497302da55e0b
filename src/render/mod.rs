//! The offscreen picture.
