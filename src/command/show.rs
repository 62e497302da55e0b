//! `burgeon check` and `burgeon wgsl`.

use super::load::Source;
use super::{Failure, flags, print, say};
use burgeon::codegen::{self, Tuning};
use burgeon::language::system::{Kind, System};
use burgeon::language::{Diagnostic, Severity};
use burgeon::plan::Plan;
use burgeon::plan::derive::StageId;

/// Everything that is wrong with a rule file.
pub fn check(flags: &flags::Check) -> Result<(), Failure> {
    let source = Source::read(&flags.file)?;
    let mut list = source.checked.diagnostics.clone();
    let mut notes = Vec::new();
    for system in &source.checked.systems {
        match compiled(&source, system) {
            Ok(Some(note)) => notes.push(note),
            Ok(None) => {}
            Err(d) => list.push(d),
        }
    }
    if list.iter().any(|d| d.severity == Severity::Error) {
        return Err(Failure::File(source.render(&list)));
    }
    if !list.is_empty() {
        say(&source.render(&list));
    }
    let names: Vec<&str> = source.checked.systems.iter().map(|s| s.name.as_str()).collect();
    let mut text = match names.as_slice() {
        [] => format!("{}: no system\n", flags.file.display()),
        names => format!("{}: {} checked\n", flags.file.display(), names.join(", ")),
    };
    notes.iter().for_each(|n| text.push_str(n));
    print(&text)
}

/// Compiles what is derived, and says what is not; then whether the axiom's files fit.
fn compiled(source: &Source, system: &System) -> Result<Option<String>, Diagnostic> {
    if !matches!(system.kind, Kind::Patch { .. }) {
        return Ok(Some(format!("  {}: this version checks it and does not derive it\n", system.name)));
    }
    let plan = match Plan::new(system) {
        Ok(plan) => plan,
        Err(e) => return Ok(Some(format!("  {}: {e}\n", system.name))),
    };
    for id in stages(&plan) {
        if let Err(e) = codegen::stage(&plan, id, &Tuning::GPU) {
            let span = e.rule.unwrap_or(system.source.name.span);
            return Err(Diagnostic::error("E0403", span, e.to_string()));
        }
    }
    // A file that is not there is no fault of the rules; one that is there is read.
    match super::load::axiom(source, system, None) {
        Err(Failure::File(text)) => Ok(Some(format!("  {}: {}\n", system.name, text.trim_end()))),
        _ => Ok(None),
    }
}

fn stages(plan: &Plan) -> Vec<StageId> {
    let sets = plan.tables.rule_sets.iter().enumerate();
    sets.flat_map(|(rule_set, set)| (0..set.stages.len()).map(move |stage| StageId { rule_set, stage })).collect()
}

/// The WGSL of every stage, then of the kernels that know only the layout.
pub fn wgsl(flags: &flags::Wgsl) -> Result<(), Failure> {
    let source = Source::read(&flags.system.file)?;
    source.refuse_errors()?;
    let system = source.system(flags.system.system.as_deref())?;
    let plan = Plan::new(system).map_err(|e| source.unsupported(&e))?;
    let failed = |e: codegen::Error| Failure::File(format!("error: {e}"));
    let mut text = String::new();
    let mut add = |title: String, shader: &codegen::Shader| {
        text.push_str(&format!("// ==== {} {title}\n\n{}\n", shader.name, shader.source));
    };
    for id in stages(&plan) {
        let groups = &plan.tables.rule_sets[id.rule_set].groups;
        let names: Vec<&str> = groups.iter().map(|&g| system.groups[g].name.as_str()).collect();
        let with = names.join(", ");
        let title = format!("(rules {}stage {})", if with.is_empty() { with } else { with + ", " }, id.stage + 1);
        let shaders = codegen::stage(&plan, id, &Tuning::GPU).map_err(failed)?;
        for shader in [&shaders.match_modules, &shaders.count, &shaders.emit] {
            add(title.clone(), shader);
        }
    }
    let shared = codegen::shared(&plan.tables.layout, &Tuning::GPU).map_err(failed)?;
    for shader in [&shared.scan, &shared.compact, &shared.retire] {
        add("(all systems)".to_string(), shader);
    }
    print(&text)
}
