//! Colours of voxels: textures the right way up and averaged in linear space, factors, vertex colours, and what is missing.

use libtest_mimic::Failed;

use crate::support::{Folder, read_json};
use crate::voxel_files::{self, key};

/// A sheet of 1 x 1 in x and y with its texture upright, 2 thousandths before z = 0.
const SHEET: &str = "mtllib m.mtl\nusemtl sheet\nv 0 0 0.002\nv 1 0 0.002\nv 1 1 0.002\nv 0 1 0.002\n\
                     vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";

pub(crate) fn sheet(folder: &Folder, side: u32, pixel: impl Fn(u32, u32) -> [u8; 3]) {
    folder.write("sheet.obj", SHEET);
    folder.write("m.mtl", "newmtl sheet\nKd 1 1 1\nmap_Kd picture.png\n");
    let picture = image::RgbImage::from_fn(side, side, |x, y| image::Rgb(pixel(x, y)));
    picture.save(folder.join("picture.png")).unwrap();
}

/// The colours of a sheet of `n` x `n` cells, row by row from the top.
fn colors(folder: &Folder, file: &str, n: usize) -> Result<Vec<Vec<[u8; 3]>>, Failed> {
    let side = 1.0 / n as f64;
    let points = voxel_files::read(&folder.join(file), side)?;
    let at = |column: usize, row: usize| {
        let center = [side * (column as f64 + 0.5), 1.0 - side * (row as f64 + 0.5), 0.5 * side + 0.002];
        let found = points
            .iter()
            .find(|(point, _)| (0..3).all(|axis| (point[axis] - key(center, side)[axis]).abs() < 100));
        found.and_then(|(_, color)| *color).ok_or("no voxel there")
    };
    Ok((0..n)
        .map(|row| (0..n).map(|column| at(column, row)).collect::<Result<_, _>>())
        .collect::<Result<_, _>>()?)
}

const QUARTERS: [[u8; 3]; 4] = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 0]];

/// Red above on the left, green beside it, blue and yellow below.
pub(crate) fn upright() -> Result<(), Failed> {
    let folder = Folder::new();
    // Large quarters, and a picture of four pixels, none of which bleeds into another.
    for (pixels, file) in [(64, "x.ply"), (2, "x.vox"), (2, "x.ply")] {
        sheet(&folder, pixels, |x, y| QUARTERS[(2 * (2 * y / pixels) + 2 * x / pixels) as usize]);
        for color in ["average", "nearest"] {
            let line = format!("voxelize sheet.obj -o {file} --resolution 8 --color {color}");
            folder.line(&line).succeeded();
            for (row, colors) in colors(&folder, file, 8)?.iter().enumerate() {
                for (column, color) in colors.iter().enumerate() {
                    assert_eq!(
                        *color,
                        QUARTERS[2 * (row / 4) + column / 4],
                        "{line}: row {row}, column {column}"
                    );
                }
            }
        }
    }
    Ok(())
}

/// Black and white pixels much smaller than cells are half as bright as white: 188 of 255 and not 128.
pub(crate) fn averaged_in_linear_space() -> Result<(), Failed> {
    let folder = Folder::new();
    sheet(&folder, 256, |x, y| [if (x + y) % 2 == 0 { 255 } else { 0 }; 3]);
    folder.line("voxelize sheet.obj -o x.ply --resolution 4").succeeded();
    for color in colors(&folder, "x.ply", 4)?.concat() {
        assert!(color[0].abs_diff(188) <= 1, "{color:?}");
    }
    folder.line("voxelize sheet.obj -o x.ply --resolution 4 --color nearest").succeeded();
    for color in colors(&folder, "x.ply", 4)?.concat() {
        assert!(color == [0; 3] || color == [255; 3], "{color:?}");
    }
    Ok(())
}

/// Colours of vertices are linear means between them, and alone where the file says nothing else of the surface.
pub(crate) fn of_vertices_and_factors() -> Result<(), Failed> {
    let folder = Folder::new();
    let header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                  property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n\
                  property list uchar int vertex_indices\nend_header\n";
    let vertices = "0 0 0.002 200 100 50\n1 0 0.002 200 100 50\n1 1 0.002 200 100 50\n0 1 0.002 200 100 50\n";
    folder.write("v.ply", format!("{header}{vertices}4 0 1 2 3\n"));
    folder.line("voxelize v.ply -o x.ply --resolution 4 --channels albedo:f32").succeeded();
    for color in colors(&folder, "x.ply", 4)?.concat() {
        assert_eq!(color, [200, 100, 50]);
    }
    sheet(&folder, 4, |_, _| [255, 255, 255]);
    folder.write("m.mtl", "newmtl sheet\nKd 0.2159 0.5 0\nmap_Kd picture.png\n");
    folder.line("voxelize sheet.obj -o x.ply --resolution 4 --channels albedo:f32").succeeded();
    for color in colors(&folder, "x.ply", 4)?.concat() {
        assert_eq!(color, [128, 188, 0]);
    }
    Ok(())
}

pub(crate) fn missing() -> Result<(), Failed> {
    let folder = Folder::new();
    sheet(&folder, 4, |_, _| [9; 3]);
    std::fs::remove_file(folder.join("picture.png"))?;
    let run = folder.line("voxelize sheet.obj -o x.npz --resolution 4 --stats s.json");
    assert!(
        run.succeeded().stderr.contains("missing texture") && run.stderr.contains("picture.png"),
        "{}",
        run.stderr
    );
    let stats = read_json(&folder.join("s.json"))?;
    assert!(
        stats["missing_textures"][0].as_str().is_some_and(|name| name.contains("picture.png")),
        "{stats}"
    );
    // A format without room for what was asked for says so; what was not asked for is not missed.
    let run =
        folder.line("voxelize sheet.obj -o x.binvox --resolution 4 --channels albedo,normal --stats s.json");
    assert!(
        run.succeeded().stderr.contains("no place for albedo") && run.stderr.contains("normal"),
        "{}",
        run.stderr
    );
    assert_eq!(
        read_json(&folder.join("s.json"))?["left_out_channels"],
        serde_json::json!(["albedo", "normal"])
    );
    assert!(
        !folder.line("voxelize sheet.obj -o x.binvox --resolution 4").succeeded().stderr.contains("no place")
    );
    Ok(())
}
