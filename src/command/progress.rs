//! The bar on a terminal: steps done, modules so far, bytes; then which file is written.

use super::counted;
use burgeon::plan::Progress;
use indicatif::{HumanBytes, ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::path::Path;
use std::time::{Duration, Instant};

/// What is done sooner shows no bar.
const PATIENCE: Duration = Duration::from_millis(300);

/// A bar on stderr, or nothing where that is no terminal.
pub struct Bar {
    bar: ProgressBar,
    start: Instant,
}

impl Bar {
    pub fn new() -> Bar {
        // Where stderr is no terminal indicatif draws nothing either; this saves the work, too.
        let bar = if std::io::stderr().is_terminal() { ProgressBar::new(0) } else { ProgressBar::hidden() };
        let bar = Bar { bar, start: Instant::now() };
        // Until there is something to show.
        bar.style("{wide_msg}");
        bar
    }

    /// A step is done.
    pub fn step(&self, p: Progress) {
        if self.waits() {
            return;
        }
        let message = format!("{}, {}", counted(p.modules, "module"), HumanBytes(p.bytes));
        self.style("step {pos}/{len} [{bar:30}] {wide_msg}");
        self.bar.update(|state| {
            state.set_len(p.of as u64);
            state.set_pos(p.step as u64);
        });
        self.bar.set_message(message);
    }

    /// A file is being written.
    pub fn writing(&self, path: &Path) {
        self.doing(&format!("writing {}", path.display()));
    }

    /// Something without steps.
    pub fn doing(&self, what: &str) {
        if !self.waits() {
            self.style("{wide_msg}");
            self.bar.set_message(what.to_string());
        }
    }

    /// One of so many cases begins.
    #[cfg_attr(not(feature = "gpu"), expect(dead_code))]
    pub fn case(&self, n: usize, of: usize, name: &str) {
        if self.waits() {
            return;
        }
        self.style("case {pos}/{len} [{bar:30}] {wide_msg}");
        self.bar.update(|state| {
            state.set_len(of as u64);
            state.set_pos(n as u64);
        });
        self.bar.set_message(name.to_string());
    }

    /// What `work` prints stands above the bar.
    #[cfg_attr(not(feature = "gpu"), expect(dead_code))]
    pub fn above<T>(&self, work: impl FnOnce() -> T) -> T {
        self.bar.suspend(work)
    }

    /// A message above the bar.
    pub fn say(&self, text: &str) {
        self.bar.suspend(|| super::say(text));
    }

    /// Takes the bar away, so that text can follow.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }

    fn waits(&self) -> bool {
        self.bar.is_hidden() || self.start.elapsed() < PATIENCE
    }

    fn style(&self, template: &str) {
        if let Ok(style) = ProgressStyle::with_template(template) {
            self.bar.set_style(style.progress_chars("=> "));
        }
    }
}
