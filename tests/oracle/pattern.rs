//! Patterns: what a module's parameters must be, and the names that they get.

use super::expression::Scope;
use super::value::{Ratio, Value};
use super::word::Param;
use burgeon::language::syntax::{Pattern, PatternArg, SignedNumber};

/// Whether the parameters fit; then `scope` holds the names that the pattern binds.
pub fn match_args(pattern: &Pattern, params: &[Param], scope: &mut Scope) -> bool {
    // A pattern without parentheses matches all parameters.
    let Some(args) = &pattern.args else { return true };
    assert_eq!(args.len(), params.len(), "arguments of `{}`", pattern.symbol.text);
    args.iter().zip(params).all(|(arg, param)| match arg {
        PatternArg::Any(_) => true,
        PatternArg::Bool(b, _) => *param == Param::Bool(*b),
        PatternArg::Number(number) => signed(number).equals(param.value()),
        PatternArg::Bind(name) => bind(&name.text, param.value(), scope),
    })
}

/// A name bound twice demands equality, of vectors component by component.
pub fn bind(name: &str, value: Value, scope: &mut Scope) -> bool {
    match (scope.bound(name), value) {
        (Some(Value::Vector(bound)), Value::Vector(value)) => *bound == value,
        (Some(bound), value) => bound.clone().equals(value),
        (None, value) => {
            scope.bound.push((name.to_string(), value));
            true
        }
    }
}

fn signed(number: &SignedNumber) -> Value {
    let value = Value::Exact(Ratio::parse(&number.number.text));
    if number.negative { value.negate() } else { value }
}
