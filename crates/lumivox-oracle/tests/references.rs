//! The oracles against pictures and numbers of other programs, on real models.
//!
//! `LUMIVOX_ASSETS` names the folder of models; the reference pictures lie beside it in `references`. Without the variable
//! every test is reported as ignored, with that reason in its name; with `LUMIVOX_REQUIRE_ASSETS=1` that fails instead.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use glam::Vec3;
use libtest_mimic::{Arguments, Failed, Trial};
use lumivox_core::{Grid, TriangleView};
use lumivox_oracle::picture::Picture;
use lumivox_oracle::tracer::{Layer, Rendering, Settings, Tracer};
use lumivox_oracle::voxels::{Coverage, VoxelSet};
use lumivox_oracle::{distance, metrics, scene as oracle};

type Check = fn(&Path) -> Result<(), Failed>;

fn main() -> ExitCode {
    let args = Arguments::from_args();
    let required = std::env::var("LUMIVOX_REQUIRE_ASSETS").is_ok_and(|v| v == "1");
    let folder = std::env::var_os("LUMIVOX_ASSETS").map(PathBuf::from).filter(|p| p.is_dir());
    let tests: [(&str, Check); 4] = [
        ("two_lamps is what another path tracer sees", |a| reference(a, "two_lamps", false)),
        ("gallery_sky is what another path tracer sees", |a| reference(a, "gallery_sky", false)),
        ("sponza_sun is what another path tracer sees", |a| reference(a, "sponza_sun", true)),
        ("voxels and distances of the bunny are those of other programs", bunny),
    ];
    let trials = tests.into_iter().map(|(name, check)| match folder.clone() {
        Some(folder) => Trial::test(name, move || check(&folder)),
        None if required => Trial::test(name, || Err("LUMIVOX_ASSETS names no folder".into())),
        None => Trial::test(format!("{name} (needs LUMIVOX_ASSETS)"), || Ok(())).with_ignored_flag(true),
    });
    libtest_mimic::run(&args, trials.collect()).exit_code()
}

/// Noise of the references themselves, over the mean of a layer: 2048 samples that each pick one of the lights.
const REFERENCE_NOISE: f64 = 0.04;

/// Direct and indirect light, each by its mean, by its low frequencies and pixel by pixel, as close as noise allows.
///
/// `upright`: the textures of that model stand on their heads when its v is read downwards, as its format says, but
/// upright in the reference.
fn reference(assets: &Path, name: &str, upright: bool) -> Result<(), Failed> {
    let folder = assets.parent().unwrap_or(assets).join("references");
    let loaded = lumivox_scene::load(&folder.join(format!("{name}.scene.json")).display().to_string());
    let loaded = loaded.map_err(|e| e.to_string())?;
    let (mut scene, camera) = converted(&loaded)?;
    if upright {
        scene.triangles.iter_mut().flat_map(|t| &mut t.uvs).for_each(|uv| uv.y = 1.0 - uv.y);
    }
    let settings = Settings { width: 256, height: 144, samples: 64, ..Settings::default() };
    let tracer = Tracer::new(&scene).map_err(|e| e.to_string())?;
    let ours = tracer.render(&camera, &settings, &|_| {}).map_err(|e| e.to_string())?;
    let mut faults = Vec::new();
    for (layer, file) in [(&ours.direct, "direct.exr"), (&ours.indirect, "indirect.exr")] {
        faults.extend(differences(&ours, layer, &folder.join(name).join(file))?);
    }
    if faults.is_empty() { Ok(()) } else { Err(faults.join("; ").into()) }
}

fn differences(ours: &Rendering, layer: &Layer, file: &Path) -> Result<Vec<String>, Failed> {
    let reference = read_exr(file)?;
    let foreground = ours.foreground();
    let d = metrics::compare(&layer.radiance, &reference, &foreground).map_err(|e| e.to_string())?;
    let noise = metrics::noise(&layer.radiance_error, &reference, &foreground).map_err(|e| e.to_string())?;
    let both = noise.hypot(REFERENCE_NOISE);
    // Errors of independent pixels shrink by the root of the Gaussian's area, 4 pi sigma^2.
    let sigma = f64::from(reference.height) / 32.0;
    let blurred = both / (4.0 * std::f64::consts::PI).sqrt() / sigma;
    let file = file.display();
    eprintln!("{file}: {d:?}, noise {noise:.4}");
    let mut faults = Vec::new();
    for (what, value, most) in [
        ("mean off by", (d.mean_ratio - 1.0).abs(), 0.01),
        ("NRMSE", d.nrmse, 1.1 * both),
        ("low-frequency NRMSE", d.low_frequency, 1.5 * blurred),
    ] {
        if value > most {
            faults.push(format!("{file}: {what} {value:.4}, more than {most:.4}"));
        }
    }
    Ok(faults)
}

/// Counts of two exact voxelizers and distances of a mesh library, as published for this model on 64 cells.
fn bunny(assets: &Path) -> Result<(), Failed> {
    let loaded = lumivox_scene::load(&assets.join("meshes/bunny.ply").display().to_string());
    let loaded = loaded.map_err(|e| e.to_string())?;
    let mesh = &loaded.meshes[0];
    let view = TriangleView::new(&mesh.positions, &mesh.indices).ok_or("indices out of range")?;
    let grid = Grid::fit(&view.bounds(), 64).map_err(|e| e.to_string())?;
    // Cells, and percent of the diagonal: mean and maximum to the mesh, mean from the mesh.
    for (coverage, cells, to_mesh, from_mesh) in [
        (Coverage::Exact, 13_977, (0.3530, 0.8301), Some(0.4638)),
        (Coverage::Thin, 8_967, (0.2220, f64::NAN), None),
    ] {
        let set = VoxelSet::of(grid, view, coverage);
        let unsure = grid.cells().filter(|&c| set.verdict(c).is_marginal()).count();
        let centers: Vec<Vec3> = set.cells().map(|c| grid.center(c)).collect();
        let (to, from) = distance::two_way(&centers, view, 200_000).map_err(|e| e.to_string())?.percent();
        eprintln!("{coverage:?}: {} cells, {unsure} marginal, {to:?} {from:?}", set.len());
        let near = |a: f64, b: f64, tolerance: f64| b.is_nan() || (a - b).abs() <= tolerance;
        if set.len().abs_diff(cells) > unsure
            || !near(to.mean, to_mesh.0, 1e-3)
            || !near(to.max, to_mesh.1, 1e-3)
            || from_mesh.is_some_and(|mean| !near(from.mean, mean, 2e-3))
        {
            return Err(format!("{coverage:?}: {} cells, {to:?} {from:?}", set.len()).into());
        }
    }
    Ok(())
}

fn read_exr(path: &Path) -> Result<Picture, Failed> {
    let image = exr::prelude::read_first_rgba_layer_from_file(
        path,
        |size, _| Picture::filled(size.width() as u32, size.height() as u32, Vec3::ZERO),
        |picture, at, (r, g, b, _): (f32, f32, f32, f32)| {
            let width = picture.width as usize;
            picture.pixels[at.y() * width + at.x()] = Vec3::new(r, g, b);
        },
    );
    Ok(image.map_err(|e| e.to_string())?.layer_data.channel_data.pixels)
}

/// The loader's scene in the oracle's words; face normals, as the references have.
fn converted(scene: &lumivox_scene::Scene) -> Result<(oracle::Scene, oracle::Camera), Failed> {
    let mut result = oracle::Scene::default();
    for texture in &scene.textures {
        result.textures.push(oracle::Texture {
            width: texture.width,
            height: texture.height,
            srgb: texture.srgb,
            pixels: texture.pixels.clone(),
            wrap: texture.wrap.map(|wrap| match wrap {
                lumivox_scene::Wrap::Repeat => oracle::Wrap::Repeat,
                lumivox_scene::Wrap::Mirror => oracle::Wrap::Mirror,
                lumivox_scene::Wrap::Clamp => oracle::Wrap::Clamp,
            }),
        });
    }
    for material in &scene.materials {
        result.materials.push(oracle::Material {
            albedo: material.base_color,
            albedo_texture: material.base_color_texture.map(|t| t as u32),
            alpha_cutoff: match material.alpha {
                lumivox_scene::AlphaMode::Mask { cutoff } => Some(cutoff),
                _ => None,
            },
            emission: material.emission,
            emission_texture: material.emission_texture.map(|t| t as u32),
        });
    }
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh];
        let point = |n: u32| instance.world_from_local.transform_point3(mesh.positions[n as usize].into());
        for corners in &mesh.indices {
            let mut triangle = oracle::Triangle::flat(corners.map(point), mesh.material as u32);
            triangle.uvs = corners.map(|n| mesh.uvs[n as usize].into());
            triangle.colors = corners.map(|n| mesh.colors[n as usize].into());
            result.triangles.push(triangle);
        }
    }
    result.lights.extend(scene.lights.iter().map(light));
    result.lights.push(oracle::Light::Constant { radiance: scene.sky });
    let camera = scene.cameras.first().ok_or("no camera")?;
    let (eye, target, up, fov_y) = (camera.eye, camera.target, camera.up, camera.fov_y);
    Ok((result, oracle::Camera { eye, target, up, fov_y }))
}

fn light(light: &lumivox_scene::Light) -> oracle::Light {
    use lumivox_scene::Light;
    match *light {
        Light::Directional { direction, irradiance } => oracle::Light::Directional { direction, irradiance },
        Light::Point { position, intensity } => oracle::Light::Point { position, intensity },
        Light::Spot { position, direction, intensity, beam, cutoff, falloff } => oracle::Light::Spot {
            position,
            direction,
            intensity,
            falloff: match falloff {
                lumivox_scene::SpotFalloff::LinearAngle => oracle::SpotFalloff::LinearAngle { beam, cutoff },
                lumivox_scene::SpotFalloff::Gltf => oracle::SpotFalloff::Gltf { inner: beam, outer: cutoff },
            },
        },
        Light::Rect { origin, u, v, radiance } => oracle::Light::Rect { origin, u, v, radiance },
    }
}
