//! The renderer on a GPU, against closed forms and laws, in small pictures.
//!
//! Without a graphics adapter every test is reported as ignored, with that reason in its name; with
//! `LUMIVOX_REQUIRE_GPU=1` that fails instead. All tests share one device of the core tier.

mod area;
mod camera;
mod direct;
mod errors;
mod indirect;
mod layers;
mod masks;
mod progressive;
mod scenes;

use std::process::ExitCode;

use libtest_mimic::{Arguments, Failed, Trial};
use lumivox::gpu::{AdapterChoice, Gpu, Tier};

type Check = fn(&Gpu) -> Result<(), Failed>;

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let required = std::env::var("LUMIVOX_REQUIRE_GPU").is_ok_and(|v| v == "1");
    let gpu = Gpu::new_blocking(&AdapterChoice::default(), Tier::Core).map_err(|e| e.to_string());
    let tests = [
        area::TESTS,
        direct::TESTS,
        errors::TESTS,
        indirect::TESTS,
        layers::TESTS,
        masks::TESTS,
        progressive::TESTS,
    ];
    let trials = tests.into_iter().flatten().map(|&(name, check)| match gpu.clone() {
        Ok(gpu) => Trial::test(name, move || check(&gpu)),
        Err(reason) if required => Trial::test(name, move || Err(reason.into())),
        Err(reason) => Trial::test(format!("{name} ({reason})"), || Ok(())).with_ignored_flag(true),
    });
    libtest_mimic::run(&arguments, trials.collect()).exit_code()
}
