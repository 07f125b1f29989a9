//! Files read back by readers that others wrote; `readers.py` has those that are not in Rust.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test that cannot go on has failed")]

mod common;

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use common::{Soup, sphere, unit_grid};
use dot_vox::SceneNode;
use glam::{IVec3, UVec3, Vec3};
use lumivox_core::{Grid, TriangleView};
use lumivox_voxels::files::{self, FileError, FileFormat, FileReport};
use lumivox_voxels::{
    Channel, Coverage, Format, GridSpec, Model, SparseVolume, SurfacePoint, VoxelizeOptions, voxelize,
};

/// A folder of its own for each test, away with its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("lumivox_voxels_{name}_{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn write(&self, name: &str, volume: &SparseVolume) -> FileReport {
        let path = self.0.join(name);
        files::write(&path, FileFormat::of_path(&path).unwrap(), volume).unwrap()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn grid(dims: [u32; 3]) -> Grid {
    Grid { origin: Vec3::new(-3.0, 7.5, 0.25), cell_size: 0.5, dims: UVec3::from(dims) }
}

/// A slanted triangle across the grid, with colours that say where.
fn slanted(grid: Grid, solid: bool) -> SparseVolume {
    let size = grid.bounds().size();
    let at = |x, y, z| (grid.origin + size * Vec3::new(x, y, z)).to_array();
    let positions = [at(0.02, 0.1, 0.03), at(0.97, 0.3, 0.1), at(0.2, 0.9, 0.98)];
    let model = Model::from(TriangleView { positions: &positions, indices: &[[0, 1, 2]] });
    let tint = move |s: &SurfacePoint| ((s.position - grid.origin) / size).extend(0.0).to_array();
    let channels = vec![
        Channel::custom("albedo", 3, tint).format(Format::F32),
        Channel::normal(),
        Channel::area(),
        Channel::custom("pair", 2, |_| [0.25, 1.0, 0.0, 0.0]).format(Format::U8),
    ];
    let options =
        VoxelizeOptions { grid: GridSpec::Grid(grid), channels, solid, ..VoxelizeOptions::default() };
    voxelize(&model, &options).unwrap()
}

/// The cells of a `.vox` file in MagicaVoxel's world, with their colours, by its scene graph.
fn vox_cells(bytes: &[u8]) -> BTreeMap<[i32; 3], [u8; 3]> {
    let data = dot_vox::load_bytes(bytes).unwrap();
    let mut cells = BTreeMap::new();
    let mut waiting = vec![(0u32, IVec3::ZERO)];
    while let Some((node, place)) = waiting.pop() {
        match &data.scenes[node as usize] {
            SceneNode::Transform { frames, child, .. } => {
                let here = frames[0].position().map_or(IVec3::ZERO, |p| IVec3::new(p.x, p.y, p.z));
                waiting.push((*child, place + here));
            }
            SceneNode::Group { children, .. } => waiting.extend(children.iter().map(|&c| (c, place))),
            SceneNode::Shape { models, .. } => {
                let model = &data.models[models[0].model_id as usize];
                let size = IVec3::new(model.size.x as i32, model.size.y as i32, model.size.z as i32);
                assert!(size.max_element() <= 256);
                for v in &model.voxels {
                    let cell = place - size / 2 + IVec3::new(v.x.into(), v.y.into(), v.z.into());
                    let color = &data.palette[usize::from(v.i)];
                    assert!(cells.insert(cell.to_array(), [color.r, color.g, color.b]).is_none());
                }
            }
        }
    }
    cells
}

#[test]
fn vox_models_stand_where_the_cells_are_in_their_colours() {
    let folder = Folder::new("vox");
    // One model, whole models, and models of odd sizes.
    for dims in [[30, 21, 9], [256, 512, 16], [301, 257, 40]] {
        let volume = slanted(grid(dims), false);
        let report = folder.write("a.vox", &volume);
        assert_eq!(report.left_out, ["normal", "area", "pair"]);
        let worst = report.color_error.unwrap();
        assert!(worst <= 40, "{worst}");
        let found = vox_cells(&std::fs::read(folder.0.join("a.vox")).unwrap());
        assert_eq!(found.len() as u64, volume.len());
        let [nx, ny, nz] = dims.map(|n| n as i32);
        for cell in volume.cells() {
            // z up: (x, -z, y), around the middle of the grid.
            let c = cell.as_ivec3();
            let there = [c.x - nx / 2, nz - 1 - c.z - nz / 2, c.y - ny / 2];
            let color = found.get(&there).unwrap_or_else(|| panic!("{dims:?} {cell}"));
            let wanted = files::srgb_from_linear(volume.value("albedo", cell).unwrap().truncate());
            assert!((0..3).all(|i| color[i].abs_diff(wanted[i]) <= worst), "{color:?} {wanted:?}");
        }
        let data = dot_vox::load(&folder.0.join("a.vox").display().to_string()).unwrap();
        let SceneNode::Transform { attributes, .. } = &data.scenes[0] else { panic!() };
        assert_eq!(attributes["_origin"], "-3.0 7.5 0.25");
        assert_eq!(
            (attributes["_cell_size"].as_str(), attributes["_axis_order"].as_str()),
            ("0.5", "x -z y")
        );
    }
}

#[test]
fn ktx2_textures_have_format_size_and_texels() {
    let folder = Folder::new("ktx2");
    let volume = slanted(grid([19, 13, 11]), false);
    let report = folder.write("a.ktx2", &volume);
    assert_eq!((report.files.len(), report.left_out.len()), (5, 0));
    use ktx2::Format as F;
    let expected = [
        ("a.ktx2", F::R8_UNORM, 1),
        ("a.albedo.ktx2", F::R32G32B32A32_SFLOAT, 16),
        ("a.normal.ktx2", F::R16G16B16A16_SFLOAT, 8),
        ("a.area.ktx2", F::R32_SFLOAT, 4),
        ("a.pair.ktx2", F::R8G8_UNORM, 2),
    ];
    for (name, format, bytes) in expected {
        let file = std::fs::read(folder.0.join(name)).unwrap();
        let reader = ktx2::Reader::new(&file[..]).unwrap();
        let header = reader.header();
        assert_eq!(header.format, Some(format), "{name}");
        assert_eq!([header.pixel_width, header.pixel_height, header.pixel_depth], [19, 13, 11]);
        assert_eq!((header.level_count, header.layer_count, header.face_count), (1, 0, 1));
        let pairs: BTreeMap<&str, &[u8]> = reader.key_value_data().collect();
        assert_eq!(pairs["lumivox.origin"], b"-3.0 7.5 0.25\0", "{name}");
        assert_eq!((pairs["lumivox.cell_size"], pairs["KTXorientation"]), (&b"0.5\0"[..], &b"ruo\0"[..]));
        let level = reader.levels().next().unwrap().data;
        assert_eq!(level.len(), 19 * 13 * 11 * bytes);
        for cell in volume.grid().cells() {
            let texel = &level[bytes * volume.grid().index(cell)..][..bytes];
            let float = |n: usize| f32::from_le_bytes(texel[4 * n..4 * n + 4].try_into().unwrap());
            match name {
                "a.ktx2" => assert_eq!(texel[0] == 255, volume.contains(cell)),
                "a.albedo.ktx2" => {
                    let wanted = volume.value("albedo", cell).unwrap_or_default().truncate();
                    assert_eq!(Vec3::new(float(0), float(1), float(2)), wanted);
                    assert_eq!(float(3) == 1.0, volume.contains(cell));
                }
                "a.area.ktx2" => assert_eq!(float(0), volume.value("area", cell).unwrap_or_default().x),
                "a.pair.ktx2" => assert_eq!(texel == [64, 255], volume.contains(cell)),
                _ => {}
            }
        }
    }
}

#[test]
fn ply_points_are_the_middles_of_cells() {
    use ply_rs_bw::{parser::Parser, ply::DefaultElement, ply::Property};
    let folder = Folder::new("ply");
    let volume = slanted(grid([19, 13, 11]), false);
    folder.write("a.ply", &volume);
    let mut file = std::io::BufReader::new(std::fs::File::open(folder.0.join("a.ply")).unwrap());
    let ply = Parser::<DefaultElement>::new().read_ply(&mut file).unwrap();
    assert!(ply.header.comments.iter().any(|c| c == "origin -3.0 7.5 0.25"));
    let float = |point: &DefaultElement, name: &str| match point.get(name) {
        Some(Property::Float(v)) => *v,
        other => panic!("{name}: {other:?}"),
    };
    let points = &ply.payload["vertex"];
    assert_eq!(points.len() as u64, volume.len());
    for (point, cell) in points.iter().zip(volume.cells()) {
        let place = Vec3::new(float(point, "x"), float(point, "y"), float(point, "z"));
        assert_eq!(volume.grid().cell_from_world(place), Some(cell));
        assert_eq!(float(point, "nz"), volume.value("normal", cell).unwrap().z);
        assert_eq!(float(point, "pair_1"), 1.0);
    }
}

#[test]
fn filled_cells_are_in_every_format_and_empty_volumes_too() {
    let folder = Folder::new("filled");
    let mut soup = sphere(9.0, 3);
    soup.positions.iter_mut().for_each(|p| *p = (Vec3::from(*p) + 10.0).to_array());
    for soup in [soup, Soup::default()] {
        let options = VoxelizeOptions {
            grid: GridSpec::Grid(unit_grid(20, 20, 20)),
            coverage: Coverage::Thin,
            channels: vec![Channel::albedo()],
            solid: true,
            ..VoxelizeOptions::default()
        };
        let volume = voxelize(&Model::from(soup.view()), &options).unwrap();
        for name in ["a.npz", "a.nhdr", "a.ktx2", "a.vdb", "a.ply", "a.vox", "a.binvox"] {
            let report = folder.write(name, &volume);
            assert!(report.files.iter().all(|file| file.exists()));
        }
        let vox = std::fs::read(folder.0.join("a.vox")).unwrap();
        assert_eq!(vox_cells(&vox).len() as u64, volume.len());
        let raw = std::fs::read(folder.0.join("a.raw")).unwrap();
        assert_eq!(raw.iter().filter(|&&b| b == 1).count() as u64, volume.len());
        let colors: BTreeSet<_> = vox_cells(&vox).into_values().collect();
        assert_eq!(colors.len(), if soup.indices.is_empty() { 0 } else { 2 }, "white surface, grey inside");
    }
    let left: Vec<_> = std::fs::read_dir(&folder.0)
        .unwrap()
        .filter_map(|e| e.ok()?.file_name().into_string().ok())
        .collect();
    assert!(left.iter().all(|name| !name.ends_with(".part")), "{left:?}");
}

#[test]
fn what_a_format_cannot_hold_is_said_with_numbers() {
    let folder = Folder::new("limits");
    let volume = slanted(grid([2001, 3, 3]), false);
    let error = files::write(&folder.0.join("a.vox"), FileFormat::Vox, &volume).unwrap_err();
    assert!(
        matches!(error, FileError::Limit { .. }) && error.to_string().contains("2001 x 3 x 3"),
        "{error}"
    );
    let nowhere = folder.0.join("no/such/folder.npz");
    let error = files::write(&nowhere, FileFormat::Npz, &volume).unwrap_err();
    assert!(matches!(error, FileError::Io { .. }) && error.to_string().contains("folder.npz"), "{error}");
    assert_eq!(FileFormat::of_path("a.obj".as_ref()), None);
    assert_eq!(FileFormat::of_path("A.VDB".as_ref()), Some(FileFormat::Vdb));
}
