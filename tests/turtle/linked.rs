//! Words with links, whose records are made by hand: trees, several curves, rings.

use super::accuracy::{Exact, Moves, layout, plan, random, records};
use burgeon::cpu::turtle_linked::turtle_linked;
use burgeon::plan::layout::{LATERAL, NONE};
use burgeon::plan::turtle::ROW_WORDS;

/// A word, and what each module hangs on.
struct Linked {
    name: &'static str,
    moves: Moves,
    links: Vec<u32>,
    ring: bool,
}

fn words() -> Vec<Linked> {
    let mut next = random(7);
    let mut moves = |n: usize| -> Moves {
        (0..n)
            .map(|_| match next() % 10 {
                0..4 => ('F', (next() % 8) as f32 / 4.0),
                4..9 => (['+', '-', '&', '^', '/', '\\'][next() as usize % 6], (next() % 400) as f32),
                _ => ('!', (next() % 5) as f32),
            })
            .collect()
    };
    let mut draw = random(99);
    let chain = |n: u32| (0..n).map(|i| i.checked_sub(1).unwrap_or(NONE)).collect::<Vec<u32>>();
    let mut ring = chain(100);
    ring[0] = 99;
    let mut tree = |n: u32, near: u32| -> Vec<u32> {
        let link = |i: u32| match i {
            0 => NONE,
            _ => (i - 1 - draw() % near.min(i)) | if draw().is_multiple_of(2) { LATERAL } else { 0 },
        };
        (0..n).map(link).collect()
    };
    let deep = tree(1000, 3);
    let mut forest = tree(777, 100);
    forest.iter_mut().step_by(50).for_each(|link| *link = NONE);
    forest.iter_mut().skip(1).step_by(60).for_each(|link| *link = NONE | LATERAL);
    let linked = |name, moves, links, ring| Linked { name, moves, links, ring };
    vec![
        linked("one module", vec![('F', 2.0)], vec![NONE], false),
        linked("one module of a ring", vec![('F', 2.0)], vec![0], true),
        linked("a chain", moves(65), chain(65), false),
        linked("a ring", moves(100), ring, true),
        linked("a star", moves(300), std::iter::once(NONE).chain([0; 299]).collect(), false),
        linked("a deep tree", moves(1000), deep, false),
        linked("a forest", moves(777), forest, false),
    ]
}

impl Linked {
    fn records(&self) -> Vec<u32> {
        let layout = layout(true);
        let mut records = records(&self.moves, &layout);
        let link = layout.link.expect("a link");
        for (record, &to) in records.chunks_exact_mut(layout.record_words).zip(&self.links) {
            record[link] = to;
        }
        records
    }

    /// The states in f64, from each module to its root.
    fn exact(&self) -> Vec<Exact> {
        let mut states: Vec<Exact> = Vec::new();
        let mut rows = Vec::new();
        for (&module, link) in self.moves.iter().zip(&self.links) {
            let parent = (link & !LATERAL) as usize;
            let before = states.get(parent).copied().unwrap_or(Exact::START);
            let state = before.then(module);
            rows.push(if self.ring { before } else { state });
            states.push(state);
        }
        rows
    }

    /// Where rows are not the exact states.
    fn difference(&self, rows: &[u32]) -> Option<String> {
        let exact = self.exact();
        let size = exact.iter().flat_map(|s| s.position).fold(1.0, |a: f64, x| a.max(x.abs()));
        for (i, (row, state)) in rows.chunks_exact(ROW_WORDS).zip(&exact).enumerate() {
            let [x, y, z, width] = [0, 1, 2, 3].map(|k| f64::from(f32::from_bits(row[k])));
            let near = [x, y, z].iter().zip(state.position).all(|(a, b)| (a - b).abs() <= 2e-5 * size);
            if !near || width != state.drawn {
                let wanted = (state.position, state.drawn);
                return Some(format!("{}, module {i}: {:?}, not {wanted:?}", self.name, (x, y, z, width)));
            }
        }
        (rows.len() != exact.len() * ROW_WORDS).then(|| format!("{}: {} words", self.name, rows.len()))
    }
}

#[test]
fn words_with_links_are_traced_along_them() {
    for word in words() {
        let layout = layout(true);
        let mut rows = vec![0; word.moves.len() * ROW_WORDS];
        turtle_linked(&plan(word.ring, &layout), &layout, &word.records(), &mut rows);
        assert_eq!(word.difference(&rows), None);
    }
}

/// A plan that traces, its layout with links.
pub fn linked_plan(ring: bool) -> burgeon::plan::Plan {
    let topology = if ring { "ring" } else { "open" };
    let text = format!("system s : curve {topology}\nmodule P(v: vec3)\naxiom: F\nrun:\n  trace into P\n");
    let system = burgeon::language::System::parse(&text).expect("a system");
    let mut plan = burgeon::plan::Plan::new(&system).expect("a plan");
    let tables = std::sync::Arc::make_mut(&mut plan.tables);
    tables.lay_out(layout(true));
    tables.turtle = super::accuracy::plan(ring, &tables.layout);
    plan
}

/// Where a device traces words with links otherwise.
#[cfg(feature = "gpu")]
pub fn difference(engine: &burgeon::gpu::Engine) -> Option<String> {
    use burgeon::plan::derive::StageId;
    for word in words() {
        let plan = linked_plan(word.ring);
        let rows = burgeon::gpu::Gpu::new(engine, &plan)
            .and_then(|mut gpu| gpu.turtle_rows(StageId { rule_set: 0, stage: 0 }, word.records()));
        match rows {
            Err(e) => return Some(e.to_string()),
            Ok(rows) => {
                if let Some(difference) = word.difference(&rows) {
                    return Some(difference);
                }
            }
        }
    }
    None
}
