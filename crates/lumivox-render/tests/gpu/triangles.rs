//! Volumes from triangles against the thin and the exact voxel set.

use glam::{Mat4, UVec3, Vec3, Vec4};
use libtest_mimic::Failed;
use lumivox::VolumeBuffer;
use lumivox::core::{Bounds, Grid, TriangleView};
use lumivox::gpu::Gpu;
use lumivox::progressive::{CHANNELS, SURFACE_SHIFT};
use lumivox::volume::{ALBEDO, EMISSION, NORMAL};
use lumivox_oracle::voxels::{Coverage, VoxelSet};
use lumivox_render::gpu_scene::GpuScene;
use lumivox_render::triangle_voxelizer::TriangleVoxelizer;
use lumivox_render::{GiMethod, Renderer, Settings, VoxelSource};
use lumivox_scene::{AlphaMode, Instance, Material, Mesh, Scene, Texture, Wrap, builtin};

use crate::Check;
use crate::moving::sliding_block;
use crate::scenes::small;

pub(crate) const TESTS: &[(&str, Check)] = &[
    ("triangles: marked cells are those of the thin set", marked_cells_are_those_of_the_thin_set),
    (
        "triangles: a closed cube is a hollow shell without holes",
        a_closed_cube_is_a_hollow_shell_without_holes,
    ),
    ("triangles: normals are those of the faces", normals_are_those_of_the_faces),
    ("triangles: textures are sampled where they lie", textures_are_sampled_where_they_lie),
    ("triangles: masks have holes", masks_have_holes),
    ("triangles: instances are placed", instances_are_placed),
    ("triangles: what moves is voxelized anew, with its sub-cells", what_moves_is_voxelized_anew),
];

/// Drivers may be off by half a step of 8 bits when they make sRGB linear.
const SRGB_ERROR: f32 = 0.5 / 255.0;

/// The channels of a volume, one entry per cell.
struct TriangleVolume {
    normal: Vec<Vec4>,
    albedo: Vec<Vec4>,
    emission: Vec<Vec4>,
}

fn voxelize(gpu: &Gpu, scene: &Scene, grid: &Grid) -> Result<TriangleVolume, Failed> {
    let panels = Scene::default();
    let (gpu_scene, textures) = GpuScene::new(gpu, scene, &panels, true)?;
    let mut volume = VolumeBuffer::new(gpu, *grid, &CHANNELS)?;
    let mut voxelizer =
        TriangleVoxelizer::new(gpu, (scene, &panels), (&gpu_scene, &textures), &volume, false)?;
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    voxelizer.record(gpu, &mut encoder, &mut volume, None)?;
    gpu.queue.submit([encoder.finish()]);
    let read = volume.read_back(gpu)?;
    let channel = |name| read.channel(name).map(<[_]>::to_vec).ok_or("no such channel");
    Ok(TriangleVolume { normal: channel(NORMAL)?, albedo: channel(ALBEDO)?, emission: channel(EMISSION)? })
}

fn marked(volume: &TriangleVolume, grid: &Grid) -> Vec<UVec3> {
    grid.cells().filter(|&c| volume.normal[grid.index(c)].w > 0.0).collect()
}

/// All triangles in world space.
fn soup(scene: &Scene) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let corners = scene.instances.iter().flat_map(|i| {
        let mesh = &scene.meshes[i.mesh];
        mesh.indices
            .iter()
            .flatten()
            .map(|&v| i.world_from_local.transform_point3(mesh.positions[v as usize].into()).to_array())
    });
    let positions: Vec<_> = corners.collect();
    let indices = (0..positions.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    (positions, indices)
}

/// A cube about the origin, faces outwards.
fn cube(half: f32) -> Scene {
    let corner = |n: u32| [0, 1, 2].map(|axis| if n >> axis & 1 == 1 { half } else { -half });
    let indices = vec![
        [0, 2, 3],
        [0, 3, 1],
        [4, 5, 7],
        [4, 7, 6],
        [0, 1, 5],
        [0, 5, 4],
        [2, 6, 7],
        [2, 7, 3],
        [0, 4, 6],
        [0, 6, 2],
        [1, 3, 7],
        [1, 7, 5],
    ];
    one_mesh(Mesh::flat("cube", (0..8).map(corner).collect(), indices, 0), Material::default())
}

fn one_mesh(mesh: Mesh, material: Material) -> Scene {
    Scene {
        meshes: vec![mesh],
        materials: vec![material],
        instances: vec![Instance { mesh: 0, world_from_local: Mat4::IDENTITY }],
        ..Scene::default()
    }
}

fn marked_cells_are_those_of_the_thin_set(gpu: &Gpu) -> Result<(), Failed> {
    let mut all_sure = 0;
    for (name, scene) in
        [("cornell", builtin::cornell(1)), ("furnace", builtin::furnace(2)), ("atrium", builtin::atrium(0))]
    {
        for resolution in [9, 24] {
            let grid = Grid::fit_with_margin(&scene.bounds(), resolution)?;
            let volume = voxelize(gpu, &scene, &grid)?;
            let (positions, indices) = soup(&scene);
            let triangles = TriangleView::new(&positions, &indices).ok_or("indices")?;
            // Surfaces are moved a little: by so much a cell may be away from them.
            let thin = VoxelSet::with_margin(grid, triangles, Coverage::Thin, 2.1 * SURFACE_SHIFT);
            let cells = marked(&volume, &grid);
            let astray: Vec<_> = cells.iter().filter(|&&c| !thin.verdict(c).possibly).collect();
            assert!(astray.is_empty(), "{name} {resolution}: {} cells, first {}", astray.len(), astray[0]);
            let sure = grid.cells().filter(|&c| thin.verdict(c).surely).count();
            let missed = grid
                .cells()
                .filter(|&c| thin.verdict(c).surely && volume.normal[grid.index(c)].w == 0.0)
                .count();
            eprintln!("{name} {resolution}: {} marked, {sure} sure, {missed} missed", cells.len());
            assert_eq!(missed, 0, "{name} {resolution}: of {sure}");
            all_sure += sure;
        }
    }
    assert!(all_sure > 1000, "{all_sure} cells that do not hang on a margin");
    Ok(())
}

fn a_closed_cube_is_a_hollow_shell_without_holes(gpu: &Gpu) -> Result<(), Failed> {
    for resolution in [7, 16, 31] {
        let scene = cube(1.0);
        let grid = Grid::fit_with_margin(&scene.bounds(), resolution)?;
        let volume = voxelize(gpu, &scene, &grid)?;
        let cells = marked(&volume, &grid);
        for &cell in &cells {
            let deepest = grid.center(cell).abs().max_element();
            assert!((deepest - 1.0).abs() < 0.6 * grid.cell_size, "{cell} is no cell of the shell");
        }
        // Through the faces of free cells nobody gets from the margin to the middle.
        let free = |c: UVec3| volume.normal[grid.index(c)].w == 0.0;
        let mut reached = vec![false; grid.cell_count() as usize];
        let mut open = vec![UVec3::ZERO];
        reached[0] = true;
        while let Some(cell) = open.pop() {
            for step in [UVec3::X, UVec3::Y, UVec3::Z] {
                for next in [Some(cell + step), cell.checked_sub(step)].into_iter().flatten() {
                    if next.cmplt(grid.dims).all() && free(next) && !reached[grid.index(next)] {
                        reached[grid.index(next)] = true;
                        open.push(next);
                    }
                }
            }
        }
        let middle = grid.dims / 2;
        assert!(free(middle) && !reached[grid.index(middle)], "{resolution}");
    }
    Ok(())
}

fn normals_are_those_of_the_faces(gpu: &Gpu) -> Result<(), Failed> {
    let scene = cube(1.0);
    let grid = Grid::fit_with_margin(&scene.bounds(), 20)?;
    let volume = voxelize(gpu, &scene, &grid)?;
    for cell in marked(&volume, &grid) {
        let p = grid.center(cell);
        let normal = volume.normal[grid.index(cell)].truncate();
        assert!(normal.length() < 1.001 && normal.dot(p) > 0.0, "{normal} at {p}");
        // Away from the edges of the cube only one face counts.
        let on_one_face = p.to_array().iter().filter(|c| c.abs() > 1.0 - 1.5 * grid.cell_size).count() == 1;
        if on_one_face {
            assert!((normal.abs().max_element() - 1.0).abs() < 1e-4, "{normal} at {p}");
        }
    }
    Ok(())
}

fn texture(pixels: &[[u8; 4]]) -> Texture {
    let side = (pixels.len() as f32).sqrt() as u32;
    Texture {
        name: "t".to_owned(),
        width: side,
        height: side,
        srgb: true,
        pixels: pixels.concat(),
        wrap: [Wrap::Clamp; 2],
    }
}

/// An upright square from 0 to 1 in x and y, whose texture stands upright.
fn textured_square(material: Material, pixels: &[[u8; 4]]) -> Scene {
    let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let mut mesh = Mesh::flat("square", positions, vec![[0, 1, 2], [0, 2, 3]], 0);
    mesh.uvs = mesh.positions.iter().map(|p| [p[0], 1.0 - p[1]]).collect();
    Scene { textures: vec![texture(pixels)], ..one_mesh(mesh, material) }
}

fn square_grid() -> Grid {
    let fitted = Grid::fit(&Bounds::new(Vec3::new(0.0, 0.0, -0.5), Vec3::new(1.0, 1.0, 0.5)), 8);
    fitted.expect("a box of one metre")
}

fn textures_are_sampled_where_they_lie(gpu: &Gpu) -> Result<(), Failed> {
    let (red, green, blue, grey) =
        ([255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [188, 188, 188, 255]);
    // Four quarters of 16 texels: filtering mixes them at their borders alone.
    let quarters = [red, green, blue, grey];
    let pixels: Vec<_> = (0..64).map(|n| quarters[n % 8 / 4 + 2 * (n / 32)]).collect();
    let material = Material {
        base_color_texture: Some(0),
        emission: Vec3::new(2.0, 4.0, 6.0),
        emission_texture: Some(0),
        ..Material::default()
    };
    let (scene, grid) = (textured_square(material, &pixels), square_grid());
    let volume = voxelize(gpu, &scene, &grid)?;
    let cells = marked(&volume, &grid);
    assert_eq!(cells.len(), 64);
    let linear_188 = ((188.0f32 / 255.0 + 0.055) / 1.055).powf(2.4);
    let mut counts = [0; 4];
    for cell in cells {
        let p = grid.center(cell);
        // Judge the cells that are no part of a border.
        if (p.x - 0.5).abs() < 0.1 || (p.y - 0.5).abs() < 0.1 {
            continue;
        }
        let which = usize::from(p.x > 0.5) + 2 * usize::from(p.y < 0.5);
        counts[which] += 1;
        let expected = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::splat(linear_188)][which];
        let (albedo, emission) = (volume.albedo[grid.index(cell)], volume.emission[grid.index(cell)]);
        assert!((albedo.truncate() - expected).abs().max_element() < SRGB_ERROR, "{albedo} at {p}");
        let expected = Vec3::new(2.0, 4.0, 6.0) * expected;
        assert!((emission.truncate() - expected).abs().max_element() < 6.0 * SRGB_ERROR, "{emission} at {p}");
    }
    assert_eq!(counts, [9; 4]);
    Ok(())
}

/// A texture of two columns, the left one cut out: cells are as opaque as its filter says there, or all of it.
fn masks_have_holes(gpu: &Gpu) -> Result<(), Failed> {
    let (hole, leaf) = ([255, 255, 255, 0], [255; 4]);
    for alpha in [AlphaMode::Mask { cutoff: 0.5 }, AlphaMode::Blend, AlphaMode::Opaque] {
        let material = Material { base_color_texture: Some(0), alpha, ..Material::default() };
        let (scene, grid) = (textured_square(material, &[hole, leaf, hole, leaf]), square_grid());
        let volume = voxelize(gpu, &scene, &grid)?;
        let cells = marked(&volume, &grid);
        // What is cut out to the last is not there.
        assert_eq!(cells.len(), if alpha == AlphaMode::Opaque { 64 } else { 48 }, "{alpha:?}");
        for cell in cells {
            let (x, opacity) = (grid.center(cell).x, volume.normal[grid.index(cell)].w);
            // Straight from the middle of one column to that of the other.
            let along = (2.0 * x - 0.5).clamp(0.0, 1.0);
            let expected = if alpha == AlphaMode::Opaque { 1.0 } else { along };
            assert!((opacity - expected).abs() < 5e-3, "{alpha:?}: {opacity} for {expected} at {x}");
        }
    }
    Ok(())
}

/// Instances go where their matrices put them, mirrored and stretched ones too.
fn instances_are_placed(gpu: &Gpu) -> Result<(), Failed> {
    let mut scene = cube(0.4);
    let stretch = Mat4::from_scale(Vec3::new(-1.0, 2.0, 0.5));
    scene.instances = vec![
        Instance { mesh: 0, world_from_local: Mat4::from_translation(Vec3::new(2.0, 0.0, 0.0)) },
        Instance { mesh: 0, world_from_local: Mat4::from_translation(Vec3::new(-2.0, 0.0, 0.0)) * stretch },
    ];
    let grid = Grid::fit_with_margin(&scene.bounds(), 40)?;
    let volume = voxelize(gpu, &scene, &grid)?;
    for (middle, half) in
        [(Vec3::new(2.0, 0.0, 0.0), Vec3::splat(0.4)), (Vec3::new(-2.0, 0.0, 0.0), Vec3::new(0.4, 0.8, 0.2))]
    {
        let near = marked(&volume, &grid).into_iter().filter(|&c| (grid.center(c).x - middle.x).abs() < 1.0);
        let mut count = 0;
        for cell in near {
            let away = (grid.center(cell) - middle) / half;
            let normal = volume.normal[grid.index(cell)].truncate();
            assert!(normal.dot(away) > 0.0, "{normal} at {away} faces inwards");
            let outside = (grid.center(cell) - middle).abs() - half;
            assert!(outside.max_element().abs() < 0.6 * grid.cell_size);
            count += 1;
        }
        assert!(count > 100);
    }
    Ok(())
}

/// After each move the volume and its sub-cells are those of a renderer that never saw another moment.
fn what_moves_is_voxelized_anew(gpu: &Gpu) -> Result<(), Failed> {
    let mut scene = sliding_block();
    let settings =
        Settings { voxels: VoxelSource::Triangles, gi: GiMethod::Gather, clip: Some(0), ..small() };
    let read = |renderer: &Renderer| -> Result<_, Failed> {
        let gathered = renderer.gathered().ok_or("no gathered light")?;
        let normals = renderer.volume().read_back(gpu)?.channel(NORMAL).map(<[_]>::to_vec);
        Ok((normals.ok_or("no normals")?, gathered.read_subcells(gpu)?))
    };
    let mut moving = Renderer::new(gpu, &scene, settings)?;
    let mut before = Vec::new();
    for seconds in [0.0, 0.4, 1.0, 0.4] {
        let pose = scene.pose(0, seconds);
        scene.apply(&pose);
        moving.set_pose(&pose);
        moving.frame(None)?;
        let mut fresh = Renderer::new(gpu, &scene, settings)?;
        fresh.frame(None)?;
        let (found, expected) = (read(&moving)?, read(&fresh)?);
        let filled: u32 = found.1.iter().map(|bits| bits.count_ones()).sum();
        assert!(filled > 1000 && found.1 != before, "{seconds} s: {filled} sub-cells");
        assert!(found == expected, "{seconds} s");
        before = found.1;
    }
    Ok(())
}
