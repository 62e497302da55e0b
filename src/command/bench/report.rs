//! The figures, for people and for programs.

use super::gpu::Adapter;
use super::{Case, ROUNDS, threads};
use crate::command::counted;

pub(super) fn of<'c, 'a>(cases: &'c [Case<'a>], name: &str, backend: &str) -> Option<&'c Case<'a>> {
    cases.iter().find(|c| c.name == name && c.backend == backend)
}

pub(super) fn table(adapter: &Adapter, cases: &[Case]) -> String {
    let mut text = format!(
        "{}; {}; medians of {ROUNDS} rounds\n\n",
        adapter.name(),
        counted(threads() as u64, "thread")
    );
    text.push_str(&format!(
        "{:13} {:44} {:7} {:>10} {:>8} {:>11} {:>8}\n",
        "name", "case", "backend", "ms", "GB/s", "M items/s", "of copy"
    ));
    for c in cases {
        let copy = of(cases, "copy", c.backend).map_or(0.0, Case::bytes_per_second);
        let (rate, share) = match c.bytes {
            0 => (String::new(), String::new()),
            _ => (
                format!("{:.2}", c.bytes_per_second() / 1e9),
                format!("{:.0} %", 100.0 * c.bytes_per_second() / copy.max(1.0)),
            ),
        };
        text.push_str(&format!(
            "{:13} {:44} {:7} {:>10.3} {:>8} {:>11.2} {:>8}\n",
            c.name,
            c.case,
            c.backend,
            c.median() * 1e3,
            rate,
            c.items as f64 / c.median().max(1e-12) / 1e6,
            share,
        ));
    }
    text
}

pub(super) fn json(adapter: &Adapter, cases: &[Case]) -> String {
    let copy = |backend| of(cases, "copy", backend).map(|c| c.bytes_per_second() / 1e9);
    let results: Vec<_> = cases
        .iter()
        .map(|c| {
            serde_json::json!({
                "name": c.name, "case": c.case, "backend": c.backend, "threads": c.threads,
                "median_ms": c.median() * 1e3, "min_ms": c.least() * 1e3, "runs": c.times.len(),
                "bytes": c.bytes, "items": c.items,
            })
        })
        .collect();
    let all = serde_json::json!({
        "adapter": adapter.name(),
        "copy_gb_s": { "cpu": copy("cpu"), "gpu": copy("gpu") },
        "results": results,
    });
    format!("{all}\n")
}
