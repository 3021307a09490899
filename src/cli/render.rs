use clap::Args;

use super::failure::{Failure, Outcome};

/// Stub
#[derive(Args)]
pub struct Arguments {}

pub fn run(_: &Arguments) -> Result<Outcome, Failure> {
    Err(Failure::usage("not yet"))
}
