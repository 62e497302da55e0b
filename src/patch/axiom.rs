//! The axiom of a patch system: its roots, read from where the system says.

use super::Net;
use crate::language::Expr;
use crate::language::Span;
use crate::language::system::{self, PatchSource, PatchStart, System};
use crate::word::{AxiomError, chosen};

/// The roots in order.
#[derive(Clone, Debug)]
pub struct Axiom {
    pub roots: Vec<Root>,
}

/// One root: a module of the axiom.
#[derive(Clone, Debug)]
pub struct Root {
    /// Index into the system's symbols.
    pub symbol: usize,
    /// One for each field; they read uniforms at most.
    pub args: Vec<Expr>,
    pub net: Net,
}

impl Axiom {
    /// Resolves the sources of a patch system; `read` gives the nets of a file by its name.
    ///
    /// # Errors
    /// What `read` says; an index beyond the file's patches; no axiom; a source that is a system; a
    /// coordinate of a net written out that its weight takes beyond the range of f32.
    pub fn load<E: std::fmt::Display>(
        system: &System,
        read: &mut dyn FnMut(&str) -> Result<Vec<Net>, E>,
    ) -> Result<Axiom, AxiomError<E>> {
        let system::Axiom::Patches(starts) = &system.axiom else {
            let message =
                format!("{} has no axiom of patches: write `axiom: P = file \"….bpt\"`", system.name);
            return Err(AxiomError::Wrong { message, span: system.source.name.span });
        };
        let mut roots = Vec::new();
        for start in starts {
            for net in nets(system, start, read)? {
                roots.push(Root { symbol: start.symbol, args: start.args.clone(), net });
            }
        }
        Ok(Axiom { roots })
    }
}

fn nets<E: std::fmt::Display>(
    system: &System,
    start: &PatchStart,
    read: &mut dyn FnMut(&str) -> Result<Vec<Net>, E>,
) -> Result<Vec<Net>, AxiomError<E>> {
    let wrong = |message: String, span: &Span| Err(AxiomError::Wrong { message, span: *span });
    match &start.source {
        PatchSource::Inline { points, .. } => {
            let system::Kind::Patch { degree, .. } = system.kind else {
                return wrong(format!("{} is no patch system", system.name), &start.span);
            };
            let mut net = Net { degree, points: points.clone() };
            for (point, p) in net.points.iter_mut().enumerate() {
                let written = *p;
                for (axis, x) in p[..3].iter_mut().enumerate() {
                    // As a reader of files does it: rounded once.
                    *x = (f64::from(written[axis]) * f64::from(written[3])) as f32;
                    if !x.is_finite() {
                        let (name, from, weight) = (["x", "y", "z"][axis], written[axis], written[3]);
                        let what = format!(
                            "{name} of point {point} of this net, {from:e}, times its weight, {weight:e}"
                        );
                        return wrong(format!("{what}, is beyond the range of 32-bit floats"), &start.span);
                    }
                }
            }
            Ok(vec![net])
        }
        PatchSource::File { path, index, span } => {
            let nets = read(path).map_err(AxiomError::Source)?;
            match index {
                None => Ok(nets),
                Some(index) => Ok(vec![chosen(nets, *index, ("patch", path), *span)?]),
            }
        }
        PatchSource::System { span, .. } => Err(AxiomError::of_system(*span)),
    }
}
