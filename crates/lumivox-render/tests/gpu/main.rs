//! The renderer on a GPU, against closed forms and laws, in small pictures.
//!
//! Without a graphics adapter every test is reported as ignored, with that reason in its name; with
//! `LUMIVOX_REQUIRE_GPU=1` that fails instead; likewise those that need models without `LUMIVOX_ASSETS`, and with
//! `LUMIVOX_REQUIRE_ASSETS=1`. All tests share one device of the core tier.

mod area;
mod camera;
mod direct;
mod errors;
mod fields;
mod gathered;
mod gathered_motion;
mod glass;
mod golden;
mod indirect;
mod layers;
mod masks;
mod moving;
mod odd;
mod progressive;
mod room;
mod scenes;
mod see_through;
mod standing;
mod switched;
mod triangles;
mod volumes;

use std::path::PathBuf;
use std::process::ExitCode;

use libtest_mimic::{Arguments, Failed, Trial};
use lumivox::gpu::{AdapterChoice, Gpu, Tier};

type Check = fn(&Gpu) -> Result<(), Failed>;

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let gpu_required = is_set("LUMIVOX_REQUIRE_GPU");
    let gpu = Gpu::new_blocking(&AdapterChoice::default(), Tier::Core).map_err(|e| e.to_string());
    let tests = [
        area::TESTS,
        direct::TESTS,
        errors::TESTS,
        fields::TESTS,
        gathered::TESTS,
        gathered_motion::TESTS,
        golden::TESTS,
        indirect::TESTS,
        layers::TESTS,
        masks::TESTS,
        glass::TESTS,
        moving::TESTS,
        progressive::TESTS,
        room::TESTS,
        see_through::TESTS,
        standing::TESTS,
        switched::TESTS,
        triangles::TESTS,
    ];
    let mut trials: Vec<Trial> = tests
        .into_iter()
        .chain(odd::TESTS.iter().copied())
        .flatten()
        .map(|&(name, check)| match gpu.clone() {
            Ok(gpu) => Trial::test(name, move || check(&gpu)),
            Err(reason) => unable(name, reason, gpu_required),
        })
        .collect();
    let assets_required = is_set("LUMIVOX_REQUIRE_ASSETS");
    let assets = std::env::var_os("LUMIVOX_ASSETS").map(PathBuf::from).filter(|p| p.is_dir());
    trials.extend(moving::WITH_ASSETS.iter().chain(volumes::WITH_ASSETS).map(|&(name, check)| {
        match (gpu.clone(), assets.clone()) {
            (Ok(gpu), Some(assets)) => Trial::test(name, move || check(&gpu, &assets)),
            (Err(reason), _) => unable(name, reason, gpu_required),
            (_, None) => unable(name, "needs LUMIVOX_ASSETS".to_owned(), assets_required),
        }
    }));
    libtest_mimic::run(&arguments, trials).exit_code()
}

/// A test that cannot run here: ignored, or failed where it must run.
fn unable(name: &str, reason: String, required: bool) -> Trial {
    match required {
        true => Trial::test(name, move || Err(reason.into())),
        false => Trial::test(format!("{name} ({reason})"), || Ok(())).with_ignored_flag(true),
    }
}

fn is_set(variable: &str) -> bool {
    std::env::var(variable).is_ok_and(|v| v == "1")
}
