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

    /// The program with the words of a line, none of which may hold a blank.
    pub fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_conemarch"));
        command.args(line.split_whitespace()).current_dir(&self.0);
        command.stdin(Stdio::null());
        command
    }

    /// Runs a command line that must succeed.
    pub fn done(&self, line: &str) -> Output {
        let output = output(&mut self.command(line));
        assert_eq!(output.status.code(), Some(0), "{line}: {}", said(&output));
        output
    }

    /// Runs a command line as if the disk were full: no file may be longer than so many bytes.
    #[cfg(unix)]
    #[allow(dead_code, reason = "not every test program fills a disk")]
    pub fn limited(&self, line: &str, bytes: u64) -> Output {
        let shell = format!(
            "trap '' XFSZ; ulimit -f {}; exec {} {line}",
            // Blocks.
            bytes / 512,
            env!("CARGO_BIN_EXE_conemarch")
        );
        output(Command::new("sh").args(["-c", &shell]).current_dir(&self.0))
    }

    /// Runs a command line that must fail with a code and one sentence that holds some
    /// parts, with `|` between them, and must leave no new file.
    pub fn fails(&self, line: &str, code: i32, parts: &str) {
        let args: Vec<&str> = line.split_whitespace().collect();
        self.fails_with(&args, code, parts);
    }

    /// The same for words that may be empty or hold blanks.
    pub fn fails_with(&self, args: &[&str], code: i32, parts: &str) {
        let before = self.files();
        let output = output(self.command("").args(args));
        let said = said(&output);
        assert_eq!(output.status.code(), Some(code), "{args:?}: {said}");
        let errors: Vec<&str> = said.lines().filter(|l| l.starts_with("error: ")).collect();
        assert_eq!(errors.len(), 1, "one sentence for {args:?}: {said}");
        assert_eq!(said.lines().last(), Some(errors[0]), "{said}");
        for part in parts.split('|') {
            let held = errors[0].contains(part);
            assert!(held, "{args:?}: `{part}` not in: {said}");
        }
        let silent = output.stdout.is_empty();
        assert!(silent, "{args:?} wrote to standard output");
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

/// Runs a command to its end.
pub fn output(command: &mut Command) -> Output {
    command.output().expect("the program starts")
}

/// Checks that a text holds some parts.
pub fn holds(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "`{part}` not in: {text}");
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
