//! Tests of what callers see, through the library and the command line: one program, which links the library once.
//!
//! Those that need the strategies are part of it where the library has these: `cargo test` in the workspace's root builds it so, for the sake of
//! `fuzz/checks`; `cargo test -p enfilade` needs `--features proptest`.

mod common;

mod buildings;
mod cells;
mod cli;
mod cli_doors;
mod cli_graph;
mod cli_trace;
mod closing;
mod convexification;
mod examples;
mod faces;
mod format;
mod frozen;
mod generate;
mod graph;
mod hostile;
mod kernels;
mod model_forms;
mod noise;
mod partition;
#[cfg(feature = "proptest")]
mod partition_random;
mod places;
mod render;
#[cfg(feature = "proptest")]
mod round_trip;
mod specimens;
mod styles;
mod truth;
