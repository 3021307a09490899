//! Writing: to stdout, or to a file that appears whole or not at all.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use serde::Serialize;

use super::failure::{Failure, Outcome};

/// Prints a text.
pub fn print(text: &str) -> Result<Outcome, Failure> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(|e| Failure::output("stdout", e))?;
    Ok(Outcome::Fine)
}

/// Prints a report as JSON.
pub fn print_json(report: &impl Serialize) -> Result<Outcome, Failure> {
    let text = serde_json::to_string_pretty(report).map_err(|e| Failure::output("stdout", e.into()))?;
    print(&(text + "\n"))
}

/// Runs `write` on a writer to stdout (no path, or `-`) or to a new file that replaces `path` when it is complete.
pub fn write(
    path: Option<&Path>,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Failure> {
    match path {
        Some(path) if path != Path::new("-") => enfilade::format::write_atomically(path, |file| {
            let mut out = BufWriter::new(file);
            write(&mut out)?;
            out.flush()
        })
        .map_err(|e| Failure::output(&path.display().to_string(), e)),
        _ => {
            let mut out = BufWriter::new(io::stdout().lock());
            write(&mut out).and_then(|()| out.flush()).map_err(|e| Failure::output("stdout", e))
        }
    }
}
