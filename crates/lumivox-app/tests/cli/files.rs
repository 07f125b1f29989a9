//! Broken files that come in.

use libtest_mimic::Failed;

use crate::support::{Folder, glb};

pub(crate) fn broken_files() -> Result<(), Failed> {
    let folder = Folder::new();
    let files: &[(&str, &[u8])] = &[
        ("text.glb", b"this is no scene at all\n"),
        ("text.gltf", b"this is no scene at all\n"),
        ("text.obj", b"v 0 0\nf 1 2 3\n"),
        ("text.ply", b"this is no scene at all\n"),
        ("text.stl", b"this is no scene at all\n"),
        ("text.off", b"this is no scene at all\n"),
        ("text.scene.json", b"this is no scene at all\n"),
        ("empty.glb", b""),
        ("empty.gltf", b""),
        ("empty.ply", b""),
        ("empty.stl", b""),
        ("empty.off", b""),
        ("empty.scene.json", b""),
        ("binary.ply", &[0xff; 300]),
        ("binary.off", &[0xff; 300]),
        ("binary.gltf", &[0xff; 300]),
    ];
    for (name, bytes) in files {
        folder.write(name, bytes);
        folder.run(["render", name, "-o", "x.png"]).failed_with(&[name]);
    }
    // Sound files without anything to see.
    for (name, text) in [("nothing.obj", "# nothing\n"), ("nothing.off", "OFF\n0 0 0\n")] {
        folder.write(name, text);
        folder.run(["render", name, "-o", "x.png"]).failed("", &["triangles"]);
    }
    for (name, words) in [
        ("missing.glb", vec!["missing.glb", "cannot be read"]),
        ("nowhere/missing.obj", vec!["nowhere/missing.obj", "cannot be read"]),
        ("picture.jpg", vec!["picture.jpg", "'jpg'", ".glb"]),
        ("scene", vec!["scene", ".glb"]),
        ("plain.json", vec!["plain.json", ".scene.json"]),
    ] {
        folder.run(["render", name, "-o", "x.png"]).failed_with(&words);
    }
    std::fs::create_dir(folder.join("folder.glb")).unwrap();
    folder.line("render folder.glb -o x.png").failed_with(&["folder.glb"]);
    let left: Vec<_> = folder.files().into_iter().filter(|f| f.contains("x.png")).collect();
    assert!(left.is_empty(), "{left:?}");
    Ok(())
}

pub(crate) fn cut_files() -> Result<(), Failed> {
    let folder = Folder::new();
    let whole = glb();
    for length in
        [1, 4, 11, 12, 19, 20, 100, whole.len() - 37, whole.len() - 36, whole.len() - 4, whole.len() - 1]
    {
        folder.write("cut.glb", &whole[..length]);
        let run = folder.line("render cut.glb -o x.png");
        assert!(run.status != Some(0), "{length} of {} bytes passed", whole.len());
        run.failed_with(&["cut.glb"]);
    }
    assert_eq!(folder.files(), ["cut.glb"]);
    Ok(())
}
