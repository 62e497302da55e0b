//! What the host gives beside the params: the values of queries without `=`, and the view.
//!
//! Values stand in one buffer of 4-byte words, those of one query after those of the other, in
//! front of the measured attributes. Where each begins, and how a point is found in a grid, stands
//! in the environment behind the uniforms, so that other values never mean another kernel.

use super::{Error, measure};
use crate::language::expr::{Expr, ExprKind, Type, Value};
use crate::language::system::{
    BinderPlace, Cell, Query, Rule, Step, StepKind, Successor, System, surface_modules,
};
use crate::patch::{Grid, Values};

/// The camera that `bbox_px` and `area_px` look through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// From the model's space to clip space: four columns.
    pub clip: [[f32; 4]; 4],
    /// Width and height of the picture in pixels.
    pub size: [f32; 2],
}

impl View {
    /// A perspective view from `eye` towards `at`; `angle` is the vertical angle of view in degrees.
    ///
    /// Depth goes from 0 at a hundredth of the distance to 1 at infinity. `up` must not point along
    /// the line of sight.
    pub fn looking(eye: [f32; 3], at: [f32; 3], up: [f32; 3], angle: f32, size: [f32; 2]) -> View {
        let [eye, at, up] = [eye, at, up].map(glam::Vec3::from);
        let camera = glam::camera::rh::view::look_at_mat4(eye, at, up);
        let near = (at - eye).length() * 0.01;
        let aspect = size[0] / size[1];
        let lens = glam::camera::rh::proj::directx::perspective_infinite(angle.to_radians(), aspect, near);
        View { clip: (lens * camera).to_cols_array_2d(), size }
    }
}

/// Words of the environment that the view takes, and that a query takes.
const VIEW_WORDS: usize = 20;
const QUERY_WORDS: usize = 10;

/// Words that all values together may take: 64 MiB, half of what WebGPU binds.
pub const MOST_WORDS: usize = 1 << 24;

/// Everything given, as a backend takes it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Given {
    /// What stands in the environment behind the uniforms.
    pub environment: Vec<u32>,
    /// The values of all queries.
    pub words: Vec<u32>,
}

/// Where the words of the environment stand that are not uniforms, by the system alone.
#[derive(Clone, Copy, Debug)]
pub struct Places {
    base: usize,
}

/// How a query is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Roots,
    Grid,
}

/// Of a query's words in the environment: where its values begin, points along x, y and z, then the
/// first point and, for each axis, how many points a unit of length holds.
impl Places {
    /// `base` is where the uniforms end.
    pub fn new(base: usize) -> Places {
        Places { base: base.next_multiple_of(4) }
    }
    /// The first word of the view: four columns of four, then width and height.
    pub fn view(self) -> usize {
        self.base
    }
    pub fn values(self, query: usize) -> usize {
        self.base + VIEW_WORDS + QUERY_WORDS * query
    }
    pub fn size(self, query: usize, axis: usize) -> usize {
        self.values(query) + 1 + axis
    }
    pub fn from(self, query: usize, axis: usize) -> usize {
        self.values(query) + 4 + axis
    }
    pub fn density(self, query: usize, axis: usize) -> usize {
        self.values(query) + 7 + axis
    }
    /// Where the next thing may stand.
    pub fn end(self, queries: usize) -> usize {
        self.values(queries)
    }
}

impl Given {
    /// Checks what is bound against what the rules ask for.
    ///
    /// # Errors
    /// [`Error::Bind`] for a query that is not the host's to bind, one that nothing is bound to,
    /// values of another type or number, a grid that is none; [`Error::View`] where rules read the
    /// screen and there is no view.
    pub fn new(
        system: &System,
        roots: usize,
        bound: &[(String, Values)],
        view: Option<View>,
    ) -> Result<Given, Error> {
        Given::behind(Vec::new(), system, roots, bound, view)
    }

    /// The same behind other words: of several curves at once the uniforms of each, and its seed.
    pub(super) fn behind(
        words: Vec<u32>,
        system: &System,
        roots: usize,
        bound: &[(String, Values)],
        view: Option<View>,
    ) -> Result<Given, Error> {
        for (name, _) in bound {
            if !system.queries.iter().any(|q| q.name == *name && q.value.is_none()) {
                return Err(Error::Bind(no_such_query(system, name)));
            }
        }
        let reads = Reads::of(system);
        if view.is_none()
            && let Some(name) = reads.screen
        {
            return Err(Error::View { attribute: name });
        }
        let mut given = Given { environment: view_words(view.unwrap_or(NO_VIEW)), words };
        for (n, query) in system.queries.iter().enumerate() {
            let values = bound.iter().rev().find(|(name, _)| *name == query.name).map(|(_, values)| values);
            match (reads.forms[n], values) {
                (None, None) => given.environment.extend([0; QUERY_WORDS]),
                (None, Some(values)) => given.add(query, values, roots)?,
                (Some(form), values) => {
                    let values = values.ok_or_else(|| Error::Bind(unbound(query, form)))?;
                    fits_form(query, form, values)?;
                    given.add(query, values, roots)?;
                }
            }
        }
        Ok(given)
    }

    fn add(&mut self, query: &Query, values: &Values, roots: usize) -> Result<(), Error> {
        let name = &query.name;
        let base = self.words.len() as u32;
        let (list, place) = match values {
            Values::Roots(list) if list.len() != roots => {
                let (found, wanted) = (list.len(), roots);
                return Err(Error::Bind(format!(
                    "{name} wants a value for each patch of the axiom, {wanted}, and is bound to {found}"
                )));
            }
            Values::Roots(list) => (list, [base, list.len() as u32, 1, 1, 0, 0, 0, 0, 0, 0]),
            Values::Grid(grid) => (&grid.values, place_of(grid, name, base)?),
        };
        if self.words.len() + list.len() * query.ty.words() > MOST_WORDS {
            return Err(Error::Bind(format!(
                "the values bound take more than {} MiB in all with those of {name}",
                MOST_WORDS >> 18
            )));
        }
        for (n, value) in list.iter().enumerate() {
            let value = of_type(value, &query.ty).ok_or_else(|| {
                let (found, wanted) = (value.ty(), &query.ty);
                Error::Bind(format!("value {n} of {name} is of type {found}; the query is of type {wanted}"))
            })?;
            self.words.extend(value.words());
        }
        self.environment.extend(place);
        Ok(())
    }
}

/// The words of a grid in the environment.
fn place_of(grid: &Grid, name: &str, base: u32) -> Result<[u32; QUERY_WORDS], Error> {
    let wrong = |what: String| Err(Error::Bind(format!("the grid of {name} {what}")));
    let [x, y, z] = grid.size;
    let points = [x, y, z].iter().try_fold(1usize, |n, &s| n.checked_mul(s as usize));
    if points.is_none_or(|n| n == 0 || n > MOST_WORDS) {
        return wrong(format!(
            "has {x}×{y}×{z} points; there must be at least one, and at most {MOST_WORDS}"
        ));
    }
    if points != Some(grid.values.len()) {
        return wrong(format!("has {x}×{y}×{z} points, and values for {}", grid.values.len()));
    }
    let mut place = [base, x, y, z, 0, 0, 0, 0, 0, 0];
    for axis in 0..3 {
        let (from, to) = (grid.from[axis], grid.to[axis]);
        let length = to - from;
        if !length.is_finite() || length < 0.0 || (length == 0.0 && grid.size[axis] > 1) {
            let axis = ["x", "y", "z"][axis];
            return wrong(format!("goes from {from} to {to} along {axis}; `to` must be the greater"));
        }
        let density = if grid.size[axis] > 1 { (grid.size[axis] - 1) as f32 / length } else { 0.0 };
        place[4 + axis] = from.to_bits();
        place[7 + axis] = density.to_bits();
    }
    Ok(place)
}

/// Looks at nothing: only where no rule asks.
const NO_VIEW: View = View { clip: [[0.0; 4]; 4], size: [0.0; 2] };

fn view_words(view: View) -> Vec<u32> {
    let words = view.clip.iter().flatten().chain(&view.size).chain(&[0.0, 0.0]);
    words.map(|x| x.to_bits()).collect()
}

/// The value as one of the type, or as it is.
fn of_type(value: &Value, ty: &Type) -> Option<Value> {
    match (value, ty) {
        (Value::Int(i), Type::Float) => Some(Value::Float(*i as f32)),
        (value, ty) if value.ty() == *ty => Some(value.clone()),
        _ => None,
    }
}

fn no_such_query(system: &System, name: &str) -> String {
    if let Some(query) = system.queries.iter().find(|q| q.name == name && q.value.is_some()) {
        return format!("{} has a value of its own: only a query without `=` is bound", query.name);
    }
    let free = system.queries.iter().filter(|q| q.value.is_none());
    let free: Vec<&str> = free.map(|q| q.name.as_str()).collect();
    match free.as_slice() {
        [] => format!("`{name}` cannot be bound: {} has no queries without `=`", system.name),
        list => format!("`{name}` is no query of {}; it has {}", system.name, list.join(", ")),
    }
}

fn unbound(query: &Query, form: Form) -> String {
    let wants = match form {
        Form::Roots => "one value a patch of the axiom",
        Form::Grid => "a grid",
    };
    format!("nothing is bound to the query {}; it wants {wants}", query.name)
}

fn fits_form(query: &Query, form: Form, values: &Values) -> Result<(), Error> {
    match (form, values) {
        (Form::Roots, Values::Grid(_)) => Err(Error::Bind(format!(
            "a grid is bound to {}, but the rules ask for it as `?{}(…)`: it wants one value a patch of the axiom",
            query.name, query.name
        ))),
        (Form::Grid, Values::Roots(_)) => Err(Error::Bind(format!(
            "one value a patch is bound to {}, but the rules ask for it at a point: it wants a grid",
            query.name
        ))),
        _ => Ok(()),
    }
}

/// What the rules of all groups, and the placement, ask for.
struct Reads {
    forms: Vec<Option<Form>>,
    /// An attribute of the screen.
    screen: Option<&'static str>,
}

impl Reads {
    fn of(system: &System) -> Reads {
        let mut reads = Reads { forms: vec![None; system.queries.len()], screen: None };
        for rule in system.groups.iter().flat_map(|g| &g.rules) {
            for binder in &rule.binders {
                if let BinderPlace::Query(n) = binder.place {
                    let query = rule.queries[n].query;
                    match &system.queries[query].value {
                        Some(value) => reads.expr(value),
                        None => reads.forms[query] = Some(Form::Roots),
                    }
                }
            }
            of_rule(rule, &mut |e| reads.expr(e));
        }
        reads.placement(system);
        reads
    }

    /// What the placement reads that ends the run.
    fn placement(&mut self, system: &System) {
        if let Some(Step { kind: StepKind::Place(index), .. }) = system.run.last() {
            self.expr(&system.placements[*index].value);
        }
    }

    fn expr(&mut self, e: &Expr) {
        e.walk(&mut |e| match e.kind {
            ExprKind::Sample(query, _) => self.forms[query] = Some(Form::Grid),
            ExprKind::Attribute(name) if measure::of_the_screen(name) => {
                self.screen.get_or_insert(name);
            }
            _ => {}
        });
    }
}

/// Every expression of a rule but those of its queries.
pub(super) fn of_rule(rule: &Rule, visit: &mut dyn FnMut(&Expr)) {
    let own = rule.lets.iter().map(|l| &l.value).chain(&rule.tests).chain(&rule.condition);
    own.for_each(&mut *visit);
    for alternative in &rule.alternatives {
        alternative.weight.iter().for_each(&mut *visit);
        match &alternative.successor {
            Successor::Erase => {}
            Successor::Relabel(m) => m.args.iter().for_each(&mut *visit),
            Successor::Word(word) => word.modules.iter().flat_map(|m| &m.args).for_each(&mut *visit),
            Successor::Surface(word) => {
                surface_modules(word, &mut |m| m.args.iter().for_each(&mut *visit));
            }
            // Of meshes, which are refused.
            Successor::Face(_) => {}
            Successor::Split(block) => of_cells(&block.cells, visit),
        }
    }
}

fn of_cells(cells: &[Cell], visit: &mut dyn FnMut(&Expr)) {
    for cell in cells {
        match cell {
            Cell::Eps => {}
            Cell::Module(m) => m.args.iter().for_each(&mut *visit),
            Cell::Block(block) => of_cells(&block.cells, visit),
        }
    }
}
