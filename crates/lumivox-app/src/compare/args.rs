//! The command line of `lumivox compare`.

use std::path::PathBuf;

use clap::Args;

use crate::args::{ShotArgs, Size};

#[derive(Debug, Args)]
pub(crate) struct CompareArgs {
    #[command(flatten)]
    pub(crate) shot: ShotArgs,
    /// Picture size; 480x270 unless the reference says otherwise.
    #[arg(long)]
    pub(crate) size: Option<Size>,
    /// Folder for pictures, differences, sheet.png and compare.json.
    #[arg(long, default_value = "out/compare")]
    pub(crate) out: PathBuf,
    /// Folder with another renderer's pictures, direct.exr and indirect.exr, instead of the path tracer's.
    #[arg(long, value_name = "DIR")]
    pub(crate) reference: Option<PathBuf>,
    /// Render ours with N x N points to a pixel, and the path tracer's all over it. Without it one, in the pixel's centre, for both; 4
    /// against --reference, since other renderers average over pixels.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=8))]
    pub(crate) antialias: Option<u32>,
    /// The path tracer stops at this many paths per pixel, even if its noise is still above a quarter of the error.
    #[arg(long, default_value_t = 65_536, value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    pub(crate) max_samples: u32,
    /// The path tracer starts no round that would end after this time.
    #[arg(long, default_value_t = 300, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) max_seconds: u32,
    /// The path tracer's random numbers: same seed, same picture.
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// Write what compare.json holds to this file too.
    #[arg(long, value_name = "FILE")]
    pub(crate) stats: Option<PathBuf>,
}

impl CompareArgs {
    /// Points to a pixel, along each side.
    pub(crate) fn points_a_side(&self) -> u32 {
        self.antialias.unwrap_or(if self.reference.is_some() { 4 } else { 1 })
    }
}
