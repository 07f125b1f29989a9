//! The frame: what is rendered, in which order, from what into what.

mod absorbers;
mod expected;
mod field_objects;
mod frame;
mod glass;
mod glass_kinds;
mod hit_light;
mod indirect;
mod injected_lights;
mod leaf_shadows;
mod pictures;
mod see_through;
mod settings;
mod shadowed_lights;
mod standing;
mod view_voxelizer;
mod volume_shadows;

use glam::{Mat4, UVec2, Vec3};
use lumivox::VolumeBuffer;
use lumivox::core::{Bounds, Grid, GridError, View};
use lumivox::gather::LightBudget;
use lumivox::gpu::{Gpu, GpuError, StageTime, StageTimer, Texture};
use lumivox::progressive::{CHANNELS, DirectLight, InjectionScale, Progressive};
use lumivox::voxelize::VoxelizeError;
use lumivox_scene::{Camera, Light, Pose, Scene};

use crate::composite::{CompositePass, Layer, Mirror};
use crate::direct::DirectPass;
use crate::gpu_scene::GpuScene;
use crate::lights::{self, LightSample, Sky};
use crate::lobes::Lobes;
use crate::shadow::ShadowPass;
use crate::surface::{self, HDR_FORMAT, RADIANCE_FORMAT, SurfacePass, SurfaceView};
use crate::triangle_voxelizer::TriangleVoxelizer;
use crate::voxel_view::{VoxelChannel, VoxelView};
use expected::Expected;
use field_objects::FieldObjects;
use glass::GlassObjects;
use indirect::Indirect;
use injected_lights::{FULL_SAMPLES, InjectedLights};
use leaf_shadows::LeafShadows;
use standing::Standing;
use view_voxelizer::ViewVoxelizer;
use volume_shadows::VolumeShadows;

pub(crate) use field_objects::Shade;
pub use field_objects::{Caster, ObjectFields};
pub use glass::{Environment, GlassSettings};
pub use glass_kinds::{GlassIssue, GlassKind, GlassNote};
pub use leaf_shadows::LeafShadowSettings;
pub use settings::{GiMethod, Polish, Settings, VoxelSource};
pub use shadowed_lights::{ShadowBatch, ShadowBatchUniform, ShadowTile, ShadowViewUniform, ShadowedLights};

/// Why a scene cannot be rendered.
#[derive(Debug, thiserror::Error)]
pub enum RendererError {
    /// The graphics device.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The volume.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// The voxelizer of triangles.
    #[error(transparent)]
    Voxelize(#[from] VoxelizeError),
    /// Nothing to see.
    #[error("the scene has no triangles to render")]
    EmptyScene,
}

/// What a frame did.
#[derive(Clone, Debug, Default)]
pub struct FrameStats {
    /// Milliseconds per stage, when measured.
    pub stages: Vec<StageTime>,
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
    objects: Option<FieldObjects>,
    leaves: Option<LeafShadows>,
    volumes: Option<VolumeShadows>,
    glass: Option<GlassObjects>,
    /// Where the scene's instances stand.
    places: Vec<Mat4>,
    lights: Vec<Light>,
    shadowed: ShadowedLights,
    injected: InjectedLights,
    sky: Sky,
    gbuffer_pass: SurfacePass,
    rsm_pass: SurfacePass,
    shadow_pass: ShadowPass,
    direct_pass: DirectPass,
    composite_pass: CompositePass,
    voxel_view: VoxelView,
    /// Made when they are first shown.
    lobes: Option<Lobes>,
    volume: VolumeBuffer,
    voxelizer: ViewVoxelizer,
    /// Where the volume comes from triangles.
    triangles: Option<TriangleVoxelizer>,
    /// Where what stands still comes from them.
    standing: Option<Standing>,
    /// Where what no view has seen is to be shown.
    expected: Option<Expected>,
    direct_light: DirectLight,
    indirect: Indirect,
    budget: Option<LightBudget>,
    over_budget: Option<f64>,
    /// Whether no frame has been made yet.
    fresh: bool,
    /// Frames since then.
    frames: u32,
    /// Whether triangles have changed the volume since its surfels were made.
    surfels_are_stale: bool,
    irradiance: Texture,
    /// What polished surfaces mirror of gathered light.
    mirrored: Option<Texture>,
    spare_radiance: Texture,
    picture: Texture,
}

impl Renderer {
    /// Uploads a scene and makes everything that frames need.
    ///
    /// # Errors
    /// An empty scene, a grid that does not fit the device (with the numbers and the largest that would), or the device's.
    pub fn new(gpu: &Gpu, scene: &Scene, settings: Settings) -> Result<Self, RendererError> {
        Self::with_fields(gpu, scene, settings, &ObjectFields::default())
    }

    /// The same with visibility fields of some of the scene's objects, for [`Settings::occlusion`], [`Settings::soft_shadows`] and
    /// [`Settings::polish`].
    ///
    /// # Errors
    /// As [`Self::new`], and fields that do not fit the device.
    pub fn with_fields(
        gpu: &Gpu,
        scene: &Scene,
        settings: Settings,
        fields: &ObjectFields,
    ) -> Result<Self, RendererError> {
        let bounds = settings.clip.map_or_else(|| scene.bounds(), |clip| scene.bounds_in_motion(clip));
        if scene.triangle_count() == 0 || bounds.is_empty() {
            return Err(RendererError::EmptyScene);
        }
        let glass = settings.glass.map(|glass| GlassObjects::new(gpu, scene, settings.size, glass));
        let glass = glass.transpose()?.flatten();
        let rest = glass.as_ref().and_then(|_| scene.without_glass());
        let scene = rest.as_ref().unwrap_or(scene);
        let grid = Grid::fit_with_margin(&bounds, settings.grid)?;
        let volume = VolumeBuffer::new(gpu, grid, &CHANNELS)?;
        let shows = |channel| settings.layer == Layer::Voxels && settings.voxel_channel == channel;
        let shows_ages = shows(VoxelChannel::Age);
        let voxelizer = ViewVoxelizer::new(gpu, &volume, settings.voxels, settings.rules(), shows_ages)?;
        let direct_light = Progressive::direct_light(gpu, &volume)?;
        let sky = Sky::of(scene);
        let indirect = Indirect::new(gpu, &volume, &settings, &sky)?;
        let panels = lights::panels(&scene.lights);
        let (mut gpu_scene, textures) = GpuScene::new(gpu, scene, &panels, settings.filtered_textures)?;
        let objects = FieldObjects::new(gpu, scene, &settings, fields)?;
        gpu_scene.set_casters(objects.iter().flat_map(FieldObjects::instances));
        let from_triangles = settings.voxels == VoxelSource::Triangles && needs_volume(&settings);
        let triangles = from_triangles.then(|| {
            let (scenes, gathers) = ((scene, &panels), matches!(indirect, Indirect::Gathered(_)));
            TriangleVoxelizer::new(gpu, scenes, (&gpu_scene, &textures), &volume, gathers)
        });
        let triangles = triangles.transpose()?;
        let is_hybrid = settings.voxels == VoxelSource::Hybrid && needs_volume(&settings);
        let standing = is_hybrid.then(|| {
            let (scenes, gathers) = ((scene, &panels), matches!(indirect, Indirect::Gathered(_)));
            Standing::new(gpu, scenes, (&gpu_scene, &textures), (&volume, gathers), settings.clip)
        });
        let standing = standing.transpose()?;
        let expected = shows(VoxelChannel::Unseen)
            .then(|| Expected::new(gpu, (scene, &panels), (&gpu_scene, &textures), &volume))
            .transpose()?;
        let camera = camera_target(gpu, &settings)?;
        let [for_picture, for_volume] = light_samples(&settings, &scene.lights, &sky);
        let uploaded = (&gpu_scene, &textures);
        let leaves = settings
            .leaf_shadows
            .map(|leaf| {
                LeafShadows::new(gpu, [scene, &panels], uploaded, &for_picture, (leaf, settings.size))
            })
            .transpose()?
            .flatten();
        let volumes = settings
            .volume_shadows
            .then(|| VolumeShadows::new(gpu, [scene, &panels], uploaded, &for_picture, (&bounds, &settings)))
            .transpose()?
            .flatten();
        let shade = |source: Option<usize>| match (&objects, &leaves, &volumes, source) {
            (_, Some(leaves), _, Some(light)) if leaves.has(light) => Shade::Leaves(light),
            (_, _, Some(volumes), Some(light)) if volumes.has(light) => Shade::Volumes(light),
            (Some(objects), ..) => objects.shade(source),
            _ => Shade::Maps,
        };
        let injected = InjectedLights::new(gpu, &for_volume, &settings)?;
        let emission = scene.materials.iter().map(|m| m.emission.max_element()).fold(0.0, f32::max);
        let composite_pass = CompositePass::new(gpu, &sky)?;
        composite_pass.update(gpu, settings.layer, mirror(&settings));
        let target = |name: &str| Texture::target(gpu, name, settings.size.to_array(), HDR_FORMAT);
        let mirrors = settings.polish.is_some() && settings.gi == GiMethod::Gather;
        let mut renderer = Self {
            gpu: gpu.clone(),
            settings,
            bounds,
            scale: injected.scale(&bounds, &camera, emission),
            gbuffer_pass: SurfacePass::gbuffer(gpu, &gpu_scene, &textures)?,
            rsm_pass: SurfacePass::rsm(gpu, &gpu_scene, &textures)?,
            shadow_pass: ShadowPass::new(gpu, &gpu_scene, &textures)?,
            scene: gpu_scene,
            camera,
            places: scene.instances.iter().map(|i| i.world_from_local).collect(),
            lights: scene.lights.clone(),
            shadowed: ShadowedLights::new(gpu, for_picture, settings.shadow_size, shade)?,
            injected,
            leaves,
            volumes,
            glass,
            objects,
            sky,
            direct_pass: DirectPass::new(gpu)?,
            composite_pass,
            voxel_view: VoxelView::new(gpu),
            lobes: None,
            volume,
            voxelizer,
            triangles,
            standing,
            expected,
            direct_light,
            indirect,
            budget: settings.light_budget.map(LightBudget::new),
            over_budget: None,
            fresh: true,
            frames: 0,
            surfels_are_stale: true,
            irradiance: target("render/irradiance")?,
            mirrored: mirrors.then(|| target("render/mirrored")).transpose()?,
            spare_radiance: Texture::target(
                gpu,
                "camera/radiance",
                settings.size.to_array(),
                RADIANCE_FORMAT,
            )?,
            picture: target("render/picture")?,
        };
        renderer.voxel_view.show(gpu, renderer.volume.grid(), settings.voxel_channel, settings.voxel_slice);
        let mut timer = StageTimer::new(gpu, None);
        renderer.voxelize_triangles(&mut timer)?;
        timer.finish(gpu)?;
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
        let [for_picture, for_volume] = light_samples(&self.settings, lights, &self.sky);
        self.shadowed.set(for_picture);
        self.injected.set(&self.gpu, &for_volume);
        let panels = lights::panels(lights);
        self.scene.set_panels(&self.gpu, &panels);
        self.lights = lights.to_vec();
        if let Some(triangles) = &mut self.triangles {
            triangles.set_panels(&self.gpu, &panels);
        }
        if let Some(standing) = &mut self.standing {
            standing.set_panels(&self.gpu, &panels);
        }
    }

    /// Moves the scene and its lights, from the next frame on; for a pose of the scene that this was made of.
    pub fn set_pose(&mut self, pose: &Pose) {
        self.scene.set_pose(&self.gpu, pose);
        self.places.clone_from(&pose.world_from_local);
        if let Some(leaves) = &mut self.leaves {
            leaves.set_places(&self.gpu, &self.places);
        }
        if let Some(volumes) = &mut self.volumes {
            volumes.set_places(&self.gpu, &self.places);
        }
        if let Some(glass) = &mut self.glass {
            glass.set_pose(&self.gpu, pose);
        }
        if let Some(triangles) = &mut self.triangles {
            triangles.set_pose(&self.gpu, pose);
        }
        if let Some(standing) = &mut self.standing {
            standing.set_pose(&self.gpu, pose);
        }
        if let Some(expected) = &mut self.expected {
            expected.set_pose(&self.gpu, pose);
        }
        self.set_lights(&pose.lights);
    }

    /// Makes the next frame voxelize all triangles anew, as if everything had moved; for measuring.
    pub fn forget_triangles(&mut self) {
        if let Some(triangles) = &mut self.triangles {
            triangles.forget();
        }
    }

    /// Chooses what the picture shows, from the next frame on.
    pub fn set_layer(&mut self, layer: Layer) {
        self.settings.layer = layer;
        self.composite_pass.update(&self.gpu, layer, mirror(&self.settings));
    }

    /// Whether views bring the volume surfaces and light, or the triangles have filled it and nobody asks for its light, or
    /// nobody asks for it at all.
    fn views_fill_volume(&self) -> bool {
        let fills =
            self.settings.voxels != VoxelSource::Triangles && !matches!(self.indirect, Indirect::Lpv(_));
        let shown = self.settings.layer == Layer::Voxels;
        fills || shown || matches!(self.indirect, Indirect::Propagated(_))
    }
}

/// How surfaces mirror in the composition.
fn mirror(settings: &Settings) -> Option<Mirror> {
    let sky = settings.gi != GiMethod::Gather;
    let of = |p: Polish| Mirror { reflectance: p.reflectance, roughness: p.reflections.roughness, sky };
    settings.polish.map(of)
}

fn needs_volume(settings: &Settings) -> bool {
    settings.gi != GiMethod::Off || settings.layer == Layer::Voxels
}

/// The samples of all lights for the picture and for the volume. Surfels see the sky by themselves: where light is gathered, the volume
/// has only as many of its samples as bring surfaces.
fn light_samples(settings: &Settings, lights: &[Light], sky: &Sky) -> [Vec<LightSample>; 2] {
    let Settings { area_samples, area_maps, .. } = *settings;
    let of_sky = match settings.gi {
        _ if area_samples == 0 => 0,
        GiMethod::Gather => area_maps.min(FULL_SAMPLES as u32),
        _ => area_maps,
    };
    [(area_samples, area_samples), (area_maps, of_sky)]
        .map(|(count, of_sky)| lights::area_samples(lights, sky, count, of_sky))
}

fn camera_target(gpu: &Gpu, settings: &Settings) -> Result<SurfaceView, GpuError> {
    let view = View::perspective(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0, 1.0, 0.1, 1.0).with_reversed_depth();
    let textures = surface::targets(gpu, "camera", settings.size, RADIANCE_FORMAT)?;
    Ok(SurfaceView::new(gpu, "camera", textures, UVec2::splat(settings.points), view))
}
