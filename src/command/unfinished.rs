//! Finished bands of a big picture, in a file beside it until the picture is complete.
//!
//! The file is a line that says what it belongs to, and then the bands in order: the bytes of
//! their rows, their [`Tally`], and a hash of both. A band is in it once it is on the disk.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::command::interrupt;
use crate::command::stats::Tally;
use crate::picture::{OutputError, Place, commit, set_unfinished};

/// The begin of the first line, with the version of the format.
const MARK: &[u8] = b"conemarch part 1 ";
/// The longest first line that is read.
const MOST_HEAD: u64 = 4096;
/// Bytes of a [`Tally`].
const TALLY: usize = 36;
/// Bytes of a hash.
const HASH: usize = 32;

/// What a file of bands belongs to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Owner {
    /// Version of the program.
    pub version: String,
    /// What rendered it.
    pub device: String,
    /// A hash of everything else that decides the bytes of the picture.
    pub picture: String,
}

/// The file, open and locked. If it holds no band, it goes when this is dropped.
#[derive(Debug)]
pub struct Unfinished {
    path: PathBuf,
    file: File,
    owner: Owner,
    /// Where each band begins, and where the last one ends.
    starts: Vec<u64>,
    tallies: Vec<Tally>,
    /// Bands of the whole picture.
    all: usize,
}

/// The name of the file beside a picture.
pub fn beside(picture: &Path) -> PathBuf {
    let mut name: OsString = picture.into();
    name.push(".part");
    name.into()
}

/// Whether the file beside a picture keeps bands, and no process adds to them.
pub fn is_left(picture: &Path) -> bool {
    let file = File::open(beside(picture)).ok();
    file.is_some_and(|mut file| {
        let is_free = !matches!(file.try_lock(), Err(TryLockError::WouldBlock));
        let bytes = file.metadata().map_or(0, |m| m.len());
        is_free && head(&mut file).is_some_and(|(_, start)| bytes > start)
    })
}

impl Unfinished {
    /// Opens the file beside a picture, or makes it. `lengths` are the bytes of the bands' rows.
    ///
    /// # Errors
    /// There is one that holds something else, or that must not be overwritten without `resume`;
    /// it is in use; it cannot be read or written.
    pub fn open(picture: &Path, owner: Owner, lengths: &[usize], resume: bool) -> Result<Self> {
        let path = beside(picture);
        if path.exists() {
            let mut file = open(&path)?;
            let shown = path.display();
            let (found, start) = head(&mut file).ok_or_else(|| {
                anyhow!("`{shown}` is in the way and no part of a picture; remove it, or name the picture with another -o")
            })?;
            let bytes = file.metadata().map_err(|e| unreadable(&path, &e))?.len();
            if !resume && bytes > start {
                return Err(anyhow!(
                    "`{shown}` keeps bands of a picture that was not finished; go on with --resume, or remove it to begin again"
                ));
            }
            if resume {
                found.check(&owner, &path)?;
                return Self::new(path, file, owner, start, lengths);
            }
        }
        let mut line = MARK.to_vec();
        serde_json::to_writer(&mut line, &owner)?;
        line.push(b'\n');
        let mut place = Place::prepare(&path)?;
        place.write_all(&line)?;
        commit(vec![place])?;
        let file = open(&path)?;
        Self::new(path, file, owner, line.len() as u64, lengths)
    }

    /// Takes in the bands of a file, which begin at `start`. Until they are known, nothing removes
    /// the file.
    fn new(
        path: PathBuf,
        mut file: File,
        owner: Owner,
        start: u64,
        lengths: &[usize],
    ) -> Result<Self> {
        let (mut starts, mut tallies) = (vec![start], Vec::new());
        let unreadable = |e| unreadable(&path, &e);
        file.seek(SeekFrom::Start(start)).map_err(unreadable)?;
        let mut from = BufReader::new(&file);
        for (band, length) in lengths.iter().enumerate() {
            interrupt::check()?;
            let mut record = Vec::new();
            let bytes = (length + TALLY + HASH) as u64;
            let read = (&mut from).take(bytes).read_to_end(&mut record);
            read.map_err(unreadable)?;
            // The last band may be torn.
            let whole = record.len() as u64 == bytes;
            let (content, hash) = record.split_at(record.len().saturating_sub(HASH));
            if !whole || owner.hash(band, content) != *hash {
                break;
            }
            tallies.push(read_tally(&content[*length..]));
            starts.push(starts[band] + bytes);
        }
        let kept = Self {
            path,
            file,
            owner,
            starts,
            tallies,
            all: lengths.len(),
        };
        kept.cut();
        kept.tell();
        Ok(kept)
    }

    /// How many bands are kept.
    pub fn count(&self) -> usize {
        self.tallies.len()
    }

    /// The tally of all bands.
    pub fn tally(&self) -> Option<Tally> {
        self.tallies.iter().copied().reduce(Tally::and)
    }

    /// Adds the next band. It is on the disk when this returns.
    ///
    /// # Errors
    /// The disk is full. The bands before stay.
    pub fn append(&mut self, mut rows: Vec<u8>, tally: Tally) -> Result<()> {
        rows.extend(write_tally(&tally));
        let hash = self.owner.hash(self.count(), &rows);
        rows.extend(hash);
        let written = self.file.seek(SeekFrom::Start(self.end()));
        let written = written.and_then(|_| self.file.write_all(&rows));
        if let Err(e) = written.and_then(|()| self.file.sync_data()) {
            self.cut();
            return Err(OutputError::full(&self.path, &e).into());
        }
        self.starts.push(self.end() + rows.len() as u64);
        self.tallies.push(tally);
        self.tell();
        Ok(())
    }

    /// The rows of a band.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn rows(&mut self, band: usize) -> Result<Vec<u8>> {
        let length = self.starts[band + 1] - self.starts[band];
        let mut rows = vec![0; length as usize - TALLY - HASH];
        let found = self.file.seek(SeekFrom::Start(self.starts[band]));
        let read = found.and_then(|_| self.file.read_exact(&mut rows));
        read.map_err(|e| unreadable(&self.path, &e))?;
        Ok(rows)
    }

    /// An error with what is kept.
    pub fn context(&self, error: anyhow::Error) -> anyhow::Error {
        match self.says() {
            Some(kept) => error.context(kept),
            None => error,
        }
    }

    /// Removes the file, once the picture is whole. If the picture cannot be brought to the disk,
    /// the bands stay.
    pub fn remove(mut self) {
        let picture = self.path.with_extension("");
        if File::open(picture).and_then(|file| file.sync_all()).is_ok() {
            self.tallies.clear();
        }
    }

    fn says(&self) -> Option<String> {
        let (path, count, all) = (self.path.display(), self.count(), self.all);
        (count > 0).then(|| {
            format!(
                "`{path}` keeps {count} of {all} bands, and the same command with --resume goes on"
            )
        })
    }

    /// Tells an interrupt what stays.
    fn tell(&self) {
        set_unfinished(&self.path, self.count() == 0);
        interrupt::keeps(self.says());
    }

    fn end(&self) -> u64 {
        self.starts.last().copied().unwrap_or_default()
    }

    /// Takes away what follows the last whole band. If that fails, the next band overwrites it.
    fn cut(&self) {
        let _ = self.file.set_len(self.end());
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        interrupt::keeps(None);
        if self.tallies.is_empty() {
            // The next render takes one that stays for empty.
            let _ = fs::remove_file(&self.path);
            set_unfinished(&self.path, false);
        }
    }
}

impl Owner {
    /// Whether bands of this owner serve another one.
    fn check(&self, now: &Self, path: &Path) -> Result<()> {
        let path = path.display();
        if self.version != now.version {
            let (before, now) = (&self.version, &now.version);
            return Err(anyhow!(
                "`{path}` was begun by conemarch {before}, and this is {now}; go on with that version, or remove it to begin again"
            ));
        }
        if self.device != now.device {
            let (before, now) = (&self.device, &now.device);
            return Err(anyhow!(
                "`{path}` was begun on {before}, and this is {now}; choose that one with --device, or remove it to begin again"
            ));
        }
        if self.picture != now.picture {
            return Err(anyhow!(
                "`{path}` keeps bands of a picture with other settings or files; give those, name this picture with another -o, or remove it to begin again"
            ));
        }
        Ok(())
    }

    fn hash(&self, band: usize, content: &[u8]) -> [u8; HASH] {
        let mut hash = Sha256::new();
        hash.update(&self.picture);
        hash.update((band as u64).to_le_bytes());
        hash.update(content);
        hash.finalize().into()
    }
}

/// Opens and locks the file.
fn open(path: &Path) -> Result<File> {
    let opened = OpenOptions::new().read(true).write(true).open(path);
    let file = opened.map_err(|e| OutputError::io(path, "cannot be opened", &e))?;
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(anyhow!(
            "`{}` is in use: another process renders this picture; wait for it, or name another file with -o",
            path.display()
        )),
        // Where files cannot be locked, nothing is lost as long as one process writes.
        _ => Ok(file),
    }
}

/// The first line, and where it ends; `None` if it is another one.
fn head(file: &mut File) -> Option<(Owner, u64)> {
    let mut bytes = Vec::new();
    file.take(MOST_HEAD).read_to_end(&mut bytes).ok()?;
    let end = bytes.iter().position(|b| *b == b'\n')?;
    let line = bytes[..end].strip_prefix(MARK)?;
    Some((serde_json::from_slice(line).ok()?, end as u64 + 1))
}

fn unreadable(path: &Path, e: &std::io::Error) -> OutputError {
    OutputError::io(path, "cannot be read", e)
}

fn write_tally(tally: &Tally) -> Vec<u8> {
    let numbers = tally.states.iter().chain([&tally.undecided]);
    let mut bytes: Vec<u8> = numbers.flat_map(|n| n.to_le_bytes()).collect();
    bytes.extend(tally.farthest.to_le_bytes());
    bytes
}

/// Reads [`TALLY`] bytes.
fn read_tally(bytes: &[u8]) -> Tally {
    let number = |i: usize| -> u64 { bytemuck::pod_read_unaligned(&bytes[8 * i..8 * i + 8]) };
    Tally {
        states: [0, 1, 2].map(number),
        undecided: number(3),
        farthest: bytemuck::pod_read_unaligned(&bytes[32..36]),
    }
}
