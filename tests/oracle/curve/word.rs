//! Words of curve systems: strings of modules, in trees with brackets.

use super::super::lots::Path;
use super::super::word::Param;
use std::fmt;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topology {
    Ring,
    Open,
    Tree,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Module {
    pub symbol: String,
    pub params: Vec<Param>,
    /// For random numbers.
    pub path: Path,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Token {
    Module(Module),
    /// `[`
    Open,
    /// `]`
    Close,
    /// Behind it begins a new curve: the turtle has moved without drawing.
    Break,
}

/// The word between two steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Word {
    pub topology: Topology,
    pub tokens: Vec<Token>,
}

/// What a module hangs on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Link {
    /// Its index in the word; `None` for what begins a curve.
    pub parent: Option<usize>,
    /// Whether it is the first of a branch.
    pub lateral: bool,
}

impl Word {
    /// A word without what a string cannot mean: empty branches, breaks with nothing on one side.
    pub fn new(topology: Topology, mut tokens: Vec<Token>) -> Word {
        loop {
            let before = tokens.len();
            let open = |t: Option<&Token>| matches!(t, None | Some(Token::Open));
            let close = |t: Option<&Token>| matches!(t, None | Some(Token::Close));
            let mut kept: Vec<Token> = Vec::with_capacity(before);
            for (i, token) in tokens.iter().enumerate() {
                let next = tokens.get(i + 1);
                match token {
                    // A curve in a branch that lost all before it still hangs on nothing.
                    Token::Break if close(next) || matches!(next, Some(Token::Break)) => {}
                    Token::Break if kept.is_empty() && open(kept.last()) => {}
                    Token::Close if matches!(kept.last(), Some(Token::Open)) => _ = kept.pop(),
                    _ => kept.push(token.clone()),
                }
            }
            tokens = kept;
            if tokens.len() == before {
                return Word { topology, tokens };
            }
        }
    }

    pub fn modules(&self) -> impl Iterator<Item = &Module> {
        self.tokens.iter().filter_map(|token| match token {
            Token::Module(module) => Some(module),
            _ => None,
        })
    }

    pub fn len(&self) -> usize {
        self.modules().count()
    }

    /// What each module hangs on. Of a ring they say nothing about its closing.
    pub fn links(&self) -> Vec<Link> {
        let mut links = Vec::new();
        let mut here = Link { parent: None, lateral: false };
        let mut stack = Vec::new();
        for token in &self.tokens {
            match token {
                Token::Module(_) => {
                    links.push(here);
                    here = Link { parent: Some(links.len() - 1), lateral: false };
                }
                Token::Open => {
                    stack.push(here);
                    here.lateral = true;
                }
                Token::Close => here = stack.pop().expect("brackets in pairs"),
                Token::Break => here = Link { parent: None, lateral: false },
            }
        }
        links
    }
}

/// As it is written: `A(1, true) [ B ] C`, and `,` where a new curve begins.
impl fmt::Display for Word {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let texts: Vec<String> = self.tokens.iter().map(Token::to_string).collect();
        f.write_str(&texts.join(" "))
    }
}

impl fmt::Display for Token {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Token::Module(module) => module.fmt(f),
            Token::Open => f.write_str("["),
            Token::Close => f.write_str("]"),
            Token::Break => f.write_str(","),
        }
    }
}

impl fmt::Display for Module {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.symbol)?;
        if self.params.is_empty() {
            return Ok(());
        }
        let param = |p: &Param| match p {
            Param::Int(i) => i.to_string(),
            Param::Bool(b) => b.to_string(),
            Param::Float(x) => x.to_string(),
            vector => {
                let parts: Vec<String> = vector.floats().iter().map(f64::to_string).collect();
                format!("({})", parts.join(", "))
            }
        };
        write!(f, "({})", self.params.iter().map(param).collect::<Vec<_>>().join(", "))
    }
}
