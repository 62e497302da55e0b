//! Error enums, each naming the offending thing.
