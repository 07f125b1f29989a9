//! Arguments: usage, help, and every wrong one named.

use libtest_mimic::Failed;

use crate::support::Folder;

pub(crate) fn no_arguments() -> Result<(), Failed> {
    let run = Folder::new().line("");
    assert_eq!(run.status, Some(2));
    for word in ["Usage: lumivox", "demo", "render", "voxelize", "compare", "bench", "info"] {
        assert!(run.stderr.contains(word), "{}", run.stderr);
    }
    Ok(())
}

pub(crate) fn help() -> Result<(), Failed> {
    for arguments in [
        "--help",
        "--version",
        "help render",
        "demo --help",
        "render --help",
        "voxelize --help",
        "compare --help",
        "bench --help",
        "info --help",
    ] {
        let run = Folder::new().line(arguments);
        assert!(!run.succeeded().stdout.is_empty() && run.stderr.is_empty(), "{arguments}");
    }
    Ok(())
}

pub(crate) fn wrong_arguments() -> Result<(), Failed> {
    let folder = Folder::new();
    for (arguments, words) in [
        ("glow", vec!["glow"]),
        ("--glow", vec!["--glow"]),
        ("bench", vec!["<NAMES>"]),
        ("bench speed", vec!["speed", "voxelizers"]),
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
        ("render builtin:cornell -o x.png --mirror magic", vec!["'magic'", "--mirror", "axis", "normal"]),
        ("render builtin:cornell -o x.png --voxelizer magic", vec!["'magic'", "--voxelizer", "triangles"]),
        ("render builtin:cornell -o x.png --tier best", vec!["'best'", "--tier", "core"]),
        ("render builtin:cornell -o x.png --exposure inf", vec!["inf", "--exposure"]),
        ("render builtin:cornell -o x.png --exposure bright", vec!["bright", "--exposure"]),
        ("compare", vec!["<SCENE>"]),
        ("compare builtin:cornell --max-samples 1", vec!["'1'", "--max-samples"]),
        ("compare builtin:cornell --max-seconds 0", vec!["'0'", "--max-seconds"]),
        ("compare builtin:cornell --layer direct", vec!["--layer"]),
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
        ("render builtin:cornell -o x.png --bounce-albedo 1.01", vec!["--bounce-albedo", "0 to 1"]),
        ("render builtin:cornell -o x.png --bounce-albedo nan", vec!["--bounce-albedo", "0 to 1"]),
        ("render builtin:cornell -o x.png --time nan", vec!["time", "finite"]),
    ] {
        folder.line(arguments).failed_with(&words);
    }
    assert_eq!(folder.files(), [""; 0]);
    Ok(())
}

pub(crate) fn wrong_outputs() -> Result<(), Failed> {
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

pub(crate) fn unknown_adapter() -> Result<(), Failed> {
    let folder = Folder::new();
    for command in ["info", "demo --out d", "render builtin:cornell:0 -o x.png"] {
        let run = folder.line(&format!("{command} --adapter no-such-adapter"));
        run.failed_with(&["no graphics adapter found", "no-such-adapter"]);
    }
    assert_eq!(folder.files(), [""; 0]);
    Ok(())
}

pub(crate) fn bad_grids() -> Result<(), Failed> {
    let folder = Folder::new();
    for grid in ["0", "1", "2", "100000", "4294967295"] {
        let run = folder.run(["render", "builtin:cornell:0", "-o", "x.png", "--size", "8x8", "--grid", grid]);
        run.failed_with(&["cells along its longest axis"]);
    }
    let run = folder.line("render builtin:cornell:0 -o x.png --size 8x8 --grid 300 --tier core");
    run.failed_with(&["300 x 300 x 300", "would fit"]);
    assert_eq!(folder.files(), [""; 0]);
    Ok(())
}
