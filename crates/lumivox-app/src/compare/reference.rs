//! What ours is held against: the path tracer's pictures, or those of another renderer.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result, bail};
use glam::Vec3;
use lumivox_oracle::picture::Picture;
use lumivox_oracle::scene::{Camera, Scene};
use lumivox_oracle::tracer::{self, PixelFilter, Rendering, Tracer};

use super::args::CompareArgs;
use crate::args::Size;
use crate::render;

/// Noise is low when it is at most this share of the error it is to show.
pub(crate) const NOISE_SHARE: f64 = 0.25;
/// Paths of the first round, which tells how long others take, and of the first two together.
const FIRST_ROUND: u32 = 4;
const SECOND_ROUND: u32 = 16;
/// Paths through a pixel that find its albedo, and whether it is all surface.
const ALBEDO_SAMPLES: u32 = 32;

/// Another renderer's pictures.
pub(crate) struct Files {
    pub(crate) direct: Picture,
    pub(crate) indirect: Picture,
}

impl Files {
    /// Reads `direct.exr` and `indirect.exr` of a folder, two pictures of one size.
    pub(crate) fn read(folder: &Path) -> Result<Self> {
        if !folder.is_dir() {
            bail!("{}: there is no such folder of reference pictures", folder.display());
        }
        let files = Self {
            direct: read_exr(&folder.join("direct.exr"))?,
            indirect: read_exr(&folder.join("indirect.exr"))?,
        };
        if files.size() != Size(files.indirect.width, files.indirect.height) {
            let (d, i) = (&files.direct, &files.indirect);
            bail!(
                "{}: direct.exr has {}x{} pixels and indirect.exr {}x{}",
                folder.display(),
                d.width,
                d.height,
                i.width,
                i.height
            );
        }
        Ok(files)
    }

    pub(crate) fn size(&self) -> Size {
        Size(self.direct.width, self.direct.height)
    }
}

/// Reads red, green and blue of a linear picture.
pub(crate) fn read_exr(path: &Path) -> Result<Picture> {
    let failed = || format!("cannot read the reference {}", path.display());
    let header = exr::meta::MetaData::read_from_file(path, false).with_context(failed)?;
    let sizes = header.headers.iter().map(|h| h.layer_size);
    if sizes.clone().any(|s| s.width() > 8192 || s.height() > 8192) {
        bail!("{}: a reference has at most 8192 pixels a side", path.display());
    }
    let image = exr::prelude::read_first_rgba_layer_from_file(
        path,
        |size, _| Picture::filled(size.width() as u32, size.height() as u32, Vec3::ZERO),
        |picture, at, (r, g, b, _): (f32, f32, f32, f32)| {
            let width = picture.width as usize;
            picture.pixels[at.y() * width + at.x()] = Vec3::new(r, g, b);
        },
    );
    let picture = image.with_context(failed)?.layer_data.channel_data.pixels;
    if let Some(n) = picture.pixels.iter().position(|p| !p.is_finite()) {
        let (x, y) = (n % picture.width as usize, n / picture.width as usize);
        bail!("{}: pixel {x}, {y} is not finite", path.display());
    }
    Ok(picture)
}

/// The path tracer's picture and how it came about.
pub(crate) struct Traced {
    pub(crate) rendering: Rendering,
    pub(crate) samples: u32,
    pub(crate) seconds: f64,
}

/// What the path tracer is asked for, and where it stops although its noise is not low yet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Budget {
    pub(crate) size: Size,
    pub(crate) seed: u64,
    pub(crate) filter: PixelFilter,
    /// Most bounces; none for all.
    pub(crate) bounces: Option<u32>,
    pub(crate) max_samples: u32,
    pub(crate) max_seconds: u32,
}

/// Traces paths in rounds, each as long as all before it, until `quiet` says that the noise is low or a limit is reached.
pub(crate) fn trace(
    scene: &Scene,
    camera: &Camera,
    budget: &Budget,
    quiet: impl Fn(&Rendering) -> bool,
) -> Result<Traced> {
    let start = Instant::now();
    let settings = tracer::Settings {
        width: budget.size.0,
        height: budget.size.1,
        seed: budget.seed,
        filter: budget.filter,
        bounces: budget.bounces,
        ..tracer::Settings::default()
    };
    let tracer = Tracer::new(scene)?;
    let mut film = tracer.film(camera, &settings)?;
    let mut samples = FIRST_ROUND.min(budget.max_samples);
    loop {
        let round = Instant::now();
        let bar = render::progress(1000, "path tracing");
        film.expose(samples, &|share| bar.set_position((1e3 * share) as u64));
        bar.finish_and_clear();
        let rendering = film.rendering();
        let taken = film.samples();
        let seconds = start.elapsed().as_secs_f64();
        let rest = f64::from(budget.max_seconds) - seconds;
        let affordable = (rest / round.elapsed().as_secs_f64() * f64::from(samples)) as u32;
        let wanted = if taken < SECOND_ROUND { SECOND_ROUND - taken } else { taken };
        samples = wanted.min(budget.max_samples - taken).min(affordable);
        // Less than an eighth more would not be worth its while.
        if (taken >= SECOND_ROUND && quiet(&rendering)) || samples == 0 || 8 * samples < taken.min(wanted) {
            return Ok(Traced { rendering, samples: taken, seconds });
        }
    }
}

/// Albedo and coverage of whole pixels, as another renderer that averages over them sees them.
pub(crate) fn albedo_and_foreground(
    scene: &Scene,
    camera: &Camera,
    args: &CompareArgs,
    size: Size,
) -> Result<(Picture, Vec<bool>)> {
    let settings = tracer::Settings {
        width: size.0,
        height: size.1,
        samples: ALBEDO_SAMPLES,
        bounces: Some(0),
        seed: args.seed,
        filter: PixelFilter::Box,
    };
    let rendering = Tracer::new(scene)?.render(camera, &settings, &|_| {})?;
    let foreground = rendering.foreground();
    Ok((rendering.albedo, foreground))
}
