//! The params of a system, for whoever sets them.

use super::expr::{Type, Value};
use super::system::{System, UniformKind};
use std::fmt;

/// A value that can be set from outside without compiling anything anew. It prints as a rule file declares it, without
/// the word `param`.
#[derive(Clone, Debug, PartialEq)]
pub struct Param<'a> {
    pub name: &'a str,
    pub ty: &'a Type,
    pub default: &'a Value,
    /// The least and the greatest value, if the declaration has a range.
    pub range: Option<(&'a Value, &'a Value)>,
}

impl fmt::Display for Param<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Param { name, ty, default, range } = self;
        write!(f, "{name}: {ty} = {default}")?;
        range.map_or(Ok(()), |(low, high)| write!(f, " in {low} .. {high}"))
    }
}

impl System {
    /// The params that the system reads, its own and those above the systems of the file, in the order of the text:
    /// what [`Options::set`](crate::plan::Options::set) may name.
    ///
    /// ```
    /// use burgeon::language::{System, Type, Value};
    ///
    /// let system = System::parse(
    ///     "param depth: int = 3 in 0 .. 9
    ///      system s : patch bezier 3
    ///      param bend: float = 0.25
    ///      module P(n: int)
    ///      rules:
    ///        P(n) : n < depth && bend > 0 -> [ P(n+1) P(n+1) ; P(n+1) P(n+1) ]",
    /// )?;
    /// let params: Vec<_> = system.params().collect();
    /// assert_eq!((params[0].name, params[0].ty, params[0].default), ("depth", &Type::Int, &Value::Int(3)));
    /// assert_eq!(params[0].range, Some((&Value::Int(0), &Value::Int(9))));
    /// assert_eq!(params[1].to_string(), "bend: float = 0.25");
    /// # Ok::<(), burgeon::language::Diagnostics>(())
    /// ```
    pub fn params(&self) -> impl Iterator<Item = Param<'_>> {
        let mut declared: Vec<_> = self.uniforms.iter().collect();
        declared.sort_by_key(|uniform| uniform.span.start);
        declared.into_iter().filter_map(|uniform| match &uniform.kind {
            UniformKind::Param { default, range } => Some(Param {
                name: &uniform.name,
                ty: &uniform.ty,
                default,
                range: range.as_ref().map(|(low, high)| (low, high)),
            }),
            UniformKind::Derived(_) => None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn params_print_as_they_are_declared() {
        let text = "param a: int = -2 in -4 .. 4\nparam b: float = 1/3 in 0 .. 1e9\nparam c: bool = true\n\
                    param d: vec2 = (1, 0.5) in (0, 0) .. (2, 1)\nparam e: vec4 = (0, 1e-6, 0, 1)\n";
        let rules = "module P\nrules:\n  P : a > 0 && b > 0 && c && d.x > 0 && e.x > 0 -> [ P | P ]\n";
        let system = System::parse(&format!("{text}system s : patch bezier 3\n{rules}")).expect("a system");
        let printed: Vec<String> = system.params().map(|param| param.to_string()).collect();
        let expected = [
            "a: int = -2 in -4 .. 4",
            "b: float = 0.33333334 in 0 .. 1e9",
            "c: bool = true",
            "d: vec2 = (1, 0.5) in (0, 0) .. (2, 1)",
            "e: vec4 = (0, 1e-6, 0, 1)",
        ];
        assert_eq!(printed, expected);
        // What is printed can be read.
        let again: String = printed.iter().map(|param| format!("param {param}\n")).collect();
        let again = System::parse(&format!("{again}system s : patch bezier 3\n{rules}")).expect("a system");
        assert!(again.params().eq(system.params()));
    }
}
