//! Patch systems: words of Bézier control nets, each with its address in the derivation tree. Modules have no neighbours.

use super::WordKind;
use crate::language::expr::Value;
use crate::language::system::{self, Kind, Rule, Successor, System};
use crate::patch;
use crate::plan::collect::{Collected, symbols, whole, words_of};
use crate::plan::columns::Content;
use crate::plan::layout::{self, Header, Layout};
use crate::plan::program::{Call, Over, Program, Work};
use crate::plan::start::Start;
use crate::plan::step::Pass;
use crate::plan::supported::Unsupported;
use crate::plan::tables::{Becomes, Builder, Resolve, RulesOf, Stage, successor};
use crate::plan::{Error, Plan, Settings};
use crate::word::Params;

/// See [`WordKind`].
#[derive(Debug)]
pub struct Patch;

impl WordKind for Patch {
    fn name(&self) -> &'static str {
        "patch"
    }

    fn supports(&self, rule: &Rule, _: &System) -> Result<(), Unsupported> {
        if let Some(context) = rule.left.as_ref().or(rule.right.as_ref()) {
            return Err(Unsupported::new("contexts in patch systems", context.span));
        }
        if rule.strict.len() != 1 {
            return Err(Unsupported::new("several strict predecessors in patch systems", rule.span));
        }
        match rule.alternatives.iter().find(|a| matches!(a.successor, Successor::Surface(_))) {
            Some(alternative) => Err(Unsupported::new("brackets in patch systems", alternative.span)),
            None => Ok(()),
        }
    }

    fn layout(
        &self,
        system: &System,
        _: &[RulesOf],
        param_words: usize,
        _: bool,
    ) -> Result<Layout, Unsupported> {
        let Kind::Patch { degree, .. } = system.kind else {
            return Err(Unsupported::new("nets of another kind of system", system.source.kind_span));
        };
        Ok(Layout::new(param_words, degree))
    }

    fn retires(&self) -> bool {
        true
    }

    fn becomes(
        &self,
        builder: &mut Builder,
        predecessor: usize,
        written: &Successor,
        resolve: Resolve,
    ) -> Becomes {
        match written {
            Successor::Relabel(m) => {
                Becomes::Nets { halves: 0, cells: [Some(successor(m, resolve)), None, None, None] }
            }
            Successor::Split(block) => builder.block(predecessor, block, resolve),
            // What else there is has been refused.
            _ => Becomes::Nets { halves: 0, cells: [const { None }; 4] },
        }
    }

    fn program(&self, stage: &Stage, _: &Layout, _: bool) -> Program {
        let measure = (stage.row.words > 0).then(|| Work::each(Pass::Measure));
        let emit = Work::new(Pass::Emit, vec![Call::once(Pass::Emit.row().entries, Over::Children)]);
        if stage.closed.is_some() {
            return Program { writing: measure.into_iter().chain([emit]).collect(), ..Program::default() };
        }
        let compact = stage.may_retire().then(|| Work::scan(Pass::Compact));
        let count = [Work::each(Pass::Match), Work::each(Pass::Count), Work::scan(Pass::Scan)];
        Program {
            joining: Vec::new(),
            counting: measure.into_iter().chain(count).chain(compact).collect(),
            writing: vec![emit],
            retiring: stage.may_retire().then(|| Work::each(Pass::Retire)).into_iter().collect(),
        }
    }

    fn first_symbols(&self, axiom: &system::Axiom) -> Vec<usize> {
        match axiom {
            system::Axiom::Patches(starts) => starts.iter().map(|start| start.symbol).collect(),
            _ => Vec::new(),
        }
    }

    fn header(&self, _: &Layout) -> Vec<&'static str> {
        vec!["symbol and halvings", "root", "high word of the key", "low word of the key", "row", "column"]
    }
}

impl Start for patch::Axiom {
    type Word = patch::Word;

    fn content(&self, plan: &Plan, values: &Settings, _: &[Settings]) -> Result<Content, Error> {
        plan.axiom(self, &values.uniforms)
    }
    fn roots(&self) -> usize {
        self.roots.len()
    }
    fn reads_params(&self) -> bool {
        self.roots.iter().any(|root| !root.args.is_empty())
    }
}

impl Plan {
    /// The word of the axiom: each root a module.
    ///
    /// # Errors
    /// [`Error::Axiom`] for a net of another degree, or one that does not hold together
    /// ([`patch::Net::validate`]); [`Error::Value`] for an argument without a value.
    pub fn axiom(&self, axiom: &patch::Axiom, uniforms: &[Value]) -> Result<Content, Error> {
        let layout = &self.tables.layout;
        let Some(degree) = layout.net else {
            let message = format!("{} is a curve system, and begins with points, not nets", self.system.name);
            return Err(Error::Axiom(message));
        };
        let mut records = Vec::with_capacity(axiom.roots.len() * layout.record_words);
        let mut nets = Vec::with_capacity(axiom.roots.len() * layout.net_points());
        for (root, start) in axiom.roots.iter().enumerate() {
            if start.net.degree != degree {
                let ([u, v], [m, n]) = (start.net.degree, degree);
                return Err(Error::Axiom(format!(
                    "patch {root} of the axiom has degree {u}×{v}; {} rewrites nets of degree {m}×{n}",
                    self.system.name
                )));
            }
            start
                .net
                .validate(self.rational())
                .map_err(|e| Error::Axiom(format!("patch {root} of the axiom: {e}")))?;
            let mut record = vec![0u32; layout.record_words];
            layout::Header { symbol: start.symbol as u16, root: root as u32, ..Default::default() }
                .write(&mut record);
            self.write_root(start.symbol, &start.args, uniforms, &mut record)?;
            records.extend(record);
            nets.extend(&start.net.points);
        }
        Ok(Content::of_nets(records, nets))
    }
}

/// Modules in the order of the derivation tree.
impl Collected for patch::Word {
    fn of(plan: &Plan, steps: u32, _: usize, chunks: Vec<Content>) -> Result<Self, Error> {
        word(plan, steps, whole(chunks))
    }
}

/// The word of these modules, in the order of the derivation tree.
fn word(plan: &Plan, steps: u32, content: Content) -> Result<patch::Word, Error> {
    let layout = &plan.tables.layout;
    let records = content.records();
    let headers: Vec<Header> = records.chunks_exact(layout.record_words).map(Header::read).collect();
    let place = |h: &Header| (h.root, h.key);
    let sorted = headers.is_sorted_by_key(place);
    let mut order: Vec<u32> = (0..headers.len() as u32).collect();
    if !sorted {
        order.sort_unstable_by_key(|&i| place(&headers[i as usize]));
    }
    let symbols = symbols(plan);
    let mut params = Params::new(&symbols);
    let module = |&i: &u32| {
        let header = &headers[i as usize];
        let words = words_of(plan, header.symbol as usize, i as usize)?;
        let record = &records[i as usize * layout.record_words..][..layout.record_words];
        Ok(patch::Module {
            symbol: header.symbol as usize,
            row: params.push_record(header.symbol as usize, words, record),
            root: header.root,
            key: header.key,
            cell: header.cell,
        })
    };
    let modules = order.iter().map(module).collect::<Result<_, Error>>()?;
    let points = layout.net_points();
    let net = |&i: &u32| &content.nets()[i as usize * points..][..points];
    let nets = match sorted {
        false => order.iter().flat_map(net).copied().collect(),
        true => content.into_nets(),
    };
    Ok(patch::Word {
        system: plan.system.name.clone(),
        steps,
        symbols,
        degree: layout.net.unwrap_or_default(),
        rational: plan.rational(),
        modules,
        params,
        nets,
    })
}
