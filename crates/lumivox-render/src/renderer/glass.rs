//! Glass of a scene: drawn over the finished picture of all that is opaque ([`lumivox::refraction`]).
//!
//! A picture has four kinds of glass at most; a kind is a material, those of its meshes that are not closed are another, which is thin, and so are
//! instances of another size, which bend otherwise ([`Kinds`]).
//! Glass throws no shadow, and indirect light goes through it as if it were not there.

use std::f32::consts::{PI, TAU};

use glam::{DVec3, Mat4, UVec2, Vec3};
use lumivox::core::{Bounds, TriangleView, View, open_edges};
use lumivox::gpu::{Buffer, Gpu, GpuError, StageTimer, Texture};
use lumivox::progressive::ViewInput;
use lumivox::refraction::{
    Backdrop, Evaluation, Glass, PICTURE_FORMAT, Pyramid, Refraction, RefractionSettings,
};
use lumivox::voxelize::{IndexView, Mesh, MeshDescriptor, VertexView};
use lumivox::wgpu::{IndexFormat, VertexFormat};
use lumivox_scene::{Pose, Scene};

use super::RendererError;
use super::glass_kinds::{Found, GlassKind, GlassNote, Kinds, described};

/// What lies around, for rays that leave the picture and for what glass mirrors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Environment {
    /// The scene's sky; black without one.
    #[default]
    Sky,
    /// A made one of mean radiance 1: bright above, dark below, and two lamps.
    Studio,
}

/// How glass is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlassSettings {
    /// Slices of a column.
    pub slices: u32,
    /// How inner cells are counted.
    pub evaluation: Evaluation,
    /// Whether glass looks at the picture behind it, or at the environment alone, as in the paper.
    pub uses_picture: bool,
    /// What lies around.
    pub environment: Environment,
}

impl Default for GlassSettings {
    fn default() -> Self {
        Self {
            slices: 32,
            evaluation: Evaluation::Bits,
            uses_picture: true,
            environment: Environment::default(),
        }
    }
}

/// All glass of a scene.
#[derive(Debug)]
pub(super) struct GlassObjects {
    kinds: Vec<GlassKind>,
    notes: Vec<GlassNote>,
    meshes: Vec<Placed>,
    shapes: Vec<Shape>,
    refraction: Refraction,
    environment: Pyramid,
    target: Texture,
}

#[derive(Debug)]
struct Placed {
    instance: usize,
    kind: u32,
    mesh: Mesh,
}

/// A mesh of the scene in buffers of its own.
#[derive(Debug)]
struct Shape {
    /// Its number in the scene.
    number: usize,
    open_edges: usize,
    /// Metres of its own space.
    size: Vec3,
    /// Whether its faces look inward, and are turned round here.
    is_turned: bool,
    /// Whether its normals are turned round here.
    turns_normals: bool,
    positions: Buffer,
    normals: Buffer,
    indices: Buffer,
}

impl Shape {
    fn new(gpu: &Gpu, scene: &Scene, number: usize) -> Result<Self, GpuError> {
        let mesh = &scene.meshes[number];
        let view = TriangleView { positions: &mesh.positions, indices: &mesh.indices };
        let open_edges = open_edges(&view);
        let (volume, along) = orientation(mesh);
        let is_turned = open_edges == 0 && volume < 0.0;
        let turns_normals = if is_turned { along > 0.0 } else { along < 0.0 };
        let turn = |[a, b, c]: [u32; 3]| if is_turned { [a, c, b] } else { [a, b, c] };
        let indices: Vec<[u32; 3]> = mesh.indices.iter().map(|t| turn(*t)).collect();
        let shape = Self {
            number,
            open_edges,
            size: Bounds::of_points(view.iter().flatten()).size(),
            is_turned,
            turns_normals,
            positions: Buffer::storage_with(gpu, "glass/positions", &mesh.positions)?,
            normals: Buffer::storage_with(gpu, "glass/normals", &mesh.normals)?,
            indices: Buffer::storage_with(gpu, "glass/indices", &indices)?,
        };
        if turns_normals {
            shape.write_normals(gpu, &mesh.normals);
        }
        Ok(shape)
    }

    fn write_normals(&self, gpu: &Gpu, normals: &[[f32; 3]]) {
        let sign = if self.turns_normals { -1.0 } else { 1.0 };
        let normals: Vec<[f32; 3]> = normals.iter().map(|n| n.map(|c| sign * c)).collect();
        gpu.queue.write_buffer(&self.normals.raw, 0, bytemuck::cast_slice(&normals));
    }

    /// How thick an instance of it is at most: its smallest extent.
    fn extent(&self, world_from_local: &Mat4) -> f32 {
        let m = world_from_local;
        let scale = [m.x_axis, m.y_axis, m.z_axis].map(|axis| axis.truncate().length());
        (self.size * Vec3::from(scale)).min_element()
    }

    fn mesh(&self, gpu: &Gpu, scene: &Scene, world_from_local: Mat4) -> Result<Mesh, RendererError> {
        let whole = &scene.meshes[self.number];
        fn vertices(buffer: &Buffer) -> VertexView<'_> {
            VertexView { buffer: &buffer.raw, offset: 0, stride: 12, format: VertexFormat::Float32x3 }
        }
        let descriptor = MeshDescriptor {
            indices: Some(IndexView {
                buffer: &self.indices.raw,
                offset: 0,
                format: IndexFormat::Uint32,
                count: 3 * whole.indices.len() as u32,
            }),
            normals: Some(vertices(&self.normals)),
            world_from_local,
            ..MeshDescriptor::new(vertices(&self.positions), whole.positions.len() as u32)
        };
        Ok(Mesh::new(gpu, &descriptor)?)
    }
}

/// Six times the volume that a closed mesh's faces look out of, negative if they look into it; and whether its normals look the same way as
/// its faces, in the mean over its area.
fn orientation(mesh: &lumivox_scene::Mesh) -> (f64, f64) {
    let point = |i: u32| DVec3::from(mesh.positions[i as usize].map(f64::from));
    let normal = |i: u32| DVec3::from(mesh.normals[i as usize].map(f64::from));
    let Some(origin) = mesh.indices.first().map(|t| point(t[0])) else { return (0.0, 0.0) };
    mesh.indices.iter().fold((0.0, 0.0), |(volume, along), t| {
        let [a, b, c] = t.map(|i| point(i) - origin);
        let face = (b - a).cross(c - a);
        let mean: DVec3 = t.iter().map(|i| normal(*i)).sum();
        (volume + a.dot(b.cross(c)), along + face.dot(mean))
    })
}

impl GlassObjects {
    /// None where the scene has no glass.
    pub(super) fn new(
        gpu: &Gpu,
        scene: &Scene,
        size: UVec2,
        settings: GlassSettings,
    ) -> Result<Option<Self>, RendererError> {
        let (mut shapes, mut placed, mut found) = (Vec::<Shape>::new(), Vec::new(), Vec::new());
        for (number, instance) in scene.instances.iter().enumerate() {
            let mesh = &scene.meshes[instance.mesh];
            let material = &scene.materials[mesh.material];
            let Some(glass) = &material.glass else { continue };
            if mesh.indices.is_empty() {
                continue;
            }
            let shape = match shapes.iter().position(|s| s.number == instance.mesh) {
                Some(shape) => shape,
                None => {
                    shapes.push(Shape::new(gpu, scene, instance.mesh)?);
                    shapes.len() - 1
                }
            };
            let Shape { open_edges, is_turned, .. } = shapes[shape];
            let extent = shapes[shape].extent(&instance.world_from_local);
            let glass_here = described(glass, material.base_color.truncate(), extent, open_edges > 0);
            found.push(Found {
                mesh: instance.mesh,
                is_turned,
                is_pane: glass.is_thin,
                kind: GlassKind { material: mesh.material, open_edges, glass: glass_here },
            });
            placed.push((number, shapes[shape].mesh(gpu, scene, instance.world_from_local)?));
        }
        let Kinds { kinds, numbers, notes } = Kinds::new(&found);
        let meshes: Vec<Placed> = placed
            .into_iter()
            .zip(numbers)
            .map(|((instance, mesh), kind)| Placed { instance, kind, mesh })
            .collect();
        if meshes.is_empty() {
            return Ok(None);
        }
        let refraction = RefractionSettings {
            slices: settings.slices,
            kinds: kinds.len() as u32,
            evaluation: settings.evaluation,
            uses_picture: settings.uses_picture,
            reversed_depth: true,
            ..RefractionSettings::new(size)
        };
        let refraction = Refraction::new(gpu, refraction)?;
        let environment = environment(gpu, scene, settings.environment)?;
        let target = Texture::target(gpu, "render/glass", size.to_array(), PICTURE_FORMAT)?;
        let mut objects = Self { kinds, notes, meshes, shapes, refraction, environment, target };
        objects.write(gpu);
        Ok(Some(objects))
    }

    fn write(&mut self, gpu: &Gpu) {
        let kinds: Vec<Glass> = self.kinds.iter().map(|kind| kind.glass).collect();
        self.refraction.set_glass(gpu, &kinds);
    }

    pub(super) fn kinds(&self) -> &[GlassKind] {
        &self.kinds
    }

    pub(super) fn notes(&self) -> &[GlassNote] {
        &self.notes
    }

    /// Changes a kind.
    pub(super) fn set_glass(&mut self, gpu: &Gpu, kind: usize, glass: Glass) {
        if let Some(kind) = self.kinds.get_mut(kind) {
            kind.glass = glass;
        }
        self.write(gpu);
    }

    /// Moves it.
    pub(super) fn set_pose(&mut self, gpu: &Gpu, pose: &Pose) {
        for Placed { instance, mesh, .. } in &mut self.meshes {
            if let Some(place) = pose.world_from_local.get(*instance) {
                mesh.set_transform(gpu, place);
            }
        }
        for moved in &pose.deformed {
            let Some(shape) = self.shapes.iter().find(|s| s.number == moved.mesh) else { continue };
            gpu.queue.write_buffer(&shape.positions.raw, 0, bytemuck::cast_slice(&moved.positions));
            shape.write_normals(gpu, &moved.normals);
        }
    }

    /// Says where the camera stands. Once a frame.
    pub(super) fn update(&mut self, gpu: &Gpu, view: &View, bounds: &Bounds) {
        let distance = |p: Vec3| -view.eye_from_world.transform_point3(p).z;
        let far = bounds.corners().map(distance).into_iter().fold(0.0, f32::max);
        self.refraction.set_view(gpu, view, [0.0, 1.01 * far.max(1e-3)]);
    }

    /// Draws it over a picture.
    pub(super) fn record(
        &mut self,
        gpu: &Gpu,
        timer: &mut StageTimer,
        camera: &ViewInput,
        picture: &mut Texture,
    ) -> Result<(), GpuError> {
        let Self { meshes, refraction, environment, target, .. } = self;
        let meshes: Vec<(&Mesh, u32)> = meshes.iter().map(|placed| (&placed.mesh, placed.kind)).collect();
        let backdrop = Backdrop { uniform: &camera.uniform, depth: &camera.textures.depth, picture };
        timer.stage(gpu, "refraction/glass", |e| {
            refraction.record(gpu, e, &meshes, &backdrop, environment, target)
        })?;
        std::mem::swap(picture, target);
        Ok(())
    }

    /// Metres of glass at each pixel. Waits.
    pub(super) fn thickness(&self, gpu: &Gpu) -> Result<Vec<f32>, GpuError> {
        Ok(self.refraction.thickness().read(gpu)?.into_iter().map(|kinds| kinds.iter().sum()).collect())
    }
}

/// All directions around, in as few pixels as do.
fn environment(gpu: &Gpu, scene: &Scene, environment: Environment) -> Result<Pyramid, GpuError> {
    let is_plain = environment == Environment::Sky && scene.sky_map.is_none();
    let size = if is_plain { UVec2::new(4, 2) } else { UVec2::new(512, 256) };
    let way = |n: u32| {
        let place = (UVec2::new(n % size.x, n / size.x).as_vec2() + 0.5) / size.as_vec2();
        let (sin, cos) = (TAU * (place.x - 0.5)).sin_cos();
        let up = PI * (0.5 - place.y);
        Vec3::new(sin * up.cos(), up.sin(), -cos * up.cos())
    };
    let radiance = |d: Vec3| match environment {
        Environment::Sky => scene.sky_radiance(d),
        Environment::Studio => studio(d),
    };
    let pixels: Vec<Vec3> = (0..size.element_product()).map(|n| radiance(way(n))).collect();
    Pyramid::environment(gpu, size, &pixels)
}

/// A room to show glass in.
fn studio(d: Vec3) -> Vec3 {
    let ground = Vec3::new(0.25, 0.23, 0.21);
    let wall = Vec3::new(0.9, 0.95, 1.0);
    let above = d.y.clamp(-1.0, 1.0);
    let base = if above < 0.0 {
        ground.lerp(wall, (1.0 + 4.0 * above).max(0.0))
    } else {
        wall * (1.0 + 0.5 * above)
    };
    let lamp = |way: Vec3, reach: f32| ((d.dot(way.normalize_or_zero()) - reach) * 40.0).clamp(0.0, 1.0);
    base + 6.0 * lamp(Vec3::new(0.6, 0.7, 0.5), 0.93) * Vec3::new(1.0, 0.95, 0.85)
        + 3.0 * lamp(Vec3::new(-0.8, 0.4, 0.3), 0.96) * Vec3::new(0.8, 0.9, 1.0)
}
