//! How a command ends.

use std::fmt::Display;
use std::process::ExitCode;

/// A command that ran.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Nothing to report.
    Fine,
    /// It found what it looks for: wrong rays, say.
    Findings,
}

/// A command that could not run.
#[derive(Debug)]
pub enum Failure {
    /// Arguments that contradict each other.
    Usage(anyhow::Error),
    /// An input that cannot be used.
    Input(anyhow::Error),
    /// An output that could not be written.
    Output(anyhow::Error),
}

impl Failure {
    pub fn usage(text: impl Display) -> Failure {
        Failure::Usage(anyhow::anyhow!("{text}"))
    }

    pub fn input(error: impl Display) -> Failure {
        Failure::Input(anyhow::anyhow!("{error}"))
    }

    /// An output failed: a pipe that its reader closed ends the command quietly.
    pub fn output(what: &str, error: std::io::Error) -> Failure {
        Failure::Output(anyhow::Error::new(error).context(what.to_owned()))
    }

    /// Reports on stderr, and gives the exit code.
    pub fn report(self) -> ExitCode {
        let (error, code) = match self {
            Failure::Usage(error) => (error, 2),
            Failure::Input(error) => (error, 3),
            Failure::Output(error) => {
                let closed = error
                    .downcast_ref::<std::io::Error>()
                    .is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe);
                if closed {
                    return ExitCode::SUCCESS;
                }
                (error, 4)
            }
        };
        eprintln!("enfilade: {error:#}");
        ExitCode::from(code)
    }
}
