//! The command line in a folder of its own.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

/// A folder of its own for each test, removed at the end. The crate `assert_cmd` would add
/// nothing: what every failure must show is checked in [`Folder::fails`].
pub struct Folder(
    pub PathBuf,
    #[allow(dead_code, reason = "removes it")] TempDir,
);

impl Folder {
    /// An empty one.
    pub fn new() -> Self {
        let folder = TempDir::with_prefix("conemarch-cli-").expect("a folder for the test");
        Self(folder.path().to_path_buf(), folder)
    }

    pub fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_conemarch"));
        command.args(args).current_dir(&self.0);
        command.stdin(Stdio::null());
        command
    }

    pub fn run(&self, args: &[&str]) -> Output {
        self.command(args).output().expect("the program starts")
    }

    /// Runs what must succeed.
    pub fn done(&self, args: &[&str]) -> Output {
        let output = self.run(args);
        assert_eq!(output.status.code(), Some(0), "{args:?}: {}", said(&output));
        output
    }

    /// Runs what must fail with a code and one sentence that holds some words, and
    /// must leave no new file.
    pub fn fails(&self, args: &[&str], code: i32, words: &[&str]) {
        let before = self.files();
        let output = self.run(args);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(code), "{args:?}: {said}");
        let errors: Vec<&str> = said.lines().filter(|l| l.starts_with("error: ")).collect();
        assert_eq!(errors.len(), 1, "one sentence for {args:?}: {said}");
        assert_eq!(said.lines().last(), Some(errors[0]), "{said}");
        for word in words {
            assert!(
                errors[0].contains(word),
                "{args:?}: `{word}` not in: {said}"
            );
        }
        assert!(
            output.stdout.is_empty(),
            "{args:?} wrote to standard output"
        );
        assert_eq!(self.files(), before, "{args:?} left a file");
    }

    pub fn files(&self) -> Vec<String> {
        let files = fs::read_dir(&self.0).expect("the folder");
        let names = files.map(|f| f.expect("a file").file_name());
        let mut names: Vec<String> = names.map(|n| n.to_string_lossy().into()).collect();
        names.sort();
        names
    }

    pub fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.0.join(name)).expect(name)
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.0.join(name), content).expect(name);
    }
}

pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

pub fn text(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("text")
}

/// Sends a signal to a process, by a shell: a bare machine has no program for it.
pub fn signal(process: u32, name: &str) {
    let command = format!("kill -{name} {process}");
    let sent = Command::new("sh").args(["-c", &command]).status();
    assert!(sent.expect("a shell").success());
}
