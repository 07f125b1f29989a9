//! Slices, the shadows of leaves, and glass.

use libtest_mimic::Failed;

use crate::support::{Folder, Run, read_exr};

pub(crate) fn wrong_arguments() -> Result<(), Failed> {
    let folder = Folder::new();
    folder.line("slices builtin:cornell:0 -o s.jpg").failed_with(&["s.jpg", ".png or .ply"]);
    folder.line("slices builtin:cornell:0 -o s.png --size 1024x1024 --slices 1024").failed_with(&[
        "1024 x 1024",
        "32768 x 32768",
        "--slices",
    ]);
    folder.line("slices builtin:cornell:0 -o s.png --slices 0").refused_with(&["--slices"]);
    folder.line("slices builtin:cornell:0 -o s.png --faces up").refused_with(&["--faces"]);
    folder.line("slices builtin:cornell:0 -o s.png --time nan").failed_with(&["--time", "finite"]);
    folder.line("slices builtin:cornell:0 -o s.png --clip dance").failed_with(&["dance", "does not move"]);
    folder
        .line("render builtin:tree:0 -o t.png --shadows transmittance --sigma 2")
        .failed_with(&["--sigma", "0 to 1"]);
    folder.line("render builtin:knot_glass:0 -o g.png --ior 9").failed_with(&["--ior", "1 to 4"]);
    folder.line("render builtin:knot_glass:0 -o g.png --frost -1").refused_with(&["-1"]);
    assert!(folder.files().is_empty());
    Ok(())
}

/// The number of cells that a run told.
fn cells(run: &Run) -> usize {
    let told = run.succeeded().stderr.split_whitespace().nth(1).and_then(|n| n.parse().ok());
    told.unwrap_or_else(|| panic!("no number of cells: {}", run.stderr))
}

pub(crate) fn slices() -> Result<(), Failed> {
    let folder = Folder::new();
    let line = "slices builtin:knot_glass:0 --size 24x18 --slices 8";
    let run = |name: &str, more: &str| cells(&folder.line(&format!("{line} -o {name} {more}")));
    let all = run("all.png", "");
    let (front, back) = (run("front.png", "--faces front"), run("back.png", "--faces back"));
    let split = run("split.png", "--faces split");
    assert!(
        front > 100 && back > 100 && front.max(back) < all && all <= front + back,
        "{all}: {front}, {back}"
    );
    assert_eq!(split, front + back);
    let sheet = image::open(folder.join("all.png"))?.into_rgb8();
    assert_eq!(sheet.dimensions(), (72, 54));
    assert_eq!(sheet.pixels().filter(|p| p.0 == [255; 3]).count(), all);
    let points = std::fs::read_to_string({
        run("all.ply", "");
        folder.join("all.ply")
    })?;
    assert!(points.contains(&format!("element vertex {all}\n")));
    assert_eq!(points.lines().skip_while(|l| *l != "end_header").count(), all + 1);
    let parallel = run("parallel.png", "--projection parallel");
    assert!(parallel > 100);
    let bytes = |name: &str| std::fs::read(folder.join(name));
    assert!(bytes("all.png")? != bytes("parallel.png")?);
    // What moves is elsewhere a second later.
    for (name, time) in [("now.png", "0"), ("then.png", "1")] {
        let line = format!("slices builtin:falling:0 -o {name} --size 24x18 --slices 8 --time {time}");
        assert!(cells(&folder.line(&line)) > 50);
    }
    assert!(bytes("now.png")? != bytes("then.png")?);
    Ok(())
}

const SMALL: &str = "--gi off --grid 8 --size 32x24 --light-samples 4 --shadow-size 256";

pub(crate) fn leaves() -> Result<(), Failed> {
    let folder = Folder::new();
    let left = |sigma: &str| -> Result<Vec<f32>, Failed> {
        let line = format!(
            "render builtin:tree:0 -o left.exr --shadows transmittance --layer transmittance --sigma {sigma} {SMALL}"
        );
        let run = folder.line(&line);
        assert!(run.succeeded().stderr.is_empty(), "{}", run.stderr);
        Ok(read_exr(&folder.join("left.exr"))?.into_iter().flatten().map(|p| p[0]).collect())
    };
    let (some, all) = (left("0.3")?, left("1")?);
    assert!(some.iter().all(|v| (0.0..=1.0).contains(v)));
    assert!(some.iter().any(|v| (0.69..0.71).contains(v)), "a pixel behind one leaf");
    // Whoever takes all leaves none, where one who takes a part leaves less than all.
    for (some, all) in some.iter().zip(&all) {
        assert_eq!(*some < 0.99, *all < 0.01, "{some}, {all}");
    }
    let idle = folder.line(&format!("render builtin:cornell:0 -o x.png --shadows transmittance {SMALL}"));
    assert!(idle.succeeded().stderr.contains("--shadows transmittance does nothing"), "{}", idle.stderr);
    Ok(())
}

pub(crate) fn glass() -> Result<(), Failed> {
    let folder = Folder::new();
    let run = folder.line(&format!("render builtin:knot_glass:0 -o metres.exr --layer thickness {SMALL}"));
    assert!(run.succeeded().stderr.is_empty(), "{}", run.stderr);
    let metres: Vec<f32> =
        read_exr(&folder.join("metres.exr"))?.into_iter().flatten().map(|p| p[0]).collect();
    let thick = metres.iter().copied().filter(|m| *m > 0.0).count();
    let most = metres.iter().copied().fold(0.0, f32::max);
    assert!(thick > 60 && (0.4..1.5).contains(&most), "{thick} pixels, {most} m");
    let mut pictures = Vec::new();
    for more in ["", "--glass opaque", "--frost 1", "--environment studio --environment-only"] {
        let run = folder.line(&format!("render builtin:knot_glass:0 -o x.png --exposure 0 {SMALL} {more}"));
        assert!(run.succeeded().stderr.is_empty(), "{more}: {}", run.stderr);
        let picture = image::open(folder.join("x.png"))?.into_rgb8();
        assert!(pictures.iter().all(|p| *p != picture), "{more}");
        pictures.push(picture);
    }
    let idle = folder.line(&format!("render builtin:cornell:0 -o x.png --ior 1.2 {SMALL}"));
    assert!(idle.succeeded().stderr.contains("the scene has no glass"), "{}", idle.stderr);
    // A quad that is not said to be thin.
    let scene = r#"{"lights":[{"type":"point","position":[0,2,0],"intensity":[9,9,9]}],
        "camera":{"eye":[0,2,3],"target":[0,0,0],"fov_y_deg":50},
        "meshes":[{"quad":[[-1,0,1],[1,0,1],[1,0,-1],[-1,0,-1]]},
                  {"quad":[[-1,1,1],[1,1,1],[1,1,-1],[-1,1,-1]],"glass":{}}]}"#;
    folder.write("pane.scene.json", scene);
    let open = folder.line(&format!("render pane.scene.json -o x.png {SMALL}"));
    assert!(open.succeeded().stderr.contains("is not closed (4 open edges)"), "{}", open.stderr);
    folder.write("pane.scene.json", scene.replace(r#""glass":{}"#, r#""glass":{"thin":true}"#));
    let thin = folder.line(&format!("render pane.scene.json -o x.png {SMALL}"));
    assert!(thin.succeeded().stderr.is_empty(), "{}", thin.stderr);
    Ok(())
}
