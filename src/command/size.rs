//! `--size WxH`.

use crate::plan::MOST_PIXELS;

/// Reads `1280x720`.
///
/// # Errors
/// The text has another form, or a side is out of range.
pub fn read(text: &str) -> Result<[u32; 2], String> {
    let side = |s: &str| {
        let digits = !s.is_empty() && s.bytes().all(|b| b.is_ascii_digit());
        let n: Option<u32> = s.parse().ok().filter(|_| digits);
        n.filter(|n| (1..=MOST_PIXELS).contains(n))
    };
    let (w, h) = text.split_once(['x', 'X']).unwrap_or_default();
    match (side(w), side(h)) {
        (Some(w), Some(h)) => Ok([w, h]),
        _ => Err(format!(
            "must be width x height in pixels, each from 1 to {MOST_PIXELS}, like 1280x720"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_two_sane_numbers_are_a_size() {
        assert_eq!(read("1280x720"), Ok([1280, 720]));
        assert_eq!(read("1X1"), Ok([1, 1]));
        for bad in [
            "",
            "x",
            "5",
            "0x5",
            "5x0",
            "abc",
            "99999x1",
            "-4x4",
            "+4x4",
            "4x4x4",
            "4 x4",
            "1e2x4",
            "99999999999999999999x1",
        ] {
            assert!(read(bad).is_err(), "{bad}");
        }
    }
}
