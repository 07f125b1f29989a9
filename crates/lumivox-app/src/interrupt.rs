//! Ctrl-C, and being asked to stop by the system: the program ends at once, wherever it is, and leaves whole files only.
//!
//! Whatever the GPU is at needs no farewell: its driver tidies up after a process. Exit handlers are not run, since those of drivers
//! would take away what other threads still use.

use std::io::IsTerminal;

use crate::part_file;

/// What shells add to the number of the signal that ended a program.
const SIGNAL_STATUS: i32 = 128;

/// From now on an interrupt ends the program with one sentence and status 130 (143 when asked by `SIGTERM`).
#[cfg(unix)]
pub(crate) fn listen() -> std::io::Result<()> {
    use signal_hook::consts::{SIGINT, SIGTERM};
    // Not SIGHUP: what was started with nohup is to outlive its terminal.
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM])?;
    std::thread::Builder::new().name("interrupt".to_owned()).spawn(move || {
        if let Some(signal) = signals.forever().next() {
            stop(|| signal_hook::low_level::exit(SIGNAL_STATUS + signal));
        }
    })?;
    Ok(())
}

/// From now on Ctrl-C ends the program with one sentence and status 130.
#[cfg(not(unix))]
pub(crate) fn listen() -> std::io::Result<()> {
    const INTERRUPT: i32 = 2;
    ctrlc::set_handler(|| stop(|| std::process::exit(SIGNAL_STATUS + INTERRUPT)))
        .map_err(std::io::Error::other)
}

fn stop(exit: impl FnOnce()) {
    part_file::remove_all_and(|| {
        // A progress bar may be in the way.
        let clear = if std::io::stderr().is_terminal() { "\r\x1b[2K" } else { "" };
        eprintln!(
            "{clear}lumivox: interrupted; files that were complete are kept, others removed, but for bakes, which the same command goes on with"
        );
        exit();
    });
}
