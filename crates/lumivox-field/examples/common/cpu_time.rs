//! The processor time of this process.

/// Seconds on all threads together, in steps of 10 ms; 0 where the system does not tell.
pub(crate) fn seconds() -> f64 {
    let Ok(stat) = std::fs::read_to_string("/proc/self/stat") else { return 0.0 };
    // After the name in brackets: user and system time are fields 14 and 15 of the line, in hundredths of a second.
    let fields = stat.rsplit(')').next().unwrap_or_default().split_whitespace();
    fields.skip(11).take(2).filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() / 100.0
}
