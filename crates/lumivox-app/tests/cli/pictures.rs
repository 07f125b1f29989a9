//! What `lumivox render` writes.

use libtest_mimic::Failed;

use crate::support::{Folder, QUICK, glb, read_exr, read_json};

pub(crate) fn picture_and_stats() -> Result<(), Failed> {
    let folder = Folder::new();
    let run = folder.line("render builtin:cornell:0 --size 64x48 --grid 16 --stats s.json -o deep/er/x.png");
    assert!(run.succeeded().stdout.is_empty());
    assert_eq!(folder.files(), ["deep/er/x.png", "s.json"]);
    let picture = image::open(folder.join("deep/er/x.png"))?.into_rgb8();
    assert_eq!(picture.dimensions(), (64, 48));
    // Red on the left, green on the right, the lit floor below the dark outside of the ceiling.
    let [left, right] = [(9, 24), (54, 24)].map(|(x, y)| picture.get_pixel(x, y).0);
    assert!(left[0] > left[1].saturating_add(30), "{left:?}");
    assert!(right[1] > right[0].saturating_add(20), "{right:?}");
    let stats = read_json(&folder.join("s.json"))?;
    assert_eq!(stats["scene"], "builtin:cornell:0");
    assert_eq!(stats["size"], serde_json::json!([64, 48]));
    assert_eq!(stats["grid"], serde_json::json!([16, 16, 16]));
    assert_eq!(stats["triangles"], 34);
    assert_eq!(stats["settled"], true);
    assert!(stats["cell_size_m"].as_f64().is_some_and(|c| (c - 2.0 / 14.0).abs() < 1e-6));
    let stages = stats["stages"].as_array().map_or(0, Vec::len);
    assert!(stages >= 8, "{}", stats["stages"]);
    assert!(stats["adapter"]["name"].as_str().is_some_and(|n| !n.is_empty()));
    Ok(())
}

pub(crate) fn exr() -> Result<(), Failed> {
    let folder = Folder::new();
    // A camera below the ceiling's height that sees the floor in the lower half of the picture.
    let scene = "render builtin:cornell:0 --size 64x48 --grid 16 --camera 0,1,3.4:0,1,0:39.3";
    folder.line(&format!("{scene} --layer depth -o depth.exr")).succeeded();
    folder.line(&format!("{scene} --layer albedo -o albedo.exr")).succeeded();
    folder.line(&format!("{scene} --layer direct --exposure 5 -o bright.exr")).succeeded();
    folder.line(&format!("{scene} --layer direct -o plain.exr")).succeeded();

    let depth = read_exr(&folder.join("depth.exr"))?;
    assert_eq!((depth[0].len(), depth.len()), (64, 48));
    // The camera is 3.4 m before the middle; the walls end between 2.4 and 4.4 m.
    let middle = depth[24][32][0];
    assert!(middle > 2.4 && middle < 4.4, "{middle} m");
    // The spot hangs from the ceiling, which it does not light: row 0 is on top.
    let albedo = read_exr(&folder.join("albedo.exr"))?;
    let plain = read_exr(&folder.join("plain.exr"))?;
    let [top, bottom] = [5, 43].map(|row| {
        let sum: f32 = plain[row].iter().map(|p| p[1]).sum();
        let there: f32 = albedo[row].iter().map(|p| p[1]).sum();
        (sum, there)
    });
    assert!(top.1 > 1.0 && bottom.1 > 1.0, "ceiling and floor are both in the picture: {top:?} {bottom:?}");
    assert!(
        bottom.0 > 1.0 && top.0 < 0.05 * bottom.0,
        "the floor is lit, the ceiling is not: {top:?} {bottom:?}"
    );
    // The red wall is on the left, and its albedo is linear.
    let red = albedo[24][12];
    for (seen, expected) in red.into_iter().zip([0.63, 0.06, 0.05]) {
        assert!((seen - expected).abs() < 0.005, "{red:?}");
    }
    // Exposure is for screens: plain.exr has the automatic one.
    assert_eq!(plain, read_exr(&folder.join("bright.exr"))?);
    Ok(())
}

pub(crate) fn series() -> Result<(), Failed> {
    let folder = Folder::new();
    let run = folder
        .run(["render", "builtin:cornell:0", "--frames", "2", "-o", "f_%03d.png"].into_iter().chain(QUICK));
    run.succeeded();
    assert_eq!(folder.files(), ["f_000.png", "f_001.png"]);
    let frames = ["f_000.png", "f_001.png"].map(|f| image::open(folder.join(f)).unwrap().into_rgb8());
    assert!(frames.iter().all(|f| f.dimensions() == (16, 12)));
    let walk = folder
        .run(["render", "builtin:atrium:0", "--frames", "2", "-o", "w_%d.png"].into_iter().chain(QUICK));
    walk.succeeded();
    let [a, b] = ["w_0.png", "w_1.png"].map(|f| image::open(folder.join(f)).unwrap().into_rgb8());
    assert!(a != b, "the walk moves");
    Ok(())
}

pub(crate) fn layers() -> Result<(), Failed> {
    let folder = Folder::new();
    let mut pictures: Vec<(&str, Vec<u8>)> = Vec::new();
    for layer in ["final", "direct", "indirect", "albedo", "normal", "depth", "voxels"] {
        let arguments = ["render", "builtin:cornell:0", "-o", "x.png", "--layer", layer];
        folder.run(arguments.into_iter().chain(QUICK)).succeeded();
        let picture = image::open(folder.join("x.png"))?.into_rgb8().into_raw();
        assert!(picture.iter().any(|b| *b > 0), "{layer} is black");
        for (other, seen) in &pictures {
            assert!(*seen != picture, "{layer} shows the same as {other}");
        }
        pictures.push((layer, picture));
    }
    Ok(())
}

/// Mirrors differ on slanted surfaces, such as the blocks in the box, and from what scatters; with a constant albedo of zero there is one
/// bounce, and with one the room is brighter than by its own.
pub(crate) fn surfaces() -> Result<(), Failed> {
    let folder = Folder::new();
    let seen = |options: &str| -> Result<Vec<f32>, Failed> {
        let run = folder.line(&format!(
            "render builtin:cornell:0 -o x.exr --size 32x24 --grid 16 --layer indirect --gi propagation {options}"
        ));
        assert!(run.succeeded().stderr.is_empty(), "{}", run.stderr);
        Ok(read_exr(&folder.join("x.exr"))?.into_iter().flatten().flatten().collect())
    };
    let total = |picture: &[f32]| picture.iter().sum::<f32>();
    let mut pictures = Vec::new();
    for mirror in ["none", "axis", "normal"] {
        pictures.push((mirror, seen(&format!("--mirror {mirror}"))?));
    }
    let usual = seen("")?;
    assert!(usual == pictures[0].1, "surfaces scatter light unless said otherwise");
    let mean = total(&usual) / usual.len() as f32;
    assert!(mean > 0.01, "there is no light: {mean}");
    for (n, (name, picture)) in pictures.iter().enumerate() {
        for (other, seen) in &pictures[..n] {
            let off: f32 = picture.iter().zip(seen).map(|(a, b)| (a - b).abs()).sum();
            let off = off / total(&usual);
            eprintln!("--mirror {name} and {other} differ by {off:.4} of the light");
            assert!(off > 0.01, "--mirror {name} shows the same as {other}: {off}");
        }
    }
    let [black, white] = [seen("--bounce-albedo 0")?, seen("--bounce-albedo 1")?].map(|p| total(&p));
    eprintln!("light of one bounce, all, and all in white: {black} {} {white}", total(&usual));
    assert!(0.0 < black && black < 0.95 * total(&usual) && white > 1.5 * total(&usual));
    let idle = folder.line("render builtin:cornell:0 -o x.png --size 16x12 --grid 8 --bounce-albedo 0.5");
    assert!(idle.succeeded().stderr.contains("--bounce-albedo is for --gi propagation"), "{}", idle.stderr);
    Ok(())
}

pub(crate) fn methods() -> Result<(), Failed> {
    let folder = Folder::new();
    for voxelizer in ["triangles", "progressive", "single-pass", "single-frame", "hybrid"] {
        for gi in ["off", "propagation", "gather"] {
            let arguments =
                ["render", "builtin:cornell:0", "-o", "x.png", "--voxelizer", voxelizer, "--gi", gi];
            folder.run(arguments.into_iter().chain(QUICK).chain(["--tier", "core"])).succeeded();
            assert!(
                image::open(folder.join("x.png"))?.into_rgb8().iter().any(|b| *b > 60),
                "{voxelizer} {gi}"
            );
        }
    }
    // A scene of one's own, without a light and without a camera.
    folder.write("triangle.glb", glb());
    let run = folder.run(["render", "triangle.glb", "-o", "t.png"].into_iter().chain(QUICK));
    assert!(run.succeeded().stderr.contains("no light"), "{}", run.stderr);
    let sunny = ["render", "triangle.glb", "-o", "t.png", "--sun", "-1,-2,-1:9,8,7"];
    assert!(folder.run(sunny.into_iter().chain(QUICK)).succeeded().stderr.is_empty());
    Ok(())
}
