//! What stands around a module, and what names it and its children.

use super::{Graph, Names, Node, NodeId, Scalar};
use crate::language::system::Hang;
use crate::plan::context::{Near, Place, Search};
use crate::plan::layout::NONE;

impl Graph {
    /// Where a place of a linked word is.
    pub(super) fn place(&mut self, place: Place, searches: &[Search]) -> NodeId {
        let node = match place {
            Place::Strict(0) | Place::Before(0) => Node::Index,
            Place::Strict(n) => Node::Beside(n),
            Place::Before(n) => Node::Up(self.place(Place::Before(n - 1), searches)),
            Place::Behind { last, steps: 0 } => return self.place(Place::Strict(last), searches),
            Place::Behind { last, steps } => {
                Node::Down(self.place(Place::Behind { last, steps: steps - 1 }, searches))
            }
            Place::Previous => Node::Previous,
            Place::Found { search, step } => {
                // All at once: a backend fills these nodes in one go.
                let first = self.push(Node::Search(search));
                let steps = 1..searches[search].steps.len();
                steps.for_each(|step| _ = self.push(Node::Found { search: first, step }));
                return first + step;
            }
        };
        self.push(node)
    }

    /// What a child hangs on.
    pub fn link(&mut self, hang: &Hang) -> NodeId {
        if hang.root {
            return self.int(NONE);
        }
        self.push(Node::Link { cell: hang.on.map(|cell| cell as u32), lateral: hang.lateral })
    }

    /// Whether the symbol that a context asks for stands in its place.
    pub fn near(&mut self, near: &Near, names: &Names) -> NodeId {
        let found = match names.linked {
            true => {
                let there = self.place(near.place, names.searches);
                self.push(Node::SymbolAt(there))
            }
            false => self.push(Node::NearSymbol(near.place.offset())),
        };
        let wanted = self.int(near.symbol);
        self.ints("==", &[found, wanted])
    }

    /// Whether so many modules, this one the first, stand before the end of the word.
    pub fn has_behind(&mut self, modules: u32) -> NodeId {
        let behind = self.push(Node::Behind);
        let wanted = self.int(modules);
        self.ints(">=", &[behind, wanted])
    }

    /// The words of a curve module's path.
    pub fn path(&mut self) -> [NodeId; 2] {
        [1, 2].map(|word| self.push(Node::Field(Scalar::Int, word)))
    }

    /// Those of its child in this slot: 64 bits, since paths are as many as modules.
    pub fn child_path(&mut self, slot: u32) -> [NodeId; 2] {
        let [high, low] = self.path();
        let slot = self.int(slot);
        let high = self.ints("hash #", &[high, slot]);
        [high, self.ints("hash #", &[low, high])]
    }

    /// That of a child in this slot which is a root: what stands for it is its number in the word.
    pub fn root_path(&mut self, slot: u32) -> [NodeId; 2] {
        [self.int(0), self.push(Node::Number(slot))]
    }

    /// The word of the record that says which of several words it is of.
    pub fn word_of(&mut self, field: usize) -> NodeId {
        self.push(Node::Field(Scalar::Int, field))
    }
}
