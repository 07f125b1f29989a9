//! The laws of voxelization and light on a device, and the contract with a host.
//!
//! One device per tier, opened once, and the stages of each grid size are shared by all tests. Without an adapter every
//! test is reported as ignored, with that reason in its name; with `LUMIVOX_REQUIRE_GPU=1` that fails instead.

mod bricks;
mod bricks_room;
mod cascade;
mod cells;
mod cleanup;
mod contract;
mod definition;
mod diagnostics;
mod energy;
mod flow;
mod forms;
mod gather;
mod gather_grain;
mod gather_proof;
mod gather_turns;
mod gather_views;
mod irradiance;
mod irradiance_sources;
mod light;
mod lighting;
mod lpv;
mod mirrors;
mod picture;
mod progressive;
mod proof;
mod random_views;
mod refraction;
mod refraction_shading;
mod shadow_volumes;
mod single_pass;
mod slicemap;
mod slicemap_use;
mod statics;
mod stored_light;
mod strays;
mod support;
mod visibility;
mod voxelize;

use std::process::ExitCode;
use std::sync::Arc;

use libtest_mimic::{Arguments, Failed, Trial};
use lumivox::gpu::{AdapterChoice, Gpu, GpuError, Tier};

use support::Lab;

/// Name and body of a test. Bodies return or panic with what is wrong.
type Test = (&'static str, fn(&Labs) -> Result<(), Failed>);

/// The shared devices.
struct Labs {
    core: Lab,
    native: Lab,
}

fn open() -> Result<Labs, GpuError> {
    let lab = |tier| Gpu::new_blocking(&AdapterChoice::default(), tier).map(Lab::new);
    Ok(Labs { core: lab(Tier::Core)?, native: lab(Tier::Native)? })
}

fn main() -> ExitCode {
    let args = Arguments::from_args();
    let required = std::env::var("LUMIVOX_REQUIRE_GPU").is_ok_and(|v| v == "1");
    let labs = if args.list { Err(GpuError::NoAdapter(String::new())) } else { open() };
    let labs = labs.map(Arc::new);
    let tests = [
        progressive::TESTS,
        cascade::TESTS,
        cleanup::TESTS,
        bricks::TESTS,
        bricks_room::TESTS,
        diagnostics::TESTS,
        lighting::TESTS,
        light::TESTS,
        energy::TESTS,
        flow::TESTS,
        forms::TESTS,
        gather::TESTS,
        gather_views::TESTS,
        gather_proof::TESTS,
        gather_turns::TESTS,
        gather_grain::TESTS,
        irradiance::TESTS,
        irradiance_sources::TESTS,
        lpv::TESTS,
        mirrors::TESTS,
        proof::TESTS,
        contract::TESTS,
        single_pass::TESTS,
        slicemap::TESTS,
        refraction::TESTS,
        refraction_shading::TESTS,
        slicemap_use::TESTS,
        statics::TESTS,
        stored_light::TESTS,
        strays::TESTS,
    ]
    .concat();
    let trials = tests
        .into_iter()
        .chain(shadow_volumes::tests())
        .chain(visibility::tests())
        .chain(voxelize::tests())
        .map(|(name, body)| match &labs {
            Ok(labs) => {
                let labs = labs.clone();
                Trial::test(name, move || body(&labs))
            }
            Err(_) if args.list => Trial::test(name, || Ok(())),
            Err(e) if required => {
                let reason = e.to_string();
                Trial::test(name, move || Err(reason.into()))
            }
            // An adapter that is there and does not work is a failure, not an absence.
            Err(GpuError::NoAdapter(_)) => {
                Trial::test(format!("{name} (no graphics adapter)"), || Ok(())).with_ignored_flag(true)
            }
            Err(e) => {
                let reason = e.to_string();
                Trial::test(name, move || Err(reason.into()))
            }
        });
    libtest_mimic::run(&args, trials.collect()).exit_code()
}
