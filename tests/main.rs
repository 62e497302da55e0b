//! All integration tests, in one binary so that linking stays cheap.
mod arrows;
mod check;
mod command;
mod grid;
mod io;
mod oracle;
mod papers;
mod parity;
mod parse;
mod render;
mod scan;
