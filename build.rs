//! Tells the program by `CONEMARCH_BUILD` which sources it is made of: parts of a picture by two
//! builds must not be joined.

use std::path::{Path, PathBuf};
use std::{fs, io};

/// FNV-1a of 64 bits (Fowler, Noll, Vo): the same for the same sources everywhere.
const START: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0100_0000_01b3;

fn main() -> io::Result<()> {
    let mut files = Vec::new();
    for source in ["Cargo.lock", "Cargo.toml", "src", "wgsl"] {
        println!("cargo:rerun-if-changed={source}");
        list(Path::new(source), &mut files)?;
    }
    files.sort();
    let mut hash = START;
    for file in files {
        for byte in fs::read(file)? {
            hash = (hash ^ u64::from(byte)).wrapping_mul(PRIME);
        }
    }
    println!("cargo:rustc-env=CONEMARCH_BUILD={hash:016x}");
    Ok(())
}

/// Adds the files of a folder, or a file if it is there.
fn list(path: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    if path.is_dir() {
        for entry in fs::read_dir(path)? {
            list(&entry?.path(), files)?;
        }
    } else if path.exists() {
        files.push(path.to_path_buf());
    }
    Ok(())
}
