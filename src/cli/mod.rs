//! The command line. Data goes to stdout, diagnostics to stderr; exit codes: 0 fine, 1 findings, 2 usage, 3 input,
//! 4 output.

mod bench;
mod bench_cells;
mod bench_model;
mod bench_robust;
mod bench_skip;
mod bench_sources;
mod compile;
mod doors;
mod export;
mod failure;
mod generate;
mod hide;
mod input;
mod inspect;
mod output;
mod plan;
mod render;
mod space;
mod stress;
mod style;
mod trace;
mod validate;
mod verify;
mod walk;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};
use failure::{Failure, Outcome};

/// Fast, accurate ray tracing of buildings.
///
/// Reads tagged glTF and OBJ models of buildings, compiles them to scenes (.enf), and answers rays and makes pictures
/// from them. Coordinates are in the model's own frame and unit everywhere, unless --frame internal is given.
#[derive(Parser)]
#[command(version, max_term_width = 110, after_help = EXAMPLES)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

const EXAMPLES: &str = "\
Examples:
  enfilade generate house -o house.glb            make a small house
  enfilade inspect house.glb                      what is in it
  enfilade validate house.glb                     do its rooms, doors and windows make sense?
  enfilade compile house.glb -o house.enf         compile it
  enfilade render house.enf -o house.png          a picture from the largest room
  enfilade walk house.enf                         walk through its rooms, and tell how fast
  echo '2 1.6 -3 1 0 0' | enfilade trace house.enf --rays -
  enfilade plan house.enf -o house.svg            its floor plan
  enfilade export house.enf --graph house.json    its rooms and what its doors and windows join
  enfilade verify house.enf --model house.glb     check a million random rays

Exit codes: 0 fine, 1 findings, 2 wrong usage, 3 bad input, 4 output failed.";

#[derive(Subcommand)]
enum Command {
    Inspect(inspect::Arguments),
    Compile(compile::Arguments),
    Validate(validate::Arguments),
    Trace(trace::Arguments),
    Render(render::Arguments),
    Walk(walk::Arguments),
    Plan(plan::Arguments),
    Export(export::Arguments),
    Verify(verify::Arguments),
    Bench(bench::Arguments),
    Stress(stress::Arguments),
    Generate(generate::Arguments),
    /// Print the shipped table of tagging rules, to read or to edit (see --rules).
    Rules,
    /// Print a completion script for a shell.
    #[command(after_help = "Example:\n  enfilade completions bash > /etc/bash_completion.d/enfilade")]
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
}

/// Parses the arguments, runs the command, reports a failure.
pub fn main() -> ExitCode {
    let arguments = match Arguments::try_parse_from(input::join_points(std::env::args_os())) {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help and version go to stdout and are no failure; a closed pipe is none either.
            let _ = error.print();
            return ExitCode::from(if error.use_stderr() { 2 } else { 0 });
        }
    };
    match run(arguments.command) {
        Ok(Outcome::Fine) => ExitCode::SUCCESS,
        Ok(Outcome::Findings) => ExitCode::from(1),
        Err(failure) => failure.report(),
    }
}

fn run(command: Command) -> Result<Outcome, Failure> {
    match command {
        Command::Inspect(arguments) => inspect::run(&arguments),
        Command::Compile(arguments) => compile::run(&arguments),
        Command::Validate(arguments) => validate::run(&arguments),
        Command::Trace(arguments) => trace::run(&arguments),
        Command::Render(arguments) => render::run(&arguments),
        Command::Walk(arguments) => walk::run(&arguments),
        Command::Plan(arguments) => plan::run(&arguments),
        Command::Export(arguments) => export::run(&arguments),
        Command::Verify(arguments) => verify::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Stress(arguments) => stress::run(&arguments),
        Command::Generate(arguments) => generate::run(&arguments),
        Command::Rules => output::print(enfilade::importers::tagging::Rules::shipped_text()),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Arguments::command(), "enfilade", &mut script);
            output::print(&String::from_utf8_lossy(&script))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_are_consistent() {
        Arguments::command().debug_assert();
    }
}
