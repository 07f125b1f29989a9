//! Shadows by volumes.

use libtest_mimic::Failed;

use crate::support::{Folder, read_exr};

pub(crate) fn wrong_arguments() -> Result<(), Failed> {
    let folder = Folder::new();
    folder.line("render builtin:cornell:0 -o v.png --shadows volume").refused_with(&["volume", "volumes"]);
    folder.line("field builtin:cornell:0 -o v.npz --shadows volumes").refused_with(&["--shadows"]);
    assert!(folder.files().is_empty());
    Ok(())
}

/// In the light of a spot volumes and maps shade the same, but for the borders.
pub(crate) fn pictures() -> Result<(), Failed> {
    let folder = Folder::new();
    let line = "render builtin:cornell:0 --size 48x36 --grid 16 --gi off --layer direct";
    let pictures = ["maps", "volumes"].map(|by| {
        let run = folder.line(&format!("{line} --shadows {by} -o {by}.exr"));
        assert!(!run.succeeded().stderr.contains("--shadows"), "{}", run.stderr);
        read_exr(&folder.join(&format!("{by}.exr")))
    });
    let [maps, volumes] = pictures;
    let (maps, volumes) = (maps?, volumes?);
    let pairs: Vec<_> =
        maps.iter().flatten().zip(volumes.iter().flatten()).map(|(a, b)| (a[1], b[1])).collect();
    let brightest = pairs.iter().map(|p| p.0).fold(0.0, f32::max);
    let alike = pairs.iter().filter(|(a, b)| (a - b).abs() <= 0.02 * brightest).count();
    let dark = pairs.iter().filter(|(_, b)| *b < 0.01 * brightest).count();
    assert!(alike * 100 >= 95 * pairs.len(), "{alike} of {} pixels are alike", pairs.len());
    assert!(dark > 20 && dark < pairs.len() / 2 + 400, "{dark} of {} pixels are dark", pairs.len());
    // An option of another way is told to do nothing.
    let told = folder.line(&format!("{line} --shadows volumes --sigma 0.7 -o told.exr"));
    assert!(told.succeeded().stderr.contains("--sigma is for --shadows transmittance"), "{}", told.stderr);
    Ok(())
}
