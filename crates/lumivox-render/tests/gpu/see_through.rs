//! Light through masks and veils: cells are as opaque as these, and both ways of light that know cells let the rest through.

use glam::{Vec3, Vec4};
use libtest_mimic::Failed;
use lumivox::gpu::Gpu;
use lumivox::volume::NORMAL;
use lumivox_render::{GiMethod, Layer, Renderer, Settings, VoxelSource};
use lumivox_scene::{AlphaMode, Camera, Material, Scene, Texture, Wrap};

use crate::Check;
use crate::scenes::{Quad, add, settle, small};

pub(crate) const TESTS: &[(&str, Check)] = &[
    ("see-through: cells are as opaque as their masks and veils", cells),
    ("see-through: a half-open screen lets half of the light through, propagation", |gpu| {
        screens(gpu, GiMethod::Propagation)
    }),
    ("see-through: a half-open screen lets half of the light through, gathering", |gpu| {
        screens(gpu, GiMethod::Gather)
    }),
];

/// Half the length of the room, its height and its width, metres.
const ROOM: Vec3 = Vec3::new(3.0, 3.0, 3.0);

/// White squares, so many a side, of which every other one is cut out.
fn checkers(squares: u32) -> Texture {
    let side = 64;
    let square = |n: u32| n * squares / side;
    let is_cut = |n: u32| (square(n % side) + square(n / side)).is_multiple_of(2);
    let pixel = |n: u32| [255, 255, 255, if is_cut(n) { 0 } else { 255 }];
    Texture {
        name: "checkers".to_owned(),
        width: side,
        height: side,
        srgb: true,
        pixels: (0..side * side).flat_map(pixel).collect(),
        wrap: [Wrap::Clamp; 2],
    }
}

/// What stands across the room.
#[derive(Clone, Copy, Debug)]
enum Screen {
    None,
    /// Every other of so many squares a side.
    Mask(u32),
    /// As opaque as this everywhere.
    Veil(f32),
    Solid,
}

/// A room with one wall that glows, another across from it that reflects half, and nothing else that does.
fn room(screen: Screen) -> Scene {
    let mut scene = Scene::default();
    let upright = |x: f32, towards: f32| Quad {
        corner: Vec3::new(x, 0.0, 0.5 * towards * ROOM.z),
        u: -towards * ROOM.z * Vec3::Z,
        v: ROOM.y * Vec3::Y,
    };
    let glowing = Material { emission: Vec3::ONE, ..Material::matte("glowing", Vec3::ZERO) };
    add(&mut scene, glowing, &[upright(-ROOM.x, 1.0)]);
    add(&mut scene, Material::matte("grey", Vec3::splat(0.5)), &[upright(ROOM.x, -1.0)]);
    let (x, y, z) = (2.0 * ROOM.x * Vec3::X, ROOM.y * Vec3::Y, ROOM.z * Vec3::Z);
    let low = Vec3::new(-ROOM.x, 0.0, -0.5 * ROOM.z);
    let rest = [(low, z, x), (low + y, x, z), (low, x, y), (low + z, y, x)].map(|(corner, u, v)| Quad {
        corner,
        u,
        v,
    });
    add(&mut scene, Material::matte("black", Vec3::ZERO), &rest);
    let black = Material::matte("screen", Vec3::ZERO);
    // In the middle of a cell, so that shifts against either side leave it there.
    let across = [upright(0.1, 1.0)];
    match screen {
        Screen::None => {}
        Screen::Solid => add(&mut scene, black, &across),
        Screen::Mask(side) => {
            scene.textures.push(checkers(side));
            let alpha = AlphaMode::Mask { cutoff: 0.5 };
            add(&mut scene, Material { base_color_texture: Some(0), alpha, ..black }, &across);
        }
        Screen::Veil(opacity) => {
            let base_color = Vec4::new(0.0, 0.0, 0.0, opacity);
            add(&mut scene, Material { base_color, alpha: AlphaMode::Blend, ..black }, &across);
        }
    }
    scene
}

/// A renderer that looks at the grey wall from behind the screen.
fn behind(gpu: &Gpu, gi: GiMethod, screen: Screen) -> Result<Renderer, Failed> {
    let settings = Settings { gi, voxels: VoxelSource::Triangles, layer: Layer::Indirect, ..small() };
    let mut renderer = Renderer::new(gpu, &room(screen), settings)?;
    let eye = Vec3::new(0.5, 1.5, 0.0);
    renderer.set_camera(&Camera::look("grey wall", eye, eye + Vec3::X, 40.0));
    settle(&mut renderer)?;
    Ok(renderer)
}

fn cells(gpu: &Gpu) -> Result<(), Failed> {
    for gi in [GiMethod::Propagation, GiMethod::Gather] {
        let opacities = |screen| -> Result<Vec<f32>, Failed> {
            let renderer = behind(gpu, gi, screen)?;
            let grid = *renderer.volume().grid();
            let read = renderer.volume().read_back(gpu)?;
            let normals = read.channel(NORMAL).ok_or("no normals")?;
            let edge = 1.5 * grid.cell_size;
            let is_across = |p: Vec3| {
                (p.x - 0.1).abs() < 0.5 * grid.cell_size
                    && p.y > edge
                    && p.y < ROOM.y - edge
                    && p.z.abs() < 0.5 * ROOM.z - edge
            };
            let across = grid.cells().filter(|&c| is_across(grid.center(c)));
            Ok(across.map(|c| normals[grid.index(c)].w).collect())
        };
        for (screen, least, most) in [
            (Screen::None, 0.0, 0.0),
            // Five squares across a cell, of which one more or less may be cut out, and the filter's blur.
            (Screen::Mask(64), 0.4, 0.6),
            (Screen::Veil(0.7), 0.699, 0.701),
            // Below the cutoff a veil is not drawn, and not there.
            (Screen::Veil(0.3), 0.0, 0.0),
            (Screen::Solid, 1.0, 1.0),
        ] {
            let found = opacities(screen)?;
            let (low, high) = found.iter().fold((f32::MAX, 0f32), |(l, h), v| (l.min(*v), h.max(*v)));
            let mean = found.iter().sum::<f32>() / found.len() as f32;
            eprintln!(
                "{gi:?}, {screen:?}: {low:.3} to {high:.3}, {mean:.4} on average, {} cells",
                found.len()
            );
            assert!(found.len() > 40 && low >= least && high <= most, "{screen:?}: {low} to {high}");
            if let Screen::Mask(_) = screen {
                assert!((mean - 0.5).abs() < 0.01, "{mean} on average");
            }
        }
    }
    Ok(())
}

/// A little less than its part comes through, since slanted light crosses more than one cell, or sub-cell, of the screen.
fn screens(gpu: &Gpu, gi: GiMethod) -> Result<(), Failed> {
    let light = |screen| -> Result<f32, Failed> {
        let picture = behind(gpu, gi, screen)?.read_picture()?;
        Ok(picture.iter().map(|p| p.y).sum::<f32>() / picture.len() as f32)
    };
    let open = light(Screen::None)?;
    let part = |screen| -> Result<f32, Failed> { Ok(light(screen)? / open) };
    let (fine, coarse) = (part(Screen::Mask(64))?, part(Screen::Mask(4))?);
    let (veil, solid) = (part(Screen::Veil(0.7))?, part(Screen::Solid)?);
    eprintln!(
        "{gi:?}: {open:.4} without a screen; of that {fine:.3} through fine and {coarse:.3} through coarse holes, {veil:.3} through a veil, {solid:.5} through a wall"
    );
    assert!(open > 0.01, "it is dark: {open}");
    assert!(solid.abs() < 1e-4, "{solid} through a wall");
    assert!(
        (fine - 0.5).abs() < 0.08 && (coarse - 0.5).abs() < 0.08,
        "{fine}, {coarse} through a half-open screen"
    );
    assert!((veil - 0.3).abs() < 0.08, "{veil} through a veil");
    Ok(())
}
