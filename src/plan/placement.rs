//! `place` at the end of a patch system: where the vertices of its tessellation go.
//!
//! The expression is a graph like any other, over the record of a vertex in place of a module's. What stands in
//! it does not hang on how finely the surface is tessellated, nor on which patch a shared vertex is seen from:
//! else the surface would pop when the level changes, or crack.
//!
//! | word | holds |
//! |---|---|
//! | 0 | 0 |
//! | 1 | root: of the patches that share the vertex the first |
//! | 2, 3 | its lattice point there, along the file's u and v |
//! | 4 – 6, 7 | smooth position, scale |
//! | 8 – 10, 11 | unit normal, u |
//! | 12 – 14, 15 | unit tangent along u, v |
//! | 16 – 18, 19 | unit bitangent, 0 |

use super::given::Given;
use super::graph::{Constants, Graph, Names, NodeId, Subject};
use super::{Error, Options, Plan, Settings, Unsupported, tables};
use crate::language::Span;
use crate::language::expr::{Expr, ExprKind, Type, Value};
use crate::language::ops;
use crate::language::system::{Step, StepKind, System};
use std::sync::Arc;

/// Words of a vertex's record, a multiple of 4.
pub const RECORD_WORDS: usize = 20;

/// Why a param of a tessellation that is not displaced cannot be set.
pub fn nothing_to_set(name: &str) -> Error {
    Error::Set(format!("`{name}` cannot be set: no placement displaces the tessellation"))
}

/// The words of the record that hold an attribute; of a frame its three axes. None for a name that no vertex
/// knows.
pub fn words_of(attribute: &str) -> &'static [usize] {
    match attribute {
        "p" | "old" => &[4, 5, 6],
        "scale" => &[7],
        "normal" => &[8, 9, 10],
        "uv" => &[11, 15],
        "frame" => &[12, 13, 14, 16, 17, 18, 8, 9, 10],
        "id" => &[1],
        _ => &[],
    }
}

/// Words of the environment between what the host gives and the constants: the seed; where the values of queries
/// begin in their buffer, and how many words they are; 0.
const OWN_WORDS: usize = 4;

/// Where vertices go.
#[derive(Clone, Debug)]
pub struct Placement {
    pub name: String,
    /// Only vertices between leaves of these symbols alone are moved; empty: all.
    pub on: Vec<usize>,
    pub span: Span,
    pub graph: Graph,
    /// x, y and z of what is added to the smooth position.
    pub offset: [NodeId; 3],
    /// The word of the environment that holds the seed; the two behind it say where given values stand.
    pub seed: usize,
    constants: Constants,
}

impl Placement {
    /// The placement that ends the run of a patch system, if one does; or what it reads that no vertex knows.
    pub fn new(system: &System) -> Result<Option<Placement>, Unsupported> {
        let Some(&Step { kind: StepKind::Place(index), .. }) = system.run.last() else { return Ok(None) };
        let Some(place) = system.placements.get(index) else { return Ok(None) };
        let mut unknown = None;
        place.value.walk(&mut |e| match e.kind {
            ExprKind::Attribute(name) if words_of(name).is_empty() => unknown = Some((name, e.span)),
            _ => {}
        });
        if let Some((name, span)) = unknown {
            return Err(Unsupported::new(format!("`{name}` in a placement of a patch system"), span));
        }
        let environment = tables::environment(system);
        let seed = environment.given.end(system.queries.len());
        let mut constants = Constants { base: seed + OWN_WORDS, words: Vec::new() };
        let mut graph = Graph::default();
        let mut names = Names {
            fields: Vec::new(),
            linked: false,
            word: None,
            searches: &[],
            // Of the record of a vertex.
            path: vec![1, 2, 3],
            environment: &environment,
            subject: Subject::Vertex { seed },
            lets: Vec::new(),
            site: tables::fnv(place.name.as_bytes()),
            constants: &mut constants,
        };
        let whole = || vectors("-", place.value.clone(), position(&place.value));
        let offset = graph.lower(&offset_of(&place.value).unwrap_or_else(whole), &mut names);
        let offset = std::array::from_fn(|k| offset[k]);
        graph.settle(&mut constants);
        let (name, on, span) = (place.name.clone(), place.on.clone(), place.span);
        Ok(Some(Placement { name, on, span, graph, offset, seed, constants }))
    }

    /// Words of the environment, a multiple of 4.
    pub fn environment_words(&self) -> usize {
        (self.constants.base + self.constants.words.len()).next_multiple_of(4)
    }
}

/// What a sum adds to the smooth position, if that is one of what is summed. Slopes are differences of it, and
/// `(p + a) - p` would be `a` with the rounding of `p`: on models that are large against it, noise.
fn offset_of(e: &Expr) -> Option<Expr> {
    match &e.kind {
        ExprKind::Attribute("p" | "old") => Some(Expr::literal(Value::Vec3([0.0; 3]), e.span)),
        ExprKind::Call(op, args) if e.ty == Type::Vec3 => {
            let (name, [a, b]) = (op.row().name, args.as_slice()) else { return None };
            let both = a.ty == Type::Vec3 && b.ty == Type::Vec3;
            match (name, offset_of(a)) {
                ("+" | "-", Some(a)) if both => Some(vectors(name, a, b.clone())),
                ("+", None) if both => Some(vectors("+", a.clone(), offset_of(b)?)),
                _ => None,
            }
        }
        _ => None,
    }
}

fn position(of: &Expr) -> Expr {
    Expr { ty: Type::Vec3, kind: ExprKind::Attribute("p"), span: of.span }
}

/// `a + b` or `a - b`; of a sum with nothing the other.
fn vectors(name: &str, a: Expr, b: Expr) -> Expr {
    let zero = ExprKind::Literal(Value::Vec3([0.0; 3]));
    match ops::find(name, &[Type::Vec3, Type::Vec3]) {
        _ if name == "+" && a.kind == zero => b,
        _ if b.kind == zero => a,
        Ok(op) => Expr { ty: Type::Vec3, span: a.span, kind: ExprKind::Call(op, vec![a, b]) },
        Err(_) => unreachable!("the table has a row {name} of two vectors"),
    }
}

/// A placement with its values: what a tessellator takes.
#[derive(Clone, Debug)]
pub struct Displacement {
    pub placement: Placement,
    /// The values of queries.
    pub given: Given,
    system: Arc<System>,
    set: Vec<(String, Value)>,
    seed: Option<u32>,
    settings: Settings,
}

impl Displacement {
    /// The plan's placement, if it has one, with the params, queries, view and seed of the options, for so many
    /// roots.
    ///
    /// # Errors
    /// As [`Plan::uniforms`] and [`Given::new`].
    pub fn new(plan: &Plan, roots: usize, options: &Options) -> Result<Option<Displacement>, Error> {
        let Some(placement) = plan.placement.clone() else { return Ok(None) };
        Ok(Some(Displacement {
            placement,
            given: Given::new(&plan.system, roots, &options.bind, options.view)?,
            system: plan.system.clone(),
            settings: plan.settings(&options.set, options.seed)?,
            set: options.set.clone(),
            seed: options.seed,
        }))
    }

    /// Other values of some params; the others stay.
    ///
    /// # Errors
    /// As [`Plan::uniforms`]; then all stay.
    pub fn set_params(&mut self, set: &[(String, Value)]) -> Result<(), Error> {
        let other = |(name, _): &&(String, Value)| !set.iter().any(|(new, _)| new == name);
        let all: Vec<_> = self.set.iter().filter(other).chain(set).cloned().collect();
        self.settings = Settings::new(&self.system, &all, self.seed)?;
        self.set = all;
        Ok(())
    }

    /// The environment of the expression, where the values of queries begin at this word of their buffer.
    pub fn environment(&self, given_base: u32) -> Vec<u32> {
        let mut words: Vec<u32> = self.settings.uniforms.iter().flat_map(Value::words).collect();
        words.resize(words.len().next_multiple_of(4), 0);
        words.extend(&self.given.environment);
        words.extend([self.settings.seed, given_base, self.given.words.len() as u32, 0]);
        words.extend(&self.placement.constants.words);
        words.resize(self.placement.environment_words(), 0);
        words
    }
}
