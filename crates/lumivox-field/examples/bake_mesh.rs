//! Bakes the visibility field of a mesh file and says how long it took.
//!
//! ```text
//! cargo run --release -p lumivox-field --example bake_mesh -- bunny.ply [bunny.lvf [POINTS [DIRECTIONS [BITS]]]]
//! ```
//!
//! Interrupted, it goes on where it was when started again. `RAYON_NUM_THREADS` sets the number of threads.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result};
use lumivox_field::{Baker, Field, Settings, Storage};

#[path = "common/cpu_time.rs"]
mod cpu_time;
#[path = "common/model.rs"]
mod model;

#[expect(clippy::print_stdout, reason = "an example that reports")]
fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let mesh = arguments.next().context("which mesh file?")?;
    let out = arguments.next().unwrap_or_else(|| {
        Path::new(&mesh).file_stem().map_or("field".into(), |s| s.to_string_lossy().into_owned()) + ".lvf"
    });
    let mut number = |default| arguments.next().map_or(Ok(default), |text| text.parse::<u32>());
    let settings = Settings {
        points: number(4226)?,
        directions: number(64)?,
        storage: Storage::from_bits(number(8)?)?,
        ..Settings::default()
    };

    let model = model::Model::load(&mesh)?;
    let (start, cpu) = (Instant::now(), cpu_time::seconds());
    let baker = Baker::new(model.mesh(), settings)?;
    let (built, cpu_built) = (start.elapsed().as_secs_f64(), cpu_time::seconds());
    let mut rays = 0;
    baker.bake_to_file(&out, |progress| {
        rays = progress.rays;
        ControlFlow::Continue(())
    })?;
    let (whole, cpu_whole) = (start.elapsed().as_secs_f64(), cpu_time::seconds());
    let field = Field::load(&out)?;

    println!("{mesh}: {} triangles, radius {} m", model.triangles(), field.sphere().radius);
    println!("{out}: {} points of {}^2 directions, {:.3} MiB", settings.points, settings.directions, {
        field.bytes() as f64 / f64::from(1 << 20)
    });
    println!("sphere and tree: {built:.2} s wall, {:.2} s CPU", cpu_built - cpu);
    println!("rays and file:   {:.2} s wall, {:.2} s CPU", whole - built, cpu_whole - cpu_built);
    println!("together:        {whole:.2} s wall, {:.2} s CPU", cpu_whole - cpu);
    let per_cpu_second = rays as f64 / (cpu_whole - cpu_built) / 1e6;
    println!(
        "{rays} rays, {per_cpu_second:.2} million per CPU-second on {} threads",
        rayon::current_num_threads()
    );
    Ok(())
}
