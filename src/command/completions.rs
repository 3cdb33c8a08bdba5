//! `conemarch completions SHELL`, and the answers to the scripts that it prints.
//!
//! A script asks this program for what may come next, so that it completes the presets and
//! keys of the program that is installed.

use std::ffi::OsStr;

use anyhow::Result;
use clap::builder::PossibleValuesParser;
use clap::{Args, Command};
use clap_complete::engine::{
    ArgValueCompleter, CompletionCandidate, PathCompleter, ValueCompleter,
};
use clap_complete::env::{CompleteEnv, Shells};

use crate::command::print::print;
use crate::preset::{BUILTIN, keys};

/// The variable by which a script asks.
const VARIABLE: &str = "CONEMARCH_COMPLETE";

/// Bash breaks words at `=` and `:`. This joins them again, and takes from the answers what stands
/// before the last sign.
const BASH: &str = r#"
_conemarch() {
    local -a joined=()
    local i word glue="" at=0
    for i in "${!COMP_WORDS[@]}"; do
        word="${COMP_WORDS[i]}"
        if [[ $i -gt 1 && ( -n $glue || $word == [=:]* ) ]]; then
            joined[at]+="$word"
        else
            at=${#joined[@]}
            joined[at]="$word"
        fi
        glue=""
        [[ $word == *[=:] ]] && glue=1
        [[ $i -eq $COMP_CWORD ]] && break
    done
    local -a COMP_WORDS=("${joined[@]}")
    local COMP_CWORD=$at current="${joined[at]}"
    _clap_complete_conemarch "$1" "$current" "$3"
    local before="${current%"${current##*[=:]}"}"
    COMPREPLY=("${COMPREPLY[@]#"$before"}")
}
asked=$(complete -p conemarch)
eval "${asked/_clap_complete_conemarch/_conemarch}"
unset asked
"#;

/// What `completions` takes.
#[derive(Args, Debug)]
pub struct Completions {
    /// The shell to complete in
    #[arg(value_name = "SHELL", value_parser = PossibleValuesParser::new(Shells::builtins().names()))]
    shell: String,
}

/// Prints the completion script of a shell.
///
/// # Errors
/// Standard output cannot be written.
pub fn run(args: &Completions) -> Result<()> {
    let mut script = Vec::new();
    if let Some(shell) = Shells::builtins().completer(&args.shell) {
        let name = "conemarch";
        shell.write_registration(VARIABLE, name, name, name, &mut script)?;
        if shell.name() == "bash" {
            script.extend(BASH.bytes());
        }
    }
    print(&script)
}

/// Answers a completion script and ends the process, if one asks.
pub fn answer(line: fn() -> Command) {
    CompleteEnv::with_factory(line).var(VARIABLE).complete();
}

/// Completes the argument PRESET: built-in names and files.
pub fn presets() -> ArgValueCompleter {
    ArgValueCompleter::new(|current: &OsStr| {
        let start = current.as_encoded_bytes();
        let names = BUILTIN.iter().map(|(name, _)| *name);
        let names = names.filter(|name| name.as_bytes().starts_with(start));
        let mut found: Vec<_> = names.map(CompletionCandidate::new).collect();
        found.extend(PathCompleter::any().complete(current));
        found
    })
}

/// Completes the keys of `--set`, and behind the sign the words that a key takes.
pub fn settings() -> ArgValueCompleter {
    ArgValueCompleter::new(|current: &OsStr| {
        let current = current.to_string_lossy();
        let mut found = Vec::new();
        for (key, help, words) in keys() {
            let start = format!("{key}=");
            if current.starts_with(&start) {
                let full = words.iter().map(|word| format!("{start}{word}"));
                let full = full.filter(|full| full.starts_with(&*current));
                found.extend(full.map(CompletionCandidate::new));
            } else if start.starts_with(&*current) {
                found.push(CompletionCandidate::new(start).help(Some(help.to_string().into())));
            }
        }
        found
    })
}
