//! The program's clock for stage times.

use std::sync::OnceLock;
use std::time::Instant;

/// Milliseconds since the first call.
pub(crate) fn millis() -> f64 {
    static START: OnceLock<Instant> = OnceLock::new();
    1e3 * START.get_or_init(Instant::now).elapsed().as_secs_f64()
}
