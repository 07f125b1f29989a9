//! Light past objects with visibility fields, beside the same light through shadow maps of their triangles.

use std::ops::ControlFlow;
use std::sync::OnceLock;

use glam::{UVec2, Vec3};
use libtest_mimic::Failed;
use lumivox::core::TriangleView;
use lumivox::gpu::Gpu;
use lumivox::visibility::{OcclusionSettings, ReflectionSettings, ShadowSettings};
use lumivox_field::{Baker, Mesh};
use lumivox_render::{Caster, GiMethod, Layer, ObjectFields, Polish, Renderer, RendererError, Settings};
use lumivox_scene::{Camera, Scene, builtin};

use crate::Check;

pub(crate) const TESTS: &[(&str, Check)] = &[
    ("fields take of the sky what its shadow maps take", sky),
    ("fields throw the shadows that shadow maps throw", shadows),
    ("objects with fields move", moving),
    ("a polished floor mirrors what a camera below it sees", mirroring),
];

fn scene() -> Scene {
    builtin::falling(0)
}

/// Fields of everything that moves, baked once.
fn fields() -> &'static ObjectFields {
    static FIELDS: OnceLock<ObjectFields> = OnceLock::new();
    FIELDS.get_or_init(|| {
        let scene = scene();
        let rigid = scene.rigid_instances();
        let first = scene.instances[rigid[0]].mesh;
        let bake = |mesh: &lumivox_scene::Mesh| {
            let triangles = TriangleView { positions: &mesh.positions, indices: &mesh.indices };
            let settings = lumivox_field::Settings {
                points: 1090,
                directions: 64,
                ..lumivox_field::Settings::default()
            };
            let baker = Baker::new(Mesh::new(triangles), settings).expect("a sound mesh");
            let field = baker.bake(|_| ControlFlow::Continue(())).expect("a field");
            field.packed().expect("a field that fits")
        };
        // The floor comes first and stands still; every other mesh falls.
        let casters = rigid
            .iter()
            .map(|&instance| Caster { instance, fields: vec![scene.instances[instance].mesh - first] });
        ObjectFields { fields: scene.meshes[first..].iter().map(bake).collect(), casters: casters.collect() }
    })
}

fn settings() -> Settings {
    Settings {
        size: UVec2::new(160, 90),
        gi: GiMethod::Off,
        layer: Layer::Direct,
        area_samples: 512,
        shadow_size: 4096,
        light_radius: 0.0,
        ..Settings::default()
    }
}

fn by_fields() -> Settings {
    let (rays, blended, denoise) = (256, true, false);
    Settings {
        occlusion: Some(OcclusionSettings { rays, blended, denoise, ..OcclusionSettings::default() }),
        soft_shadows: Some(ShadowSettings { rays: 16, blended, denoise }),
        ..settings()
    }
}

fn picture(gpu: &Gpu, scene: &Scene, settings: Settings) -> Result<Vec<Vec3>, RendererError> {
    let mut renderer = Renderer::with_fields(gpu, scene, settings, fields())?;
    renderer.set_camera(&scene.cameras[0]);
    renderer.frame(None)?;
    renderer.read_picture()
}

/// Root mean square of the difference over the mean, and the part of pixels that are off by more than a part of the mean.
fn apart(a: &[Vec3], b: &[Vec3], far: f32) -> [f32; 2] {
    let count = a.len() as f32;
    let mean = a.iter().map(|v| v.element_sum() / 3.0).sum::<f32>() / count;
    let each = || a.iter().zip(b).map(|(a, b)| (*a - *b).abs().element_sum() / 3.0 / mean);
    let beyond = each().filter(|d| *d > far).count() as f32;
    [(each().map(|d| d * d).sum::<f32>() / count).sqrt(), beyond / count]
}

fn sky(gpu: &Gpu) -> Result<(), Failed> {
    let scene = Scene { lights: Vec::new(), ..scene() };
    let maps = picture(gpu, &scene, settings())?;
    let looked_up = picture(gpu, &scene, by_fields())?;
    let open = picture(gpu, &scene, Settings { occlusion: Some(tiny_reach()), ..settings() })?;
    let [rms, far] = apart(&maps, &looked_up, 0.2);
    let [without, _] = apart(&maps, &open, 0.2);
    eprintln!(
        "fields beside maps: RMS {rms:.4}, {far:.4} of pixels off by a fifth; without objects {without:.4}"
    );
    assert!(rms < 0.25 * without && far < 0.02, "{rms} {far} {without}");
    Ok(())
}

/// Of a falloff so short that objects take nothing.
fn tiny_reach() -> OcclusionSettings {
    OcclusionSettings { reach: 1e-6, ..OcclusionSettings::default() }
}

fn shadows(gpu: &Gpu) -> Result<(), Failed> {
    let scene = Scene { sky: Vec3::ZERO, ..scene() };
    let maps = picture(gpu, &scene, settings())?;
    let looked_up = picture(gpu, &scene, by_fields())?;
    let [rms, far] = apart(&maps, &looked_up, 0.3);
    let dark = Settings { soft_shadows: None, ..by_fields() };
    let same = picture(gpu, &scene, dark)?;
    eprintln!("fields beside maps: RMS {rms:.4}, {far:.4} of pixels off");
    // Without soft shadows the maps have everything.
    assert_eq!(apart(&maps, &same, 0.3), [0.0, 0.0]);
    assert!(far < 0.06, "{rms} {far}");
    Ok(())
}

fn moving(gpu: &Gpu) -> Result<(), Failed> {
    let mut scene = scene();
    let mut renderer = Renderer::with_fields(gpu, &scene, by_fields(), fields())?;
    renderer.set_camera(&scene.cameras[0]);
    renderer.frame(None)?;
    let before = renderer.read_picture()?;
    let pose = scene.pose(0, 1.7);
    scene.apply(&pose);
    renderer.set_pose(&pose);
    renderer.set_camera(&scene.cameras[0]);
    renderer.frame(None)?;
    let after = renderer.read_picture()?;
    let anew = picture(gpu, &scene, by_fields())?;
    // The shadow maps of a scene made anew reach a little more or less far.
    let [_, far] = apart(&anew, &after, 0.2);
    assert!(far < 0.01, "{far} of pixels differ from those of objects that always stood there");
    assert!(apart(&before, &after, 0.3)[1] > 0.05);
    Ok(())
}

fn mirroring(gpu: &Gpu) -> Result<(), Failed> {
    let mut scene = Scene { lights: Vec::new(), sky: Vec3::ONE, ..scene() };
    scene.cameras[0].target = Vec3::new(0.1, -1.2, 2.0);
    let reflections =
        ReflectionSettings { roughness: 0.0, blended: true, denoise: false, ..ReflectionSettings::default() };
    let polish = Some(Polish { reflections, reflectance: 1.0 });
    let base = Settings { area_samples: 4, ..settings() };
    let mirror = picture(gpu, &scene, Settings { polish, layer: Layer::Reflections, ..base })?;
    let final_mirror = picture(gpu, &scene, Settings { polish, layer: Layer::Final, ..base })?;
    let floor = picture(gpu, &scene, Settings { layer: Layer::Albedo, ..base })?;
    // From under the floor, without it.
    let mut below = scene.clone();
    below.instances.retain(|i| below.meshes[i.mesh].name != "floor");
    let flipped = |v: Vec3| Vec3::new(v.x, -v.y, v.z);
    let camera = scene.cameras[0].clone();
    below.cameras[0] = Camera { eye: flipped(camera.eye), target: flipped(camera.target), ..camera };
    let mut renderer = Renderer::new(gpu, &below, Settings { layer: Layer::Albedo, ..base })?;
    renderer.set_camera(&below.cameras[0]);
    renderer.frame(None)?;
    let bodies = renderer.read_picture()?;
    let paint = scene.materials[0].base_color.truncate();
    let (width, height) = (160, 90);
    let (mut on_floor, mut met, mut wrong) = (0, 0, 0);
    for n in 0..width * height {
        if floor[n].distance(paint) > 0.01 {
            continue;
        }
        on_floor += 1;
        assert!((mirror[n] - final_mirror[n]).abs().max_element() < 2e-3 * (1.0 + mirror[n].max_element()));
        let body = bodies[n % width + width * (height - 1 - n / width)];
        if body == Vec3::ZERO {
            wrong += i32::from(mirror[n].distance(Vec3::ONE) > 0.01);
            continue;
        }
        met += 1;
        // Sky from above and less from below: the colour is the body's, up to a factor.
        let factor = mirror[n].dot(body) / body.length_squared();
        let alike = mirror[n].distance(factor * body) < 0.02;
        wrong += i32::from(!alike || !(0.35..=1.05).contains(&factor));
    }
    eprintln!("{on_floor} pixels of the floor, {met} mirror a body, {wrong} differ");
    assert!(met > 500 && 8 * wrong < met, "{met} {wrong}");
    Ok(())
}
