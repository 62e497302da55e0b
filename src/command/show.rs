//! `burgeon check` and `burgeon wgsl`.

use super::axiom::{self, AxiomError};
use super::source::{Loaded, Source, params};
use super::{Failure, counted, flags, print, say};
use burgeon::codegen::{self, Tessellation, Tuning};
use burgeon::language::system::{Axiom, System};
use burgeon::language::{Diagnostic, Severity};
use burgeon::plan::tables::RulesOf;
use burgeon::plan::{Placement, Plan};

/// Everything that is wrong with a rule file.
pub fn check(flags: &flags::Check) -> Result<(), Failure> {
    let source = Source::read(&flags.file)?;
    let mut list = source.checked.diagnostics.clone();
    let mut failures = Vec::new();
    let mut lines = Vec::new();
    for system in &source.checked.systems {
        let made = compiled(&source, system, &mut list);
        match made {
            Ok(note) => lines.push(format!("{}: {note}\n{}", system.name, params(system))),
            Err(Wrong::Rules(d)) => list.push(d),
            Err(Wrong::Other(failure)) => failures.push(failure),
        }
    }
    if list.iter().any(|d| d.severity == Severity::Error) {
        failures.insert(0, Failure::File(source.render(&list)));
    } else if !list.is_empty() {
        say(&source.render(&list));
    }
    super::joined(failures)?;
    match lines.as_slice() {
        [] => print(&format!("{}: no system\n", flags.file.display())),
        lines => print(&lines.concat()),
    }
}

/// What keeps a system from being derived, but for what this version does not do.
enum Wrong {
    Rules(Diagnostic),
    Other(Failure),
}

/// Compiles what is derived, and says what is not; then whether the axiom's files fit.
fn compiled(source: &Source, system: &System, warnings: &mut Vec<Diagnostic>) -> Result<String, Wrong> {
    let plan = match Plan::new(system) {
        Ok(plan) => plan,
        Err(e) => return Ok(format!("checked; {e}, line {}", source.line(e.span))),
    };
    if let Some((rule, derive)) = plan.without_end() {
        let message = "no word is ever terminal: this rule, or one beside it, fires in every step";
        let warning = Diagnostic::warning("W0401", rule, message);
        warnings.push(
            warning
                .label(derive, "this makes as many steps as `max` says")
                .hint("write `derive n` for n steps, or a condition that ends it, as in `A(n) : n > 0 -> …`"),
        );
    }
    for id in plan.stages() {
        if let Err(e) = codegen::stage(&plan, id, &Tuning::GPU) {
            let span = e.rule.unwrap_or(system.source.name.span);
            return Err(Wrong::Rules(Diagnostic::error("E0403", span, e.to_string())));
        }
    }
    if let Some(placement) = &plan.placement
        && let Err(e) = vertices(&plan, placement)
    {
        return Err(Wrong::Rules(Diagnostic::error("E0403", placement.span, e.to_string())));
    }
    if matches!(system.axiom, Axiom::None) {
        return Ok("checked and compiled; `run` needs an axiom".to_string());
    }
    match axiom::axiom(source, system, None, true) {
        Ok(axiom) => {
            axiom.notes.iter().for_each(|note| say(&format!("note: {note}")));
            Ok(format!("checked and compiled, {}", counted(axiom.value.roots() as u64, "root")))
        }
        // The rules may be right where the file is not there yet.
        Err(AxiomError::Missing(d)) => Ok(format!("checked and compiled; {}", d.message)),
        Err(AxiomError::Rules(d)) => Err(Wrong::Rules(d)),
        Err(AxiomError::Other(failure)) => Err(Wrong::Other(failure)),
    }
}

/// The kernel of the vertices that the placement displaces.
fn vertices(plan: &Plan, placement: &Placement) -> Result<codegen::Shader, codegen::Error> {
    let (degree, rational) = (plan.tables.layout.net.unwrap_or_default(), plan.rational());
    let what = Tessellation { degree, rational, word: true, derived: false, options: Default::default() };
    codegen::vertices(&what, Some(placement), &Tuning::GPU, None)
}

/// The WGSL of every stage and of the placement, then of the kernels that know only the layout.
pub fn wgsl(flags: &flags::Wgsl) -> Result<(), Failure> {
    let loaded = Loaded::read(&flags.system)?;
    let plan = loaded.plan(Plan::new)?;
    let system = &loaded.system;
    let failed = |e: codegen::Error| Failure::File(format!("error: {e}"));
    let mut text = String::new();
    let mut add = |title: String, shader: &codegen::Shader| {
        text.push_str(&format!("// ---- {} {title}\n\n{}\n", shader.name, shader.source));
    };
    for id in plan.stages() {
        let with = match &plan.tables.rule_sets[id.rule_set].of {
            RulesOf::Groups(groups) => {
                let names: Vec<&str> = groups.iter().map(|&g| system.groups[g].name.as_str()).collect();
                names.join(", ")
            }
            RulesOf::Trace(into) => format!("of trace into {}", plan.tables.symbols[*into].name),
        };
        let of = if with.is_empty() { system.name.clone() } else { format!("{}, rules {with}", system.name) };
        let title = format!("of {of}, stage {}", id.stage + 1);
        let shaders = codegen::stage(&plan, id, &Tuning::GPU).map_err(failed)?;
        for shader in &shaders {
            add(title.clone(), shader);
        }
    }
    if let Some(placement) = &plan.placement {
        let shader = vertices(&plan, placement).map_err(failed)?;
        add(format!("of {}, place {}", system.name, placement.name), &shader);
    }
    for shader in codegen::shared(&plan, &Tuning::GPU).map_err(failed)? {
        add("of any system".to_string(), &shader);
    }
    print(&text)
}
