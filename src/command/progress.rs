//! The bar on a terminal: steps done, modules so far, bytes; then what is made of them and which file is written.

use super::counted;
use burgeon::plan::Progress;
use indicatif::{HumanBytes, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::cell::Cell;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// What is done sooner shows no bar.
const PATIENCE: Duration = Duration::from_millis(300);

/// Between two looks of what counts fast.
const TICK: Duration = Duration::from_millis(100);

const STEPS: &str = "step {pos}/{len} [{bar:30}] {wide_msg}";
const CASES: &str = "case {pos}/{len} [{bar:30}] {wide_msg}";
/// Of something that has no steps: it turns, and says for how long the command runs.
const ALONE: &str = "{spinner} {elapsed} {wide_msg}";

/// A bar on stderr, or nothing where that is no terminal.
pub struct Bar {
    bar: ProgressBar,
    on_terminal: bool,
    style: Cell<&'static str>,
    /// When the message was last changed.
    last: Cell<Option<Instant>>,
}

impl Bar {
    pub fn new() -> Bar {
        let on_terminal = std::io::stderr().is_terminal();
        let bar = ProgressBar::with_draw_target(Some(0), ProgressDrawTarget::hidden());
        if on_terminal {
            let bar = bar.clone();
            // It must show itself: who works for long reports nothing until that is done.
            std::thread::spawn(move || {
                std::thread::sleep(PATIENCE);
                if !bar.is_finished() {
                    bar.set_draw_target(ProgressDrawTarget::stderr());
                    bar.enable_steady_tick(TICK);
                }
            });
        }
        let bar = Bar { bar, on_terminal, style: Cell::new(""), last: Cell::new(None) };
        // Until there is something to show.
        bar.show(ALONE, None, String::new());
        bar
    }

    /// A step is done.
    pub fn step(&self, p: Progress) {
        if self.is_due() {
            let message = format!("{}, {}", counted(p.modules, "module"), HumanBytes(p.bytes));
            self.show(STEPS, Some([p.step as u64, p.of as u64]), message);
        }
    }

    /// So many bytes of a file are written.
    pub fn writing(&self, name: &str, bytes: u64) {
        if bytes == 0 {
            self.doing(&format!("writing {name}"));
        } else if self.is_due() {
            self.show(ALONE, None, format!("writing {name}, {}", HumanBytes(bytes)));
        }
    }

    /// Something without steps begins.
    pub fn doing(&self, what: &str) {
        self.show(ALONE, None, what.to_string());
    }

    /// One of so many cases begins.
    #[cfg_attr(not(feature = "gpu"), expect(dead_code))]
    pub fn case(&self, n: usize, of: usize, name: &str) {
        self.show(CASES, Some([n as u64, of as u64]), name.to_string());
    }

    /// What `work` prints stands above the bar.
    pub fn above<T>(&self, work: impl FnOnce() -> T) -> T {
        self.bar.suspend(work)
    }

    /// A message above the bar.
    pub fn say(&self, text: &str) {
        self.above(|| super::say(text));
    }

    /// Takes the bar away, so that text can follow.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }

    /// Whether what counts fast is to be shown again; else not even its text is made.
    fn is_due(&self) -> bool {
        self.on_terminal && self.last.get().is_none_or(|last| last.elapsed() >= TICK)
    }

    fn show(&self, template: &'static str, counts: Option<[u64; 2]>, message: String) {
        if !self.on_terminal {
            return;
        }
        self.last.set(Some(Instant::now()));
        if self.style.replace(template) != template
            && let Ok(style) = ProgressStyle::with_template(template)
        {
            self.bar.set_style(style.progress_chars("=> "));
        }
        if let Some([at, of]) = counts {
            self.bar.update(|state| {
                state.set_len(of);
                state.set_pos(at);
            });
        }
        self.bar.set_message(message);
    }
}

/// However the command ends, no bar stays on the terminal.
impl Drop for Bar {
    fn drop(&mut self) {
        self.clear();
    }
}
