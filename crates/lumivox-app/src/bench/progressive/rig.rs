//! What progressive voxelization is fed with here: G-buffers of a model, from a camera that goes round it.

use anyhow::Result;
use glam::{UVec2, Vec3};
use lumivox::core::{Bounds, Grid, View};
use lumivox::gpu::Gpu;
use lumivox::progressive::{
    AttributeChannel, AttributeKind, AttributeView, CleanupRule, FrameDiagnostics, InjectionPattern,
    InjectionScale, ProgressiveVoxelizer, VoxelizerSettings,
};
use lumivox::wgpu::CommandEncoder;
use lumivox_render::gpu_scene::GpuScene;
use lumivox_render::surface::{self, RADIANCE_FORMAT, SurfacePass, SurfaceView};
use lumivox_scene::{Pose, Scene};

use crate::bench::timing::Timer;

/// A scene on the device, and a camera.
#[derive(Debug)]
pub(super) struct Rig {
    scene: GpuScene,
    pass: SurfacePass,
    pub(super) camera: SurfaceView,
    size: UVec2,
}

impl Rig {
    /// Pictures of `size` texels, all of which are injected.
    pub(super) fn new(gpu: &Gpu, scene: &Scene, size: UVec2) -> Result<Self> {
        let (scene, textures) = GpuScene::new(gpu, scene, &Scene::default(), true)?;
        let pass = SurfacePass::gbuffer(gpu, &scene, &textures)?;
        let nowhere = View::perspective(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0, 1.0, 0.1, 1.0);
        let targets = surface::targets(gpu, "bench", size, RADIANCE_FORMAT)?;
        let camera = SurfaceView::new(gpu, "bench", targets, size, nowhere.with_reversed_depth());
        Ok(Self { scene, pass, camera, size })
    }

    /// The scale of a frame with this view alone.
    pub(super) fn scale(&self) -> InjectionScale {
        let points = self.size.element_product();
        InjectionScale { attribute_points: points, light_points: points, radiance_max: 4.0 }
    }

    /// Moves the scene.
    pub(super) fn pose(&self, gpu: &Gpu, pose: &Pose) {
        self.scene.set_pose(gpu, pose);
    }

    /// Looks at the scene from here.
    pub(super) fn look(&mut self, gpu: &Gpu, view: View) {
        self.camera.view = view;
        self.camera.update(gpu, self.scale());
    }

    pub(super) fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
    ) -> Result<(), lumivox::gpu::GpuError> {
        self.pass.record(gpu, encoder, &self.scene, None, &mut self.camera)
    }

    /// Its pictures as those of some channels: albedo and emission in turn.
    pub(super) fn attribute_view(
        &self,
        gpu: &Gpu,
        channels: &[AttributeChannel],
        points: UVec2,
    ) -> AttributeView {
        let input = &self.camera.input.textures;
        let pictures = [&input.albedo, &input.emission, &input.albedo, &input.emission];
        let count = channels.iter().filter(|c| c.kind != AttributeKind::Normal).count();
        let pictures = pictures.into_iter().take(count).cloned().collect();
        let (depth, normal) = (input.depth.clone(), input.normal.clone());
        AttributeView::new(gpu, "bench", depth, normal, pictures, points)
    }

    /// Draws the picture.
    pub(super) fn draw(&mut self, timer: &Timer<'_>) -> Result<()> {
        timer.submit(|e| self.record(timer.gpu, e))
    }
}

/// The views of a camera that goes once round each axis of a box, `steps` for each.
pub(super) fn orbit(bounds: &Bounds, steps: u32) -> Vec<View> {
    let (center, radius) = (bounds.center(), 0.5 * bounds.size().length());
    let (fov, axes) = (0.7f32, [Vec3::Y, Vec3::X, Vec3::Z]);
    let distance = 1.02 * radius / (0.5 * fov).sin();
    let round = |axis: Vec3| {
        let from = axis.any_orthonormal_vector();
        (0..steps).map(move |n| {
            // Not along an axis: there all views of a box see its sides edge-on.
            let angle = (n as f32 + 0.37) / steps as f32 * std::f32::consts::TAU;
            let side = from * angle.cos() + axis.cross(from) * angle.sin();
            let eye = center + distance * (side + 0.13 * axis).normalize_or_zero();
            View::perspective(eye, center, axis, fov, 1.0, distance - 1.1 * radius, distance + 1.1 * radius)
                .with_reversed_depth()
        })
    };
    axes.into_iter().flat_map(round).collect()
}

/// Normal, albedo and emission, as the dense form has them.
pub(super) fn three_channels() -> Vec<AttributeChannel> {
    let kinds = [AttributeKind::Normal, AttributeKind::Color(1.0), AttributeKind::Color(4.0)];
    ["normal", "albedo", "emission"]
        .into_iter()
        .zip(kinds)
        .map(|(n, k)| AttributeChannel::new(n, k))
        .collect()
}

/// A volume of bricks, and the one view that it is fed with.
#[derive(Debug)]
pub(super) struct Bricks {
    pub(super) voxelizer: ProgressiveVoxelizer,
    view: AttributeView,
    /// A view that only cleans, which stands where its rig does.
    other: Option<AttributeView>,
    points: u32,
    grid: Grid,
    settings: VoxelizerSettings,
}

impl Bricks {
    /// With room for what a surface takes on this grid.
    pub(super) fn new(
        gpu: &Gpu,
        rig: &Rig,
        grid: Grid,
        channels: &[AttributeChannel],
        points: UVec2,
        cleanup: CleanupRule,
    ) -> Result<Self> {
        // No surface here takes half of this, and both fit what every device binds.
        let sides = grid.dims.as_u64vec3();
        let around = 2 * (sides.x * sides.y + sides.y * sides.z + sides.z * sides.x) / 16;
        let values = 512 * channels.len() as u64;
        let sums = 256 * (4 * channels.len() as u64 + 1);
        let most = u64::from(u32::MAX).min(gpu.device.limits().max_storage_buffer_binding_size);
        let bricks = (3 * around).min(most / values);
        let bricks_in_view = (3 * around / 2).min(most / sums);
        let settings = VoxelizerSettings {
            bricks: bricks as u32,
            bricks_in_view: bricks_in_view as u32,
            cleanup,
            ..VoxelizerSettings::default()
        };
        let view = rig.attribute_view(gpu, channels, points);
        let voxelizer = ProgressiveVoxelizer::new(gpu, grid, channels, settings)?;
        Ok(Self { points: view.point_count(), voxelizer, view, other: None, grid, settings })
    }

    /// The same, in which cells die that few frames have shown.
    pub(super) fn mortal(self, gpu: &Gpu, max_age: u32, confident: u32) -> Result<Self> {
        let settings = VoxelizerSettings { max_age, confident, ..self.settings };
        let voxelizer = ProgressiveVoxelizer::new(gpu, self.grid, self.voxelizer.channels(), settings)?;
        Ok(Self { voxelizer, settings, ..self })
    }

    /// The same with a second view that only cleans.
    pub(super) fn with_other(self, gpu: &Gpu, rig: &Rig) -> Self {
        let depth = rig.camera.input.textures.depth.clone();
        Self { other: Some(AttributeView::cleaning(gpu, "bench, second view", depth)), ..self }
    }

    /// The same with points in another order.
    pub(super) fn with_pattern(self, pattern: InjectionPattern) -> Self {
        Self { view: self.view.with_pattern(pattern, 1), ..self }
    }

    /// Cleanup and injection in so many turns.
    pub(super) fn set_turns(&mut self, turns: f32) {
        self.voxelizer.set_turns(turns);
        self.view.set_split(turns.round() as u32);
    }

    /// A frame of what the camera sees.
    pub(super) fn frame(&mut self, timer: &Timer<'_>, rig: &Rig) -> Result<FrameDiagnostics> {
        self.step(timer, rig)?;
        Ok(self.voxelizer.diagnostics(timer.gpu, None)?)
    }

    /// The same without asking what happened.
    pub(super) fn step(&mut self, timer: &Timer<'_>, rig: &Rig) -> Result<()> {
        self.step_with(timer, rig, None)
    }

    /// The same with where the second view stands.
    pub(super) fn step_with(&mut self, timer: &Timer<'_>, rig: &Rig, other: Option<&Rig>) -> Result<()> {
        let Self { voxelizer, view, other: second, points, .. } = self;
        voxelizer.update(timer.gpu, &[]);
        view.update(timer.gpu, &rig.camera.view, *points, voxelizer.frame());
        let mut views = vec![&*view];
        if let (Some(second), Some(other)) = (&*second, other) {
            second.update(timer.gpu, &other.camera.view, *points, voxelizer.frame());
            views.push(second);
        }
        timer.submit(|e| voxelizer.record(timer.gpu, e, &views))
    }
}
