//! Calls: functions, queries at a point, random numbers.

use super::scope::{Scope, Where};
use super::typing::{Operand, article};
use super::{Checker, code};
use crate::language::diagnostic::Diagnostic;
use crate::language::expr::{Expr, ExprKind, Type};
use crate::language::ops::{self, Mismatch};
use crate::language::syntax::{self, Name, Span};

impl<'a> Checker<'a> {
    pub(super) fn function(
        &mut self,
        scope: &mut Scope<'a>,
        name: &'a Name,
        args: &'a [syntax::Expr],
        span: Span,
    ) -> Option<Operand> {
        if let Some(query) = self.query_ids.get(name.text.as_str()).copied() {
            return self.sample(scope, name, query, args, span);
        }
        let random = ["rand", "randn"].into_iter().find(|f| *f == name.text);
        // The site of a call is its place in the text, before those of its arguments.
        let site = scope.sites;
        if random.is_some() {
            scope.sites += 1;
        }
        let operands: Vec<Option<Operand>> = args.iter().map(|a| self.operand(scope, a)).collect();
        if let Some(function) = random {
            return self.random(scope, function, site, name, operands, span);
        }
        if ops::overloads(&name.text).is_empty() {
            self.unknown_function(name);
            return None;
        }
        let operands: Vec<Operand> = operands.into_iter().collect::<Option<_>>()?;
        if name.text == "noise" && scope.decides {
            let message = "`noise` decides here: CPU and GPU agree on it only within a bound";
            let warning = Diagnostic::warning(code::NOISE, span, message);
            self.report(warning.hint("modules near the threshold may go either way"));
        }
        self.operation(&name.text, operands, span)
    }

    fn unknown_function(&mut self, name: &Name) {
        let text = name.text.as_str();
        let hint = match text {
            "vec2" => Some("a vector is written `(x, y)`".to_string()),
            "vec3" => Some("a vector is written `(x, y, z)`".to_string()),
            "vec4" => Some("a vector is written `(x, y, z, w)`".to_string()),
            "lerp" => Some("it is called `mix`".to_string()),
            "select" => Some("write `if(condition, then, otherwise)`".to_string()),
            "ln" => Some("it is called `log`".to_string()),
            "random" => Some("it is called `rand`".to_string()),
            _ => {
                let functions = ops::TABLE.iter().filter(|r| !r.is_operator()).map(|r| r.name);
                self.nearest(text, functions.chain(["rand", "randn"]).chain(self.query_ids.keys().copied()))
            }
        };
        let message = format!("there is no function `{text}`");
        self.report(Diagnostic::error(code::UNKNOWN_FUNCTION, name.span, message).hint_if(hint));
    }

    pub(super) fn mismatch(&mut self, name: &str, mismatch: Mismatch, types: &[Type], span: Span) {
        let rows = ops::overloads(name);
        let operator = rows.first().is_some_and(|op| op.row().is_operator());
        let given: Vec<String> = types.iter().map(article).collect();
        let (code, message) = match mismatch {
            Mismatch::Name => (code::UNKNOWN_FUNCTION, format!("there is no function `{name}`")),
            Mismatch::Arity => {
                let mut takes: Vec<usize> = rows.iter().map(|op| op.row().args.len()).collect();
                takes.sort_unstable();
                takes.dedup();
                let takes: Vec<String> = takes.iter().map(usize::to_string).collect();
                let takes = takes.join(" or ");
                let plural = if takes == "1" { "" } else { "s" };
                let message = format!("`{name}` takes {takes} argument{plural}, not {}", types.len());
                (code::FUNCTION_ARITY, message)
            }
            Mismatch::Types if operator && given.len() == 1 => {
                (code::OPERANDS, format!("`{name}` does not stand before {}", given[0]))
            }
            Mismatch::Types if operator => {
                (code::OPERANDS, format!("`{name}` does not stand between {}", given.join(" and ")))
            }
            Mismatch::Types => (code::OPERANDS, format!("`{name}` does not take {}", given.join(", "))),
        };
        let hint = match mismatch {
            Mismatch::Name => None,
            _ if operator => {
                let logical = matches!(name, "&&" | "||" | "!");
                logical.then(|| format!("`{name}` takes bools, such as comparisons"))
            }
            _ => {
                let forms: Vec<String> = rows.iter().take(4).map(|op| format!("`{}`", op.row())).collect();
                Some(format!("it is {}", forms.join(", ")))
            }
        };
        self.report(Diagnostic::error(code, span, message).hint_if(hint));
    }

    fn random(
        &mut self,
        scope: &Scope<'a>,
        function: &'static str,
        site: usize,
        name: &Name,
        operands: Vec<Option<Operand>>,
        span: Span,
    ) -> Option<Operand> {
        if !scope.place.is_random() {
            let message = format!("`{function}` cannot stand in {}", scope.place.describe());
            let error = Diagnostic::error(code::RANDOM, name.span, message);
            self.report(error.hint("random numbers are drawn in rules, `place` and `mark`"));
            return None;
        }
        let fits = match function {
            "rand" => matches!(operands.len(), 0 | 2),
            _ => operands.is_empty(),
        };
        if !fits {
            let takes = if function == "rand" { "no argument or 2" } else { "no argument" };
            let message = format!("`{function}` takes {takes}, not {}", operands.len());
            self.report(Diagnostic::error(code::FUNCTION_ARITY, span, message));
            return None;
        }
        let mut args = Vec::with_capacity(operands.len());
        for operand in operands {
            args.push(self.coerce(operand?, &Type::Float, || "the bounds of `rand` are floats".into())?);
        }
        Operand::typed(Expr { ty: Type::Float, kind: ExprKind::Random { function, args, site }, span })
    }

    fn sample(
        &mut self,
        scope: &mut Scope<'a>,
        name: &Name,
        query: Option<usize>,
        args: &'a [syntax::Expr],
        span: Span,
    ) -> Option<Operand> {
        let query = query?;
        if matches!(scope.place, Where::Const | Where::Param | Where::Axiom | Where::Run) {
            let message = format!("the query `{}` has no value in {}", name.text, scope.place.describe());
            self.report(Diagnostic::error(code::NOT_HERE, name.span, message));
            return None;
        }
        let [point] = args else {
            let message = format!("`{}` takes one point, not {} arguments", name.text, args.len());
            self.report(Diagnostic::error(code::FUNCTION_ARITY, span, message));
            return None;
        };
        let point =
            self.expr(scope, point, &Type::Vec3, || format!("`{}` takes a point, a vec3", name.text))?;
        if self.host_bound(query) {
            let ty = self.queries[query].ty.clone();
            return Operand::typed(Expr { ty, kind: ExprKind::Sample(query, Box::new(point)), span });
        }
        let message = format!("`{}` has a value of its own and cannot be asked at a point", name.text);
        let error = Diagnostic::error(code::OPERANDS, span, message);
        self.report(error.hint(format!("bind it before the predecessor: `?{}(x)`", name.text)));
        None
    }
}
