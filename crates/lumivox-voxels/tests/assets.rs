//! Real models: cells against the oracle and against counts of other programs, memory, and nasty files.
//!
//! `LUMIVOX_ASSETS` names the folder of models. Without the variable every test is reported as ignored, with that reason
//! in its name; with `LUMIVOX_REQUIRE_ASSETS=1` that fails instead.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test that cannot go on has failed")]

mod common;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use common::{COVERAGES, Soup, against_oracle};
use libtest_mimic::{Arguments, Failed, Trial};
use lumivox_core::Grid;
use lumivox_voxels::{Channel, Coverage, MeshView, Model, VoxelizeOptions, voxelize};

type Check = fn(&Path) -> Result<(), Failed>;

fn main() -> ExitCode {
    let args = Arguments::from_args();
    let required = std::env::var("LUMIVOX_REQUIRE_ASSETS").is_ok_and(|v| v == "1");
    let folder = std::env::var_os("LUMIVOX_ASSETS").map(PathBuf::from).filter(|p| p.is_dir());
    let tests: [(&str, Check); 4] = [
        ("cells of the bunny are the oracle's", bunny),
        ("cells of bunny and dragon are as many as other programs count", counts),
        ("the dragon on 2048 cells takes less than a gibibyte", large),
        ("nasty files are voxelized or refused", nasty),
    ];
    let trials = tests.into_iter().map(|(name, check)| match folder.clone() {
        Some(folder) => Trial::test(name, move || check(&folder)),
        None if required => Trial::test(name, || Err("LUMIVOX_ASSETS names no folder".into())),
        None => Trial::test(format!("{name} (needs LUMIVOX_ASSETS)"), || Ok(())).with_ignored_flag(true),
    });
    libtest_mimic::run(&args, trials.collect()).exit_code()
}

fn load(folder: &Path, name: &str) -> Result<Soup, Failed> {
    let path = folder.join("meshes").join(name);
    let scene = lumivox_scene::load(&path.display().to_string()).map_err(|e| e.to_string())?;
    let mesh = scene.meshes.into_iter().next().ok_or("no mesh")?;
    Ok(Soup { positions: mesh.positions, indices: mesh.indices })
}

fn bunny(folder: &Path) -> Result<(), Failed> {
    let soup = load(folder, "bunny.ply")?;
    for n in [64, 150] {
        let grid = Grid::fit(&soup.view().bounds(), n)?;
        for coverage in COVERAGES {
            let difference = against_oracle(&soup, grid, coverage);
            println!("bunny, {n} cells, {coverage:?}: {difference}");
            if !difference.is_equal_within_margin() {
                return Err(format!("{n} {coverage:?}: {difference}").into());
            }
        }
    }
    Ok(())
}

/// Cells in double precision by an implementation that has nothing to do with this project: conservative, which another
/// library confirms cell for cell, and thin.
const COUNTS: [(&str, u32, u64, u64); 6] = [
    ("bunny.ply", 64, 13_977, 8_967),
    ("bunny.ply", 256, 224_717, 134_858),
    ("bunny.ply", 512, 898_102, 533_823),
    ("dragon.ply", 64, 10_247, 7_116),
    ("dragon.ply", 256, 167_553, 100_821),
    ("dragon.ply", 512, 670_717, 392_973),
];

fn counts(folder: &Path) -> Result<(), Failed> {
    for (name, n, exact, thin) in COUNTS {
        let soup = load(folder, name)?;
        for (coverage, expected) in [(Coverage::Exact, exact), (Coverage::Thin, thin)] {
            let options = VoxelizeOptions { coverage, ..VoxelizeOptions::resolution(n) };
            let found = voxelize(&Model::from(soup.view()), &options)?.len();
            println!("{name}, {n} cells, {coverage:?}: {found}, elsewhere {expected}");
            // The other grid is in double precision, so that a few verdicts on the hair's breadth differ.
            if found.abs_diff(expected) > 4 {
                return Err(format!("{name} {n} {coverage:?}: {found} cells, not {expected}").into());
            }
        }
    }
    Ok(())
}

fn large(folder: &Path) -> Result<(), Failed> {
    let soup = load(folder, "dragon.ply")?;
    let before = peak_bytes();
    let options = VoxelizeOptions {
        channels: vec![Channel::albedo(), Channel::normal()],
        memory_limit: 1 << 30,
        ..VoxelizeOptions::resolution(2048)
    };
    let volume = voxelize(&Model::from(soup.view()), &options)?;
    println!(
        "{} cells in {} bricks, {} bytes; the process grew by {:?}",
        volume.len(),
        volume.brick_count(),
        volume.bytes(),
        before.zip(peak_bytes()).map(|(before, after)| after - before)
    );
    let grew = before.zip(peak_bytes()).map_or(0, |(before, after)| after - before);
    if volume.bytes() > 200 << 20 || grew > 1 << 30 {
        return Err(format!("{} bytes, and the process grew by {grew}", volume.bytes()).into());
    }
    Ok(())
}

/// The most memory this process has had, where the system tells.
fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(1024 * line.trim().trim_end_matches(" kB").parse::<u64>().ok()?)
}

fn nasty(folder: &Path) -> Result<(), Failed> {
    let (mut done, mut refused) = (0, 0);
    for entry in std::fs::read_dir(folder.join("nasty"))? {
        let Ok(scene) = lumivox_scene::load(&entry?.path().display().to_string()) else { continue };
        let mut model = Model::default();
        for instance in &scene.instances {
            let mesh = &scene.meshes[instance.mesh];
            model.meshes.push(MeshView {
                normals: Some(&mesh.normals),
                uvs: Some(&mesh.uvs),
                colors: Some(&mesh.colors),
                world_from_local: instance.world_from_local,
                ..MeshView::new(lumivox_core::TriangleView {
                    positions: &mesh.positions,
                    indices: &mesh.indices,
                })
            });
        }
        for coverage in COVERAGES {
            let channels = vec![Channel::albedo(), Channel::normal()];
            let options =
                VoxelizeOptions { coverage, channels, solid: true, ..VoxelizeOptions::resolution(40) };
            match voxelize(&model, &options) {
                Ok(_) => done += 1,
                Err(_) => refused += 1,
            }
        }
    }
    println!("{done} volumes, {refused} refused");
    if done < 20 { Err("hardly any file was read".into()) } else { Ok(()) }
}
