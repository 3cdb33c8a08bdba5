//! Whole numbers and sizes in words, and amounts of memory for people to read.

/// A number of digits alone.
pub fn whole(text: &str) -> Option<u32> {
    // Numbers may have a sign where they are parsed.
    let digits = text.bytes().all(|b| b.is_ascii_digit());
    text.parse().ok().filter(|_| digits)
}

/// A size like `1280x720`, with sides from 1 to `most`.
///
/// ```
/// # use conemarch::base::units::size;
/// assert_eq!(size("1280x720", 1280), Some([1280, 720]));
/// assert_eq!(size("1X1", 1), Some([1, 1]));
/// let bad = ";x;5;0x5;5x0;abc;1281x1;-4x4;+4x4;4x4x4;4 x4;1e2x4;99999999999999999999x1";
/// assert!(bad.split(';').all(|text| size(text, 1280).is_none()));
/// ```
pub fn size(text: &str, most: u32) -> Option<[u32; 2]> {
    let side = |s: &str| whole(s).filter(|n| (1..=most).contains(n));
    let (w, h) = text.split_once(['x', 'X'])?;
    Some([side(w)?, side(h)?])
}

const UNITS: [(&str, f64); 3] = [
    ("GiB", (1_u64 << 30) as f64),
    ("MiB", (1_u64 << 20) as f64),
    ("KiB", 1024.0),
];

/// An amount in tenths of its largest unit, each rounded in a direction.
fn in_units(bytes: u64, round: fn(f64) -> f64) -> String {
    let bytes = bytes as f64;
    match UNITS.iter().find(|(_, unit)| bytes >= *unit) {
        Some((name, unit)) => format!("{} {name}", round(10.0 * bytes / unit) / 10.0),
        None => format!("{bytes} bytes"),
    }
}

/// Bytes that something needs, rounded up.
///
/// ```
/// # use conemarch::base::units::bytes_needed;
/// assert_eq!(bytes_needed((1 << 30) + 1), "1.1 GiB");
/// assert_eq!(bytes_needed(1 << 20), "1 MiB");
/// ```
pub fn bytes_needed(bytes: u64) -> String {
    in_units(bytes, f64::ceil)
}

/// Bytes that are available, rounded down.
///
/// ```
/// # use conemarch::base::units::bytes_available;
/// assert_eq!(bytes_available((3 << 29) - 1), "1.4 GiB");
/// assert_eq!(bytes_available(1000), "1000 bytes");
/// ```
pub fn bytes_available(bytes: u64) -> String {
    in_units(bytes, f64::floor)
}
