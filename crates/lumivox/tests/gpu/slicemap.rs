//! Slicemaps against a definition in double precision, and the light that they leave against closed forms.

use libtest_mimic::Failed;
use lumivox::core::View;
use lumivox::glam::{DVec2, DVec3, DVec4, UVec2, Vec2, Vec3};
use lumivox::gpu::{Gpu, GpuError, Texture};
use lumivox::light::IRRADIANCE_FORMAT;
use lumivox::slicemap::{Slicemap, SlicemapSettings, Slicing, Transmittance, TransmittanceSettings};

use crate::picture::{Paint, Shape, Thing};
use crate::support::{Random, Shot, run};
use crate::voxelize::soups::{Soup, scattered, sphere};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("slicemap: bits are those of the definition", |labs| definition(labs, false)),
    ("slicemap: conservative columns miss nothing", |labs| definition(labs, true)),
    ("slicemap: edge-on walls have bits only if conservative", edge_on),
    ("slicemap: front and back of a sphere, and its thickness", sphere_sides),
    ("slicemap: kinds are kept apart, in one pass as in two", kinds),
    ("slicemap: what does not fit is refused with numbers", refused),
    ("slicemap: planes take light one after the other", planes),
    ("slicemap: the table counts as the processor does", table),
];

/// Hardware snaps corners to 1/256 of a pixel, on some devices to 1/16.
const SNAP: f64 = 1.0 / 16.0;

/// A triangle in a view, in double precision.
struct Seen {
    clip: [DVec4; 3],
    distance: [f64; 3],
}

impl Seen {
    fn new(view: &View, soup: &Soup, triangle: [u32; 3]) -> Self {
        let world = triangle.map(|i| DVec3::from(soup.positions[i as usize].map(f64::from)));
        let clip = world.map(|p| view.clip_from_world.as_dmat4() * p.extend(1.0));
        Self { clip, distance: world.map(|p| -(view.eye_from_world.as_dmat4() * p.extend(1.0)).z) }
    }

    /// The range of distances in a rectangle of pixels, exactly: by cutting the triangle to it.
    fn range(&self, size: UVec2, low: DVec2, high: DVec2) -> Option<[f64; 2]> {
        let size = size.as_dvec2();
        let ndc = |p: DVec2| DVec2::new(2.0 * p.x / size.x - 1.0, 1.0 - 2.0 * p.y / size.y);
        let (a, b) = (ndc(low), ndc(high));
        let mut points: Vec<(DVec4, f64)> = self.clip.into_iter().zip(self.distance).collect();
        // Inside: in front of the eye, and between the sides.
        let sides = [
            DVec4::new(0.0, 0.0, 0.0, 1.0),
            DVec4::new(1.0, 0.0, 0.0, -a.x),
            DVec4::new(-1.0, 0.0, 0.0, b.x),
            DVec4::new(0.0, -1.0, 0.0, a.y),
            DVec4::new(0.0, 1.0, 0.0, -b.y),
        ];
        for side in sides {
            let mut cut = Vec::new();
            for n in 0..points.len() {
                let (p, q) = (points[n], points[(n + 1) % points.len()]);
                let (f, g) = (side.dot(p.0), side.dot(q.0));
                if f >= 0.0 {
                    cut.push(p);
                }
                if (f < 0.0) != (g < 0.0) {
                    let t = f / (f - g);
                    cut.push((p.0 + t * (q.0 - p.0), p.1 + t * (q.1 - p.1)));
                }
            }
            points = cut;
        }
        let low = points.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(|p| p.1).fold(f64::NEG_INFINITY, f64::max);
        (low <= high).then_some([low, high])
    }
}

/// Slices that a range of distances falls into, a little larger or smaller.
fn slices(range: [f64; 2], [near, far]: [f64; 2], slices: u32, larger: f64) -> std::ops::RangeInclusive<u32> {
    let place = |d: f64| (d - near) / (far - near).max(1e-30) * f64::from(slices);
    let slice = |p: f64| p.floor().clamp(0.0, f64::from(slices) - 1.0) as u32;
    slice(place(range[0]) - larger)..=slice(place(range[1]) + larger)
}

pub(crate) fn views() -> Vec<(View, [f32; 2])> {
    let eye = Vec3::new(7.0, 4.0, 9.0);
    let ortho = View::orthographic(eye, Vec3::new(0.3, 0.1, 0.0), Vec3::Y, Vec2::new(7.0, 5.0), 24.0);
    let far = View::perspective(eye, Vec3::ZERO, Vec3::Y, 0.5, 1.4, 4.0, 20.0);
    let reversed = View::perspective(Vec3::new(-3.0, 5.0, 4.0), Vec3::ZERO, Vec3::Y, 0.8, 1.4, 1.0, 15.0);
    vec![(ortho, [6.0, 18.0]), (far, [5.0, 19.0]), (reversed.with_reversed_depth(), [1.0, 15.0])]
}

pub(crate) const SIZE: UVec2 = UVec2::new(40, 28);
/// More than a word of them.
const SLICES: u32 = 40;

fn definition(labs: &Labs, conservative: bool) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    for (seed, (view, range)) in (3..).zip(views()) {
        let mut soup = scattered(seed, 200, 2.5, 3.0);
        soup.positions.iter_mut().flatten().for_each(|p| *p -= 1.5);
        let mesh = soup.mesh(gpu)?;
        for slicing in [Slicing::Uniform, Slicing::Local] {
            let settings =
                SlicemapSettings { size: SIZE, slices: SLICES, slicing, conservative, ..Default::default() };
            let mut map = Slicemap::new(gpu, settings)?;
            map.set_view(gpu, &view, range);
            run(gpu, |e| map.record(gpu, e, &[(&mesh, 0)]))?;
            let (bits, extents) = (map.read(gpu)?, map.read_extents(gpu)?);
            let seen: Vec<Seen> = soup.indices.iter().map(|t| Seen::new(&view, &soup, *t)).collect();
            let mut counts = [0u32; 2];
            for column in 0..SIZE.element_product() {
                let corner = UVec2::new(column % SIZE.x, column / SIZE.x).as_dvec2();
                let found =
                    |s: u32| bits[(column * SLICES.div_ceil(32) + s / 32) as usize] >> (s % 32) & 1 == 1;
                // What has to be there, and what may: of the column's middle, or of the column.
                let (least, most) = match conservative {
                    false => ([0.5, 0.5], [0.5 - SNAP, 0.5 + SNAP]),
                    true => ([0.01, 0.99], [-0.01, 1.01]),
                };
                let part = |[a, b]: [f64; 2]| (corner + DVec2::splat(a), corner + DVec2::splat(b));
                let own = match slicing {
                    Slicing::Uniform => Some(range.map(f64::from)),
                    Slicing::Local => extents[column as usize].map(|e| e.map(f64::from)),
                };
                if let (Slicing::Local, Some(own)) = (slicing, own) {
                    check_extent(own, &seen, part(least), part(most));
                }
                let mut may = [false; SLICES as usize];
                for triangle in &seen {
                    let (low, high) = part(most);
                    let Some(wide) = triangle.range(SIZE, low, high) else { continue };
                    let Some(own) = own else { continue };
                    slices(wide, own, SLICES, 0.01).for_each(|s| may[s as usize] = true);
                    if conservative {
                        let (low, high) = part(least);
                        if let Some(narrow) = triangle.range(SIZE, low, high) {
                            for s in slices(narrow, own, SLICES, -0.01) {
                                counts[0] += 1;
                                assert!(
                                    found(s),
                                    "{view:?}, {slicing:?}, column {corner}: slice {s} is missed"
                                );
                            }
                        }
                    } else {
                        // The middle is inside whatever the snapping, and in one slice.
                        let corners = [[-SNAP, -SNAP], [SNAP, -SNAP], [-SNAP, SNAP], [SNAP, SNAP]];
                        let middles = corners.map(|[x, y]| corner + 0.5 + DVec2::new(x, y));
                        let depths: Vec<_> =
                            middles.iter().filter_map(|&m| triangle.range(SIZE, m, m)).collect();
                        if depths.len() == 4 {
                            let (low, high) = (
                                depths.iter().map(|d| d[0]).fold(f64::INFINITY, f64::min),
                                depths.iter().map(|d| d[1]).fold(0.0, f64::max),
                            );
                            let one = slices([low, high], own, SLICES, 0.01);
                            if one.start() == one.end() {
                                counts[0] += 1;
                                assert!(
                                    found(*one.start()),
                                    "{view:?}, {slicing:?}, column {corner}: {one:?} is missed"
                                );
                            }
                        }
                    }
                }
                for s in 0..SLICES {
                    counts[1] += u32::from(found(s));
                    assert!(
                        !found(s) || may[s as usize],
                        "{view:?}, {slicing:?}, column {corner}: slice {s} is empty"
                    );
                }
            }
            eprintln!(
                "{slicing:?}, conservative {conservative}: {} bits, {} asked for",
                counts[1], counts[0]
            );
            assert!(counts[0] > 100 && counts[1] > 300, "{counts:?}");
        }
    }
    Ok(())
}

fn from_above(side: f32, far: f32) -> View {
    View::orthographic(Vec3::new(0.0, far, 0.0), Vec3::ZERO, Vec3::Z, Vec2::splat(side), far)
}

fn edge_on(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    // A wall that the view runs along, 2 m high from 3 to 5 m of 8.
    let [a, b] = [-1.0f32, 1.0].map(|x| [Vec3::new(x, 3.0, 0.1), Vec3::new(x, 5.0, 0.1)]);
    let wall = Soup::of([[a[0], b[0], b[1]], [a[0], b[1], a[1]]]).mesh(gpu)?;
    let bits = |conservative| -> Result<Vec<u32>, Failed> {
        let settings = SlicemapSettings {
            size: UVec2::splat(16),
            slices: 32,
            slicing: Slicing::Uniform,
            conservative,
            ..Default::default()
        };
        let mut map = Slicemap::new(gpu, settings)?;
        map.set_view(gpu, &from_above(4.0, 8.0), [0.0, 8.0]);
        run(gpu, |e| map.record(gpu, e, &[(&wall, 0)]))?;
        Ok(map.read(gpu)?)
    };
    assert!(bits(false)?.iter().all(|&word| word == 0));
    let whole = bits(true)?;
    let filled: Vec<u32> = whole.into_iter().filter(|&word| word != 0).collect();
    // Half the width, one column thick, and slices 12 to 19, with the neighbours that it touches.
    assert!((8..=10).contains(&filled.len()), "{} columns", filled.len());
    assert!(
        filled.iter().all(|word| word & 0x000f_f000 == 0x000f_f000 && word & !0x001f_f800 == 0),
        "{filled:x?}"
    );
    Ok(())
}

fn sphere_sides(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let ball = sphere(Vec3::new(0.0, 4.0, 0.0), 1.5, 5).mesh(gpu)?;
    let settings = SlicemapSettings {
        size: UVec2::splat(40),
        slices: 256,
        slicing: Slicing::Uniform,
        splits_faces: true,
        ..Default::default()
    };
    let mut map = Slicemap::new(gpu, settings)?;
    map.set_view(gpu, &from_above(4.0, 8.0), [2.0, 6.0]);
    run(gpu, |e| map.record(gpu, e, &[(&ball, 0)]))?;
    let bits = map.read(gpu)?;
    let mut worst = 0f32;
    for column in 0..1600u32 {
        let sets = [0, 1].map(|set| -> Vec<u32> {
            let word = |s: u32| bits[((2 * column + set) * 8 + s / 32) as usize];
            (0..256).filter(|&s| word(s) >> (s % 32) & 1 == 1).collect()
        });
        let middle = (UVec2::new(column % 40, column / 40).as_vec2() + 0.5) * 0.1 - 2.0;
        let inside = 1.5f32 * 1.5 - middle.length_squared();
        if inside < 0.3 {
            assert!(inside > -0.05 || sets.iter().all(Vec::is_empty), "column {middle} beside the ball");
            continue;
        }
        assert_eq!(sets.each_ref().map(Vec::len), [1, 1], "column {middle}: {sets:?}");
        let thickness = (sets[1][0] as f32 - sets[0][0] as f32) * 4.0 / 256.0;
        worst = worst.max((thickness - 2.0 * inside.sqrt()).abs());
    }
    // A slice either way, and the facets.
    assert!(worst < 0.025, "thickness is off by {worst}");
    Ok(())
}

fn kinds(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let [one, two] = [5, 6].map(|seed| scattered(seed, 30, 2.0, 3.0).mesh(gpu));
    let (one, two) = (one?, two?);
    let map = |kinds, meshes: &[(&lumivox::voxelize::Mesh, u32)]| -> Result<Vec<u32>, GpuError> {
        let settings = SlicemapSettings {
            size: SIZE,
            slices: 32,
            kinds,
            slicing: Slicing::Uniform,
            ..Default::default()
        };
        let mut map = Slicemap::new(gpu, settings)?;
        let (view, range) = views()[0];
        map.set_view(gpu, &view, range);
        run(gpu, |e| map.record(gpu, e, meshes))?;
        map.read(gpu)
    };
    let both = map(3, &[(&one, 2), (&two, 0)])?;
    let (first, second) = (map(1, &[(&one, 0)])?, map(1, &[(&two, 0)])?);
    assert!(first != second && first.iter().any(|&w| w != 0));
    for (column, words) in both.chunks(3).enumerate() {
        assert_eq!(words, [second[column], 0, first[column]], "column {column}");
    }
    Ok(())
}

fn refused(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let reason = |settings| Slicemap::new(gpu, settings).err().map(|e| e.to_string()).unwrap_or_default();
    let large = SlicemapSettings { size: UVec2::splat(4096), slices: 512, ..Default::default() };
    assert!(reason(large).contains("1073741824 bytes"), "{}", reason(large));
    let nothing = SlicemapSettings { size: UVec2::new(0, 4), ..Default::default() };
    assert!(reason(nothing).contains("columns"), "{}", reason(nothing));
    let many = SlicemapSettings { slices: 2000, ..Default::default() };
    assert!(reason(many).contains("2000 slices"), "{}", reason(many));
    let mesh = sphere(Vec3::ZERO, 1.0, 0).mesh(gpu)?;
    let mut map = Slicemap::new(gpu, SlicemapSettings { size: SIZE, ..Default::default() })?;
    let unknown = run(gpu, |e| map.record(gpu, e, &[(&mesh, 1)]));
    assert!(unknown.is_err_and(|e| e.to_string().contains("number 1")));
    Ok(())
}

/// Level squares of 4 m at heights.
fn level(heights: impl IntoIterator<Item = f32>) -> Soup {
    Soup::of(heights.into_iter().flat_map(|y| {
        let corner = |x: f32, z: f32| Vec3::new(2.0 * x, y, 2.0 * z);
        let [a, b, c, d] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        [[a, b, c], [a, c, d]]
    }))
}

/// What is left of the light at the middle of a floor at `height`, under planes at 1, 2, 3 and 4 m.
fn left_at(
    gpu: &Gpu,
    height: f32,
    (settings, counted): (SlicemapSettings, TransmittanceSettings),
    uses_table: bool,
) -> Result<Vec<[f32; 4]>, Failed> {
    let leaves = level([1.0, 2.0, 3.0, 4.0]).mesh(gpu)?;
    let mut map = Slicemap::new(gpu, settings)?;
    map.set_view(gpu, &from_above(4.0, 6.0), [0.5, 5.9]);
    let camera = View::orthographic(
        Vec3::new(0.0, height + 0.5, 0.0),
        Vec3::new(0.0, height, 0.0),
        Vec3::Z,
        Vec2::splat(3.0),
        2.0,
    );
    let point = DVec3::new(0.0, f64::from(height), 0.0);
    let floor = Thing(Shape::Plane { point, normal: DVec3::Y }, |_| Paint::default());
    let shot = Shot::take(gpu, camera, UVec2::splat(8), &[floor])?;
    let pass = Transmittance::new(gpu, uses_table)?;
    pass.update(gpu, &counted);
    let mut target = Texture::target(gpu, "left", [8, 8], IRRADIANCE_FORMAT)?;
    run(gpu, |e| {
        map.record(gpu, e, &[(&leaves, 0)])?;
        pass.record(gpu, e, &map, &shot.input, &mut target, false)
    })?;
    let texels: Vec<[half::f16; 4]> = lumivox::gpu::read_texture(gpu, &target)?;
    Ok(texels.into_iter().map(|t| t.map(half::f16::to_f32)).collect())
}

fn planes(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let counted = TransmittanceSettings { through: [Vec3::new(0.5, 0.8, 1.0); 4], ..Default::default() };
    for slicing in [Slicing::Uniform, Slicing::Local] {
        let settings = SlicemapSettings { size: UVec2::splat(16), slices: 96, slicing, ..Default::default() };
        let mut before = f32::INFINITY;
        for (height, surfaces) in [(4.5f32, 0), (3.5, 1), (2.5, 2), (1.5, 3), (0.5, 4)] {
            for left in left_at(gpu, height, (settings, counted), false)? {
                let expected = [0.5f32.powi(surfaces), 0.8f32.powi(surfaces), 1.0];
                for (left, expected) in left.iter().zip(expected) {
                    assert!((left - expected).abs() < 1e-3, "{slicing:?}, {height} m: {left} of {expected}");
                }
                assert!(left[0] <= before, "light grows with depth at {height} m");
            }
            before = 0.5f32.powi(surfaces);
        }
    }
    // Three slices of 1.8 m: steps without interpolation, none with.
    let coarse = SlicemapSettings {
        size: UVec2::splat(16),
        slices: 3,
        slicing: Slicing::Uniform,
        ..Default::default()
    };
    for interpolates in [false, true] {
        let counted = TransmittanceSettings { interpolates, ..counted };
        let heights = (0..40).map(|n| 5.2 - 0.12 * n as f32);
        let left: Vec<f32> = heights
            .map(|h| Ok(left_at(gpu, h, (coarse, counted), false)?[9][0]))
            .collect::<Result<_, Failed>>()?;
        let step = left.windows(2).map(|w| w[0] - w[1]).fold(0.0, f32::max);
        assert!(left.windows(2).all(|w| w[1] <= w[0] + 1e-3), "light grows with depth: {left:?}");
        assert!(
            if interpolates { step < 0.1 } else { step > 0.2 },
            "interpolates {interpolates}: step of {step}"
        );
    }
    Ok(())
}

fn table(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut random = Random::new(4);
    let settings = SlicemapSettings { size: UVec2::splat(16), slices: 130, ..Default::default() };
    for _ in 0..6 {
        let height = 0.2 + 4.6 * random.unit();
        let by = |uses_table| left_at(gpu, height, (settings, TransmittanceSettings::default()), uses_table);
        assert_eq!(by(false)?, by(true)?);
    }
    Ok(())
}

/// A column's own range holds all of what surely lies in it, and nothing that does not.
fn check_extent([near, far]: [f64; 2], seen: &[Seen], least: (DVec2, DVec2), most: (DVec2, DVec2)) {
    let over = |(low, high): (DVec2, DVec2)| {
        let ranges = seen.iter().filter_map(|triangle| triangle.range(SIZE, low, high));
        ranges.fold([f64::INFINITY, f64::NEG_INFINITY], |sum, r| [sum[0].min(r[0]), sum[1].max(r[1])])
    };
    let outer = over(most);
    assert!(near > outer[0] - 1e-3 && far < outer[1] + 1e-3, "{near} to {far}, of {outer:?}");
    // Of a single point, triangles whose edge runs through it may count or not.
    if least.0 != least.1 {
        let inner = over(least);
        assert!(near < inner[0] + 1e-3 && far > inner[1] - 1e-3, "{near} to {far}, of {inner:?}");
    }
}
