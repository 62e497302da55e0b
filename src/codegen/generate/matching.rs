//! Which rule matches.

use super::Text;
use super::values::{Values, lane};
use crate::plan::code::RuleCode;
use crate::plan::tables::{MatchRule, Stage};

/// `matching_rule(m)`: the rule that fires on a module.
pub fn matching(stage: &Stage) -> Text {
    let mut text = Text::default();
    text.line("fn matching_rule(m: Record) -> u32 {");
    if stage.closed.is_some() && stage.productions.len() == 1 {
        text.line("  return 0u;");
        text.line("}");
        return text;
    }
    text.line("  switch symbol_of(m) {");
    for (symbol, ids) in stage.by_symbol.iter().enumerate() {
        let idle = stage.idle(symbol);
        if ids.is_empty() {
            continue;
        }
        text.line(format!("    case {symbol}u: {{"));
        let mut decided = false;
        for &id in ids {
            let rule = &stage.rules[id];
            try_rule(&mut text, rule, &stage.code.rules[id], idle);
            decided = stage.code.rules[id].guards.is_empty();
            if decided {
                break;
            }
        }
        if !decided {
            text.line(format!("      return {idle}u;"));
        }
        text.line("    }");
    }
    // The other symbols have no rules in this stage.
    text.line(format!("    default: {{ return {}u; }}", stage.without_rules()));
    text.line("  }");
    text.line("}");
    text
}

fn try_rule(text: &mut Text, rule: &MatchRule, code: &RuleCode, idle: u32) {
    let args = code.unchanged.iter().flatten().flatten().map(|u| u.0);
    let used = args.chain(code.guards.iter().copied()).chain(code.choice);
    let values = Values::new(text, &code.graph, used, "      ", rule.span);
    let guarded = !code.guards.is_empty();
    let mut indent = "      ".to_string();
    if guarded {
        let guards: Vec<String> = code.guards.iter().map(|&g| values.text(g)).collect();
        text.of_rule(format!("{indent}if {} {{", guards.join(" && ")), rule.span);
        indent.push_str("  ");
    }
    let first = rule.productions.start;
    let drawn = code.choice.map(|choice| values.text(choice));
    let id = match &drawn {
        None => format!("{first}u"),
        Some(drawn) => format!("{first}u + u32({drawn})"),
    };
    let unchanged = code.unchanged.iter().enumerate();
    let idle_if: Vec<String> = unchanged
        .filter_map(|(n, args)| {
            let same =
                args.as_ref()?.iter().map(|&(node, at)| format!("{} == {}", values.word(node), lane(at)));
            let drawn = drawn.iter().map(|drawn| format!("{drawn} == {n}i"));
            let all: Vec<String> = drawn.chain(same).collect();
            Some(if all.is_empty() { "true".to_string() } else { format!("({})", all.join(" && ")) })
        })
        .collect();
    match idle_if.is_empty() {
        true => text.of_rule(format!("{indent}return {id};"), rule.span),
        false => {
            let line = format!("{indent}return select({id}, {idle}u, {});", idle_if.join(" || "));
            text.of_rule(line, rule.span);
        }
    }
    if guarded {
        text.line("      }");
    }
}
