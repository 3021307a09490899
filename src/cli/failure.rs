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
        eprintln!("enfilade: {}", told(&error));
        ExitCode::from(code)
    }
}

/// An error and its causes; a cause that its error already tells is not told again.
fn told(error: &anyhow::Error) -> String {
    let mut text = error.to_string();
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if !text.contains(&cause) {
            text = format!("{text}: {cause}");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_are_told_once() {
        let io = || std::io::Error::other("no space");
        let error = anyhow::Error::new(io()).context("a.png: no space");
        assert_eq!(told(&error), "a.png: no space");
        assert_eq!(told(&anyhow::Error::new(io()).context("a.png")), "a.png: no space");
    }
}
