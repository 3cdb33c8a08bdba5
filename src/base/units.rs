//! Amounts of memory for people to read.

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
