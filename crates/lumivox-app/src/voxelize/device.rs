//! Where triangles are voxelized: the one place that knows which voxelizers there are.

use std::ops::ControlFlow;

use anyhow::{Result, bail};
use lumivox::gpu::{AdapterChoice, Gpu, Tier};
use lumivox::wgpu::DeviceType;
use lumivox_core::Grid;
use lumivox_scene::Scene;
use lumivox_voxels::{GridSpec, SparseVolume, VoxelizeOptions};
use serde::Serialize;

use super::args::{ColorArg, DeviceArg, MethodArg, VoxelizeArgs};
use super::channel::ChannelArg;
use super::gpu;
use super::model::Surfaces;
use super::stages::Stages;
use crate::clock;
use crate::stats::AdapterStats;

/// What is to be voxelized.
pub(super) struct Work<'a> {
    pub(super) args: &'a VoxelizeArgs,
    pub(super) scene: &'a Scene,
    pub(super) grid: Grid,
    pub(super) channels: &'a [ChannelArg],
    pub(super) stages: &'a Stages,
}

/// A volume, and how it came about.
pub(super) struct Made {
    pub(super) volume: SparseVolume,
    pub(super) skipped_triangles: u64,
    pub(super) device: DeviceStats,
}

/// Where and how a volume was made.
#[derive(Clone, Debug, Serialize)]
pub(super) struct DeviceStats {
    kind: &'static str,
    threads: Option<usize>,
    adapter: Option<AdapterStats>,
    method: &'static str,
    /// Parts that the grid was done in, where it did not fit a GPU at once.
    slabs: Option<u32>,
    /// From triangles and textures at hand to cells, without what is compiled, uploaded and read back.
    ms: f64,
    #[serde(skip)]
    words: String,
}

impl DeviceStats {
    /// The device in words.
    pub(super) fn name(&self) -> String {
        format!("{}, {:.1} ms", self.words, self.ms)
    }
}

/// A chosen device.
#[derive(Debug)]
pub(super) enum Device {
    /// The CPU, and why, if a GPU was looked for.
    Cpu { because: Option<String> },
    /// A GPU; with `is_auto` it is not what was asked for, and the CPU may stand in.
    Gpu { gpu: Gpu, method: MethodArg, is_auto: bool },
}

impl Device {
    /// The device that was asked for, if it is there.
    pub(super) fn choose(args: &VoxelizeArgs) -> Result<Self> {
        let method = args.method.unwrap_or(MethodArg::Direct);
        let wants_cpu = args.device == DeviceArg::Cpu || args.method == Some(MethodArg::Cpu);
        let wants_gpu = args.device == DeviceArg::Gpu
            || args.adapter.is_some()
            || args.method.is_some_and(|method| method != MethodArg::Cpu);
        match (wants_cpu, wants_gpu) {
            (true, true) => bail!("--device, --method and --adapter ask for the CPU and for a GPU"),
            (true, false) => Ok(Self::Cpu { because: None }),
            (false, true) => {
                gpu::check(args, method)?;
                let choice = AdapterChoice { name: args.adapter.clone() };
                Ok(Self::Gpu { gpu: Gpu::new_blocking(&choice, Tier::Native)?, method, is_auto: false })
            }
            (false, false) => Ok(Self::automatic(args, method)),
        }
    }

    /// A real GPU that can do it, or the CPU.
    fn automatic(args: &VoxelizeArgs, method: MethodArg) -> Self {
        let cpu = |because: String| Self::Cpu { because: Some(because) };
        if let Err(error) = gpu::check(args, method) {
            return cpu(error.to_string());
        }
        // Adapters come with the most capable kind first.
        let Some(first) = pollster::block_on(Gpu::adapters()).into_iter().next() else {
            return cpu("there is no graphics adapter".to_owned());
        };
        let info = first.get_info();
        match info.device_type {
            DeviceType::DiscreteGpu | DeviceType::IntegratedGpu | DeviceType::VirtualGpu => {}
            _ => return cpu(format!("there is no GPU, only {}", info.name)),
        }
        match Gpu::new_blocking(&AdapterChoice::default(), Tier::Native) {
            Ok(gpu) => Self::Gpu { gpu, method, is_auto: true },
            Err(error) => cpu(error.to_string()),
        }
    }

    /// Makes the volume.
    pub(super) fn voxelize(&self, work: &Work<'_>) -> Result<Made> {
        match self {
            Self::Cpu { because } => on_cpu(work, because.as_deref()),
            Self::Gpu { gpu, method, is_auto } => match on_gpu(work, gpu, *method) {
                Err(error) if *is_auto => on_cpu(work, Some(&format!("{error:#}"))),
                made => made,
            },
        }
    }
}

fn on_cpu(work: &Work<'_>, because: Option<&str>) -> Result<Made> {
    let Work { args, scene, stages, .. } = work;
    stages.enter("textures");
    let surfaces = Surfaces::new(scene, args.color == ColorArg::Average && !work.channels.is_empty());
    let progress = |progress| -> ControlFlow<()> { stages.report(progress) };
    let options = VoxelizeOptions {
        grid: GridSpec::Grid(work.grid),
        coverage: args.coverage().into(),
        channels: work.channels.iter().map(|channel| channel.channel(args.color)).collect(),
        solid: args.solid,
        snap: args.snap,
        memory_limit: args.memory << 20,
        progress: Some(&progress),
        ..VoxelizeOptions::default()
    };
    let start = clock::millis();
    let volume = lumivox_voxels::voxelize(&surfaces.model(scene), &options)?;
    let ms = clock::millis() - start;
    let threads = rayon::current_num_threads();
    let because = because.map(|words| format!("; {words}")).unwrap_or_default();
    let device = DeviceStats {
        kind: "cpu",
        threads: Some(threads),
        adapter: None,
        method: MethodArg::Cpu.name(),
        slabs: None,
        ms,
        words: format!("the CPU ({threads} threads{because})"),
    };
    Ok(Made { skipped_triangles: volume.report().skipped_triangles, volume, device })
}

fn on_gpu(work: &Work<'_>, gpu: &Gpu, method: MethodArg) -> Result<Made> {
    let gpu::Outcome { volume, ms, slabs } = gpu::voxelize(work, gpu, method)?;
    let device = DeviceStats {
        kind: "gpu",
        threads: None,
        adapter: Some(AdapterStats::new(gpu)),
        method: method.name(),
        slabs: Some(slabs),
        ms,
        words: format!("{}, method {}", gpu.device.adapter_info().name, method.name()),
    };
    Ok(Made { volume, skipped_triangles: gpu::skipped_triangles(work.scene), device })
}
