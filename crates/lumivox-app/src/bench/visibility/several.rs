//! Several objects on the CPU, that occlude a corner and each other (Table 1's last column).

use anyhow::Result;
use glam::{Affine3A, Vec3};
use lumivox_field::{Baker, Field, Interpolation, Ray, Settings, Sphere};

use super::corner::{RAYS, corner, occlusion, rms, whole};
use super::models::Model;
use super::surface::row;
use crate::bench::report::Report;

/// Table 1: seconds of true rays, of the bakes and of the look-ups, of 26,444,800 rays.
const TABLE_1: [f64; 3] = [4286.8, 334.6, 4.692];
const TABLE_1_RAYS: f64 = 26_444_800.0;

/// An object of radius 1 somewhere.
struct Body {
    baker: Baker,
    field: Field,
    object_from_world: Affine3A,
}

/// The bunny casts, the two others cast and receive, and a corner receives.
pub(super) fn several(models: &[Model], quick: bool, report: &mut Report) -> Result<()> {
    report.head("Several objects on the CPU (Table 1)");
    let points = if quick { 1090 } else { 4226 };
    let settings = Settings { points, directions: 32, ..Settings::default() };
    let places = [Vec3::ZERO, Vec3::new(2.0, 0.0, 0.5), Vec3::new(0.5, 0.0, 2.0)];
    let names: Vec<_> = models.iter().cycle().take(places.len()).map(Model::title).collect();
    let (mut bodies, mut baked_s) = (Vec::new(), 0.0);
    for (model, place) in models.iter().cycle().zip(places) {
        let (baker, field, seconds) = model.baked(settings)?;
        baked_s += seconds;
        let Sphere { center, radius } = baker.sphere();
        let world_from_object = Affine3A::from_translation(place)
            * Affine3A::from_scale(Vec3::splat(1.0 / radius))
            * Affine3A::from_translation(-center);
        bodies.push(Body { baker, field, object_from_world: world_from_object.inverse() });
    }
    let mut receivers = corner(Sphere { center: Vec3::ZERO, radius: 1.0 });
    let of_corner = receivers.len();
    for (model, body) in models.iter().cycle().zip(&bodies).skip(1) {
        let world_from_object = body.object_from_world.inverse();
        let mesh = model.object.mesh();
        let (triangles, outwards) = (mesh.triangles, outwards(&mesh));
        // Not all of them: true rays take as long as the rest of the page. In their middles, since a corner lies on its neighbours too.
        let every = (triangles.len() / if quick { 200 } else { 8000 }).max(1);
        receivers.extend((0..triangles.len()).step_by(every).map(|n| {
            let [a, b, c] = triangles.triangle(n).map(|p| world_from_object.transform_point3(p));
            let normal = outwards * (b - a).cross(c - a).normalize_or(Vec3::Y);
            ((a + b + c) / 3.0 + 1e-3 * normal, normal)
        }));
    }
    let nearest = |ray: &Ray, look: &dyn Fn(&Body, &Ray) -> Option<f32>| {
        bodies.iter().find_map(|body| look(body, &ray.transformed(&body.object_from_world)))
    };
    let (exact, true_s) = occlusion(&receivers, |ray| nearest(ray, &|b, r| b.baker.trace(r)), whole);
    let look = |body: &Body, ray: &Ray| body.field.ahead(ray, body.field.hit_bias(), Interpolation::Nearest);
    let (found, look_s) = occlusion(&receivers, |ray| nearest(ray, &look), whole);
    let rays = receivers.len() as f64 * f64::from(RAYS);
    report.say(&format!(
        "{}: the first casts, the others cast and receive, and so does a corner: {rays} rays from {} points. In parentheses the papers' times, \
         for as many rays of theirs.",
        names.join(", "),
        receivers.len()
    ));
    let scaled = |seconds: f64| seconds * rays / TABLE_1_RAYS;
    let beside = [scaled(TABLE_1[0]), TABLE_1[1], scaled(TABLE_1[2])];
    let values = [true_s, baked_s, look_s];
    let mut line: Vec<String> =
        values.iter().zip(beside).map(|(value, paper)| format!("{value:.3} ({paper:.3})")).collect();
    let errors =
        [rms(&found[..of_corner], &exact[..of_corner]), rms(&found[of_corner..], &exact[of_corner..])];
    line.extend(errors.map(|error| format!("{error:.2}")));
    for ((metric, value), paper) in ["true rays", "bake", "look-ups"].into_iter().zip(values).zip(beside) {
        report.push(row("Table 1", "several objects".to_owned(), metric, value, "s", Some(paper)));
    }
    for (metric, error) in ["RMS of the corner", "RMS of the objects' own points"].into_iter().zip(errors) {
        report.push(row("Table 1", "several objects".to_owned(), metric, error, "grey levels", None));
    }
    let header =
        ["true rays s", "bakes s", "look-ups s", "RMS of the corner", "RMS of the objects' own points"];
    report.table(&header.map(str::to_owned), &[line]);
    Ok(())
}

/// -1 for a mesh whose triangles are seen from outside in the other order, as those of some files are.
fn outwards(mesh: &lumivox_field::Mesh<'_>) -> f32 {
    let triangles = mesh.triangles;
    let volumes = (0..triangles.len()).map(|n| {
        let [a, b, c] = triangles.triangle(n);
        a.dot(b.cross(c))
    });
    if volumes.sum::<f32>() < 0.0 { -1.0 } else { 1.0 }
}
