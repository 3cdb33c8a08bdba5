//! Time.

/// Tells the time in milliseconds since any fixed moment.
pub type Clock = fn() -> f64;

/// Milliseconds since the first call.
#[cfg(feature = "cli")]
pub fn clock() -> f64 {
    use std::sync::OnceLock;
    use std::time::Instant;

    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64() * 1e3
}
