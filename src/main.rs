//! The enfilade command.
#![forbid(unsafe_code)]

fn main() {}
