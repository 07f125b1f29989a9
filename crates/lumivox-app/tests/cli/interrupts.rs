//! Ctrl-C and being asked to stop, in the middle of every command.

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use libtest_mimic::Failed;

use crate::support::{Folder, PROGRAM, glb};

/// On a busy machine; by itself it takes milliseconds.
const PATIENCE: Duration = Duration::from_secs(5);

/// A run of the program, ended with the test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn start(folder: &Folder, line: &str) -> Running {
    let mut command = folder.command(PROGRAM);
    let command = command.args(line.split_whitespace()).stdout(Stdio::null()).stderr(Stdio::piped());
    Running(command.spawn().unwrap())
}

/// Waits until a file of the folder is what `wanted` says.
fn wait_for(folder: &Folder, child: &mut Running, wanted: impl Fn(&str) -> bool) {
    let start = Instant::now();
    while !folder.files().iter().any(|f| wanted(f)) {
        assert!(child.0.try_wait().unwrap().is_none(), "ended before it could be interrupted");
        assert!(start.elapsed() < Duration::from_secs(120), "nothing was written");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Sends a signal; the program ends with this status and one sentence.
fn interrupt(mut child: Running, signal: &str, status: i32) {
    let start = Instant::now();
    let sent = Command::new("kill").args([format!("-{signal}"), child.0.id().to_string()]).status().unwrap();
    assert!(sent.success());
    while child.0.try_wait().unwrap().is_none() {
        assert!(start.elapsed() < PATIENCE, "it goes on after an interrupt");
        std::thread::sleep(Duration::from_millis(2));
    }
    let mut said = String::new();
    child.0.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert_eq!(child.0.wait().unwrap().code(), Some(status), "{said}");
    assert!(said.starts_with("lumivox: interrupted") && said.lines().count() == 1, "{said}");
}

pub(crate) fn series() -> Result<(), Failed> {
    let quick = "--size 64x36 --grid 16 --iterations 1 --frames 2000";
    for (line, first, signal, status) in [
        (format!("demo {quick} --out o"), "o/single-frame/frame_0000.png", "INT", 130),
        (format!("render builtin:atrium:0 {quick} -o o/f_%04d.png"), "o/f_0000.png", "INT", 130),
        (format!("render builtin:atrium:0 {quick} -o o/f_%04d.exr"), "o/f_0001.exr", "TERM", 143),
    ] {
        let folder = Folder::new();
        let mut child = start(&folder, &line);
        wait_for(&folder, &mut child, |f| f == first);
        interrupt(child, signal, status);
        let files = folder.files();
        assert!(files.iter().any(|f| f == first), "{line}: {files:?}");
        for file in files {
            let path = folder.join(&file);
            match file.rsplit_once('.').map(|(_, ending)| ending) {
                Some("png") => assert_eq!(image::open(path)?.into_rgb8().dimensions(), (64, 36), "{file}"),
                Some("exr") => assert_eq!(crate::support::read_exr(&path)?.len(), 36, "{file}"),
                _ => return Err(format!("{line}: {file} was left behind").into()),
            }
        }
    }
    Ok(())
}

pub(crate) fn unfinished() -> Result<(), Failed> {
    let folder = Folder::new();
    let mut child = start(&folder, "render builtin:atrium:0 --size 64x36 --grid 16 --frames 2000 -o g.gif");
    // Once to try whether it can be written, and then for good; either must be gone.
    wait_for(&folder, &mut child, |f| f.ends_with(".part"));
    interrupt(child, "INT", 130);
    assert_eq!(folder.files(), [""; 0]);

    folder.write("triangle.glb", glb());
    folder.write("x.png", "the old one");
    for line in [
        "render triangle.glb --size 2048x2048 --grid 64 --voxelizer progressive -o x.png --stats s.json",
        "compare triangle.glb --size 480x270 --grid 64 --max-seconds 600 --out .",
    ] {
        let mut child = start(&folder, line);
        // That the scene has no light is told before any rendering.
        let mut said = BufReader::with_capacity(1, child.0.stderr.take().unwrap());
        said.read_line(&mut String::new())?;
        std::thread::sleep(Duration::from_millis(300));
        child.0.stderr = Some(said.into_inner());
        interrupt(child, "INT", 130);
        assert_eq!(folder.files(), ["triangle.glb", "x.png"], "{line}");
        assert_eq!(std::fs::read(folder.join("x.png"))?, b"the old one");
    }
    Ok(())
}

pub(crate) fn volumes() -> Result<(), Failed> {
    // Files of many gigabytes, none of which may be there in the end; not even those that are complete already.
    for name in ["x.npz", "x.nhdr", "x.ktx2"] {
        let folder = Folder::new();
        folder.write(name, "the old one");
        let line =
            format!("voxelize builtin:cornell:0 --resolution 2048 --channels occupancy,normal -o {name}");
        let mut child = start(&folder, &line);
        // Names are tried first, with empty files.
        let begun = |folder: &Folder| {
            let sizes = std::fs::read_dir(folder.join(".")).into_iter().flatten().flatten();
            sizes.filter_map(|entry| entry.metadata().ok()).any(|found| found.len() > 1 << 20)
        };
        let start = Instant::now();
        while !begun(&folder) {
            assert!(child.0.try_wait().unwrap().is_none(), "ended before it could be interrupted");
            assert!(start.elapsed() < Duration::from_secs(120), "nothing was written");
            std::thread::sleep(Duration::from_millis(5));
        }
        interrupt(child, "INT", 130);
        assert_eq!(folder.files(), [name]);
        assert_eq!(std::fs::read(folder.join(name))?, b"the old one");
    }
    Ok(())
}
