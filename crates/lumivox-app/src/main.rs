//! The program `lumivox`: lights scenes with voxel volumes from the command line.

mod args;
mod bench;
mod clock;
mod compare;
mod demo;
mod field;
mod framing;
mod framing_cells;
mod info;
mod interrupt;
mod lighting;
mod motion;
mod output;
mod part_file;
mod render;
mod sheet;
mod slices;
mod stats;
mod voxelize;

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    let filter = tracing_subscriber::EnvFilter::try_from_env("LUMIVOX_LOG").unwrap_or_else(|_| {
        tracing_subscriber::EnvFilter::new("warn,wgpu=error,wgpu_core=error,wgpu_hal=off")
    });
    tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr).without_time().init();
    let arguments = args::Arguments::parse();
    if let Err(error) = interrupt::listen() {
        tracing::warn!("an interrupt may leave a temporary file behind: {error}");
    }
    let result = match &arguments.command {
        args::Command::Demo(demo) => demo::run(demo),
        args::Command::Render(render) => render::run(render),
        args::Command::Voxelize(voxelize) => voxelize::run(voxelize),
        args::Command::Slices(slices) => slices::run(slices),
        args::Command::Field(field) => field::run(field),
        args::Command::Compare(compare) => compare::run(compare),
        args::Command::Bench(bench) => bench::run(bench),
        args::Command::Info(info) => info::run(info),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            tracing::debug!("{error:?}");
            eprintln!("lumivox: {error:#}");
            ExitCode::FAILURE
        }
    }
}
