//! Loads a file in a process of its own: this test's program, started once more.

use std::io::Write;
use std::path::Path;
use std::process::{Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use lumivox_scene::load;

/// Longest that a broken file may take to be understood or refused.
const PATIENCE: Duration = Duration::from_secs(5);

/// Most memory that a broken file may take, in KiB: 1 GiB of address space, the program itself included.
const MEMORY_KIB: u32 = 1 << 20;

/// Names the file that this process is to load as the child of a test.
pub(crate) const CHILD: &str = "LUMIVOX_LOAD_AS_CHILD";

/// Loads a file in a process of its own, whose address space is bounded where the system can do that.
pub(crate) fn in_a_child(path: &Path) -> Result<String, String> {
    let program = std::env::current_exe().map_err(|e| e.to_string())?;
    let mut command = if cfg!(target_os = "linux") {
        let mut shell = Command::new("sh");
        shell.arg("-c").arg(format!("ulimit -v {MEMORY_KIB} && exec \"$0\"")).arg(program);
        shell
    } else {
        Command::new(program)
    };
    command.env(CHILD, path).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().map_err(|e| e.to_string())?;
    let start = Instant::now();
    while child.try_wait().map_err(|e| e.to_string())?.is_none() {
        if start.elapsed() > PATIENCE {
            // It may have ended in between.
            let _ = child.kill();
            let _ = child.wait();
            return Err(format!("still running after {PATIENCE:?}"));
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    let output = child.wait_with_output().map_err(|e| e.to_string())?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    if output.status.success() {
        return Ok(text);
    }
    Err(format!("{}: {text}{}", output.status, String::from_utf8_lossy(&output.stderr)))
}

/// What the child does: says "scene" or "error" and why; any other end is a failure.
pub(crate) fn load_as_child(path: &str) -> ExitCode {
    let said = match load(path) {
        Err(error) => format!("error {error}"),
        Ok(mut scene) => {
            for clip in 0..scene.clips().len().max(1) {
                let pose = scene.pose(clip, 0.3);
                scene.apply(&pose);
                if let Err(fault) = super::check_sound(&scene) {
                    panic!("{}", fault.message().unwrap_or_default());
                }
            }
            format!("scene of {} triangles", scene.triangle_count())
        }
    };
    match std::io::stdout().write_all(said.as_bytes()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(_) => ExitCode::FAILURE,
    }
}
