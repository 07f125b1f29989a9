//! The fence around third-party parsers: a panic inside becomes an error, without a word on the terminal.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

use crate::SceneError;

thread_local! {
    static SILENT: Cell<bool> = const { Cell::new(false) };
}

/// Runs `parse`, and turns its panic into [`SceneError::Parser`].
///
/// The first call wraps the process's panic hook in one that stays quiet on a thread inside a fence; everywhere else
/// the hook that was there goes on as before.
pub(crate) fn fenced<T>(
    file: &str,
    parser: &'static str,
    parse: impl FnOnce() -> Result<T, SceneError>,
) -> Result<T, SceneError> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let before = take_hook();
        set_hook(Box::new(move |info| {
            if !SILENT.get() {
                before(info);
            }
        }));
    });
    let outer = SILENT.replace(true);
    // Unwind safe: what the parser has touched is dropped with it.
    let result = catch_unwind(AssertUnwindSafe(parse));
    SILENT.set(outer);
    result.unwrap_or_else(|payload| {
        let reason = payload
            .downcast_ref::<&str>()
            .map(|s| (*s).to_owned())
            .or_else(|| payload.downcast_ref::<String>().cloned())
            .unwrap_or_else(|| "no message".to_owned());
        Err(SceneError::Parser { file: file.to_owned(), parser, reason })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_an_error_that_names_file_and_parser() {
        let error = fenced::<()>("x.obj", "OBJ", || panic!("index {} is odd", 3)).unwrap_err();
        assert_eq!(error.to_string(), "x.obj: the OBJ reader failed on this file: index 3 is odd");
        assert!(!SILENT.get());
        assert_eq!(fenced("x.obj", "OBJ", || Ok(1)), Ok(1));
    }
}
