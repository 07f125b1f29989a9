//! `lumivox info`: adapters, tier, limits and what fits.

use std::io::Write;

use anyhow::Result;
use lumivox::gpu::{AdapterChoice, Gpu, Tier};
use serde::Serialize;

use crate::args::{GpuArgs, InfoArgs, TierArg};
use crate::output;
use crate::stats::{self, AdapterStats};

#[derive(Debug, Serialize)]
struct Info {
    adapters: Vec<String>,
    adapter: AdapterStats,
    max_storage_buffer_binding_bytes: u64,
    max_buffer_bytes: u64,
    max_texture_2d: u32,
    max_storage_buffers_per_stage: u32,
    max_color_bytes_per_sample: u32,
    largest_volume_side: u32,
    largest_lit_volume_side: u32,
}

/// Bytes of the largest buffer per cell: a volume channel, and the sums of injected light.
const VOLUME_CELL_BYTES: u64 = lumivox::volume::CHANNEL_BYTES;
const LIT_CELL_BYTES: u64 = 4 * lumivox::progressive::LIGHT_SUM_WORDS;

/// Opens the device that the arguments ask for.
pub(crate) fn open_gpu(args: &GpuArgs) -> Result<Gpu> {
    let tier = match args.tier {
        TierArg::Core => Tier::Core,
        TierArg::Native => Tier::Native,
    };
    Ok(Gpu::new_blocking(&AdapterChoice { name: args.adapter.clone() }, tier)?)
}

/// Runs the command.
pub(crate) fn run(args: &InfoArgs) -> Result<()> {
    args.stats.as_deref().map_or(Ok(()), output::prepare)?;
    let adapters = pollster::block_on(Gpu::adapters());
    let gpu = open_gpu(&args.gpu)?;
    let limits = gpu.device.limits();
    let binding = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    let side = |cell_bytes: u64| ((binding / cell_bytes) as f64).cbrt() as u32;
    let info = Info {
        adapters: adapters
            .iter()
            .map(|a| a.get_info())
            .map(|i| format!("{} ({:?}, {}, {})", i.name, i.device_type, i.backend, i.driver_info))
            .collect(),
        adapter: AdapterStats::new(&gpu),
        max_storage_buffer_binding_bytes: limits.max_storage_buffer_binding_size,
        max_buffer_bytes: limits.max_buffer_size,
        max_texture_2d: limits.max_texture_dimension_2d,
        max_storage_buffers_per_stage: limits.max_storage_buffers_per_shader_stage,
        max_color_bytes_per_sample: limits.max_color_attachment_bytes_per_sample,
        largest_volume_side: side(VOLUME_CELL_BYTES).min(lumivox::core::Grid::MAX_SIDE),
        largest_lit_volume_side: side(LIT_CELL_BYTES).min(lumivox::core::Grid::MAX_SIDE),
    };
    print(&info)?;
    if let Some(path) = &args.stats {
        stats::write(path, &info)?;
    }
    Ok(())
}

fn print(info: &Info) -> Result<()> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "adapters:")?;
    for adapter in &info.adapters {
        writeln!(out, "  {adapter}")?;
    }
    writeln!(out, "device:\n  {}", serde_json::to_string(&info.adapter)?)?;
    writeln!(out, "limits:")?;
    writeln!(out, "  one storage buffer      {} MiB", info.max_storage_buffer_binding_bytes >> 20)?;
    writeln!(out, "  storage buffers a stage {}", info.max_storage_buffers_per_stage)?;
    writeln!(out, "  colour bytes a sample   {}", info.max_color_bytes_per_sample)?;
    writeln!(out, "  2D texture side         {}", info.max_texture_2d)?;
    writeln!(out, "what fits:")?;
    writeln!(out, "  volume of attributes    {0} x {0} x {0} cells", info.largest_volume_side)?;
    writeln!(out, "  volume with light       {0} x {0} x {0} cells", info.largest_lit_volume_side)?;
    Ok(())
}
