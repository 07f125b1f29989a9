//! Disks that are full: a limit on the size of files stands for them.

use libtest_mimic::Failed;

use crate::support::{Folder, PROGRAM, Run};

/// What shells count file sizes in.
const BLOCK: u64 = 512;

/// Runs the program where no file may grow beyond so many blocks.
fn run_within(folder: &Folder, blocks: u64, line: &str) -> Run {
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec {PROGRAM} {line}");
    Run::new(folder.command("sh").args(["-c", &script]).output().unwrap())
}

pub(crate) fn every_format() -> Result<(), Failed> {
    let still = "render builtin:cornell:0 --size 64x48 --grid 8 --iterations 1";
    let series = "render builtin:cornell:0 --size 64x48 --grid 8 --iterations 1 --frames 3";
    for (line, name) in [
        (format!("{still} -o x.png"), "x.png"),
        (format!("{still} -o x.exr"), "x.exr"),
        (format!("{series} -o x.gif"), "x.gif"),
        ("info --stats x.json".to_owned(), "x.json"),
    ] {
        let folder = Folder::new();
        run_within(&folder, 1 << 20, &line).succeeded();
        let length = std::fs::metadata(folder.join(name))?.len();
        assert!(length > BLOCK, "{name} has {length} bytes");
        // Full from the start, and full at the very end, where only the last bytes fail.
        for blocks in [1, (length - 1) / BLOCK] {
            folder.write(name, "the old one");
            let run = run_within(&folder, blocks, &line);
            run.failed_with(&["cannot write", name, "File too large"]);
            assert_eq!(folder.files(), [name], "{blocks} blocks of {length} bytes");
            assert_eq!(std::fs::read(folder.join(name))?, b"the old one");
        }
    }
    let folder = Folder::new();
    let run = run_within(&folder, 1, &format!("{series} -o f_%d.png"));
    run.failed_with(&["cannot write", "f_0.png", "File too large"]);
    run_within(&folder, 1, "demo --frames 2 --size 64x36 --grid 16 --out o").failed_with(&[
        "cannot write",
        "frame_0000.png",
        "File too large",
    ]);
    let compare = "compare builtin:cornell:0 --size 64x48 --grid 8 --max-samples 2 --out o";
    run_within(&folder, 1, compare).failed_with(&["cannot write", "o/", "File too large"]);
    assert_eq!(folder.files(), [""; 0]);
    // Standard output may be full, too.
    if std::path::Path::new("/dev/full").exists() {
        run_within(&folder, 1 << 20, "info > /dev/full").failed_with(&["No space left"]);
        run_within(&folder, 1 << 20, "info --stats /dev/full").failed_with(&["/dev/full", "No space left"]);
    }
    Ok(())
}

pub(crate) fn volumes() -> Result<(), Failed> {
    for name in ["x.npz", "x.vox", "x.vdb", "x.binvox", "x.ply"] {
        let folder = Folder::new();
        let line = format!("voxelize builtin:cornell:0 --resolution 48 -o {name}");
        run_within(&folder, 1 << 20, &line).succeeded();
        let length = std::fs::metadata(folder.join(name))?.len();
        assert!(length > BLOCK, "{name} has {length} bytes");
        for blocks in [1, (length - 1) / BLOCK] {
            folder.write(name, "the old one");
            run_within(&folder, blocks, &line).failed_with(&["cannot write", name, "File too large"]);
            assert_eq!(folder.files(), [name], "{blocks} blocks of {length} bytes");
            assert_eq!(std::fs::read(folder.join(name))?, b"the old one");
        }
    }
    // Of several files none is replaced where one does not fit.
    let folder = Folder::new();
    folder.write("x.nhdr", "the old one");
    let run = run_within(&folder, 64, "voxelize builtin:cornell:0 --resolution 48 -o x.nhdr");
    run.failed_with(&["cannot write", "x.raw", "File too large"]);
    assert_eq!(
        (folder.files(), std::fs::read(folder.join("x.nhdr"))?),
        (vec!["x.nhdr".to_owned()], b"the old one".to_vec())
    );
    Ok(())
}
