//! Scenes made of quads, and the settings of small pictures.

use glam::{Mat4, UVec2, Vec3};
use libtest_mimic::Failed;
use lumivox::gpu::Gpu;
use lumivox::volume::NORMAL;
use lumivox_render::{GiMethod, Renderer, RendererError, Settings, VoxelSource};
use lumivox_scene::{Camera, Instance, Material, Mesh, Scene};

/// A parallelogram `corner + s u + t v`; its front is where `u x v` points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Quad {
    pub(crate) corner: Vec3,
    pub(crate) u: Vec3,
    pub(crate) v: Vec3,
}

impl Quad {
    /// A horizontal square about a point, facing up; its `uv` runs with x and with -z.
    pub(crate) fn level(middle: Vec3, side: f32) -> Self {
        let half = 0.5 * side;
        Self { corner: middle + Vec3::new(-half, 0.0, half), u: side * Vec3::X, v: -side * Vec3::Z }
    }

    /// An upright rectangle about a point, facing +z; its `uv` runs with x and with y.
    pub(crate) fn upright(middle: Vec3, width: f32, height: f32) -> Self {
        let corner = middle - Vec3::new(0.5 * width, 0.5 * height, 0.0);
        Self { corner, u: width * Vec3::X, v: height * Vec3::Y }
    }

    pub(crate) fn normal(&self) -> Vec3 {
        self.u.cross(self.v).normalize_or_zero()
    }
}

/// Adds quads of a material. Texture rows count from the top, so that `v` of the quad runs upwards in the texture.
pub(crate) fn add(scene: &mut Scene, material: Material, quads: &[Quad]) {
    scene.materials.push(material);
    for quad in quads {
        let corners =
            [quad.corner, quad.corner + quad.u, quad.corner + quad.u + quad.v, quad.corner + quad.v];
        let mesh = scene.meshes.len();
        scene.meshes.push(Mesh {
            name: "quad".to_owned(),
            positions: corners.map(|p| p.to_array()).to_vec(),
            normals: vec![quad.normal().to_array(); 4],
            uvs: vec![[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]],
            colors: vec![[1.0; 4]; 4],
            indices: vec![[0, 1, 2], [0, 2, 3]],
            material: scene.materials.len() - 1,
        });
        scene.instances.push(Instance { mesh, world_from_local: Mat4::IDENTITY });
    }
}

/// The six faces of a box, facing outwards.
pub(crate) fn block(low: Vec3, high: Vec3) -> Vec<Quad> {
    let size = high - low;
    let (x, y, z) = (size.x * Vec3::X, size.y * Vec3::Y, size.z * Vec3::Z);
    [(low, y, x), (low + z, x, y), (low, z, y), (low + x, y, z), (low, x, z), (low + y, z, x)]
        .map(|(corner, u, v)| Quad { corner, u, v })
        .to_vec()
}

/// Small and quick.
pub(crate) fn small() -> Settings {
    Settings {
        size: UVec2::splat(96),
        grid: 24,
        voxels: VoxelSource::Progressive,
        gi: GiMethod::Off,
        iterations: 0,
        points: 256,
        ..Settings::default()
    }
}

/// One frame of a scene.
pub(crate) fn picture(
    gpu: &Gpu,
    scene: &Scene,
    camera: &Camera,
    settings: Settings,
) -> Result<Vec<Vec3>, Failed> {
    let mut renderer = Renderer::new(gpu, scene, settings)?;
    renderer.set_camera(camera);
    renderer.frame(None)?;
    Ok(renderer.read_picture()?)
}

/// A frame, and as many steps as it takes until next to no light is under way, or until gathered light grows no more.
pub(crate) fn settle(renderer: &mut Renderer) -> Result<(), RendererError> {
    renderer.frame(None)?;
    let sent = renderer.light_in_volume()?;
    let gathers = renderer.settings().gi == GiMethod::Gather;
    let mut before = sent;
    for _ in 0..100 {
        renderer.settle(if gathers { 8 } else { 64 }, None)?;
        let now = renderer.light_in_volume()?;
        if (gathers && now - before <= 1e-4 * now) || now <= 1e-3 * sent {
            break;
        }
        before = now;
    }
    Ok(())
}

/// Which cells are occupied.
pub(crate) fn occupied(gpu: &Gpu, renderer: &Renderer) -> Result<Vec<bool>, Failed> {
    let volume = renderer.volume().read_back(gpu)?;
    Ok(volume.channel(NORMAL).unwrap_or_default().iter().map(|n| n.w > 0.0).collect())
}

/// Radiosity that leaves each cell, summed over the colours.
pub(crate) fn radiosities(gpu: &Gpu, renderer: &Renderer) -> Result<Vec<f32>, Failed> {
    let cells = renderer.direct_light().read_back(gpu)?;
    Ok(cells.iter().map(|bands| bands.iter().map(|&b| lumivox::core::sh::integral(b)).sum()).collect())
}

/// A camera that sees nothing but the sky above the scene.
pub(crate) fn skyward() -> Camera {
    Camera {
        name: "sky".to_owned(),
        eye: Vec3::new(0.0, 50.0, 0.0),
        target: Vec3::new(0.0, 60.0, 0.0),
        up: Vec3::X,
        fov_y: 0.8,
    }
}
