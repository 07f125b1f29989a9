//! The program `lumivox` as its users meet it: wrong arguments and broken files end in one clear sentence, and the
//! commands write what they promise.
//!
//! Without a graphics adapter the tests that need one are reported as ignored, with that reason in their name; with
//! `LUMIVOX_REQUIRE_GPU=1` that fails instead. The same holds for tests on the models that `LUMIVOX_ASSETS` names, and
//! `LUMIVOX_REQUIRE_ASSETS=1`.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod arguments;
mod compare;
mod direct_light;
mod field;
mod files;
#[cfg(unix)]
mod full_disk;
#[cfg(unix)]
mod interrupts;
mod others;
mod outputs;
mod pictures;
mod pixels;
mod see_through;
mod support;
mod volumes;
mod voxel_colors;
mod voxel_files;
mod voxel_nasty;
mod voxelize;
mod voxelize_gpu;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use libtest_mimic::{Arguments, Failed, Trial};
use lumivox::gpu::Gpu;

type Check = fn() -> Result<(), Failed>;
type AssetCheck = fn(&Path) -> Result<(), Failed>;

const ANYWHERE: &[(&str, Check)] = &[
    ("no arguments show the usage", arguments::no_arguments),
    ("wrong arguments are named", arguments::wrong_arguments),
    ("wrong outputs are named before anything is rendered", arguments::wrong_outputs),
    ("files that are no scenes are named", files::broken_files),
    ("files cut off anywhere are named", files::cut_files),
    ("references that cannot be compared with are named", compare::wrong_references),
    ("help and version succeed", arguments::help),
    ("field names what is wrong", field::wrong_arguments),
    ("field bakes, draws, checks and reads", field::baked),
    ("field cuts what is elongated into several spheres", field::several_spheres),
    ("shadows by volumes are asked for by their name", volumes::wrong_arguments),
    ("slices, leaves and glass name what is wrong", see_through::wrong_arguments),
    ("voxelize names what is wrong before it begins", voxelize::wrong_arguments),
    ("voxelize writes the same cells in every format", voxelize::formats),
    ("voxelize takes any grid, and tells what it did", voxelize::grids),
    ("voxelize fills what is closed and names the hole of what is open", voxelize::solid),
    ("voxelize takes many meshes", voxelize::many),
    ("voxelize takes a moment of what moves", voxelize::moving),
    ("textures are upright on voxels", voxel_colors::upright),
    ("textures are averaged in linear space", voxel_colors::averaged_in_linear_space),
    ("colours of vertices and factors", voxel_colors::of_vertices_and_factors),
    ("missing textures, and channels that a format cannot hold", voxel_colors::missing),
    #[cfg(unix)]
    ("an interrupt leaves no part of a volume", interrupts::volumes),
    #[cfg(unix)]
    ("a full disk leaves the old volume", full_disk::volumes),
];

const WITH_ASSETS: &[(&str, AssetCheck)] =
    &[("nasty files are voxelized or refused", voxel_nasty::nasty_files)];

const WITH_GPU: &[(&str, Check)] = &[
    ("unknown adapters are named", arguments::unknown_adapter),
    ("grids that cannot be are refused", arguments::bad_grids),
    ("outputs that cannot be written are named", outputs::unwritable),
    ("what is read is never written over", outputs::over_the_scene),
    ("names and numbers at their limits", outputs::limits),
    #[cfg(unix)]
    ("links, devices and names that are not Unicode", outputs::unusual_places),
    #[cfg(unix)]
    ("an interrupt leaves whole files alone", interrupts::series),
    #[cfg(unix)]
    ("an interrupt ends what has no whole file yet", interrupts::unfinished),
    #[cfg(unix)]
    ("a full disk leaves the old file", full_disk::every_format),
    ("a picture and its statistics", pictures::picture_and_stats),
    ("an EXR is linear and upright", pictures::exr),
    (
        "an EXR shows the right thing at every pixel of every layer",
        pixels::every_layer_shows_the_right_pixels,
    ),
    ("a series has a file per frame", pictures::series),
    ("a scene that moves", pixels::scenes_move),
    ("every layer", pictures::layers),
    ("every voxelizer, with and without indirect light", pictures::methods),
    ("surfaces of propagation reflect as they are told to", pictures::surfaces),
    ("a comparison with the path tracer", compare::against_the_tracer),
    ("gathered light in a box is the path tracer's", compare::gathered_light_in_a_box),
    ("comparisons with another renderer's pictures", compare::references_from_files),
    ("comparisons of whole pixels", compare::antialiased),
    ("comparisons under a rect light", compare::rect_light),
    ("comparisons of what moves", compare::moving),
    ("comparisons without light, bounces or a volume", compare::dark_and_unlit),
    ("direct light of lamps in a box is the path tracer's", direct_light::lamps_in_a_box),
    ("direct light of lamps in the room is the path tracer's", direct_light::lamps_in_the_room),
    ("direct light of the sky in a box is the path tracer's", direct_light::sky_in_a_box),
    ("a demo writes all it promises", others::demo),
    ("pictures by visibility fields", field::pictures),
    ("slices of fronts and backs, parallel, and of a moment", see_through::slices),
    ("leaves leave a part of the light", see_through::leaves),
    ("shadows by volumes are those of maps, but for borders", volumes::pictures),
    ("glass has a thickness, and tells what it is not", see_through::glass),
    ("info tells adapters and limits", others::info),
    ("voxelize on a GPU has the exact cells, but for margins", voxelize_gpu::coverages),
    ("voxelize runs every method", voxelize_gpu::methods),
    ("voxelize on a GPU has the CPU's values", voxelize_gpu::channels),
    ("voxelize on a GPU has the CPU's textures, about", voxelize_gpu::textures),
    ("voxelize on a GPU does in slabs what does not fit at once", voxelize_gpu::slabs),
    ("voxelize refuses what a GPU cannot do", voxelize_gpu::refusals),
];

/// For `--ignored`: minutes each on a software driver.
const LONG: &[(&str, Check)] =
    &[("direct light of the sky, patiently, is the path tracer's", direct_light::sky_with_patience)];

/// With models and a graphics adapter.
const WITH_BOTH: &[(&str, AssetCheck)] =
    &[("direct light of lamps in Sponza is the path tracer's", direct_light::lamps_in_sponza)];

/// Likewise, for `--ignored`.
const LONG_WITH_BOTH: &[(&str, AssetCheck)] =
    &[("direct light of area lights in Sponza is the path tracer's", direct_light::area_lights_in_sponza)];

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let required = std::env::var("LUMIVOX_REQUIRE_GPU").is_ok_and(|v| v == "1");
    let has_gpu = !pollster::block_on(Gpu::adapters()).is_empty();
    let mut trials: Vec<Trial> = ANYWHERE.iter().map(|&(name, check)| Trial::test(name, check)).collect();
    trials.extend(WITH_GPU.iter().map(|&(name, check)| match (has_gpu, required) {
        (true, _) => Trial::test(name, check),
        (false, true) => Trial::test(name, || Err("no graphics adapter found".into())),
        (false, false) => {
            Trial::test(format!("{name} (no graphics adapter)"), || Ok(())).with_ignored_flag(true)
        }
    }));
    let assets = std::env::var_os("LUMIVOX_ASSETS").map(PathBuf::from).filter(|path| path.is_dir());
    let assets_required = std::env::var("LUMIVOX_REQUIRE_ASSETS").is_ok_and(|v| v == "1");
    let with_assets = |&(name, check): &(&str, AssetCheck)| match assets.clone() {
        Some(assets) => Trial::test(name, move || check(&assets)),
        None if assets_required => Trial::test(name, || Err("LUMIVOX_ASSETS names no folder".into())),
        None => Trial::test(format!("{name} (needs LUMIVOX_ASSETS)"), || Ok(())).with_ignored_flag(true),
    };
    trials.extend(WITH_ASSETS.iter().map(with_assets));
    if has_gpu {
        trials.extend(WITH_BOTH.iter().map(with_assets));
        trials.extend(LONG.iter().map(|&(name, check)| Trial::test(name, check).with_ignored_flag(true)));
        trials.extend(LONG_WITH_BOTH.iter().map(|t| with_assets(t).with_ignored_flag(true)));
    }
    libtest_mimic::run(&arguments, trials).exit_code()
}
