//! The frame: what is rendered, in which order, from what into what.

use glam::{UVec2, Vec3};
use lumivox::VolumeBuffer;
use lumivox::core::{Bounds, Grid, GridError, View};
use lumivox::gpu::{Gpu, GpuError, StageTime, StageTimer, Texture, Uniform};
use lumivox::light::{IndirectLight, LightSettings};
use lumivox::progressive::{CHANNELS, DirectLight, InjectionScale, Progressive};
use lumivox::volume::{ALBEDO, EMISSION, NORMAL};
use lumivox_scene::{Camera, Light, Scene};

use crate::composite::{CompositePass, Layer};
use crate::direct::DirectPass;
use crate::gpu_scene::GpuScene;
use crate::lights::{self, LightUniform};
use crate::surface::{HDR_FORMAT, SurfacePass, SurfaceView};
use crate::triangles;
use crate::voxel_view::VoxelView;

/// Why a scene cannot be rendered.
#[derive(Debug, thiserror::Error)]
pub enum RendererError {
    /// The graphics device.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The volume.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// Nothing to see.
    #[error("the scene has no triangles to render")]
    EmptyScene,
}

/// Where the volume comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoxelSource {
    /// All triangles of the scene, once; then views add what they see.
    Triangles,
    /// Views alone, kept from frame to frame.
    Progressive,
    /// Views alone, from nothing in every frame.
    SingleFrame,
}

/// How indirect light is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GiMethod {
    /// Not at all.
    Off,
    /// Iterative propagation through the volume.
    Propagation,
}

/// What is rendered, and how well.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Width and height of the picture.
    pub size: UVec2,
    /// Cells along the longest side of the scene. More resolve finer shadows of indirect light; memory grows with the cube,
    /// and light needs more iterations to cross a room.
    pub grid: u32,
    /// Where the volume comes from.
    pub voxels: VoxelSource,
    /// How indirect light is found.
    pub gi: GiMethod,
    /// Propagation steps in every frame.
    pub iterations: u32,
    /// How light propagates; its sky is the scene's.
    pub light: LightSettings,
    /// Texels a side of a directional or spot light's reflective shadow map; a point light's six have half as many.
    pub rsm_size: u32,
    /// Injection points a side of a light's view. The camera injects every pixel up to this many a side.
    pub points: u32,
    /// What the picture shows.
    pub layer: Layer,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            size: UVec2::new(960, 540),
            grid: 64,
            voxels: VoxelSource::Progressive,
            gi: GiMethod::Propagation,
            iterations: 64,
            light: LightSettings::default(),
            rsm_size: 1024,
            points: 512,
            layer: Layer::Final,
        }
    }
}

/// What a frame did.
#[derive(Clone, Debug, Default)]
pub struct FrameStats {
    /// Milliseconds per stage, when measured.
    pub stages: Vec<StageTime>,
}

/// A light with its views.
#[derive(Debug)]
struct LightSource {
    uniform: Uniform<LightUniform>,
    views: Vec<SurfaceView>,
}

/// A scene, its lights, its volume and a camera.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    settings: Settings,
    bounds: Bounds,
    scale: InjectionScale,
    scene: GpuScene,
    camera: SurfaceView,
    lights: Vec<LightSource>,
    sky: Vec3,
    gbuffer_pass: SurfacePass,
    rsm_pass: SurfacePass,
    direct_pass: DirectPass,
    composite_pass: CompositePass,
    voxel_view: VoxelView,
    volume: VolumeBuffer,
    progressive: Progressive,
    direct_light: DirectLight,
    indirect: IndirectLight,
    irradiance: Texture,
    picture: Texture,
}

impl Renderer {
    /// Uploads a scene and makes everything that frames need.
    ///
    /// # Errors
    /// An empty scene, a grid that does not fit the device (with the numbers and the largest that would), or the device's.
    pub fn new(gpu: &Gpu, scene: &Scene, settings: Settings) -> Result<Self, RendererError> {
        let bounds = scene.bounds();
        if scene.triangle_count() == 0 || bounds.is_empty() {
            return Err(RendererError::EmptyScene);
        }
        let grid = Grid::fit_with_margin(&bounds, settings.grid)?;
        let mut volume = VolumeBuffer::new(gpu, grid, &CHANNELS)?;
        let progressive = Progressive::new(gpu, &volume)?;
        let direct_light = Progressive::direct_light(gpu, &volume)?;
        let indirect = IndirectLight::new(gpu, &volume)?;
        indirect.update(gpu, &LightSettings { sky: scene.sky, ..settings.light });
        if settings.voxels == VoxelSource::Triangles && needs_volume(&settings) {
            let made = triangles::voxelize(scene, &grid);
            volume.upload(gpu, NORMAL, &made.normal)?;
            volume.upload(gpu, ALBEDO, &made.albedo)?;
            volume.upload(gpu, EMISSION, &made.emission)?;
        }

        let (gpu_scene, textures) = GpuScene::new(gpu, scene)?;
        let camera = camera_target(gpu, &settings)?;
        let lights: Vec<_> = scene
            .lights
            .iter()
            .map(|light| light_source(gpu, light, &bounds, &settings))
            .collect::<Result<Vec<_>, GpuError>>()?
            .into_iter()
            .flatten()
            .collect();
        let composite_pass = CompositePass::new(gpu);
        composite_pass.update(gpu, settings.layer, scene.sky);
        let renderer = Self {
            gpu: gpu.clone(),
            settings,
            bounds,
            scale: injection_scale(scene, &bounds, &camera, &lights),
            gbuffer_pass: SurfacePass::gbuffer(gpu, &gpu_scene, &textures)?,
            rsm_pass: SurfacePass::rsm(gpu, &gpu_scene, &textures)?,
            scene: gpu_scene,
            camera,
            lights,
            sky: scene.sky,
            direct_pass: DirectPass::new(gpu),
            composite_pass,
            voxel_view: VoxelView::new(gpu),
            volume,
            progressive,
            direct_light,
            indirect,
            irradiance: Texture::target(gpu, "render/irradiance", settings.size.to_array(), HDR_FORMAT)?,
            picture: Texture::target(gpu, "render/picture", settings.size.to_array(), HDR_FORMAT)?,
        };
        gpu.wait()?;
        Ok(renderer)
    }

    /// Moves the camera, from the next frame on.
    pub fn set_camera(&mut self, camera: &Camera) {
        let aspect = self.settings.size.x as f32 / self.settings.size.y.max(1) as f32;
        let reach = self.bounds.size().length();
        let far = self.bounds.corners().iter().map(|c| c.distance(camera.eye)).fold(0.0, f32::max);
        let planes = (5e-4 * reach, 1.01 * far.max(2e-3 * reach));
        self.camera.view =
            View::perspective(camera.eye, camera.target, camera.up, camera.fov_y, aspect, planes.0, planes.1)
                .with_reversed_depth();
    }

    /// Moves and changes the lights, as many and of the same kinds as before, from the next frame on.
    pub fn set_lights(&mut self, lights: &[Light]) {
        let placed = lights.iter().filter_map(|l| Some((l, lights::light_uniform(l)?)));
        for (source, (light, value)) in self.lights.iter().zip(placed) {
            source.uniform.write(&self.gpu, &value);
            debug_assert_eq!(source.views.len(), lights::light_views(light, &self.bounds).len());
        }
        let views = lights.iter().flat_map(|l| lights::light_views(l, &self.bounds));
        for (target, view) in self.lights.iter_mut().flat_map(|s| &mut s.views).zip(views) {
            target.view = view;
        }
    }

    /// Chooses what the picture shows, from the next frame on.
    pub fn set_layer(&mut self, layer: Layer) {
        self.settings.layer = layer;
        self.composite_pass.update(&self.gpu, layer, self.sky);
    }

    /// One frame. With a clock (milliseconds since any moment) every stage is submitted alone and timed.
    pub fn frame(&mut self, clock: Option<fn() -> f64>) -> Result<FrameStats, RendererError> {
        let Self { gpu, settings, scene, camera, lights, volume, progressive, indirect, .. } = self;
        let gpu = &*gpu;
        let mut timer = StageTimer::new(gpu, clock);

        camera.update(gpu, self.scale);
        lights.iter().flat_map(|l| &l.views).for_each(|v| v.update(gpu, self.scale));

        // What the camera and the lights see.
        timer.stage(gpu, "raster/gbuffer", |e| self.gbuffer_pass.record(gpu, e, scene, None, camera))?;
        timer.stage(gpu, "raster/rsm", |e| {
            lights.iter_mut().try_for_each(|light| {
                let LightSource { uniform, views } = light;
                views.iter_mut().try_for_each(|v| self.rsm_pass.record(gpu, e, scene, Some(uniform), v))
            })
        })?;
        timer.stage(gpu, "raster/direct", |e| {
            let views = lights.iter().flat_map(|l| l.views.iter().map(|v| (&l.uniform, v)));
            camera.record_clear_radiance(e);
            views.into_iter().try_for_each(|(light, v)| self.direct_pass.record(gpu, e, light, v, camera))
        })?;

        if needs_volume(settings) {
            // Views to volume.
            timer.stage(gpu, "progressive/cleanup", |e| match settings.voxels {
                VoxelSource::Triangles => Ok(()),
                VoxelSource::SingleFrame => {
                    volume.record_clear(e);
                    Ok(())
                }
                VoxelSource::Progressive => {
                    let views = lights.iter().flat_map(|l| &l.views).chain([&*camera]);
                    views.into_iter().try_for_each(|v| progressive.record_cleanup(gpu, e, &v.input, volume))
                }
            })?;
            timer.stage(gpu, "progressive/injection", |e| {
                progressive.record_begin(e, &mut self.direct_light);
                for light in lights.iter() {
                    let views = light.views.iter().map(|v| &v.input);
                    progressive.record_light(gpu, e, views, volume, &mut self.direct_light)?;
                }
                progressive.record_camera(gpu, e, &camera.input, volume, &mut self.direct_light)?;
                progressive.record_end(gpu, e, &camera.input, volume)
            })?;

            // Volume to light.
            timer.stage(gpu, "light/transport", |e| indirect.record_transport(gpu, e, volume))?;
            timer.stage(gpu, "light/seed", |e| indirect.record_seed(gpu, e, volume, &self.direct_light))?;
            timer.stage(gpu, "light/propagation", |e| {
                indirect.record_propagation(gpu, e, volume, propagation_steps(settings))
            })?;
        }
        let mut stats = FrameStats { stages: timer.finish(gpu)? };
        stats.stages.extend(self.compose(clock)?.stages);
        Ok(stats)
    }

    /// Goes on propagating the light of the last frame, `iterations` steps more, and makes the picture anew.
    pub fn settle(
        &mut self,
        iterations: u32,
        clock: Option<fn() -> f64>,
    ) -> Result<FrameStats, RendererError> {
        let Self { gpu, volume, indirect, .. } = self;
        let mut timer = StageTimer::new(gpu, clock);
        timer.stage(gpu, "light/propagation", |e| indirect.record_propagation(gpu, e, volume, iterations))?;
        let mut stats = FrameStats { stages: timer.finish(gpu)? };
        stats.stages.extend(self.compose(clock)?.stages);
        Ok(stats)
    }

    /// Light to picture.
    fn compose(&mut self, clock: Option<fn() -> f64>) -> Result<FrameStats, RendererError> {
        let Self { gpu, settings, camera, volume, indirect, irradiance, picture, .. } = self;
        let mut timer = StageTimer::new(gpu, clock);
        timer.stage(gpu, "light/reconstruction", |e| {
            indirect.record_reconstruction(gpu, e, volume, &camera.input, irradiance)
        })?;
        timer.stage(gpu, "composite", |e| match settings.layer {
            Layer::Voxels => self.voxel_view.record(gpu, e, camera, (volume, &self.direct_light), picture),
            _ => self.composite_pass.record(gpu, e, camera, irradiance, picture),
        })?;
        Ok(FrameStats { stages: timer.finish(gpu)? })
    }

    /// Makes a picture of the volume as the last frame left it, from any camera, without the cells above a height.
    pub fn show_voxels(&mut self, camera: &Camera, cut_height: f32) -> Result<(), RendererError> {
        self.set_camera(camera);
        let Self { gpu, camera, volume, picture, .. } = self;
        self.voxel_view.cut(gpu, cut_height);
        camera.update(gpu, self.scale);
        let mut timer = StageTimer::new(gpu, None);
        timer.stage(gpu, "debug/voxels", |e| {
            self.voxel_view.record(gpu, e, camera, (volume, &self.direct_light), picture)
        })?;
        timer.finish(gpu)?;
        self.voxel_view.cut(gpu, f32::MAX);
        Ok(())
    }

    /// Flux still under way in the volume; see [`IndirectLight::flux_under_way`].
    pub fn flux_under_way(&self) -> Result<f64, RendererError> {
        Ok(self.indirect.flux_under_way(&self.gpu)?)
    }

    /// The picture, linear radiance, row 0 on top. Waits.
    pub fn read_picture(&self) -> Result<Vec<Vec3>, RendererError> {
        let texels: Vec<[half::f16; 4]> = lumivox::gpu::read_texture(&self.gpu, &self.picture)?;
        Ok(texels.iter().map(|t| Vec3::new(t[0].to_f32(), t[1].to_f32(), t[2].to_f32())).collect())
    }

    /// The volume.
    pub fn volume(&self) -> &VolumeBuffer {
        &self.volume
    }

    /// The direct light of the volume's cells.
    pub fn direct_light(&self) -> &DirectLight {
        &self.direct_light
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }
}

fn needs_volume(settings: &Settings) -> bool {
    settings.gi != GiMethod::Off || settings.layer == Layer::Voxels
}

fn propagation_steps(settings: &Settings) -> u32 {
    if settings.gi == GiMethod::Off { 0 } else { settings.iterations }
}

fn camera_target(gpu: &Gpu, settings: &Settings) -> Result<SurfaceView, GpuError> {
    let view = View::perspective(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0, 1.0, 0.1, 1.0).with_reversed_depth();
    SurfaceView::new(gpu, "camera", settings.size, UVec2::splat(settings.points), view)
}

/// The targets of a light's views; none for lights without a reflective shadow map.
fn light_source(
    gpu: &Gpu,
    light: &Light,
    bounds: &Bounds,
    settings: &Settings,
) -> Result<Option<LightSource>, GpuError> {
    let Some(uniform) = lights::light_uniform(light) else { return Ok(None) };
    let views = lights::light_views(light, bounds);
    let share = if views.len() > 1 { 2 } else { 1 };
    let (size, points) = (UVec2::splat(settings.rsm_size / share), UVec2::splat(settings.points / share));
    let targets = views.into_iter().map(|v| SurfaceView::new(gpu, "rsm", size, points, v));
    Ok(Some(LightSource {
        uniform: Uniform::new(gpu, "render/light", &uniform),
        views: targets.collect::<Result<_, _>>()?,
    }))
}

fn injection_scale(
    scene: &Scene,
    bounds: &Bounds,
    camera: &SurfaceView,
    lights: &[LightSource],
) -> InjectionScale {
    let points_of = |views: &[SurfaceView]| views.iter().map(|v| v.input.point_count()).sum::<u32>();
    let camera_points = camera.input.point_count();
    let light_points = lights.iter().map(|l| points_of(&l.views));
    let reflected: f32 = scene.lights.iter().map(|l| lights::radiance_bound(l, bounds)).sum();
    let emitted = scene.materials.iter().map(|m| m.emission.max_element()).fold(0.0, f32::max);
    InjectionScale {
        attribute_points: light_points.clone().sum::<u32>() + camera_points,
        light_points: light_points.fold(camera_points, u32::max),
        radiance_max: reflected.max(emitted).max(1e-3),
    }
}
