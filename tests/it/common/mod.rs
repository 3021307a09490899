//! What the tests of the whole program share: a folder of their own, the binary, small numbers.
#![allow(dead_code)]

#[cfg(feature = "compile")]
pub mod cases;
pub mod enf;
#[cfg(all(feature = "gltf", feature = "obj", feature = "compile", feature = "render"))]
pub mod forms;
#[cfg(feature = "compile")]
pub mod prisms;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A file of `fixtures/`.
pub fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name)
}

/// A fixture's path as an argument.
pub fn fixture_arg(name: &str) -> String {
    fixture(name).to_str().unwrap().to_owned()
}

/// A temporary folder in which the binary runs, so that short names do.
pub struct Folder(tempfile::TempDir);

/// How a command ended, and what it said.
#[derive(Debug)]
pub struct Ran {
    pub code: i32,
    pub out: Vec<u8>,
    pub err: String,
}

impl Ran {
    /// What it wrote to stdout, as text.
    pub fn text(&self) -> &str {
        std::str::from_utf8(&self.out).unwrap()
    }

    /// What it wrote to stdout, as JSON and nothing else.
    pub fn json(&self) -> serde_json::Value {
        serde_json::from_slice(&self.out).unwrap_or_else(|e| panic!("{e}: {}", self.text()))
    }

    /// Panics unless it ended with `code`.
    #[track_caller]
    pub fn expect(self, code: i32) -> Ran {
        assert_eq!(self.code, code, "stderr: {}\nstdout: {}", self.err, String::from_utf8_lossy(&self.out));
        self
    }

    /// Panics unless it failed with `code`, wrote no data, and named all of `words` on stderr in one line.
    #[track_caller]
    pub fn expect_failure(self, code: i32, words: &[&str]) -> Ran {
        let ran = self.expect(code);
        assert!(ran.out.is_empty(), "data beside a failure: {}", String::from_utf8_lossy(&ran.out));
        assert_eq!(ran.err.trim_end().lines().count(), 1, "{}", ran.err);
        for word in words {
            assert!(ran.err.contains(word), "no '{word}' in: {}", ran.err);
        }
        ran
    }
}

impl Folder {
    pub fn new() -> Folder {
        Folder(tempfile::tempdir().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), bytes).unwrap();
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// The names of all files in it, sorted.
    pub fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// The binary, to be run in the folder.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_enfilade"));
        command.args(arguments).current_dir(self.0.path());
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// Runs the binary with nothing on stdin.
    pub fn run(&self, arguments: &[&str]) -> Ran {
        self.run_with(arguments, b"")
    }

    /// Runs the binary with `stdin`. Whatever it does, it does not panic.
    pub fn run_with(&self, arguments: &[&str], stdin: &[u8]) -> Ran {
        let mut child = self.command(arguments).spawn().unwrap();
        let mut to_child = child.stdin.take().unwrap();
        let output = std::thread::scope(|scope| {
            // A command that fails early leaves its stdin unread: no failure of this test.
            scope.spawn(move || to_child.write_all(stdin).ok());
            child.wait_with_output().unwrap()
        });
        let err = String::from_utf8(output.stderr).unwrap();
        assert!(!err.contains("panicked"), "{arguments:?}: {err}");
        let code = output.status.code().unwrap_or_else(|| panic!("{arguments:?}: {}", output.status));
        Ran { code, out: output.stdout, err }
    }

    /// Compiles the house to `house.enf`.
    pub fn compile_house(&self) {
        self.run(&["compile", &fixture_arg("house.glb"), "-o", "house.enf"]).expect(0);
    }
}
