use super::*;
use crate::builtin::checks;

fn instances(scene: &Scene, name: &str) -> Vec<usize> {
    let named = |i: &usize| scene.meshes[scene.instances[*i].mesh].name == name;
    (0..scene.instances.len()).filter(named).collect()
}

/// Moments between keys as well as at keys.
fn moments(count: u32) -> impl Iterator<Item = f32> {
    (0..count).map(move |i| walk::DURATION * (i as f32 + 0.37 * (i % 3) as f32) / count as f32)
}

#[test]
fn triangles_are_as_documented_and_all_is_closed() {
    assert_eq!([0, 1, 2, 3, 4].map(|d| door(d).triangle_count()), [2536, 4532, 9344, 20912, 48924]);
    for detail in [0, 2] {
        let scene = door(detail);
        assert_eq!(checks::open_edges(&checks::world_triangles(&scene, |_| true)), 0);
    }
}

#[test]
fn the_clip_loops_without_a_jump() {
    let scene = door(0);
    let [clip] = scene.clips() else { panic!("one clip") };
    assert_eq!((clip.name.as_str(), clip.duration), ("door", walk::DURATION));
    let step = walk::DURATION / 400.0;
    for i in 0..400 {
        let [a, b] = [0.0, 1.0].map(|d| scene.pose(0, step * (i as f32 + d)));
        for (k, (a, b)) in a.world_from_local.iter().zip(&b.world_from_local).enumerate() {
            // Nothing is faster than 4 m/s or turns by more than 10 rad/s.
            let name = &scene.meshes[scene.instances[k].mesh].name;
            assert!((a.w_axis - b.w_axis).length() < 4.0 * step, "{name} at step {i}");
            assert!(
                (a.x_axis - b.x_axis).length().max((a.y_axis - b.y_axis).length()) < 10.0 * step,
                "{name} {i}"
            );
        }
    }
    assert_eq!(scene.pose(0, 0.0).world_from_local, scene.pose(0, walk::DURATION).world_from_local);
}

#[test]
fn the_door_shuts_and_opens() {
    let scene = door(0);
    let leaf = instances(&scene, "door leaf")[0];
    let free_edge =
        |t: f32| scene.pose(0, t).world_from_local[leaf].transform_point3(2.0 * LEAF[0] * Vec3::X);
    assert!((free_edge(0.0) - Vec3::new(LEAF[0], 0.0, HINGE.z)).length() < 1e-5);
    assert!(free_edge(4.0).z > 1.3 && free_edge(4.0).x < -0.7);
    // Shut, it hides the back room: straight through the opening every ray ends at the leaf.
    let shut = checks::world_triangles(&scene, |n| n == "door leaf");
    for i in 0..20 {
        for j in 0..40 {
            let x = OPENING[0] * (i as f32 / 9.5 - 1.0);
            let y = 0.02 + (OPENING[1] - 0.02) * j as f32 / 39.0;
            assert!(checks::hit(&shut, Vec3::new(x, y, 1.0), Vec3::NEG_Z).is_some(), "{x} {y}");
        }
    }
}

#[test]
fn the_leaf_never_enters_the_wall_and_the_figure_never_a_wall_or_the_door() {
    let mut scene = door(0);
    for t in moments(120) {
        let pose = scene.pose(0, t);
        scene.apply(&pose);
        for p in checks::world_triangles(&scene, |n| n == "door leaf").iter().flatten() {
            assert!(p.z > 0.001 && p.y > 0.005 && p.x > -HALF, "{t}: {p}");
        }
        for p in checks::world_triangles(&scene, |n| n.starts_with("figure")).iter().flatten() {
            assert!(p.x.abs() < HALF - 0.2 && p.z < BACK[1] - 0.5 && p.z > BACK[0] + 0.6, "{t}: {p}");
        }
    }
}

#[test]
fn feet_stay_above_the_floor_and_one_always_stands_still() {
    let scene = door(0);
    let feet = instances(&scene, "figure foot");
    let soles = |t: f32| {
        let pose = scene.pose(0, t);
        feet.iter()
            .map(|&f| {
                let mesh = &scene.meshes[scene.instances[f].mesh];
                let points =
                    mesh.positions.iter().map(|&p| pose.world_from_local[f].transform_point3(p.into()));
                let low = points.map(|p| p.y).fold(f32::INFINITY, f32::min);
                (low, pose.world_from_local[f].w_axis.truncate())
            })
            .collect::<Vec<_>>()
    };
    let mut lifted = 0.0f32;
    for t in moments(900) {
        let (now, soon) = (soles(t), soles(t + 0.01));
        assert!(now.iter().all(|(low, _)| *low > 0.0), "{t}: {now:?}");
        lifted = now.iter().map(|f| f.0).fold(lifted, f32::max);
        let slips = now.iter().zip(&soon).map(|(a, b)| a.1.distance(b.1) / 0.01);
        let slowest = slips.fold(f32::INFINITY, f32::min);
        // Where one step ends and the next begins the feet change over.
        let [now_step, soon_step] = [0.0, 0.01].map(|d| walk::step_at(walk::wrapped(t + d)).0);
        assert!(now_step != soon_step || slowest < 0.05, "{t}: the foot that stands slides at {slowest} m/s");
        assert!(now.iter().any(|(low, _)| *low < 0.01), "{t}: it flies");
    }
    assert!(lifted > 0.05);
}

#[test]
fn joints_stay_together() {
    let scene = door(0);
    let at = |name: &str, which: usize| instances(&scene, name)[which];
    let joints = |which: usize| {
        let down = |length: f32| -length * Vec3::Y;
        [
            ("figure thigh", down(figure::THIGH), "figure shin"),
            ("figure shin", down(figure::SHIN), "figure foot"),
            ("figure upper arm", down(0.28), "figure forearm"),
            ("figure forearm", down(0.25), "figure hand"),
        ]
        .map(|(upper, end, lower)| (at(upper, which), end, at(lower, which)))
    };
    for t in moments(300) {
        let world = scene.pose(0, t).world_from_local;
        for (upper, end, lower) in joints(0).into_iter().chain(joints(1)) {
            let gap = world[upper].transform_point3(end).distance(world[lower].w_axis.truncate());
            assert!(gap < 1e-4, "{t}: {gap}");
        }
        let pelvis = world[at("figure pelvis", 0)];
        for (which, side) in [(0, 1.0), (1, -1.0)] {
            let hip = pelvis.transform_point3(side * figure::HIP * Vec3::X);
            assert!(hip.distance(world[at("figure thigh", which)].w_axis.truncate()) < 1e-4);
        }
    }
}
