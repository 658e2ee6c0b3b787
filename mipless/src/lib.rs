//! Self-filtering procedural texture graphs: load, check, edit, compile and evaluate.
