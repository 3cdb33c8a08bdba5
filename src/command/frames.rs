//! The files of a film's frames: their names, and whether they are complete.

use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use image::{ImageFormat, ImageReader};

use crate::command::output::bits_of;
use crate::picture::BitDepth;
use crate::plan::Plan;
use crate::preset;

/// The names of frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    /// What stands before the number.
    pub before: String,
    /// Digits of the number at least.
    pub digits: usize,
    /// What stands after it.
    pub after: String,
}

impl Pattern {
    /// Reads a pattern with one `%d` or `%05d`.
    ///
    /// # Errors
    /// It is no such pattern.
    pub fn read(text: &str) -> Result<Self, String> {
        let form =
            "must have %05d, or another width, for the number of the frame, like out-%05d.png";
        let (before, rest) = text.split_once('%').ok_or(form)?;
        let (digits, after) = rest.split_once('d').ok_or(form)?;
        let zero = digits.is_empty() || digits.starts_with('0');
        let width = digits.parse::<usize>().ok().filter(|width| *width <= 9);
        if !zero || after.contains('%') || (width.is_none() && !digits.is_empty()) {
            return Err(form.into());
        }
        Ok(Self {
            before: before.into(),
            digits: width.unwrap_or(0),
            after: after.into(),
        })
    }

    /// The name of a frame.
    pub fn name(&self, frame: u32) -> PathBuf {
        let width = self.digits;
        format!("{}{frame:0width$}{}", self.before, self.after).into()
    }
}

/// When a file got its content or its name, as far as the system tells.
pub fn changed(path: &Path) -> Option<SystemTime> {
    let file = fs::metadata(path).ok()?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        use std::time::{Duration, UNIX_EPOCH};
        // A file that is copied or moved here may keep an older time of its content.
        let [seconds, rest] = [file.ctime(), file.ctime_nsec()].map(|n| n.max(0) as u64);
        let since = Duration::from_secs(seconds) + Duration::from_nanos(rest);
        file.modified().ok().max(Some(UNIX_EPOCH + since))
    }
    #[cfg(not(unix))]
    file.modified().ok()
}

/// Whether a frame was rendered already: a complete PNG with this plan and these bits, newer than
/// the files that the plan names.
pub fn is_there(path: &Path, plan: &Plan, depth: Option<BitDepth>) -> bool {
    let is_newer = |(_, file): &(_, PathBuf)| changed(file) >= changed(path);
    if plan.files().iter().any(is_newer) {
        return false;
    }
    let Ok(bytes) = fs::read(path) else {
        return false;
    };
    bits_of(path) == Some(depth.unwrap_or_default() as u8)
        && preset::find(path).is_ok_and(|found| found.text == preset::write_beside(plan, path))
        && is_whole(&bytes)
}

/// Whether a PNG has all of its pixels, undamaged by their checksums.
fn is_whole(png: &[u8]) -> bool {
    // An empty chunk ends the file.
    let mut reader = ImageReader::with_format(Cursor::new(png), ImageFormat::Png);
    reader.no_limits();
    png.ends_with(b"IEND\xae\x42\x60\x82") && reader.decode().is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pattern_numbers_its_frames() {
        let name = |text: &str| Pattern::read(text).map(|p| p.name(42));
        assert_eq!(name("a/out-%05d.png"), Ok("a/out-00042.png".into()));
        assert_eq!(name("%d.png"), Ok("42.png".into()));
        assert_eq!(name("%01d.png"), Ok("42.png".into()));
        for wrong in [
            "out.png",
            "%5d.png",
            "%x.png",
            "%05d-%d.png",
            "%099d.png",
            "%-3d.png",
        ] {
            assert!(name(wrong).is_err(), "{wrong}");
        }
    }
}
