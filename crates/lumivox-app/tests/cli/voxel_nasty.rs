//! Every awkward file ends in a volume or in a sentence, soon, and leaves nothing half.

use std::path::Path;
use std::time::{Duration, Instant};

use libtest_mimic::Failed;

use crate::support::Folder;

pub(crate) fn nasty_files(assets: &Path) -> Result<(), Failed> {
    let folder = Folder::new();
    let (mut done, mut refused) = (0, 0);
    let mut folders = vec![assets.join("nasty")];
    while let Some(place) = folders.pop() {
        for entry in std::fs::read_dir(place)? {
            let path = entry?.path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let name = path.display().to_string();
            let start = Instant::now();
            let line = ["voxelize", &name, "-o", "x.npz", "--resolution", "40", "--solid", "--channels"];
            let run = folder.run(line.into_iter().chain(["albedo,normal,emission,area"]));
            assert!(start.elapsed() < Duration::from_secs(20), "{name} took {:?}", start.elapsed());
            match run.status {
                Some(0) => {
                    run.succeeded();
                    assert_eq!(folder.files(), ["x.npz"], "{name}");
                    std::fs::remove_file(folder.join("x.npz"))?;
                    done += 1;
                }
                _ => {
                    run.failed("", &["lumivox: ", &path.file_name().unwrap_or_default().to_string_lossy()]);
                    assert_eq!(run.status, Some(1), "{name}: {}", run.stderr);
                    assert_eq!(folder.files(), [""; 0], "{name}");
                    refused += 1;
                }
            }
        }
    }
    assert!(done > 25 && refused > 25, "{done} volumes, {refused} refused");
    Ok(())
}
