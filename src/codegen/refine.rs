//! The kernels of a mesh refinement: masks traced from the schemes, and the body that refines a quad.

use super::generate::Text;
use super::{Edit, Error, NOTHING, Shader, Tuning, build, workgroup_constant};
use crate::mesh::Scheme;
use crate::mesh::schemes::{QuadScheme, Vector, Visit};
use std::ops::{Add, Mul, Sub};

/// Those that all levels share.
pub struct Refinement {
    pub first: Shader,
    pub rings: Shader,
    pub gather: Shader,
    pub quads: Shader,
    pub triangles: Shader,
}

/// Links and validates the kernels of a scheme.
pub fn refinement(scheme: Scheme, tuning: &Tuning, edit: Option<&Edit>) -> Result<Refinement, Error> {
    let constants = workgroup_constant(tuning);
    let faces = |triangles: bool| {
        build("faces", &format!("{constants}const TRIANGLES = {triangles};\n"), NOTHING, edit)
    };
    Ok(Refinement {
        first: build("first", &constants, NOTHING, edit)?,
        rings: build("rings", &constants, &|part| (part == "masks").then(|| masks(scheme)), edit)?,
        gather: build("gather", &constants, NOTHING, edit)?,
        quads: faces(false)?,
        triangles: faces(true)?,
    })
}

/// What stands around the roots of a dispatch, and so what their kernel looks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Around {
    /// Everything is regular.
    Grid,
    /// Corners may have rings.
    Corners,
    /// And sides may be sharp.
    Creases,
}

/// A variant of the kernel that refines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Levels {
    /// How many at once: 0, where the roots themselves are written, to 2.
    pub levels: u32,
    pub around: Around,
    /// Whether the last of them goes on as a tile, and whether its vertices are kept.
    pub tile: bool,
    pub fine: bool,
    /// Whether the vertices of the first of two levels are kept.
    pub coarse: bool,
}

/// Links and validates a variant.
pub fn levels(scheme: Scheme, what: &Levels, tuning: &Tuning, edit: Option<&Edit>) -> Result<Shader, Error> {
    let parts = |part: &str| match part {
        "masks" => Some(masks(scheme)),
        "body" => Some(body(what)),
        _ => None,
    };
    build("levels", &workgroup_constant(tuning), &parts, edit)
}

/// An expression of WGSL.
#[derive(Clone)]
struct Traced(String);

impl Add for Traced {
    type Output = Traced;
    fn add(self, other: Traced) -> Traced {
        Traced(format!("({} + {})", self.0, other.0))
    }
}

impl Sub for Traced {
    type Output = Traced;
    fn sub(self, other: Traced) -> Traced {
        Traced(format!("({} - {})", self.0, other.0))
    }
}

impl Mul<f32> for Traced {
    type Output = Traced;
    fn mul(self, by: f32) -> Traced {
        Traced(format!("({} * {by:?}f)", self.0))
    }
}

impl Vector for Traced {}

/// The masks as functions, each pinned: what is summed of their results is not merged with their last product.
fn masks(scheme: Scheme) -> Text {
    struct Functions;
    impl Visit for Functions {
        type Output = Vec<String>;
        fn quads<S: QuadScheme>(self) -> Vec<String> {
            fn points<const N: usize>(names: [&str; N]) -> [Traced; N] {
                names.map(|name| Traced(name.to_string()))
            }
            let [vertex] = points(["p"]);
            let [e, f] = [points(["a", "b", "c", "d"]), points(["f", "g", "h", "i"])];
            let function = |name: &str, arguments: &[&str], value: Traced| {
                let arguments: Vec<String> = arguments.iter().map(|a| format!("{a}: vec3f")).collect();
                format!("fn {name}({}) -> vec3f {{ return pin({}); }}", arguments.join(", "), value.0)
            };
            vec![
                function("face", &["a", "b", "c", "d"], S::face(e.clone())),
                function("edge", &["a", "b", "f", "g"], S::edge(points(["a", "b"]), points(["f", "g"]))),
                function(
                    "inner",
                    &["p", "a", "b", "c", "d", "f", "g", "h", "i"],
                    S::vertex(vertex.clone(), e, f),
                ),
                function("crease", &["p", "a", "b"], S::crease(vertex, points(["a", "b"]))),
                function("middle", &["a", "b"], (Traced("a".into()) + Traced("b".into())) * 0.5),
            ]
        }
    }
    let mut text = Text::default();
    scheme.visit(Functions).into_iter().for_each(|line| text.line(line));
    text
}

/// A point of a block, from (-1, -1).
fn name(of: &str, x: i32, y: i32) -> String {
    format!("{of}_{}_{}", x + 1, y + 1)
}

/// Whether quad (x, y) of n × n lies at side k.
const TOUCHES: [&str; 4] = ["y == 0u", "x + 1u == n", "y + 1u == n", "x == 0u"];

fn body(what: &Levels) -> Text {
    let mut text = Text::default();
    let mut line = |line: String| text.line(format!("  {line}"));
    let blocks = ["a", "b", "c"];
    line("let own = roots[ROOT * root + 4u];".into());
    line("let after = roots[ROOT * root + 5u];".into());
    line("let extra = own.w;".into());
    line("let width = n + 3u;".into());
    line("let begin = (root - params.chunk) * width * width + y * width + x;".into());
    for j in 0..4 {
        for i in 0..4 {
            line(format!("let {} = tiles[begin + {j}u * width + {i}u].xyz;", name("a", i - 1, j - 1)));
        }
    }
    for level in 0..what.levels {
        let [from, to] = [blocks[level as usize], blocks[level as usize + 1]];
        let n = 1 << level;
        smooth(n, from, to, &mut line);
        if what.around > Around::Grid {
            mend(n, from, to, level, what.around == Around::Creases, &mut line);
        }
        if level == 0 && what.levels == 2 && what.coarse {
            vertices(2 * n, to, "put_coarse", &mut line);
        }
    }
    let last = blocks[what.levels as usize];
    let block = 1 << what.levels;
    if what.fine {
        vertices(block, last, "put_fine", &mut line);
    }
    if what.tile {
        tile(block, last, &mut line);
    }
    let mut whole = Text::default();
    whole.line("fn refine_quad(root: u32, x: u32, y: u32, n: u32) {");
    whole.lines.append(&mut text.lines);
    whole.line("}");
    whole
}

/// The smooth masks, from n × n quads of a block to the next level.
fn smooth(n: i32, from: &str, to: &str, line: &mut dyn FnMut(String)) {
    for y in -1..=n {
        for x in -1..=n {
            let p = |i, j| name(from, x + i, y + j);
            let corners = [p(0, 0), p(1, 0), p(1, 1), p(0, 1)].join(", ");
            line(format!("var {} = face({corners});", name(to, 2 * x + 1, 2 * y + 1)));
        }
    }
    for y in -1..=n {
        for x in -1..=n {
            let p = |i, j| name(from, x + i, y + j);
            let f = |i, j| name(to, 2 * (x + i) + 1, 2 * (y + j) + 1);
            if x >= 0 {
                let points = [p(0, 0), p(0, 1), f(-1, 0), f(0, 0)].join(", ");
                line(format!("var {} = edge({points});", name(to, 2 * x, 2 * y + 1)));
            }
            if y >= 0 {
                let points = [p(0, 0), p(1, 0), f(0, -1), f(0, 0)].join(", ");
                line(format!("var {} = edge({points});", name(to, 2 * x + 1, 2 * y)));
            }
            if x >= 0 && y >= 0 {
                let edges = [p(-1, 0), p(1, 0), p(0, -1), p(0, 1)].join(", ");
                let faces = [f(-1, -1), f(0, 0), f(0, -1), f(-1, 0)].join(", ");
                line(format!("var {} = inner({}, {edges}, {faces});", name(to, 2 * x, 2 * y), p(0, 0)));
            }
        }
    }
}

/// What the smooth masks miss, on a block of 2n × 2n quads: sharp sides, and corners with rings.
fn mend(n: i32, from: &str, to: &str, level: u32, sides: bool, line: &mut dyn FnMut(String)) {
    let block = 2 * n;
    line("if extra != NONE {".into());
    for k in (0..4).filter(|_| sides) {
        let axis = ["x", "y", "x", "y"][k];
        let point = |of: &str, t: i32, n: i32| {
            let (x, y) = [(t, 0), (n, t), (t, n), (0, t)][k];
            name(of, x, y)
        };
        line(format!("  if {} && extras[extra + {}u] != NONE {{", TOUCHES[k], 16 + 2 * k));
        for t in -1..=block + 1 {
            let old = |i: i32| point(from, t.div_euclid(2) + i, n);
            let sharp = match t.rem_euclid(2) {
                1 => format!("middle({}, {})", old(0), old(1)),
                _ => format!("crease({}, {}, {})", old(0), old(-1), old(1)),
            };
            // Before the first it wraps, and is beyond the last.
            let at = match t {
                -1 => format!("{block}u * {axis} - 1u"),
                _ => format!("{block}u * {axis} + {t}u"),
            };
            let weight = format!("weight(extra, {k}u, params.level + {level}u, {at}, {block}u * n)");
            let own = point(to, t, block);
            line(format!("    {own} = mended({own}, {sharp}, {weight});"));
        }
        line("  }".into());
    }
    for k in 0..4usize {
        let (x, y) = [(0, 0), (block, 0), (block, block), (0, block)][k];
        let before = (k + 3) & 3;
        line(format!("  if {} && {} {{", TOUCHES[k], TOUCHES[before]));
        line(format!("    let ring = ring_of(extra, {k}u);"));
        line("    if ring.x != NONE {".into());
        line(format!("      let here = ring.x + (params.level + {}u) * ring.y;", level + 1));
        line(format!("      {} = rings[here].xyz;", name(to, x, y)));
        for (word, side) in [("z", k), ("w", before)] {
            let (dx, dy) = [(0, -1), (1, 0), (0, 1), (-1, 0)][side];
            let own = name(to, x + dx, y + dy);
            line(format!("      if ring.{word} != NONE {{ {own} = rings[here + ring.{word}].xyz; }}"));
        }
        line("    }".into());
        line("  }".into());
    }
    line("}".into());
}

/// Writes the vertices that the root owns of a block of so many quads a side.
fn vertices(block: i32, of: &str, put: &str, line: &mut dyn FnMut(String)) {
    line("{".into());
    line(format!("  let s = {block}u * n;"));
    line("  let m = s - 1u;".into());
    line("  let to = numbers(root, own, after, s);".into());
    for j in 0..block {
        for i in 0..block {
            let at = format!("to.inside + ({block}u * y + {j}u) * m + {block}u * x + {i}u");
            let put = format!("{put}({at}, {});", name(of, i, j));
            line(match (i, j) {
                (0, 0) => format!("  if x > 0u && y > 0u {{ {put} }}"),
                (0, _) => format!("  if x > 0u {{ {put} }}"),
                (_, 0) => format!("  if y > 0u {{ {put} }}"),
                _ => format!("  {put}"),
            });
        }
    }
    for k in 0..4usize {
        let (x, y) = [(0, 0), (block, 0), (block, block), (0, block)][k];
        let (bit, below) = (1 << k, (1 << k) - 1);
        line(format!("  if {} && {} && (own.z & {bit}u) != 0u {{", TOUCHES[k], TOUCHES[(k + 3) & 3]));
        line(format!("    {put}(to.begin + countOneBits(own.z & {below}u), {});", name(of, x, y)));
        line("  }".into());
        line(format!("  if {} && (own.z & {}u) != 0u {{", TOUCHES[k], bit << 4));
        line(format!("    let side = to.sides + countOneBits(own.z & {}u) * m - 1u;", below << 4));
        let axis = ["x", "y", "x", "y"][k];
        for i in 0..block {
            let (x, y) = [(i, 0), (block, i), (i, block), (0, i)][k];
            let along = format!("{block}u * {axis} + {i}u");
            // The last two sides run down their axes.
            let along = if k < 2 { along } else { format!("s - ({along})") };
            let put = format!("{put}(side + {along}, {});", name(of, x, y));
            line(if i == 0 { format!("    if {axis} > 0u {{ {put} }}") } else { format!("    {put}") });
        }
        line("  }".into());
    }
    line("}".into());
}

/// Writes what the block has of the next tile.
fn tile(block: i32, of: &str, line: &mut dyn FnMut(String)) {
    line(format!("let wide = {block}u * n + 3u;"));
    line(format!("let tile = (root - params.chunk) * wide * wide + {block}u * y * wide + {block}u * x;"));
    for j in 0..block + 3 {
        for i in 0..block + 3 {
            let ends = [
                (i == 0, "x == 0u"),
                (j == 0, "y == 0u"),
                (i > block, "x + 1u == n"),
                (j > block, "y + 1u == n"),
            ];
            let only: Vec<&str> = ends.into_iter().filter_map(|(is, test)| is.then_some(test)).collect();
            let put = format!("next[tile + {j}u * wide + {i}u] = vec4f({}, 1.0);", name(of, i - 1, j - 1));
            line(if only.is_empty() { put } else { format!("if {} {{ {put} }}", only.join(" && ")) });
        }
    }
}
