//! Whether every layer of an EXR shows the right thing at the right pixel, by points projected on the CPU.

use glam::{Vec2, Vec3};
use libtest_mimic::Failed;

use crate::support::{Folder, read_exr};

const EYE: Vec3 = Vec3::new(0.4, 1.3, 3.0);
const TARGET: Vec3 = Vec3::new(0.1, 0.9, 0.0);
const FOV_Y: f32 = 50.0;
const SIZE: (usize, usize) = (97, 64);
/// W/m2 of a sun along -z.
const SUN: f32 = 2.0;

/// Squares that face +z: middle, half side, albedo.
const SQUARES: [(Vec3, f32, Vec3); 4] = [
    (Vec3::new(-1.0, 1.5, 0.0), 0.3, Vec3::new(0.8, 0.1, 0.1)),
    (Vec3::new(0.9, 1.4, -0.4), 0.25, Vec3::new(0.1, 0.7, 0.2)),
    (Vec3::new(-0.7, 0.5, 0.6), 0.2, Vec3::new(0.1, 0.2, 0.9)),
    (Vec3::new(0.8, 0.3, 0.3), 0.3, Vec3::new(0.5, 0.5, 0.5)),
];

/// Column, row and distance along the view, from the camera's definition.
fn project(p: Vec3) -> (f32, f32, f32) {
    let forward = (TARGET - EYE).normalize_or_zero();
    let right = forward.cross(Vec3::Y).normalize_or_zero();
    let up = right.cross(forward);
    let way = p - EYE;
    let depth = way.dot(forward);
    let half_height = (0.5 * FOV_Y.to_radians()).tan() * depth;
    let (width, height) = (SIZE.0 as f32, SIZE.1 as f32);
    let ndc = Vec2::new(way.dot(right) / (half_height * width / height), way.dot(up) / half_height);
    ((0.5 + 0.5 * ndc.x) * width, (0.5 - 0.5 * ndc.y) * height, depth)
}

pub(crate) fn every_layer_shows_the_right_pixels() -> Result<(), Failed> {
    let folder = Folder::new();
    let vector = |v: Vec3| format!("[{},{},{}]", v.x, v.y, v.z);
    let quads = SQUARES.map(|(middle, half, albedo)| {
        let corner = |x: f32, y: f32| vector(middle + half * Vec3::new(x, y, 0.0));
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)].join(",");
        format!(r#"{{"quad": [{corners}], "albedo": {}}}"#, vector(albedo))
    });
    let scene = format!(
        r#"{{"camera": {{"eye": {}, "target": {}, "up": [0,1,0], "fov_y_deg": {FOV_Y}}},
            "lights": [{{"type": "directional", "direction": [0,0,-1], "irradiance": [{SUN},{SUN},{SUN}]}}],
            "meshes": [{}]}}"#,
        vector(EYE),
        vector(TARGET),
        quads.join(",")
    );
    folder.write("squares.scene.json", scene);
    let layer = |name: &str| -> Result<Vec<Vec<[f32; 3]>>, Failed> {
        let size = format!("{}x{}", SIZE.0, SIZE.1);
        let arguments = ["render", "squares.scene.json", "-o", "x.exr", "--grid", "16", "--iterations", "0"];
        folder.run(arguments.into_iter().chain(["--size", &size, "--layer", name])).succeeded();
        read_exr(&folder.join("x.exr"))
    };
    let [albedo, direct, picture] = [layer("albedo")?, layer("direct")?, layer("final")?];
    let [normal, depth, indirect] = [layer("normal")?, layer("depth")?, layer("indirect")?];
    let mut drawn = 0;
    for (middle, half, reflectance) in SQUARES {
        // Its border's pixels from both sides: a quarter of a pixel decides.
        let (x0, y0, _) = project(middle + half * Vec3::new(-1.0, 1.0, 0.0));
        let (x1, y1, _) = project(middle + half * Vec3::new(1.0, -1.0, 0.0));
        let pixel = (x1 - x0) / (2.0 * half);
        for row in 0..SIZE.1 {
            for column in 0..SIZE.0 {
                // Back from the pixel's middle to the square's plane.
                let at = unproject(column as f32 + 0.5, row as f32 + 0.5, middle.z);
                let inside = half - (at - middle).truncate().abs().max_element();
                if inside.abs() < 0.25 / pixel || inside < 0.0 {
                    continue;
                }
                drawn += 1;
                let seen = |image: &[Vec<[f32; 3]>]| Vec3::from(image[row][column]);
                let near = |a: Vec3, b: Vec3, tolerance: f32| (a - b).abs().max_element() < tolerance;
                // Eight bits of sRGB, half a step: 0.004 at most.
                assert!(
                    near(seen(&albedo), reflectance, 0.005),
                    "albedo {} at {column},{row}",
                    seen(&albedo)
                );
                let lit = reflectance * SUN / std::f32::consts::PI;
                assert!(near(seen(&direct), lit, 0.005), "direct {} of {lit}", seen(&direct));
                assert!(near(seen(&picture), lit + seen(&indirect), 0.005), "final {}", seen(&picture));
                assert!(near(seen(&normal), Vec3::new(0.5, 0.5, 1.0), 0.002), "normal {}", seen(&normal));
                let distance = project(at).2;
                assert!(near(seen(&depth), Vec3::splat(distance), 2e-3), "depth {}", seen(&depth));
            }
        }
        assert!(y1 > y0 + 4.0, "row 0 is on top: {y0} {y1}");
    }
    assert!(drawn > 300, "{drawn} pixels were judged");
    // Beside the squares there is nothing.
    let nothing = albedo.iter().flatten().filter(|p| **p == [0.0; 3]).count();
    assert!(nothing > SIZE.0 * SIZE.1 / 2, "{nothing} pixels are empty");
    Ok(())
}

/// The point of the plane `z` that a picture position shows.
fn unproject(x: f32, y: f32, z: f32) -> Vec3 {
    let forward = (TARGET - EYE).normalize_or_zero();
    let right = forward.cross(Vec3::Y).normalize_or_zero();
    let up = right.cross(forward);
    let half_height = (0.5 * FOV_Y.to_radians()).tan();
    let (width, height) = (SIZE.0 as f32, SIZE.1 as f32);
    let across = (2.0 * x / width - 1.0) * half_height * width / height;
    let direction = forward + across * right + (1.0 - 2.0 * y / height) * half_height * up;
    EYE + (z - EYE.z) / direction.z * direction
}

/// A lamp that moves lights another half of the floor; a clip that is not there is named.
pub(crate) fn scenes_move() -> Result<(), Failed> {
    let folder = Folder::new();
    let quick = ["--size", "24x16", "--grid", "12", "--iterations", "4"];
    let run = |rest: &str| {
        let arguments = ["render", "builtin:door:0"].into_iter().chain(quick);
        folder.run(arguments.chain(rest.split_whitespace()))
    };
    run("-o t0.png --time 0").succeeded();
    run("-o t1.png --time 2").succeeded();
    run("-o none.png --time 2 --clip none").succeeded();
    let picture = |name: &str| image::open(folder.join(name)).map(|p| p.into_rgb8());
    assert!(picture("t0.png")? != picture("t1.png")?, "time moves the scene");
    assert!(picture("t1.png")? != picture("none.png")?, "without a clip it stands still");
    run("-o x.png --clip dance").failed_with(&["no clip", "dance", "known are"]);
    run("-o walk.gif --frames 3 --fps 4 --time 1").succeeded();
    let gif =
        image::codecs::gif::GifDecoder::new(std::io::Cursor::new(std::fs::read(folder.join("walk.gif"))?))?;
    let frames = image::AnimationDecoder::into_frames(gif).collect_frames()?;
    assert_eq!(frames.len(), 3);
    assert!(frames.iter().all(|f| f.delay().numer_denom_ms() == (250, 1)));
    assert!(frames[0].buffer() != frames[2].buffer(), "the animation moves");
    run("-o x.gif").failed_with(&["x.gif", "--frames"]);
    run("-o x_%d.png --frames 2 --fps 0").failed_with(&["--fps"]);
    Ok(())
}
