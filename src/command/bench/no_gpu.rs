//! In place of `gpu.rs` in a build without it.

use super::systems::Plans;
use super::{Case, Failure};
use burgeon::patch::Net;

/// There is no device in this build.
pub struct Adapter;

impl Adapter {
    pub fn open(_: Option<&str>) -> Result<Adapter, Failure> {
        Ok(Adapter)
    }
    pub fn name(&self) -> String {
        "no adapter".to_string()
    }
    pub fn cases(
        &self,
        _: &Plans,
        _: &[Net],
        _: &[Net],
        _: u32,
        _: &dyn Fn(&str) -> bool,
        _: &mut Vec<Case>,
    ) -> Result<(), Failure> {
        Ok(())
    }
}
