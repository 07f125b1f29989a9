//! A volume from a scene's triangles, where every surface should count, seen or not; for gathered light with its sub-cells.
//!
//! For gathered light, cells have every surface that touches them (`exact`), with area-weighted means of its values, and sub-cells,
//! four times as fine, are `thin`: no ray gets through, and nothing stands farther out than half a sub-cell. Light that
//! propagates goes through faces of cells, and takes `thin` cells: walls one cell thick.
//!
//! What is seen through, masks and veils, is as opaque as it is on average in a cell, which light that propagates goes by; of its
//! sub-cells as many are filled.
//!
//! Surfaces are moved a little behind their visible side, as injection moves its points, so that one on a cell boundary belongs
//! to the cell behind.
//!
//! What has moved once is a layer of its own, and voxelized again when it moves; what stands still is kept.

use glam::Mat4;
use lumivox::VolumeBuffer;
use lumivox::core::Grid;
use lumivox::gather::GatheredLight;
use lumivox::gpu::{Gpu, GpuError};
use lumivox::progressive::SURFACE_SHIFT;
use lumivox::voxelize::{Channel, Coverage, Layer, Mesh, Options, SeeThrough, VoxelizeError, Voxelizer};
use lumivox::wgpu::CommandEncoder;
use lumivox_scene::{Pose, Scene};

use crate::gpu_scene::GpuScene;
use crate::material_textures::MaterialTextures;

/// Sub-cells along an axis of a cell.
const SUBCELLS: u32 = 4;

/// A scene's meshes as the voxelizer sees them, and what it makes of them.
#[derive(Debug)]
pub struct TriangleVoxelizer {
    cells: Level,
    subcells: Option<(Level, VolumeBuffer)>,
    /// One for each instance of the scene, then of what only lights see.
    meshes: Vec<Placed>,
    first_panel: usize,
    /// Whether the volume is that of another moment.
    is_stale: bool,
    /// Whether what stands still is not in its layer.
    still_is_stale: bool,
}

#[derive(Debug)]
struct Placed {
    mesh: Mesh,
    /// Its number in the scene; none of what only lights see.
    number: Option<usize>,
    world_from_local: Mat4,
    moves: bool,
}

/// One voxelizer, and the layers that it keeps once anything has moved.
#[derive(Debug)]
struct Level {
    voxelizer: Voxelizer,
    layers: Option<[Layer; 2]>,
}

impl TriangleVoxelizer {
    /// For volumes over the grid of `volume`, and sub-cells if light is gathered. `scene` and `panels` are those that `gpu_scene` was
    /// made of.
    ///
    /// # Errors
    /// When a channel of the grid's cells or the bits of the sub-cells do not fit the device.
    pub fn new(
        gpu: &Gpu,
        (scene, panels): (&Scene, &Scene),
        (gpu_scene, textures): (&GpuScene, &MaterialTextures),
        volume: &VolumeBuffer,
        gathers: bool,
    ) -> Result<Self, VoxelizeError> {
        let materials = scene.materials.iter().chain(&panels.materials);
        let brightest = materials.map(|m| m.emission.max_element()).fold(0.0, f32::max);
        // A range has a width.
        let emission = Channel::emission().range(0.0, if brightest > 1e-20 { brightest } else { 1.0 });
        let channels = [Channel::normal(), Channel::albedo(), emission];
        let coverage = if gathers { Coverage::Exact } else { Coverage::Thin };
        let grid = *volume.grid();
        let how = Options {
            coverage,
            shift: SURFACE_SHIFT as f32,
            see_through: SeeThrough::Opacity,
            ..Options::default()
        };
        let cells = Level::new(gpu, grid, &channels, &how)?;
        let fine = Grid { cell_size: grid.cell_size / SUBCELLS as f32, dims: grid.dims * SUBCELLS, ..grid };
        let subcells = if gathers {
            let how = Options {
                coverage: Coverage::Thin,
                shift: SUBCELLS as f32 * SURFACE_SHIFT as f32,
                see_through: SeeThrough::Dithered,
                ..Options::default()
            };
            let level = Level::new(gpu, fine, &[], &how)?;
            let bare = level.voxelizer.volume(gpu)?;
            Some((level, bare))
        } else {
            None
        };
        // Cells take means over texels, and of linear light.
        let filtered = match textures.is_filtered() {
            true => None,
            false => Some(MaterialTextures::new(gpu, scene, true)?),
        };
        let textures = filtered.as_ref().unwrap_or(textures);
        let instances = scene.instances.iter().map(|i| (Some(i.mesh), i.world_from_local));
        let instances = instances.chain(panels.instances.iter().map(|i| (None, i.world_from_local)));
        let meshes = gpu_scene.voxel_meshes(gpu, [scene, panels], textures)?.into_iter().zip(instances).map(
            |(mesh, (number, world_from_local))| Placed { mesh, number, world_from_local, moves: false },
        );
        Ok(Self {
            cells,
            subcells,
            meshes: meshes.collect(),
            first_panel: scene.instances.len(),
            is_stale: true,
            still_is_stale: true,
        })
    }

    /// Tells which instances of the scene will move, before they do.
    pub fn set_moving(&mut self, moving: &[bool]) {
        for (placed, moves) in self.meshes.iter_mut().take(self.first_panel).zip(moving) {
            placed.moves |= moves;
        }
    }

    /// Moves the scene's instances; vertices are the scene's own on the GPU, and move with it.
    pub fn set_pose(&mut self, gpu: &Gpu, pose: &Pose) {
        let panels = self.first_panel;
        for placed in self.meshes.iter_mut().take(panels) {
            let is_deformed = pose.deformed.iter().any(|d| Some(d.mesh) == placed.number);
            self.is_stale |= is_deformed;
            self.still_is_stale |= is_deformed && !placed.moves;
            placed.moves |= is_deformed;
        }
        let places = pose.world_from_local.iter().copied();
        self.place(gpu, 0, panels, places);
    }

    /// Moves what only lights see.
    pub fn set_panels(&mut self, gpu: &Gpu, panels: &Scene) {
        let places = panels.instances.iter().map(|instance| instance.world_from_local);
        self.place(gpu, self.first_panel, self.meshes.len() - self.first_panel, places);
    }

    fn place(&mut self, gpu: &Gpu, first: usize, count: usize, places: impl Iterator<Item = Mat4>) {
        for (placed, world_from_local) in self.meshes.iter_mut().skip(first).take(count).zip(places) {
            if placed.world_from_local != world_from_local {
                placed.mesh.set_transform(gpu, &world_from_local);
                placed.world_from_local = world_from_local;
                self.is_stale = true;
                self.still_is_stale |= !placed.moves;
                placed.moves = true;
            }
        }
    }

    /// Makes the next recording voxelize everything.
    pub fn forget(&mut self) {
        (self.is_stale, self.still_is_stale) = (true, true);
    }

    /// Whether what stands still is not what it was when the volume was filled.
    pub fn still_is_stale(&self) -> bool {
        self.still_is_stale
    }

    /// Whether anything has moved since the volume was filled.
    pub fn is_stale(&self) -> bool {
        self.is_stale
    }

    /// Makes room for layers, once something has moved. Before recording.
    pub fn make_layers(&mut self, gpu: &Gpu) -> Result<(), GpuError> {
        if self.meshes.iter().any(|placed| placed.moves) {
            self.cells.make_layers(gpu)?;
            if let Some((level, _)) = &mut self.subcells {
                level.make_layers(gpu)?;
            }
        }
        Ok(())
    }

    /// Fills the volume with what stands still alone; [`Self::record_still_subcells`] has its sub-cells.
    pub fn record_still(
        &mut self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        volume: &mut VolumeBuffer,
    ) -> Result<(), GpuError> {
        let still: Vec<&Mesh> = self.meshes.iter().filter(|p| !p.moves).map(|p| &p.mesh).collect();
        self.cells.voxelizer.record(gpu, encoder, &still, volume)?;
        if let Some((level, bare)) = &mut self.subcells {
            level.voxelizer.record(gpu, encoder, &still, bare)?;
        }
        (self.is_stale, self.still_is_stale) = (false, false);
        Ok(())
    }

    /// Adds the sub-cells of what stands still to those of views.
    pub fn record_still_subcells(
        &self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        volume: &VolumeBuffer,
        gathered: &mut GatheredLight,
    ) -> Result<(), GpuError> {
        let Some((level, _)) = &self.subcells else { return Ok(()) };
        gathered.record_static_subcells(gpu, encoder, volume, level.voxelizer.occupancy())
    }

    /// Fills the volume, and the sub-cells of gathered light.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        volume: &mut VolumeBuffer,
        gathered: Option<&mut GatheredLight>,
    ) -> Result<(), GpuError> {
        let (moving, still): (Vec<_>, Vec<_>) = self.meshes.iter().partition(|placed| placed.moves);
        let [moving, still] = [moving, still].map(|of| of.into_iter().map(|p| &p.mesh).collect::<Vec<_>>());
        let parts = Parts { still: &still, moving: &moving, still_is_stale: self.still_is_stale };
        self.cells.record(gpu, encoder, &parts, volume)?;
        if let (Some((level, bare)), Some(gathered)) = (&mut self.subcells, gathered) {
            level.record(gpu, encoder, &parts, bare)?;
            gathered.record_subcells(gpu, encoder, volume, level.voxelizer.occupancy())?;
        }
        (self.is_stale, self.still_is_stale) = (false, false);
        Ok(())
    }
}

/// What a level is made of.
struct Parts<'a> {
    still: &'a [&'a Mesh],
    moving: &'a [&'a Mesh],
    still_is_stale: bool,
}

impl Level {
    fn new(gpu: &Gpu, grid: Grid, channels: &[Channel], options: &Options) -> Result<Self, VoxelizeError> {
        Ok(Self { voxelizer: Voxelizer::new(gpu, grid, channels, options)?, layers: None })
    }

    /// Layers take as much room as the sums that are worked in, each: those of grids that are done in several windows are not kept.
    fn make_layers(&mut self, gpu: &Gpu) -> Result<(), GpuError> {
        if self.layers.is_none() && self.voxelizer.triangle_passes() == 1 {
            self.layers = Some([self.voxelizer.layer(gpu)?, self.voxelizer.layer(gpu)?]);
        }
        Ok(())
    }

    fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        parts: &Parts<'_>,
        volume: &mut VolumeBuffer,
    ) -> Result<(), GpuError> {
        let Self { voxelizer, layers: Some([still, moving]) } = self else {
            return self.voxelizer.record(gpu, encoder, &[parts.still, parts.moving].concat(), volume);
        };
        if parts.still_is_stale {
            voxelizer.record_layer(gpu, encoder, parts.still, still)?;
        }
        voxelizer.record_layer(gpu, encoder, parts.moving, moving)?;
        voxelizer.record_merge(gpu, encoder, &[still, moving], volume)
    }
}
