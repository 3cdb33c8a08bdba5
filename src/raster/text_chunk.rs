//! The texts in a PNG, which other programs may have compressed or moved behind the pixels.
//!
//! Chunks are passed over by their lengths, so that neither the pixels nor their number
//! matter. The decoder of pixels reads what stands before them, and no more.

use std::io::{Cursor, Error, Read, Seek, copy, sink};

use png::{Decoder, DecodingError};

/// The first bytes of every PNG.
pub const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Longest text of a picture, and longest preset, that is read, packed or not: far more than any
/// needs, so that a wrong file is rejected at once.
pub const MOST_TEXT: usize = 1 << 20;
/// A file of 32 GiB has so many chunks of pixels; a stream that never ends has more.
const MOST_CHUNKS: usize = 1 << 22;

/// The first text under a keyword, if there is one. The reader stands behind the signature.
///
/// # Errors
/// In words: the file is no PNG or ends before its end, or the text is damaged.
pub fn text(from: &mut (impl Read + Seek), keyword: &str) -> Result<Option<String>, String> {
    let broken = |why: &str| format!("is a broken PNG: {why}; fetch or save it again");
    let cut = |e| broken(&format!("it cannot be read to its end: {e}"));
    let mut header = Vec::new();
    for _ in 0..MOST_CHUNKS {
        let mut start = [0; 8];
        from.read_exact(&mut start).map_err(cut)?;
        let [a, b, c, d, kind @ ..] = start;
        // A checksum follows the content.
        let rest = u64::from(u32::from_be_bytes([a, b, c, d])) + 4;
        match &kind {
            _ if header.is_empty() && &kind != b"IHDR" => return Err(broken("it has no header")),
            b"IHDR" | b"tEXt" | b"zTXt" | b"iTXt" if rest <= MOST_TEXT as u64 => {
                let mut chunk = start.to_vec();
                let mut content = from.by_ref().take(rest);
                content.read_to_end(&mut chunk).map_err(cut)?;
                let named = chunk[8..].strip_prefix(keyword.as_bytes());
                if header.is_empty() {
                    header = [SIGNATURE, &chunk].concat();
                } else if named.is_some_and(|rest| rest.starts_with(&[0])) {
                    let text = decoded([&header[..], &chunk].concat());
                    let why = |e| broken(&format!("its text `{keyword}` is damaged: {e}"));
                    return text.map(Some).map_err(why);
                }
            }
            b"IEND" => return Ok(None),
            // A pipe cannot seek.
            _ if from.seek_relative(rest as i64).is_ok() => {}
            _ => _ = copy(&mut from.by_ref().take(rest), &mut sink()).map_err(cut)?,
        }
    }
    Err(broken("it has too many chunks"))
}

/// The text of a file that has only a header and one text.
fn decoded(mut file: Vec<u8>) -> Result<String, DecodingError> {
    file.extend(b"\0\0\0\0IDAT");
    let reader = Decoder::new(Cursor::new(file)).read_info()?;
    let info = reader.info();
    if let Some(mut chunk) = info.utf8_text.first().cloned() {
        chunk.decompress_text_with_limit(MOST_TEXT)?;
        return chunk.get_text();
    }
    if let Some(mut chunk) = info.compressed_latin1_text.first().cloned() {
        chunk.decompress_text_with_limit(MOST_TEXT)?;
        return chunk.get_text();
    }
    let plain = info.uncompressed_latin1_text.first();
    // The decoder passes over chunks whose checksum is wrong.
    let wrong = || DecodingError::IoError(Error::other("its checksum is wrong"));
    plain.map(|chunk| chunk.text.clone()).ok_or_else(wrong)
}
