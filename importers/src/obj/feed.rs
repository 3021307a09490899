//! The way from a file into `tobj`: a reader that hands it only statements that a guard has looked at.
//!
//! `tobj` reads from a `BufRead`, keeps no line numbers in its errors, and panics or errs on some statements that
//! occur in practice. The [`Feed`] stands between: it takes one statement from the file, gives it to the
//! [`Guard`], and hands on what the guard makes of it. As it is always at one statement, an error of `tobj` is
//! about that one.

use std::io::{self, BufRead, Read};

use crate::error::{ImportError, ImportErrorKind};
use crate::limits::Budget;
use crate::obj::lines::{LineError, Lines};
use crate::watch::Watch;

/// Looks at each statement before `tobj` does.
pub(super) trait Guard {
    /// Writes what `tobj` shall read for `statement`, which starts at line `number`: nothing, or whole lines.
    fn statement(
        &mut self,
        number: u64,
        statement: &[u8],
        budget: &mut Budget,
        out: &mut Vec<u8>,
    ) -> Result<(), ImportError>;

    /// The file has ended.
    fn end(&mut self, budget: &mut Budget) -> Result<(), ImportError>;

    /// An error about line `number`, with the guard's file and the element that it is in.
    fn error(&self, number: u64, kind: ImportErrorKind) -> ImportError;
}

/// A `BufRead` for `tobj` over `R`, through guard `G`.
pub(super) struct Feed<'a, R, G> {
    lines: Lines<R>,
    guard: G,
    budget: &'a mut Budget,
    watch: &'a Watch,
    /// Called with the source every few statements.
    progress: &'a dyn Fn(&R),
    out: Vec<u8>,
    given: usize,
    statements: u64,
    ended: bool,
    failure: Option<ImportError>,
}

impl<'a, R: BufRead, G: Guard> Feed<'a, R, G> {
    pub(super) fn new(
        source: R,
        guard: G,
        budget: &'a mut Budget,
        watch: &'a Watch,
        progress: &'a dyn Fn(&R),
    ) -> Self {
        Feed {
            lines: Lines::new(source),
            guard,
            budget,
            watch,
            progress,
            out: Vec::new(),
            given: 0,
            statements: 0,
            ended: false,
            failure: None,
        }
    }

    /// The guard's or the reader's error if there was one, else `tobj`'s, at the statement in hand.
    pub(super) fn failure(&mut self, error: tobj::LoadError) -> ImportError {
        if let Some(failure) = self.failure.take() {
            return failure;
        }
        let text = String::from_utf8_lossy(self.lines.text());
        let kind = ImportErrorKind::Malformed(format!("{}: '{}'", in_words(error), excerpt(text.trim())));
        self.guard.error(self.lines.number(), kind)
    }

    /// The source and the guard, after the end.
    pub(super) fn into_parts(self) -> (R, G) {
        let (source, taken) = self.lines.into_source();
        self.budget.give_back(taken);
        (source, self.guard)
    }

    fn next_statement(&mut self) -> Result<(), ImportError> {
        self.out.clear();
        self.given = 0;
        self.statements += 1;
        if self.statements.is_multiple_of(4096) {
            self.watch.check().map_err(|e| self.guard.error(self.lines.number(), e.into()))?;
            (self.progress)(self.lines.source());
        }
        match self.lines.advance(self.budget) {
            Ok(true) => {}
            Ok(false) => {
                self.ended = true;
                return self.guard.end(self.budget);
            }
            // The line that cannot be read is the one after the last one that could.
            Err(LineError::Io(e)) => return Err(self.guard.error(self.lines.number() + 1, e.into())),
            Err(LineError::OverBudget(e)) => return Err(self.guard.error(self.lines.number() + 1, e.into())),
        }
        let (number, text) = (self.lines.number(), self.lines.text());
        if text.contains(&0) {
            let kind = ImportErrorKind::Malformed("a zero byte: this is no text file".to_owned());
            return Err(self.guard.error(number, kind));
        }
        self.guard.statement(number, text, self.budget, &mut self.out)
    }
}

impl<R: BufRead, G: Guard> BufRead for Feed<'_, R, G> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        while self.given >= self.out.len() && !self.ended {
            if let Err(error) = self.next_statement() {
                self.failure = Some(error);
                self.out.clear();
                self.ended = true;
                return Err(io::Error::other("refused by the guard"));
            }
        }
        Ok(self.out.get(self.given..).unwrap_or_default())
    }

    fn consume(&mut self, count: usize) {
        self.given += count;
    }
}

impl<R: BufRead, G: Guard> Read for Feed<'_, R, G> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(buffer)?;
        self.consume(count);
        Ok(count)
    }
}

/// The start of a text, for messages.
pub(super) fn excerpt(text: &str) -> String {
    const LONGEST: usize = 40;
    let mut start: String =
        text.chars().take(LONGEST).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().nth(LONGEST).is_some() {
        start.push_str("...");
    }
    start
}

fn in_words(error: tobj::LoadError) -> String {
    use tobj::LoadError;
    match error {
        LoadError::PositionParseError => "a vertex is three numbers".to_owned(),
        LoadError::ColorParseError => "a vertex is three numbers, and a weight or a colour".to_owned(),
        LoadError::ScalingByZeroError => "a vertex of weight zero".to_owned(),
        LoadError::FaceParseError => "a face is at least three corners v, v/vt, v//vn or v/vt/vn".to_owned(),
        LoadError::FaceVertexOutOfBounds => "a face refers to a vertex that there is not".to_owned(),
        LoadError::MaterialParseError => "a material's value cannot be read".to_owned(),
        other => other.to_string(),
    }
}
