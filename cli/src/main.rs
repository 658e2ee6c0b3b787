//! The command `mipless`.

fn main() {}
