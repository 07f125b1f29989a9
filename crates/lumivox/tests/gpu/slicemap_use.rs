//! Slicemaps as hosts use them: tables, ends from elsewhere, reading back, vertices that move, and the law of depth.

use libtest_mimic::Failed;
use lumivox::glam::{UVec2, Vec3};
use lumivox::gpu::{Gpu, GpuError, Texture};
use lumivox::light::IRRADIANCE_FORMAT;
use lumivox::slicemap::{Slicemap, SlicemapSettings, Slicing, Transmittance, TransmittanceSettings};

use crate::picture::{Paint, Shape, Thing};
use crate::slicemap::{SIZE, views};
use crate::support::{Shot, run};
use crate::voxelize::soups::{Soup, scattered, sphere};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("slicemap: the cellmask sets the bits that shifts set", cellmask),
    ("slicemap: columns may end where a box around ends", box_around),
    ("slicemap: light never rises with depth", never_rises),
    ("slicemap: what is read back lies on the surface", read_back),
    ("slicemap: vertices that move are sliced where they are", moving),
];

fn bits_of(
    gpu: &Gpu,
    settings: SlicemapSettings,
    [bounds, mesh]: [&lumivox::voxelize::Mesh; 2],
) -> Result<Vec<u32>, GpuError> {
    let mut map = Slicemap::new(gpu, settings)?;
    let (view, range) = views()[1];
    map.set_view(gpu, &view, range);
    run(gpu, |e| {
        map.record_extents(gpu, e, &[(bounds, 0)])?;
        map.record_bits(gpu, e, &[(mesh, 0)])
    })?;
    map.read(gpu)
}

fn cellmask(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mesh = scattered(11, 60, 2.0, 3.0).mesh(gpu)?;
    for slices in [32, 97] {
        let by = |uses_table| {
            let settings = SlicemapSettings { size: SIZE, slices, uses_table, ..Default::default() };
            bits_of(gpu, settings, [&mesh, &mesh])
        };
        let shifted = by(false)?;
        assert!(shifted.iter().any(|&word| word != 0));
        assert_eq!(shifted, by(true)?);
    }
    Ok(())
}

/// Columns of a ball between the ends of a larger one: as many bits as uniform slices of such a range would have, all of them inside.
fn box_around(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let [ball, around] = [1.0, 1.2].map(|radius| sphere(Vec3::ZERO, radius, 4).mesh(gpu));
    let (ball, around) = (ball?, around?);
    let settings = SlicemapSettings { size: SIZE, slices: 32, ..Default::default() };
    let (own, wide) = (bits_of(gpu, settings, [&ball, &ball])?, bits_of(gpu, settings, [&around, &ball])?);
    let mut columns = 0;
    for (own, wide) in own.iter().zip(&wide).filter(|(own, _)| **own != 0) {
        columns += 1;
        assert!(own & 1 == 1 && own >> 31 == 1, "a ball reaches from end to end of its own columns: {own:x}");
        assert!(*wide != 0 && wide & 1 == 0 && wide >> 31 == 0, "and not of a larger one's: {wide:x}");
    }
    assert!(columns > 30, "{columns} columns");
    Ok(())
}

/// Walls farther and farther from the light, behind random leaves: at each pixel no more light is left than before.
fn never_rises(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut soup = scattered(21, 150, 2.5, 3.0);
    soup.positions.iter_mut().flatten().for_each(|p| *p -= 1.5);
    let leaves = soup.mesh(gpu)?;
    let pass = Transmittance::new(gpu, false)?;
    let mut target = Texture::target(gpu, "left", SIZE.to_array(), IRRADIANCE_FORMAT)?;
    for (view, range) in views() {
        let eye = view.eye_from_world.inverse();
        let (forward, from) = (eye.transform_vector3(Vec3::NEG_Z), eye.transform_point3(Vec3::ZERO));
        for (slicing, interpolates) in
            [(Slicing::Uniform, false), (Slicing::Local, false), (Slicing::Local, true)]
        {
            let settings = SlicemapSettings { size: SIZE, slices: 24, slicing, ..Default::default() };
            let mut map = Slicemap::new(gpu, settings)?;
            map.set_view(gpu, &view, range);
            let through = [Vec3::new(0.7, 0.5, 0.0); 4];
            pass.update(gpu, &TransmittanceSettings { through, interpolates, ..Default::default() });
            run(gpu, |e| map.record(gpu, e, &[(&leaves, 0)]))?;
            let mut before = vec![[1.0f32; 3]; SIZE.element_product() as usize];
            let mut darkest = 1.0f32;
            for n in 0..12 {
                let away = range[0] + (range[1] - range[0]) * (n as f32 + 0.5) / 12.0;
                let point = (from + away * forward).as_dvec3();
                let wall = Thing(Shape::Plane { point, normal: -forward.as_dvec3() }, |_| Paint::default());
                let shot = Shot::take(gpu, view, SIZE, &[wall])?;
                run(gpu, |e| pass.record(gpu, e, &map, &shot.input, &mut target, false))?;
                let texels: Vec<[half::f16; 4]> = lumivox::gpu::read_texture(gpu, &target)?;
                for (left, before) in texels.iter().zip(&mut before) {
                    for (left, before) in left.iter().map(|c| c.to_f32()).zip(before) {
                        assert!((0.0..=1.0).contains(&left), "{left}");
                        assert!(left <= *before + 1e-3, "{slicing:?}: {left} after {before} at {away} m");
                        *before = left;
                        darkest = darkest.min(left);
                    }
                }
            }
            assert!(darkest < 0.01, "{slicing:?}: {darkest}");
        }
    }
    Ok(())
}

/// Cells of a ball lie at its surface, in every view and slicing, and a sheet shows each of them once.
fn read_back(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let ball = sphere(Vec3::ZERO, 1.5, 4).mesh(gpu)?;
    for (view, range) in views() {
        for slicing in [Slicing::Uniform, Slicing::Local] {
            let settings = SlicemapSettings { size: SIZE, slices: 200, slicing, ..Default::default() };
            let mut map = Slicemap::new(gpu, settings)?;
            map.set_view(gpu, &view, range);
            run(gpu, |e| map.record(gpu, e, &[(&ball, 0)]))?;
            let host = map.read_host(gpu, &view, range)?;
            let mut filled = 0;
            for (column, set, slice) in host.filled() {
                filled += 1;
                assert_eq!(set, 0);
                let center = host.center(column, slice).ok_or("a filled column has an extent")?;
                // Half a cell of at most 14 m in 200, along the view, and facets.
                assert!((center.length() - 1.5).abs() < 0.05, "{slicing:?}: {center} at {}", center.length());
            }
            assert!(filled > 80, "{filled} cells");
            let (size, pixels) = host.sheet(20);
            assert_eq!(
                (size, pixels.len()),
                (SIZE * UVec2::new(20, 10), 10 * 20 * SIZE.element_product() as usize)
            );
            assert_eq!(pixels.iter().filter(|p| **p == 255).count(), filled);
            assert!(!host.is_filled(SIZE, 0, 0) && !host.is_filled(UVec2::ZERO, 1, 0));
        }
    }
    Ok(())
}

/// A host's buffer whose vertices a skin or a wave has moved is sliced as it is now.
fn moving(labs: &Labs) -> Result<(), Failed> {
    use lumivox::voxelize::{Mesh, MeshDescriptor, VertexView};
    let gpu = &labs.core.gpu;
    let still = sphere(Vec3::ZERO, 1.0, 3);
    let bent = |p: [f32; 3]| {
        let p = Vec3::from(p);
        (p + Vec3::new(0.3 * (2.0 * p.y).sin(), 0.0, 0.5 * p.y * p.y)).to_array()
    };
    let corners = |soup: &Soup| -> Vec<[f32; 3]> {
        soup.indices.iter().flatten().map(|&i| soup.positions[i as usize]).collect()
    };
    let before = corners(&still);
    let after: Vec<_> = before.iter().copied().map(bent).collect();
    let buffer = crate::voxelize::soups::buffer(gpu, &before);
    let view =
        VertexView { buffer: &buffer, offset: 0, stride: 12, format: lumivox::wgpu::VertexFormat::Float32x3 };
    let mesh = Mesh::new(gpu, &MeshDescriptor::new(view, before.len() as u32))?;
    let settings = SlicemapSettings { size: SIZE, slices: 64, splits_faces: true, ..Default::default() };
    let mut map = Slicemap::new(gpu, settings)?;
    let (view, range) = views()[0];
    map.set_view(gpu, &view, range);
    let mut sliced = || -> Result<Vec<u32>, GpuError> {
        run(gpu, |e| map.record(gpu, e, &[(&mesh, 0)]))?;
        map.read(gpu)
    };
    let first = sliced()?;
    gpu.queue.write_buffer(&buffer, 0, lumivox::bytemuck::cast_slice(&after));
    let second = sliced()?;
    assert!(first != second);
    let moved = Soup {
        positions: after,
        indices: (0..before.len() as u32 / 3).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect(),
    };
    let mut fresh = Slicemap::new(gpu, settings)?;
    fresh.set_view(gpu, &view, range);
    let mesh = moved.mesh(gpu)?;
    run(gpu, |e| fresh.record(gpu, e, &[(&mesh, 0)]))?;
    assert_eq!(second, fresh.read(gpu)?);
    Ok(())
}
