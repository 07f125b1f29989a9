//! The program `lumivox` as its users meet it: wrong arguments and broken files end in one clear sentence, and the
//! commands write what they promise.
//!
//! Without a graphics adapter the tests that need one are reported as ignored, with that reason in their name; with
//! `LUMIVOX_REQUIRE_GPU=1` that fails instead.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Output};
use std::sync::atomic::{AtomicU32, Ordering};

use libtest_mimic::{Arguments, Failed, Trial};
use lumivox::gpu::Gpu;

type Check = fn() -> Result<(), Failed>;

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let anywhere: [(&str, Check); 6] = [
        ("no arguments show the usage", no_arguments),
        ("wrong arguments are named", wrong_arguments),
        ("wrong outputs are named before anything is rendered", wrong_outputs),
        ("files that are no scenes are named", broken_files),
        ("files cut off anywhere are named", cut_files),
        ("help and version succeed", help),
    ];
    let with_gpu: [(&str, Check); 10] = [
        ("unknown adapters are named", unknown_adapter),
        ("grids that cannot be are refused", bad_grids),
        ("outputs that cannot be written are named", unwritable_outputs),
        ("a picture and its statistics", picture_and_stats),
        ("an EXR is linear and upright", exr),
        ("a series has a file per frame", series),
        ("every layer", layers),
        ("every voxelizer, with and without indirect light", methods),
        ("a demo writes all it promises", demo),
        ("info tells adapters and limits", info),
    ];
    let required = std::env::var("LUMIVOX_REQUIRE_GPU").is_ok_and(|v| v == "1");
    let has_gpu = !pollster::block_on(Gpu::adapters()).is_empty();
    let mut trials: Vec<Trial> = anywhere.into_iter().map(|(name, check)| Trial::test(name, check)).collect();
    trials.extend(with_gpu.into_iter().map(|(name, check)| match (has_gpu, required) {
        (true, _) => Trial::test(name, check),
        (false, true) => Trial::test(name, || Err("no graphics adapter found".into())),
        (false, false) => {
            Trial::test(format!("{name} (no graphics adapter)"), || Ok(())).with_ignored_flag(true)
        }
    }));
    libtest_mimic::run(&arguments, trials).exit_code()
}

/// A folder of one test, gone with it.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("lumivox-cli-{}-{number}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// Runs the program in the folder.
    fn run<S: AsRef<OsStr>>(&self, arguments: impl IntoIterator<Item = S>) -> Run {
        let output = Command::new(env!("CARGO_BIN_EXE_lumivox"))
            .args(arguments)
            .current_dir(&self.0)
            .env_remove("LUMIVOX_LOG")
            // Drivers complain on stderr when there is none.
            .env("XDG_RUNTIME_DIR", &self.0)
            .output()
            .unwrap();
        Run::new(output)
    }

    /// Runs the program with arguments that have no spaces in them.
    fn line(&self, arguments: &str) -> Run {
        self.run(arguments.split_whitespace())
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.0.join(name), bytes).unwrap();
    }

    fn join(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Everything in it, sorted, folders as their contents.
    fn files(&self) -> Vec<String> {
        let mut files = Vec::new();
        let mut folders = vec![self.0.clone()];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).unwrap().flatten() {
                let path = entry.path();
                match path.is_dir() {
                    true => folders.push(path),
                    false => {
                        let inner = path.strip_prefix(&self.0).unwrap();
                        let parts: Vec<_> = inner.iter().map(|p| p.to_string_lossy()).collect();
                        files.push(parts.join("/"));
                    }
                }
            }
        }
        files.sort();
        files
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

struct Run {
    status: Option<i32>,
    stdout: String,
    stderr: String,
}

impl Run {
    fn new(output: Output) -> Self {
        Self {
            status: output.status.code(),
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }

    /// The program ended well and had nothing to complain about.
    fn succeeded(&self) -> &Self {
        assert!(self.status == Some(0), "status {:?}: {}", self.status, self.stderr);
        assert!(!self.stderr.contains("panicked") && !self.stderr.contains("ERROR"), "{}", self.stderr);
        self
    }

    /// The program ended in one sentence of its own that holds all of `words`.
    fn failed_with(&self, words: &[&str]) {
        self.failed("lumivox: ", words);
        assert_eq!(self.stderr.lines().count(), 1, "one sentence: {}", self.stderr);
    }

    /// The command line parser refused the arguments in a sentence that holds all of `words`.
    fn refused_with(&self, words: &[&str]) {
        self.failed("error: ", words);
        assert_eq!(self.status, Some(2), "{}", self.stderr);
    }

    fn failed(&self, start: &str, words: &[&str]) {
        assert!(self.status.is_some_and(|s| s != 0), "status {:?}: {}", self.status, self.stderr);
        assert!(!self.stderr.contains("panicked"), "{}", self.stderr);
        assert!(self.stderr.starts_with(start), "does not start with {start:?}: {}", self.stderr);
        for word in words {
            assert!(self.stderr.contains(word), "does not name {word:?}: {}", self.stderr);
        }
    }
}

fn no_arguments() -> Result<(), Failed> {
    let run = Folder::new().line("");
    assert_eq!(run.status, Some(2));
    for word in ["Usage: lumivox", "demo", "render", "info"] {
        assert!(run.stderr.contains(word), "{}", run.stderr);
    }
    Ok(())
}

fn help() -> Result<(), Failed> {
    for arguments in ["--help", "--version", "help render", "demo --help", "render --help", "info --help"] {
        let run = Folder::new().line(arguments);
        assert!(!run.succeeded().stdout.is_empty() && run.stderr.is_empty(), "{arguments}");
    }
    Ok(())
}

fn wrong_arguments() -> Result<(), Failed> {
    let folder = Folder::new();
    for (arguments, words) in [
        ("glow", vec!["glow"]),
        ("--glow", vec!["--glow"]),
        ("render", vec!["--output", "<SCENE>"]),
        ("render builtin:cornell", vec!["--output"]),
        ("render -o x.png", vec!["<SCENE>"]),
        ("render builtin:cornell builtin:cornell -o x.png", vec!["builtin:cornell"]),
        ("render builtin:cornell -o x.png --size 64", vec!["'64'", "--size", "WIDTHxHEIGHT"]),
        ("render builtin:cornell -o x.png --size 0x64", vec!["'0x64'", "1 to 8192"]),
        ("render builtin:cornell -o x.png --size 64x99999", vec!["'64x99999'", "1 to 8192"]),
        ("render builtin:cornell -o x.png --size 64xlarge", vec!["--size", "large"]),
        ("render builtin:cornell -o x.png --camera 1,2,3", vec!["'1,2,3'", "--camera"]),
        ("render builtin:cornell -o x.png --camera 1,2:3,4,5", vec!["1,2", "three numbers"]),
        ("render builtin:cornell -o x.png --camera 1,2,3:1,2,3", vec!["--camera", "same point"]),
        ("render builtin:cornell -o x.png --camera 1,2,3:0,0,nan", vec!["nan", "finite"]),
        ("render builtin:cornell -o x.png --camera -1,2,3:0,0,0:180", vec!["1 to 170 degrees"]),
        ("render builtin:cornell -o x.png --sun 0,-1,0", vec!["'0,-1,0'", "--sun"]),
        ("render builtin:cornell -o x.png --sun 0,0,0:3", vec!["--sun", "not zero"]),
        ("render builtin:cornell -o x.png --sun 0,-1,0:-3", vec!["--sun", "negative"]),
        ("render builtin:cornell -o x.png --sun 0,-1,0:1,2", vec!["1,2", "three numbers"]),
        ("render builtin:cornell -o x.png --grid many", vec!["many", "--grid"]),
        ("render builtin:cornell -o x.png --grid -1", vec!["-1"]),
        ("render builtin:cornell -o x_%d.png --frames 0", vec!["'0'", "--frames", "1..=100000"]),
        ("render builtin:cornell -o x_%d.png --frames 100001", vec!["--frames", "1..=100000"]),
        ("render builtin:cornell -o x.png --iterations 5000", vec!["--iterations", "4096"]),
        ("render builtin:cornell -o x.png --layer light", vec!["'light'", "--layer", "indirect"]),
        ("render builtin:cornell -o x.png --gi magic", vec!["'magic'", "--gi", "propagation"]),
        ("render builtin:cornell -o x.png --voxelizer magic", vec!["'magic'", "--voxelizer", "triangles"]),
        ("render builtin:cornell -o x.png --tier best", vec!["'best'", "--tier", "core"]),
        ("render builtin:cornell -o x.png --exposure inf", vec!["inf", "--exposure"]),
        ("render builtin:cornell -o x.png --exposure bright", vec!["bright", "--exposure"]),
        ("demo --frames 1", vec!["'1'", "--frames", "2..=2000"]),
        ("demo --grid 4", vec!["'4'", "--grid", "8..=2048"]),
        ("demo --size 5", vec!["'5'", "--size"]),
        ("demo --iterations none", vec!["none", "--iterations"]),
        ("demo tour", vec!["tour"]),
        ("info all", vec!["all"]),
        ("info --tier all", vec!["all", "--tier"]),
        ("info --stats", vec!["--stats"]),
    ] {
        folder.line(arguments).refused_with(&words);
    }
    for (arguments, words) in [
        ("render builtin:palace -o x.png", vec!["palace", "atrium", "cornell", "furnace"]),
        ("render builtin:cornell:9 -o x.png", vec!["cornell", "9", "from 0 to 4"]),
        ("render builtin: -o x.png", vec!["''", "atrium"]),
        ("render builtin:cornell -o x.png --persistence 1.5", vec!["persistence", "0 to 1"]),
        ("render builtin:cornell -o x.png --time nan", vec!["time", "finite"]),
    ] {
        folder.line(arguments).failed_with(&words);
    }
    assert_eq!(folder.files(), [""; 0]);
    Ok(())
}

fn wrong_outputs() -> Result<(), Failed> {
    let folder = Folder::new();
    for (output, words) in [
        ("picture", vec!["picture", ".png", ".exr"]),
        ("picture.bmp", vec!["picture.bmp", ".png", ".exr"]),
        ("picture.", vec!["picture.", ".png", ".exr"]),
    ] {
        folder.run(["render", "builtin:cornell:0", "-o", output]).failed_with(&words);
    }
    for output in ["x.png", "x_%.png", "x_%s.png", "x_%d_%d.png", "x_%99d.png", "%d/x.png"] {
        let run = folder.run(["render", "builtin:cornell:0", "--frames", "2", "-o", output]);
        run.failed_with(&[output, "picture_%04d.png"]);
    }
    assert_eq!(folder.files(), [""; 0]);
    Ok(())
}

/// A GLB of one triangle.
fn glb() -> Vec<u8> {
    let mut binary: Vec<u8> =
        [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    binary.resize(36, 0);
    let json = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":36}],"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}]}"#;
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut file = Vec::new();
    file.extend(b"glTF");
    file.extend(2u32.to_le_bytes());
    file.extend((12 + 8 + json.len() as u32 + 8 + binary.len() as u32).to_le_bytes());
    file.extend((json.len() as u32).to_le_bytes());
    file.extend(b"JSON");
    file.extend(&json);
    file.extend((binary.len() as u32).to_le_bytes());
    file.extend(b"BIN\0");
    file.extend(&binary);
    file
}

fn broken_files() -> Result<(), Failed> {
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

fn cut_files() -> Result<(), Failed> {
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

fn unknown_adapter() -> Result<(), Failed> {
    let folder = Folder::new();
    for command in ["info", "demo --out d", "render builtin:cornell:0 -o x.png"] {
        let run = folder.line(&format!("{command} --adapter no-such-adapter"));
        run.failed_with(&["no graphics adapter found", "no-such-adapter"]);
    }
    assert_eq!(folder.files(), [""; 0]);
    Ok(())
}

fn bad_grids() -> Result<(), Failed> {
    let folder = Folder::new();
    for grid in ["0", "1", "100000", "4294967295"] {
        let run = folder.run(["render", "builtin:cornell:0", "-o", "x.png", "--size", "8x8", "--grid", grid]);
        run.failed_with(&["cells along its longest axis"]);
    }
    let run = folder.line("render builtin:cornell:0 -o x.png --size 8x8 --grid 300 --tier core");
    run.failed_with(&["300 x 300 x 300", "would fit"]);
    assert_eq!(folder.files(), [""; 0]);
    Ok(())
}

const QUICK: [&str; 6] = ["--size", "16x12", "--grid", "8", "--iterations", "4"];

fn unwritable_outputs() -> Result<(), Failed> {
    let folder = Folder::new();
    folder.write("file", "in the way");
    std::fs::create_dir_all(folder.join("taken.png/inside")).unwrap();
    for output in ["file/x.png", "file/deeper/x.exr", "taken.png"] {
        let run = folder.run(["render", "builtin:cornell:0", "-o", output].into_iter().chain(QUICK));
        run.failed_with(&["cannot write", output]);
    }
    let stats = ["render", "builtin:cornell:0", "-o", "x.png", "--stats", "file/s.json"];
    folder.run(stats.into_iter().chain(QUICK)).failed_with(&["cannot write", "file/s.json"]);
    folder.line("info --stats file/s.json").failed_with(&["cannot write", "file/s.json"]);
    let demo = ["demo", "--frames", "2", "--out", "file/demo"];
    folder.run(demo.into_iter().chain(QUICK)).failed_with(&["cannot write", "file/demo"]);
    let left = folder.files();
    assert!(left.iter().all(|f| f == "file" || f == "x.png"), "half-written files: {left:?}");
    Ok(())
}

fn read_json(path: &Path) -> Result<serde_json::Value, Failed> {
    Ok(serde_json::from_str(&std::fs::read_to_string(path)?)?)
}

fn picture_and_stats() -> Result<(), Failed> {
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

/// The rows of an EXR.
fn read_exr(path: &Path) -> Result<Vec<Vec<[f32; 3]>>, Failed> {
    let image = exr::prelude::read_first_rgba_layer_from_file(
        path,
        |size, _| vec![vec![[0.0f32; 3]; size.width()]; size.height()],
        |pixels: &mut Vec<Vec<[f32; 3]>>, at, (r, g, b, _): (f32, f32, f32, f32)| {
            pixels[at.y()][at.x()] = [r, g, b]
        },
    )
    .map_err(|e| e.to_string())?;
    Ok(image.layer_data.channel_data.pixels)
}

fn exr() -> Result<(), Failed> {
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

fn series() -> Result<(), Failed> {
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

fn layers() -> Result<(), Failed> {
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

fn methods() -> Result<(), Failed> {
    let folder = Folder::new();
    for voxelizer in ["triangles", "progressive", "single-frame"] {
        for gi in ["off", "propagation"] {
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

fn demo() -> Result<(), Failed> {
    let folder = Folder::new();
    let run = folder.line("demo --frames 2 --size 64x36 --grid 16 --out out/demo");
    assert!(run.succeeded().stderr.contains("out/demo"));
    let expected = [
        "progressive/frame_0000.png",
        "progressive/frame_0001.png",
        "sheet.png",
        "single-frame/frame_0000.png",
        "single-frame/frame_0001.png",
        "timings.json",
        "walk.gif",
    ];
    assert_eq!(folder.files(), expected.map(|f| format!("out/demo/{f}")));
    let out = folder.join("out/demo");
    for frame in expected.iter().filter(|f| f.contains("frame_")) {
        assert_eq!(image::open(out.join(frame))?.into_rgb8().dimensions(), (64, 36), "{frame}");
    }
    let sheet = image::open(out.join("sheet.png"))?.into_rgb8();
    assert!(sheet.width() > 3 * 64 && sheet.height() > 2 * 36);
    let gif = image::codecs::gif::GifDecoder::new(std::io::BufReader::new(std::fs::File::open(
        out.join("walk.gif"),
    )?))?;
    let frames = image::AnimationDecoder::into_frames(gif).collect_frames()?;
    assert_eq!(frames.len(), 2);
    assert!(frames[0].buffer().width() > 2 * 64);
    let timings = read_json(&out.join("timings.json"))?;
    assert_eq!(timings["frames"], 2);
    let walks = timings["walks"].as_array().cloned().unwrap_or_default();
    assert_eq!(walks.len(), 2);
    for walk in walks {
        let cells = walk["occupied_cells"].as_array().cloned().unwrap_or_default();
        assert!(cells.len() == 2 && cells.iter().all(|c| c.as_u64() > Some(0)), "{walk}");
        assert!(walk["stages_last_frame"].as_array().is_some_and(|s| !s.is_empty()));
    }
    Ok(())
}

fn info() -> Result<(), Failed> {
    let folder = Folder::new();
    let run = folder.line("info --stats i.json");
    let run = run.succeeded();
    for word in ["adapters:", "device:", "limits:", "what fits:", "volume with light"] {
        assert!(run.stdout.contains(word), "{}", run.stdout);
    }
    let info = read_json(&folder.join("i.json"))?;
    assert!(info["adapters"].as_array().is_some_and(|a| !a.is_empty()));
    assert!(info["largest_lit_volume_side"].as_u64() >= Some(100));
    let core = folder.line("info --tier core --stats c.json");
    core.succeeded();
    let core = read_json(&folder.join("c.json"))?;
    assert_eq!(core["adapter"]["tier"], "Core");
    assert_eq!(core["max_storage_buffer_binding_bytes"], 128 << 20);
    // Part of the adapter's name is enough, in any case.
    let name = info["adapter"]["name"].as_str().unwrap_or_default().to_uppercase();
    folder.run(["info", "--adapter", &name[..name.len().min(5)]]).succeeded();
    Ok(())
}
