//! Where pictures can go, where they cannot, and numbers at their limits.

use libtest_mimic::Failed;

use crate::support::{Folder, QUICK, glb, read_exr, read_json};

pub(crate) fn unwritable() -> Result<(), Failed> {
    let folder = Folder::new();
    folder.write("file", "in the way");
    std::fs::create_dir_all(folder.join("taken.png/inside"))?;
    std::fs::create_dir_all(folder.join("series_0.png"))?;
    let long = format!("{}.png", "x".repeat(400));
    let mut outputs = vec!["file/x.png", "file/deeper/x.exr", "taken.png", &long];
    if cfg!(target_os = "linux") {
        outputs.extend(["/proc/x.png", "/proc/self/deeper/x.exr"]);
    }
    for output in outputs {
        let run = folder.run(["render", "builtin:cornell:0", "-o", output].into_iter().chain(QUICK));
        run.failed_with(&["cannot write", output]);
    }
    let series = ["render", "builtin:cornell:0", "-o", "series_%d.png", "--frames", "2"];
    folder.run(series.into_iter().chain(QUICK)).failed_with(&["cannot write", "series_0.png"]);
    let stats = ["render", "builtin:cornell:0", "-o", "x.png", "--stats", "file/s.json"];
    folder.run(stats.into_iter().chain(QUICK)).failed_with(&["cannot write", "file/s.json"]);
    folder.line("info --stats file/s.json").failed_with(&["cannot write", "file/s.json"]);
    let demo = ["demo", "--frames", "2", "--out", "file/demo"];
    folder.run(demo.into_iter().chain(QUICK)).failed_with(&["cannot write", "file/demo"]);
    // All of them are known before anything is rendered.
    assert_eq!(folder.files(), ["file"]);
    Ok(())
}

pub(crate) fn over_the_scene() -> Result<(), Failed> {
    let folder = Folder::new();
    folder.write("triangle.glb", glb());
    std::fs::create_dir(folder.join("deep"))?;
    for stats in ["triangle.glb", "./triangle.glb", "deep/../triangle.glb"] {
        let run =
            folder.run(["render", "triangle.glb", "-o", "x.png", "--stats", stats].into_iter().chain(QUICK));
        run.failed_with(&[stats, "the scene would be overwritten"]);
        folder
            .run(["compare", "triangle.glb", "--stats", stats, "--out", "deep"])
            .failed_with(&[stats, "scene"]);
    }
    let run = folder
        .run(["render", "triangle.glb", "-o", "x.png", "--stats", "deep/../x.png"].into_iter().chain(QUICK));
    run.failed_with(&["x.png", "cannot be one file"]);
    assert_eq!(folder.files(), ["triangle.glb"]);
    assert_eq!(std::fs::read(folder.join("triangle.glb"))?, glb());
    Ok(())
}

#[cfg(unix)]
pub(crate) fn unusual_places() -> Result<(), Failed> {
    use std::os::unix::ffi::OsStrExt;
    use std::os::unix::fs::symlink;

    let folder = Folder::new();
    let render = |output: &std::ffi::OsStr, more: &[&str]| {
        let start = ["render", "builtin:cornell:0", "-o"].map(std::ffi::OsStr::new);
        let rest = QUICK.iter().chain(more).map(std::ffi::OsStr::new);
        folder.run(start.into_iter().chain([output]).chain(rest))
    };
    // A link stays one, and what it leads to is the picture.
    std::fs::create_dir(folder.join("far"))?;
    folder.write("far/real.png", "the old one");
    symlink("far/real.png", folder.join("link.png"))?;
    render("link.png".as_ref(), &[]).succeeded();
    assert!(std::fs::symlink_metadata(folder.join("link.png"))?.is_symlink());
    assert_eq!(image::open(folder.join("far/real.png"))?.width(), 16);
    symlink("nowhere.png", folder.join("dangling.png"))?;
    render("dangling.png".as_ref(), &[]).failed_with(&["cannot write", "dangling.png", "leads nowhere"]);
    symlink("round.png", folder.join("round.png"))?;
    render("round.png".as_ref(), &[]).failed_with(&["cannot write", "round.png"]);

    // As long as names can be, and not Unicode.
    let longest = format!("{}.png", "x".repeat(251));
    render(longest.as_ref(), &[]).succeeded();
    assert_eq!(image::open(folder.join(&longest))?.width(), 16);
    std::fs::remove_file(folder.join(&longest))?;
    let odd = std::ffi::OsStr::from_bytes(b"\xff\xfe.png");
    render(odd, &[]).succeeded();
    std::fs::remove_file(folder.join(".").join(odd))?;
    render(odd, &["--frames", "2"]).failed_with(&["Unicode"]);

    // Devices are written into and stay what they are.
    let run = render("x.png".as_ref(), &["--stats", "/dev/stdout"]);
    assert!(run.succeeded().stdout.contains("\"triangles\": 34"), "{}", run.stdout);
    render("x.png".as_ref(), &["--stats", "/dev/null"]).succeeded();
    assert!(!std::fs::metadata("/dev/null")?.is_file());
    assert_eq!(folder.files(), ["dangling.png", "far/real.png", "link.png", "round.png", "x.png"]);
    Ok(())
}

pub(crate) fn limits() -> Result<(), Failed> {
    let folder = Folder::new();
    let render = |line: &str| folder.line(&format!("render builtin:cornell:0 --iterations 4 {line}"));
    for size in [[1, 1], [8192, 1], [1, 300]] {
        render(&format!("--grid 8 --size {}x{} -o x.exr", size[0], size[1])).succeeded();
        let rows = read_exr(&folder.join("x.exr"))?;
        assert_eq!([rows[0].len(), rows.len()], size);
        assert!(rows.iter().flatten().flatten().all(|c| c.is_finite()));
    }
    // Everything that gives light is white, and black.
    for (exposure, expected) in [("1000", 255), ("-1000", 0), ("3e38", 255), ("-3e38", 0)] {
        let camera = "--camera 0,1,0.9:0,0.5,-1";
        render(&format!("--grid 8 --size 8x8 {camera} --exposure {exposure} -o x.png")).succeeded();
        let picture = image::open(folder.join("x.png"))?.into_rgb8();
        let seen = picture.get_pixel(4, 4).0;
        assert_eq!(seen, [expected; 3], "at {exposure} EV");
    }
    for (more, words) in [
        ("--fps 0 --frames 2 -o x_%d.png", vec!["--fps", "0.1 to 1000"]),
        ("--fps nan --frames 2 -o x_%d.png", vec!["--fps", "0.1 to 1000"]),
        ("--fps 60 --frames 2 -o x.gif", vec!["--fps 60", ".gif", "50"]),
    ] {
        render(&format!("--size 8x8 {more}")).failed_with(&words);
    }
    for (scene, time) in
        [("builtin:atrium:0", "-5"), ("builtin:atrium:0", "1e30"), ("builtin:cornell:0", "1e30")]
    {
        let series = "--size 8x8 --grid 8 --iterations 1 --frames 1 --fps 0.1 -o t_%d.exr --stats s.json";
        folder.line(&format!("render {scene} {series} --time {time}")).succeeded();
        let rows = read_exr(&folder.join("t_0.exr"))?;
        assert!(rows.iter().flatten().flatten().all(|c| c.is_finite()), "{scene} at {time} s");
        assert_eq!(read_json(&folder.join("s.json"))?["frames"], 1);
    }
    assert_eq!(folder.files(), ["s.json", "t_0.exr", "x.exr", "x.png"]);
    // The coarsest grid, and boxes that no camera could be found for.
    render("--grid 3 --size 8x8 -o x.png").succeeded();
    for corner in ["1e30 0 0", "0 0 0"] {
        folder.write("odd.off", format!("OFF\n3 1 0\n0 0 0\n{corner}\n0 0 0\n3 0 1 2\n"));
        folder.line("render odd.off -o o.png").failed_with(&["a grid needs a box of 1e-9 to 1e9 metres"]);
    }
    Ok(())
}
