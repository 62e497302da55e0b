//! The tests, tested: every kernel broken on purpose must show.
//!
//! A row of [`MUTANTS`] replaces a text in a file of `wgsl/`, once. The comparison with the CPU, or
//! the scans by themselves, must then find a difference. A row whose text is no longer there fails
//! as well, so the table follows the kernels. Mutants that change no result are not listed: another
//! order of independent writes, a bounds check that the buffer's own end repeats.

use crate::{degrees, device, mutants, tier};
use burgeon::codegen::{GENERATED, Mapping, Tuning};
use burgeon::conformance::systems::{WIDE, WRITTEN};
use burgeon::conformance::{self, Compared, Outcome, Trouble, scans};
use burgeon::gpu::{self, Engine};
use burgeon::plan::compare::{Pair, PairError};
use burgeon::plan::derive::{collect, derive};

/// How a mutant is looked for: systems and scans of the conformance suite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Check {
    /// `every` in chunks.
    Every,
    /// `closed`, `mixed`: growth as a closed form.
    Closed,
    /// `deep`, `deep_closed`: addresses to the last bit and beyond.
    Deep,
    /// Workgroups in two dimensions.
    Wide,
    /// `values`: elementary functions, random numbers and weights.
    Values,
    /// Infinities and what is not a number, in every operation on floats.
    Specials,
    /// `measures`: attributes, values of the host, a view.
    Measured,
    /// Nets with more rows than columns, and with fewer.
    Degrees,
    /// Scan and compaction by themselves.
    Scans,
    /// These with workgroups in two dimensions.
    WideScans,
}

/// A mutant: the file, the text, what stands in its place, and the check that must see it.
type Mutant = (&'static str, &'static str, &'static str, Check);

use Check::*;

const MATCHING: &[Mutant] = &[
    ("match_modules", "if i >= extent.count", "if i + 1u >= extent.count", Every),
    ("match_modules", "if rule < KEEP", "if rule <= KEEP", Every),
    ("match_modules", "rule < KEEP", "rule < 1u", Every),
    ("match_modules", "if rule > KEEP", "if rule >= KEEP", Every),
    ("match_modules", "1u << (symbol_of(m) & 31u)", "2u << (symbol_of(m) & 31u)", Every),
    ("match_modules", "atomicStore(&status.too_deep, 1u)", "atomicStore(&status.too_deep, 0u)", Deep),
    ("match_modules", "rule_word(rule) & 3u", "rule_word(rule) & 0u", Deep),
    ("count", "i < extent.count", "i + 1u < extent.count", Every),
    ("count", ">> 8u", ">> 7u", Every),
    ("count", "& 255u", "& 3u", Every),
    ("rules", "RULE_TABLE + rule", "RULE_TABLE + rule + 1u", Every),
    ("rules", "if ONLY_RULE_WORD != 0u", "if ONLY_RULE_WORD == 0u", Closed),
    ("rules", "return ONLY_RULE_WORD;", "return ONLY_RULE_WORD & 0xfffffffdu;", Closed),
    (
        "rules",
        "fn uniform_word(at: u32) -> u32 {\n  let quad = environment[at >> 2u];",
        "fn uniform_word(at: u32) -> u32 {\n  let quad = environment[at >> 3u];",
        Every,
    ),
    ("ops", "select(b, 1i, undefined)", "select(b, 2i, undefined)", Every),
    ("ops", "a - int_div(a, b) * b", "a + int_div(a, b) * b", Every),
    ("ops", "return 0i;", "return 1i;", Every),
    ("extent", "id.y * groups.x", "id.y * groups.y", Wide),
    ("extent", "id.x + id.y", "id.x - id.y", Wide),
    (GENERATED, "rule * CELLS + c", "rule * CELLS + (c ^ 1u)", Every),
    (GENERATED, "{ return m; }", "{ return r; }", Every),
    (GENERATED, " && ", " || ", Every),
    (GENERATED, "return select(", "return max(3u, 1u) + 0u * select(", Every),
];

const MEASURING: &[Mutant] = &[
    ("measure", "if i >= extent.count", "if i + 1u >= extent.count", Measured),
    ("measure", "extent.given + i * MEASURED", "i * MEASURED", Measured),
    ("measure", "sum += points[k];", "sum += points[k - 1u];", Measured),
    ("measure", "return sum / f32(POINTS);", "return sum / f32(POINTS - 1u);", Measured),
    ("measure", "let c01 = points[COLUMNS - 1u];", "let c01 = points[COLUMNS];", Measured),
    ("measure", "(c10 - c00) * u;", "(c10 - c00) * u * u;", Measured),
    ("measure", "f32(j) / f32(COLUMNS - 1u)", "f32(j) / f32(COLUMNS)", Measured),
    ("measure", "points[k + 2u * stride]", "points[k + 3u * stride]", Measured),
    ("measure", "- 2u, COLUMNS, COLUMNS)", "- 2u, COLUMNS, 1u)", Measured),
    ("measure", "bend(ROWS, max(COLUMNS, 2u) - 2u, 1u)", "bend(1u, max(COLUMNS, 2u) - 2u, 1u)", Measured),
    ("measure", "a.y * b.z - a.z * b.y", "a.y * b.z + a.z * b.y", Measured),
    ("measure", "return sum * 0.5;", "return sum;", Measured),
    ("measure", "clip.xy / clip.w", "clip.xy", Measured),
    ("measure", "if clip.w > 0.0", "if clip.w > -100.0", Measured),
    ("measure", "if before == 0u", "if before == POINTS", Measured),
    ("measure", "select(GREATEST, -1.0, before == POINTS)", "-1.0", Measured),
    ("measure", "greatest.x - least.x, greatest.y - least.y", "greatest.x - least.x, 0.0", Measured),
    ("measure", "abs(a.x * b.y - a.y * b.x)", "a.x * b.y - a.y * b.x", Measured),
    ("measure", "2u * index + 1u", "2u * index", Measured),
    ("measure", "(126u - halvings)", "(127u - halvings)", Measured),
    ("measure", "m.q1.y, m.q0.x >> 24u", "m.q1.x, m.q0.x >> 24u", Measured),
    ("attributes", "extent.given + m.index", "m.index", Measured),
    ("attributes", "m.index * MEASURED", "m.index", Measured),
    ("attributes", "max(extent.given, 1u) - 1u", "max(extent.given, 9u) - 9u", Measured),
];

const ELEMENTARY: &[Mutant] = &[
    ("elementary", "n * 1.5703125", "n * 1.56", Values),
    ("elementary", "0.16666655", "0.16", Values),
    ("elementary", "1.0 - z * (0.5", "1.0 - z * (0.6", Values),
    ("elementary", "t.x == 2.0", "t.x == 1.0", Values),
    ("elementary", "(y * power_of_two(half))", "(y * power_of_two(n))", Values),
    ("elementary", "e -= 1.0", "e -= 2.0", Values),
    ("elementary", "select(y, -y, x < 0.0)", "select(y, -y, x > 0.0)", Values),
    ("elementary", "0xc2b2ae35u", "0xc2b2ae37u", Values),
    ("elementary", "h >> 13u", "h >> 14u", Values),
    ("elementary", "(middle >> 16u)", "(middle >> 15u)", Values),
    ("elementary", "f32(h >> 8u)", "f32(h >> 9u)", Values),
    ("elementary", "(h >> 16u) + (h & 0xffffu)", "(h >> 16u) + (h & 0x7fffu)", Values),
    ("elementary", "t * 6.0 - 15.0", "t * 6.0 - 14.0", Values),
    ("elementary", "(h & 2u) == 0u", "(h & 4u) == 0u", Values),
    (GENERATED, "extent.seed", "extent.run_step", Values),
];

const NUMBERS: &[Mutant] = &[
    ("numbers", "magnitude(x) > INFINITE", "magnitude(x) >= INFINITE", Specials),
    ("numbers", "magnitude(x) >= INFINITE", "magnitude(x) > INFINITE", Specials),
    ("numbers", "(-2147483647i - 1i) - b", "b", Specials),
    ("numbers", "x < y && x >= -0x7f800000i && y <= 0x7f800000i", "x < y", Specials),
    ("numbers", "x <= y && x >= -0x7f800000i && y <= 0x7f800000i", "x <= y", Specials),
    ("numbers", "&& abs(x) <= 0x7f800000i", "", Specials),
    ("numbers", "select(a, b, is_less(b, a))", "select(b, a, is_less(a, b))", Specials),
    ("numbers", "select(a, b, is_less(a, b))", "select(b, a, is_less(b, a))", Specials),
    ("numbers", "i32(is_less(0.0, x)) - i32", "i32(is_at_most(0.0, x)) - i32", Specials),
    ("numbers", "is_special(b) && sign_bit(a) != sign_bit(b)", "false", Specials),
    ("numbers", "special_sum(a, negative_of(b))", "special_sum(a, b)", Specials),
    ("numbers", " || magnitude(a) == 0u || magnitude(b) == 0u {", " {", Specials),
    ("numbers", "select(INFINITE, 0u, is_special(b))", "INFINITE", Specials),
    (
        "numbers",
        "if has_fraction(x) {\n    return floor",
        "if !has_fraction(x) {\n    return floor",
        Specials,
    ),
    ("numbers", "magnitude(x) < 0x4b000000u", "magnitude(x) < 0x3f800000u", Specials),
    ("numbers", "return 0i;", "return 1i;", Specials),
    ("elementary", "is_less(1.0, x) == is_less(0.0, y)", "is_less(1.0, x)", Specials),
    ("elementary", "y = far_off(given_y)", "y = given_y", Specials),
    ("elementary", "x = far_off(given_x)", "x = given_x", Specials),
    ("elementary", "select(1.5707964, -1.5707964, sign_bit(x) != 0u)", "1.5707964", Specials),
    ("elementary", "is_at_most(x, bitcast<f32>(0x7f7fffffu))", "true", Specials),
];

const ADDRESSES: &[Mutant] = &[
    ("address", "m.q0.x & 0xffffu", "m.q0.x & 0x1u", Every),
    ("address", "return max(", "return min(", Every),
    ("cell", "var high = m.q0.z;", "var high = m.q0.w;", Deep),
    ("cell", "let su = halves & 1u;", "let su = halves >> 1u;", Every),
    ("cell", "(hu << sv) | hv", "(hv << sv) | hu", Every),
    ("cell", "(64u - du - dv)", "(63u - du - dv)", Every),
    ("cell", "if shift >= 32u", "if shift > 32u", Deep),
    ("cell", "shift - 32u", "shift - 31u", Every),
    ("cell", "if shift == 31u", "if shift == 30u", Deep),
    ("cell", "bits >> 1u", "bits", Deep),
    ("cell", "(m.q1.x << su) | hu", "(m.q1.x << su) | hv", Every),
    ("cell", "(m.q1.y << sv) | hv", "(m.q1.y << su) | hv", Every),
    ("cell", "(du << 16u) | (dv << 24u)", "(dv << 16u) | (du << 24u)", Every),
    ("address", "const MAX_HALVINGS = 31u;", "const MAX_HALVINGS = 30u;", Deep),
    ("address", "+ (halves >> 1u) > MAX_HALVINGS", "+ (halves >> 1u) >= MAX_HALVINGS", Deep),
];

/// Of the mapping of emit that takes an invocation a net.
const NETS: &[Mutant] = &[
    ("emit", "if i >= extent.count", "if i + 1u >= extent.count", Every),
    ("emit", "r * COLUMNS + c", "c * COLUMNS + r", Every),
    ("emit", "r * COLUMNS + c", "r * ROWS + c", Degrees),
    ("emit", "write_row(e, 0u, v, net[r], r)", "write_row(e, 0u, v, net[r], 0u)", Every),
    ("emit", "write_row(e, 0u, v, net[0], level)", "write_row(e, 0u, v, net[1], level)", Closed),
    ("emit", "r + level + 1u < ROWS", "r + level + 2u < ROWS", Every),
    ("emit", "r + level + 1u < ROWS", "r + level < ROWS", Degrees),
    ("emit", "net[r + 1u][c]) * 0.5", "net[r + 1u][c]) * 0.25", Degrees),
    ("emit", "write_row(e, 2u, v, net[r], r)", "write_row(e, 2u, u, net[r], r)", Every),
    ("rows", "let to = place(e, c) *", "let to = place(e, c + 1u) *", Every),
    ("rows", "* POINTS + r * COLUMNS;", "* POINTS + r * ROWS;", Degrees),
    ("rows", "if lives(e, c) {", "if lives(e, c + 1u) {", Every),
    ("rows", "next_nets[to + level] = line[0];", "next_nets[to + level] = line[1];", Every),
    ("rows", "k + level + 1u < COLUMNS", "k + level + 2u < COLUMNS", Every),
    ("rows", "(line[k] + line[k + 1u]) * 0.5", "(line[k] * 0.5 + line[k + 1u]) * 0.5", Degrees),
    ("rows", "select(c, c + 1u, split)", "select(c + 1u, c, split)", Every),
    ("rows", "if lives(e, last)", "if lives(e, c)", Every),
    ("rows", "place(e, last)", "place(e, c)", Every),
];

const CHILDREN: &[Mutant] = &[
    ("children", "e.first = i * CLOSED;", "e.first = i * 4u;", Closed),
    ("children", "e.first = offsets[i];", "e.first = offsets[i + 1u];", Every),
    ("children", "(word >> 4u) & 15u", "(word >> 4u) & 7u", Every),
    ("children", "word & 3u", "word & 1u", Every),
    ("children", "end > extent.capacity", "end >= extent.capacity", Every),
    ("children", "(1u << c) - 1u)", "(2u << c) - 1u)", Every),
    ("children", "(e.live & (1u << c)) != 0u", "(e.live & (2u << c)) != 0u", Every),
    ("children", "c >> 1u, c & 1u)", "c & 1u, c >> 1u)", Every),
    ("children", "atomicStore(&status.too_deep, 1u)", "atomicStore(&status.too_deep, 0u)", Deep),
    ("halving", "let bc = (p1 + p2) * 0.5", "let bc = (p1 + p2) * 0.25", Every),
    ("halving", "let abc = (ab + bc)", "let abc = (ab + cd)", Every),
    ("halving", "bcd, cd, p3)", "cd, bcd, p3)", Every),
    ("retire", "if k >= extent.count", "if k + 1u >= extent.count", Every),
    ("retire", "if k >= extent.capacity", "if k + 1u >= extent.capacity", Every),
    ("retire", "records[i * QUADS + q]", "records[k * QUADS + q]", Every),
    ("retire", "nets[i * POINTS + p]", "nets[k * POINTS + p]", Every),
    ("retire", "q < QUADS", "q < 1u", Every),
    ("retire", "p < POINTS", "p + 1u < POINTS", Every),
];

/// Of the mapping of emit that takes an invocation a point.
const POINTS: &[Mutant] = &[
    ("emit_by_point", "let i = lane >> 4u;", "let i = lane >> 3u;", Every),
    ("emit_by_point", "let net = local & ~15u;", "let net = 0u;", Every),
    ("emit_by_point", "workgroupBarrier();\n  let c = net + column;", "let c = net + column;", Every),
    ("emit_by_point", "points[c + 4u], points[c + 8u]", "points[c + 8u], points[c + 4u]", Every),
    ("emit_by_point", "case 3u: { write_child(e, 3u", "case 3u: { write_child(e, 2u", Every),
    ("emit_by_point", "write_point(e, 3u, k, of_second_half", "write_point(e, 3u, k, of_first_half", Every),
    ("emit_by_point", "let column = k & 3u;", "let column = k & 1u;", Every),
    ("extent", "id.y * groups.x", "id.y * groups.y", Wide),
];

/// Of the mapping of emit that takes an invocation a line.
const LINES: &[Mutant] = &[
    ("emit_by_line", "r * COLUMNS + c];\n  }\n  var second", "r * ROWS + c];\n  }\n  var second", Degrees),
    ("emit_by_line", "var second = first;\n  if split", "var second = first;\n  if !split", Every),
    ("emit_by_line", "if r + level < ROWS", "if r + level + 1u < ROWS", Degrees),
    ("emit_by_line", "(second[r] + second[r + 1u]) * 0.5", "(second[r + 1u] + second[r]) * 0.25", Every),
    ("emit_by_line", "first[level] = second[0];", "first[level] = second[1];", Every),
    ("emit_by_line", "to + POINTS + r * COLUMNS", "to + POINTS + r * ROWS", Degrees),
    ("emit_by_line", "halves[begin + r * COLUMNS + c]", "halves[begin + r * ROWS + c]", Degrees),
    ("emit_by_line", "let slot = local / LINES;", "let slot = local / (LINES + 1u);", Degrees),
    ("emit_by_line", "let k = local % LINES;", "let k = local & 3u;", Degrees),
    ("emit_by_line", "/ WORKGROUP * NETS + slot", "/ WORKGROUP + slot", Degrees),
    ("emit_by_line", "if slot < NETS && i", "if i", Degrees),
    ("emit_by_line", "let begin = slot * 2u * POINTS;", "let begin = slot * POINTS;", Degrees),
    ("emit_by_line", "e.fits && k < COLUMNS", "e.fits && k < ROWS", Degrees),
    (
        "emit_by_line",
        "read_column(u, i, k, begin);\n  }\n  workgroupBarrier();",
        "read_column(u, i, k, begin);\n  }",
        Degrees,
    ),
    ("emit_by_line", "c < 4u; c += LINES", "c < 4u; c += 4u", Degrees),
    ("emit_by_line", "if k < ROWS {", "if k < COLUMNS {", Degrees),
    ("emit_by_line", "half_row(begin + POINTS, k)", "half_row(begin, k)", Every),
];

const SCANS: &[Mutant] = &[
    ("compositions", "keep(own.tile, inclusive)", "keep(own.tile, before_of(local))", Scans),
    ("compositions", "local == WORKGROUP - 1u && own", "local == 0u && own", Scans),
    ("scan", "offsets[own.start + k] = base + before[k]", "offsets[own.start + k] = base", Scans),
    (
        "scan",
        "before[k] = sum;\n      sum += counts[own.start + k];",
        "sum += counts[own.start + k];\n      before[k] = sum;",
        Scans,
    ),
    ("scan", "sums[own.tile] + inclusive - sum", "sums[own.tile] + inclusive", Scans),
    ("scan", "offsets[k] = base + before[k - own.start]", "offsets[k] = base + before[0]", Scans),
    ("scan", "offsets[extent.count] = sums[", "offsets[extent.count] = 1u + sums[", Scans),
    ("compact", "rules[i] == extent.wanted", "rules[i] >= extent.wanted", Scans),
    ("compositions", "min(start + ITEMS, extent.count)", "min(start + ITEMS, extent.count - 1u)", Scans),
    ("scan", "k < end; k++", "k + 1u < end; k++", Scans),
    ("compact", "i < end; i++", "i + 1u < end; i++", Scans),
    ("compact", "hit << (k & 31u)", "hit << (k & 15u)", Scans),
    ("compact", "hits[k >> 5u]", "hits[k >> 6u]", Scans),
    ("compact", "sums[own.tile] + inclusive - sum", "sums[own.tile] + inclusive", Scans),
    ("compact", "start + w * 32u", "start + w * 31u", Scans),
    ("compact", "left &= left - 1u;", "left &= left - 2u;", Scans),
    (
        "compositions",
        "    workgroupBarrier();\n    if local >= distance {\n      partial[local] = composed",
        "    if local >= distance {\n      partial[local] = composed",
        Scans,
    ),
    ("compositions", "if local >= distance", "if local > distance", Scans),
    ("compositions", "distance << 1u", "distance << 2u", Scans),
    ("tiles", "(count + TILE - 1u) / TILE", "count / TILE", Scans),
    ("tiles", "group.x + group.y * groups.x", "group.x", WideScans),
    ("compositions", "composed(first, before_of(local))", "composed(first, inclusive)", Scans),
    (
        "compositions",
        "keep(t, state);\n    state = composed(state, here);",
        "state = composed(state, here);\n    keep(t, state);",
        Scans,
    ),
    ("compositions", "(tiles + WORKGROUP - 1u) / WORKGROUP", "tiles / WORKGROUP", Scans),
    ("sums", "return 0u;", "return 1u;", Scans),
    (
        "sums",
        "sums[tile_count(extent.count)] = total;",
        "sums[tile_count(extent.count)] = total - 1u;",
        Scans,
    ),
    ("compositions", "if local == WORKGROUP - 1u {", "if local == 0u {", Scans),
];

/// Nets of this degree, both backends in lockstep; what went wrong.
fn lockstep(engine: &Engine, degree: [usize; 2]) -> Result<(), String> {
    let job = degrees::job(degree);
    let mut pair = Pair::new(job.cpu(1), job.gpu(engine), ["CPU", "GPU"]);
    let options = job.options(None, None);
    derive(&job.axiom, &options, &mut pair).and_then(|d| collect(&mut pair, &d)).map(drop).map_err(
        |e| match e {
            PairError::Right(gpu::Error::Codegen(e)) => panic!("this is no mutant: {e}"),
            e => e.to_string(),
        },
    )
}

/// A system of the suite, both backends in lockstep; what went wrong.
fn parity(engine: &Engine, name: &str, chunk: Option<usize>) -> Result<(), String> {
    let subject = WRITTEN.iter().chain([&WIDE]).find(|s| s.name == name).expect("a system of the suite");
    seen(subject.compare(engine, &[chunk], None))
}

/// The case of the suite that is about them; what went wrong.
fn specials(engine: &Engine) -> Result<(), String> {
    let case = conformance::cases().into_iter().find(|c| c.name == "infinities and NaN").expect("a case");
    match case.run(engine, None).outcome {
        Outcome::Differs(what) => Err(what),
        Outcome::Failed(gpu::Error::Codegen(e)) => panic!("this is no mutant: {e}"),
        Outcome::Failed(e) => panic!("{e}"),
        _ => Ok(()),
    }
}

/// What a mutant was seen by; it must be a kernel at all.
fn seen(result: Result<Compared, Trouble>) -> Result<(), String> {
    match result {
        Ok(_) => Ok(()),
        Err(Trouble::Failed(gpu::Error::Codegen(e))) => panic!("this is no mutant: {e}"),
        Err(e) => Err(e.to_string()),
    }
}

impl Check {
    /// Sizes that bring out what the check is about with little work.
    fn tuning(self, mapping: Mapping) -> Tuning {
        let tuning = Tuning { mapping, ..Tuning::CPU_DRIVER };
        match self {
            // 40,000 workgroups, which is more than go in one dimension.
            Wide if mapping == Mapping::PointPerInvocation => Tuning { workgroup: 16, ..tuning },
            Wide => Tuning { workgroup: 1, ..tuning },
            Scans => Tuning { scan_workgroup: 16, scan_items: 64, ..tuning },
            WideScans => Tuning { scan_workgroup: 2, scan_items: 32, ..tuning },
            _ => tuning,
        }
    }

    fn run(self, engine: &Engine) -> Result<(), String> {
        match self {
            Every => parity(engine, "every", Some(9)),
            Closed => parity(engine, "closed", None).and_then(|()| parity(engine, "mixed", None)),
            Deep => parity(engine, "deep", None).and_then(|()| parity(engine, "deep_closed", None)),
            Wide => parity(engine, "wide", None),
            Values => parity(engine, "values", None),
            Specials => specials(engine),
            Measured => parity(engine, "measures", None),
            Scans => seen(scans::compare(engine, &[0, 1, 63, 1024, 1025, 20_000])),
            Degrees => [[4, 1], [1, 4], [2, 1]].into_iter().try_for_each(|degree| lockstep(engine, degree)),
            // 64 elements a tile.
            WideScans => seen(scans::compare(engine, &[32_769 * 64])),
        }
    }
}

/// Runs the mutants, in a sample one of each file and one for each check, and names those that live. What the mappings of emit share is checked with the
/// one that the driver compiles in a tenth of the time.
#[track_caller]
fn kill(list: &[Mutant], mapping: Mapping) {
    let Some(headless) = device::headless() else { return };
    let kept = Engine::new(&headless.device, &headless.queue).keeping_kernels();
    let engine = |check: Check| kept.retuned(check.tuning(mapping));
    let list =
        tier::sample(list.iter().copied(), |(file, .., check)| vec![file.to_string(), format!("{check:?}")]);
    let mut checks: Vec<Check> = Vec::new();
    for &(.., check) in &list {
        if !checks.contains(&check) {
            checks.push(check);
        }
    }
    for check in checks {
        // Unbroken kernels pass, or the check says nothing.
        if let Err(e) = check.run(&engine(check)) {
            panic!("{check:?} without a mutant: {e}");
        }
    }
    let unseen = |&(file, find, replace, check): &Mutant| {
        let difference = |engine: &Engine| check.run(engine).err();
        let unseen = mutants::unseen(&engine(check), (file, find, replace), difference)?;
        Some(format!("{unseen} by {check:?}"))
    };
    mutants::assert_seen(list.iter().filter_map(unseen));
}

#[test]
fn every_mutant_of_matching_and_counting_is_seen() {
    kill(MATCHING, Mapping::PointPerInvocation);
}

#[test]
fn every_mutant_of_measuring_is_seen() {
    kill(MEASURING, Mapping::NetPerInvocation);
}

#[test]
fn every_mutant_of_elementary_functions_is_seen() {
    kill(ELEMENTARY, Mapping::PointPerInvocation);
}

#[test]
fn every_mutant_of_infinities_and_nan_is_seen() {
    kill(NUMBERS, Mapping::PointPerInvocation);
}

#[test]
fn every_mutant_of_addresses_is_seen() {
    kill(ADDRESSES, Mapping::PointPerInvocation);
}

#[test]
fn every_mutant_of_children_and_retirement_is_seen() {
    kill(CHILDREN, Mapping::PointPerInvocation);
}

#[test]
fn every_mutant_of_emit_is_seen() {
    kill(NETS, Mapping::NetPerInvocation);
}

#[test]
fn every_mutant_of_emit_by_point_is_seen() {
    kill(POINTS, Mapping::PointPerInvocation);
}

#[test]
fn every_mutant_of_emit_by_line_is_seen() {
    kill(LINES, Mapping::LinePerInvocation);
}

#[test]
fn every_mutant_of_scan_and_compaction_is_seen() {
    kill(SCANS, Mapping::NetPerInvocation);
}

/// Every kernel, and every file that kernels share, is broken more than once.
#[test]
fn every_file_has_mutants() {
    let all: Vec<&Mutant> =
        [MATCHING, MEASURING, ELEMENTARY, NUMBERS, ADDRESSES, CHILDREN, NETS, POINTS, LINES, SCANS]
            .into_iter()
            .flatten()
            .collect();
    for folder in ["wgsl", "wgsl/shared"] {
        for entry in std::fs::read_dir(folder).expect("the kernels") {
            let path = entry.expect("an entry").path();
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            // What measures a device derives nothing; the picture, the tessellation and the refinement have tests of
            // their own.
            let other =
                ["copy", "expand", "picture", "shared", "tessellate", "refine"].contains(&name.as_str());
            let count = all.iter().filter(|m| m.0 == name).count()
                + crate::runs::mutants_of(&name)
                + crate::curves::mutants_of(&name)
                + crate::turtle::mutants_of(&name)
                + crate::affine::mutants_of(&name);
            assert!(other || count >= 2, "{} has {count} mutants", path.display());
        }
    }
}
