//! Soft shadows of a ball on a floor, beside exact rays.

use libtest_mimic::Failed;
use lumivox::glam::{DVec3, Mat4, Vec3};
use lumivox::gpu::read_texture;
use lumivox::visibility::{Fields, Objects, Placement, Receiver, ShadowLight, ShadowSettings, SoftShadows};

use super::objects::ball;
use super::occlusion::{SIZE, floor, points};
use crate::support::run;
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[("visibility: soft shadows are those of exact rays", soft_shadows)];

/// Points of the light that a reference ray goes to, along a side.
const GRID: u32 = 48;

/// The share of a light that a point of the floor sees past a ball.
fn visible(p: DVec3, light: &ShadowLight, center: DVec3, radius: f64) -> f64 {
    let (mut seen, mut sent) = (0.0, 0.0);
    for n in 0..GRID * GRID {
        let [s, t] = [n % GRID, n / GRID].map(|i| (f64::from(i) + 0.5) / f64::from(GRID));
        let (turn, out) = (std::f64::consts::TAU * s, t.sqrt());
        let disk = |axis: DVec3, radius: f64| {
            let (a, b) = axis.any_orthonormal_pair();
            radius * out * (turn.cos() * a + turn.sin() * b)
        };
        let (way, weight, ends) = match *light {
            ShadowLight::Ball { position, radius } => {
                let middle = position.as_dvec3() - p;
                (middle + disk(middle.normalize_or_zero(), f64::from(radius)), 1.0, 1.0)
            }
            ShadowLight::Rect { origin, u, v } => {
                let [origin, u, v] = [origin, u, v].map(|v| v.as_dvec3());
                let way = origin + s * u + t * v - p;
                let shines = u.cross(v).normalize_or_zero().dot(-way).max(0.0);
                (way, shines * way.y.max(0.0) / way.length_squared().powi(2), 1.0)
            }
            ShadowLight::Sun { direction, angle } => {
                let way = -direction.as_dvec3().normalize_or_zero();
                (way + disk(way, f64::from(angle).tan()), 1.0, f64::INFINITY)
            }
        };
        let from = p - center;
        let (a, b) = (way.length_squared(), from.dot(way));
        let root = b * b - a * (from.length_squared() - radius * radius);
        let met = root > 0.0 && (0.0..ends).contains(&((-b - root.sqrt()) / a));
        sent += weight;
        seen += if met { 0.0 } else { weight };
    }
    seen / sent
}

fn soft_shadows(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let shot = floor(gpu)?;
    let points = points(&shot);
    let packed = ball().packed().expect("a field that fits");
    let fields = Fields::new(gpu, &[&packed])?;
    let mut objects = Objects::new(gpu, 2)?;
    let (center, radius) = (Vec3::new(0.3, 1.2, 0.1), 0.8);
    let place = Mat4::from_translation(center) * Mat4::from_scale(Vec3::splat(radius));
    // Behind the lights nothing throws a shadow.
    let above = Mat4::from_translation(Vec3::new(0.0, 30.0, 0.0)) * Mat4::from_scale(Vec3::splat(5.0));
    objects.update(gpu, &fields, &[Placement::new(0, place, 0), Placement::new(0, above, 1)])?;
    let mut lights = [
        ShadowLight::Ball { position: Vec3::new(-1.5, 6.0, 1.0), radius: 0.6 },
        ShadowLight::Ball { position: Vec3::new(1.0, 5.0, -2.0), radius: 0.0 },
        ShadowLight::Rect {
            origin: Vec3::new(-1.0, 5.0, -1.0),
            u: Vec3::new(2.0, 0.0, 0.0),
            v: Vec3::new(0.0, 0.0, 1.5),
        },
        ShadowLight::Sun { direction: Vec3::new(0.5, -1.0, -0.3), angle: 0.08 },
    ];
    if let ShadowLight::Rect { u, v, .. } = &mut lights[2] {
        assert!(u.cross(*v).y < 0.0, "it shines on the floor");
    }
    let settings = ShadowSettings { rays: 64, blended: true, denoise: false };
    let mut shadows = SoftShadows::new(gpu, SIZE, &objects, lights.len(), settings)?;
    shadows.update(gpu, &objects, &lights);
    let receiver = Receiver::from(&shot.input);
    run(gpu, |e| shadows.record(gpu, e, &fields, &objects, &receiver))?;
    for (n, light) in lights.iter().enumerate() {
        // The far ball stands in the sun's way, on a part of the floor that the picture shows.
        let texels: Vec<half::f16> = read_texture(gpu, shadows.factor(n).expect("a light of four"))?;
        let drawn = shadows.read_drawn_tiles(gpu, n)?;
        let both = |p: &DVec3| {
            let one = visible(*p, light, center.as_dvec3(), f64::from(radius));
            let other = visible(*p, light, DVec3::new(0.0, 30.0, 0.0), 5.0);
            if matches!(light, ShadowLight::Sun { .. }) { one.min(other) } else { one }
        };
        let expected: Vec<f64> = points.iter().map(both).collect();
        let square: f64 = texels.iter().zip(&expected).map(|(a, b)| (a.to_f64() - b).powi(2)).sum();
        let rms = (square / expected.len() as f64).sqrt();
        let (dark, half) = (
            expected.iter().filter(|e| **e == 0.0).count(),
            expected.iter().filter(|e| **e > 0.0 && **e < 1.0).count(),
        );
        eprintln!("light {n}: RMS {rms:.4}, {dark} dark and {half} half-lit pixels, {drawn} tiles of 108");
        assert!(dark > 30 && (half > 40 || n == 1), "{dark} {half}");
        // The edge of a hard shadow is as wide as a pixel there and falls on either side.
        assert!(rms < if n == 1 { 0.06 } else { 0.02 }, "{rms}");
        assert!(drawn < 60 && drawn > 4, "{drawn}");
    }
    Ok(())
}
