//! Words of curves as `.json`: every module with its symbol and parameters.
//!
//! ```json
//! {"version": 1, "kind": "curve", "system": "chaikin", "steps": 3, "topology": "ring",
//!  "modules": [{"symbol": "P", "params": [[0.25, 0.0]]}, …]}
//! ```
//!
//! A module that does not hang on the one before it tells its `parent`, the index of a module or null, and whether it is
//! the first of a branch: `"parent": 3, "lateral": true`.
//!
//! Several words are a list, each with what it was derived with:
//!
//! ```json
//! {"version": 1, "kind": "curves", "words": [
//! {"set": {"w": 0.25}, "seed": 7, "word": {"version": 1, "kind": "curve", …}}, …]}
//! ```

use super::super::number::Number;
use super::super::write::WriteError;
use crate::curve::{Word, Words};
use crate::language::Value;
use crate::language::system::Topology;
use serde::ser::{Serialize, SerializeSeq, Serializer};
use serde_json::json;
use std::io::Write;

/// Writes a word.
///
/// # Errors
/// What the writer reports; a number that is not finite, naming the module.
pub fn write(writer: &mut dyn Write, word: &Word) -> Result<(), WriteError> {
    object(writer, word)?;
    Ok(writeln!(writer)?)
}

/// Writes several words that these starts have become; the seed is null where it was that of the run.
///
/// # Errors
/// What the writer reports; a number that is not finite, naming the word and the module.
pub fn write_words(writer: &mut dyn Write, starts: &Words, words: &[Word]) -> Result<(), WriteError> {
    write!(writer, "{{\"version\":1,\"kind\":\"curves\",\"words\":[")?;
    for (n, (start, word)) in starts.words.iter().zip(words).enumerate() {
        let comma = if n == 0 { "" } else { "," };
        write!(writer, "{comma}\n{{\"set\":{{")?;
        for (k, (name, value)) in start.set.iter().enumerate() {
            let comma = if k == 0 { "" } else { "," };
            let value = serde_json::to_string(&Param(value)).map_err(std::io::Error::from)?;
            write!(writer, "{comma}{}:{value}", json!(name))?;
        }
        write!(writer, "}},\"seed\":{},\"word\":", json!(start.seed))?;
        object(writer, word).map_err(|e| e.of_word(n, words.len()))?;
        write!(writer, "}}")?;
    }
    Ok(writeln!(writer, "\n]}}")?)
}

fn object(writer: &mut dyn Write, word: &Word) -> Result<(), WriteError> {
    let topology = match word.topology {
        Topology::Ring => "ring",
        Topology::Open => "open",
        Topology::Tree => "tree",
    };
    let (system, steps) = (json!(word.system), word.steps);
    write!(
        writer,
        "{{\"version\":1,\"kind\":\"curve\",\"system\":{system},\"steps\":{steps},\"topology\":\"{topology}\",\
         \"modules\":["
    )?;
    for (n, module) in word.modules.iter().enumerate() {
        let values = word.params(n).to_vec();
        let floats = values.iter().flat_map(Value::words).zip(values.iter().flat_map(are_floats));
        let wrong = floats.map(|(w, is)| (f32::from_bits(w), is)).find(|(x, is)| *is && !x.is_finite());
        if let Some((x, _)) = wrong {
            return Err(WriteError::not_finite(format_args!("module {n}"), x));
        }
        let symbol = json!(word.symbols[module.symbol].name);
        let params: Vec<Param> = values.iter().map(Param).collect();
        let params = serde_json::to_string(&params).map_err(std::io::Error::from)?;
        let comma = if n == 0 { "" } else { "," };
        write!(writer, "{comma}\n{{\"symbol\":{symbol},\"params\":{params}")?;
        // Where nothing is said, a module hangs on the one before.
        if module.parent != n.checked_sub(1) || module.lateral {
            let (parent, lateral) = (json!(module.parent), module.lateral);
            write!(writer, ",\"parent\":{parent},\"lateral\":{lateral}")?;
        }
        write!(writer, "}}")?;
    }
    Ok(write!(writer, "\n]}}")?)
}

/// For each word of a value whether it is a float.
fn are_floats(value: &Value) -> Vec<bool> {
    vec![!matches!(value, Value::Int(_) | Value::Bool(_)); value.words().len()]
}

struct Param<'a>(&'a Value);

impl Serialize for Param<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let vector = |serializer: S, v: &[f32]| {
            let mut list = serializer.serialize_seq(Some(v.len()))?;
            v.iter().try_for_each(|&x| list.serialize_element(&Number(x)))?;
            list.end()
        };
        match self.0 {
            Value::Bool(b) => serializer.serialize_bool(*b),
            Value::Int(i) => serializer.serialize_i32(*i),
            Value::Float(x) => Number(*x).serialize(serializer),
            Value::Vec2(v) => vector(serializer, v),
            Value::Vec3(v) => vector(serializer, v),
            Value::Vec4(v) => vector(serializer, v),
            Value::List(list) => {
                let mut all = serializer.serialize_seq(Some(list.len()))?;
                list.iter().try_for_each(|v| all.serialize_element(&Param(v)))?;
                all.end()
            }
        }
    }
}
