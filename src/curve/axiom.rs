//! The axiom of a curve system: its modules, read from where the system says.

use super::polyline::{Note, Polyline, notes};
use crate::language::expr::{Expr, Type, Value};
use crate::language::system::{self, CurveSource, CurveStart, Hang, System};
use crate::word::{AxiomError, chosen};

/// The parts of a word, in order.
#[derive(Clone, Debug, Default)]
pub struct Axiom {
    pub parts: Vec<Part>,
    /// What became of the curves of its files, with the name of each file.
    pub notes: Vec<(String, Note)>,
}

/// Modules from one source, of which the one at `shift` comes first.
#[derive(Clone, Debug)]
pub struct Part {
    pub modules: Vec<Root>,
    /// The module at the end of its axis; none if it has nothing but branches.
    pub exit: Option<usize>,
    /// Of type int, over uniforms.
    pub shift: Option<Expr>,
}

/// A module of the axiom.
#[derive(Clone, Debug)]
pub struct Root {
    /// Index into the system's symbols.
    pub symbol: usize,
    /// One for each field; they read uniforms at most.
    pub args: Vec<Expr>,
    /// What it hangs on, in its part; what hangs on nothing of the part hangs on the axis of the part before.
    pub hang: Hang,
}

impl Axiom {
    /// Resolves the sources of a curve system; `read` gives the curves of a file by its name. All of them are one part of
    /// the word; a closed one comes back to its first point where the word is no ring.
    ///
    /// # Errors
    /// What `read` says; an index beyond the file's curves; no axiom; a source that is a system; a coordinate that is not
    /// finite.
    pub fn load<E: std::fmt::Display>(
        system: &System,
        read: &mut dyn FnMut(&str) -> Result<Vec<Polyline>, E>,
    ) -> Result<Axiom, AxiomError<E>> {
        let system::Axiom::Curve(starts) = &system.axiom else {
            let message =
                format!("{} has no axiom of a curve: write `axiom: P((0, 0)) P((1, 0))`", system.name);
            return Err(AxiomError::Wrong { message, span: system.source.name.span });
        };
        let (mut parts, mut notes): (Vec<Part>, Vec<(String, Note)>) = Default::default();
        for start in starts {
            match start {
                CurveStart::Word(word) => {
                    let root = |(m, &hang): (&system::Module, &Hang)| Root {
                        symbol: m.symbol,
                        args: m.args.clone(),
                        hang,
                    };
                    let modules = word.modules.iter().zip(&word.hangs).map(root).collect();
                    parts.push(Part { modules, exit: word.exit(), shift: None });
                }
                CurveStart::Points { symbol, args, source, shift, span } => {
                    let points = points(system, source, read, &mut notes)?;
                    let fields = &system.symbols[*symbol].fields;
                    let module = |(n, point): (usize, &[f32; 4])| {
                        let arg = |(arg, field): (&Option<Expr>, &system::Field)| match arg {
                            Some(arg) => arg.clone(),
                            None => Expr::literal(of_type(point, &field.ty), *span),
                        };
                        let hang = Hang { on: n.checked_sub(1), slot: n as u32, ..Hang::default() };
                        Root { symbol: *symbol, args: args.iter().zip(fields).map(arg).collect(), hang }
                    };
                    if let Some(n) = points.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
                        let message = format!("point {n} of the axiom is not finite: {:?}", points[n]);
                        return Err(AxiomError::Wrong { message, span: *span });
                    }
                    let modules = points.iter().enumerate().map(module).collect();
                    let exit = points.len().checked_sub(1);
                    parts.push(Part { modules, exit, shift: shift.clone() });
                }
                CurveStart::System { span, .. } => return Err(AxiomError::of_system(*span)),
            }
        }
        Ok(Axiom { parts, notes })
    }

    /// Modules in all.
    pub fn len(&self) -> usize {
        self.parts.iter().map(|part| part.modules.len()).sum()
    }

    /// No module at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

fn points<E: std::fmt::Display>(
    system: &System,
    source: &CurveSource,
    read: &mut dyn FnMut(&str) -> Result<Vec<Polyline>, E>,
    said: &mut Vec<(String, Note)>,
) -> Result<Vec<[f32; 4]>, AxiomError<E>> {
    match source {
        CurveSource::Inline(points) => Ok(points.iter().map(coordinates).collect()),
        CurveSource::System { span, .. } => Err(AxiomError::of_system(*span)),
        CurveSource::File { path, index, span } => {
            let mut curves = read(path).map_err(AxiomError::Source)?;
            if let Some(index) = index {
                curves = vec![chosen(curves, *index, ("curve", path), *span)?];
            }
            said.extend(notes(system, path, &curves, true).into_iter().map(|note| (path.clone(), note)));
            Ok(curves.into_iter().flat_map(|curve| curve.into_word(&system.kind)).collect())
        }
    }
}

fn coordinates(point: &Value) -> [f32; 4] {
    match *point {
        Value::Vec2([x, y]) => [x, y, 0.0, 1.0],
        Value::Vec3([x, y, z]) => [x, y, z, 1.0],
        Value::Vec4(p) => p,
        // The checker takes lists of vectors alone.
        _ => [0.0, 0.0, 0.0, 1.0],
    }
}

fn of_type(&[x, y, z, w]: &[f32; 4], ty: &Type) -> Value {
    match ty {
        Type::Vec2 => Value::Vec2([x, y]),
        Type::Vec3 => Value::Vec3([x, y, z]),
        _ => Value::Vec4([x, y, z, w]),
    }
}
