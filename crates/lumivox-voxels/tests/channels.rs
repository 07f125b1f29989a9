//! What channels say about surfaces.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test that cannot go on has failed")]

mod common;

use common::{Soup, cuboid, sphere, unit_grid};
use glam::{Mat4, UVec3, Vec2, Vec3, Vec4};
use lumivox_core::TriangleView;
use lumivox_voxels::{
    Channel, Coverage, Format, GridSpec, Material, MaterialOf, MeshView, Model, Rule, SparseVolume, Values,
    VoxelizeOptions, voxelize,
};

fn run(model: &Model<'_>, side: u32, coverage: Coverage, channels: Vec<Channel>) -> SparseVolume {
    let grid = GridSpec::Grid(unit_grid(side, side, side));
    voxelize(model, &VoxelizeOptions { grid, coverage, channels, ..VoxelizeOptions::default() }).unwrap()
}

/// Two walls in one layer of cells: below, from 0 to 8, and above, half as wide and one in three parts nearer.
fn walls() -> Soup {
    let wall = |y: f32, x: f32| {
        let [a, b, c, d] = [[0.0, 0.0], [x, 0.0], [x, 8.0], [0.0, 8.0]].map(|[x, z]| Vec3::new(x, y, z));
        [[a, c, b], [a, d, c]]
    };
    Soup::of([wall(4.2, 8.0), wall(4.6, 6.5)].concat())
}

#[test]
fn several_surfaces_in_a_cell_become_what_the_rule_says() {
    let soup = walls();
    let red = Material { base_color: Vec4::new(0.8, 0.1, 0.0, 1.0), ..Material::default() };
    let blue = Material { base_color: Vec4::new(0.0, 0.2, 0.6, 1.0), ..Material::default() };
    let mesh = MeshView { material: MaterialOf::Triangle(&[0, 0, 1, 1]), ..MeshView::new(soup.view()) };
    let model = Model { meshes: vec![mesh], materials: vec![red, blue] };
    for coverage in common::COVERAGES {
        let channel =
            |rule: Rule| Channel::albedo().named(&format!("{rule:?}")).rule(rule).format(Format::F32);
        let rules = [Rule::Average, Rule::Sum, Rule::Maximum, Rule::Nearest];
        let mut channels: Vec<Channel> = rules.into_iter().map(channel).collect();
        channels.push(Channel::area());
        let volume = run(&model, 8, coverage, channels);
        let value = |name: &str, x: u32| volume.value(name, UVec3::new(x, 4, 3)).unwrap().truncate();
        let near = |a: Vec3, b: [f32; 3]| {
            assert!((a - Vec3::from(b)).abs().max_element() < 2e-5, "{coverage:?} {a}")
        };
        // Off the diagonal, one triangle of each wall fills the cell.
        near(value("Average", 1), [0.4, 0.15, 0.3]);
        near(value("Maximum", 1), [0.8, 0.2, 0.6]);
        near(value("Nearest", 1), [0.0, 0.2, 0.6]);
        near(value("Nearest", 7), [0.8, 0.1, 0.0]);
        near(value("Sum", 1), [0.8, 0.3, 0.6]);
        near(value("area", 1), [2.0, 0.0, 0.0]);
        near(value("area", 7), [1.0, 0.0, 0.0]);
        if coverage == Coverage::Exact {
            // The upper wall covers half of column 6.
            near(value("Average", 6), [1.6 / 3.0, 0.4 / 3.0, 0.2]);
            near(value("area", 6), [1.5, 0.0, 0.0]);
        }
    }
}

#[test]
fn areas_add_up_to_that_of_the_mesh() {
    let mut soup = sphere(7.3, 4);
    soup.positions.iter_mut().for_each(|p| *p = (Vec3::from(*p) + 8.0).to_array());
    let area: f64 =
        soup.view().iter().map(|[a, b, c]| 0.5 * (b - a).as_dvec3().cross((c - a).as_dvec3()).length()).sum();
    let volume = run(&Model::from(soup.view()), 16, Coverage::Exact, vec![Channel::area()]);
    let sum: f64 = volume.cells().map(|cell| f64::from(volume.value("area", cell).unwrap().x)).sum();
    assert!((sum / area - 1.0).abs() < 1e-5, "{sum} {area}");
    // One sample stands for a column: right on average.
    let volume = run(&Model::from(soup.view()), 16, Coverage::Sampled, vec![Channel::area()]);
    let sum: f64 = volume.cells().map(|cell| f64::from(volume.value("area", cell).unwrap().x)).sum();
    assert!((sum / area - 1.0).abs() < 0.02, "{sum} {area}");
}

#[test]
fn normals_point_outwards_in_every_format_and_through_every_transform() {
    let soup = sphere(1.0, 4);
    let center = Vec3::splat(8.0);
    let turn =
        Mat4::from_translation(center) * Mat4::from_rotation_x(1.0) * Mat4::from_scale(Vec3::splat(7.0));
    let mirror = turn * Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    for (world_from_local, with_normals) in [(turn, false), (turn, true), (mirror, false), (mirror, true)] {
        let normals = with_normals.then_some(soup.positions.as_slice());
        let mesh = MeshView { normals, world_from_local, ..MeshView::new(soup.view()) };
        let model = Model { meshes: vec![mesh], materials: vec![] };
        for (format, tolerance) in [(Format::U8, 0.01), (Format::F16, 0.002), (Format::F32, 1e-5)] {
            let volume = run(&model, 16, Coverage::Exact, vec![Channel::normal().format(format)]);
            for cell in volume.cells() {
                let normal = volume.value("normal", cell).unwrap().truncate();
                let out = (volume.grid().center(cell) - center).normalize_or_zero();
                assert!((normal.length() - 1.0).abs() < tolerance, "{format:?} {normal}");
                assert!(normal.dot(out) > 0.95, "{format:?} {cell} {normal} {out}");
            }
        }
    }
}

#[test]
fn stretched_meshes_turn_their_normals_as_planes_turn() {
    let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 1.0]];
    let slanted = Vec3::new(0.0, -1.0, 1.0).to_array();
    let mesh = MeshView {
        normals: Some(&[slanted; 3]),
        world_from_local: Mat4::from_scale(Vec3::new(4.0, 1.0, 4.0)),
        ..MeshView::new(TriangleView { positions: &positions, indices: &[[0, 1, 2]] })
    };
    let flat = MeshView { normals: None, ..mesh };
    let channel = || vec![Channel::normal().format(Format::F32)];
    let [own, face] = [mesh, flat].map(|mesh| {
        let volume = run(&Model { meshes: vec![mesh], materials: vec![] }, 4, Coverage::Exact, channel());
        let cell = volume.cells().next().unwrap();
        volume.value("normal", cell).unwrap()
    });
    assert!((own - face).length() < 1e-5 && own.y < -0.9, "{own} {face}");
}

#[test]
fn textures_vertex_colours_and_emission_multiply() {
    let corners = [Vec3::new(0.0, 0.5, 0.0), Vec3::new(16.0, 0.5, 0.0), Vec3::new(0.0, 0.5, 16.0)];
    let soup = Soup::of([corners]);
    let uvs = corners.map(|p| [p.x / 16.0, p.z / 16.0]);
    let colors = [[1.0, 0.5, 1.0, 1.0]; 3];
    let ramp = |uv: Vec2, _: f32| Vec4::new(uv.x, 1.0, uv.y, 1.0);
    let material = Material {
        base_color: Vec4::new(1.0, 1.0, 0.5, 1.0),
        base_color_texture: Some(&ramp),
        emission: Vec3::new(100.0, 0.0, 1.0),
        emission_texture: Some(&ramp),
        ..Material::default()
    };
    let mesh = MeshView { uvs: Some(&uvs), colors: Some(&colors), ..MeshView::new(soup.view()) };
    let model = Model { meshes: vec![mesh], materials: vec![material] };
    for coverage in common::COVERAGES {
        let volume = run(&model, 16, coverage, vec![Channel::albedo(), Channel::emission()]);
        for (x, z) in [(1, 1), (7, 2), (3, 9)] {
            let (u, v) = ((x as f32 + 0.5) / 16.0, (z as f32 + 0.5) / 16.0);
            let cell = UVec3::new(x, 0, z);
            let albedo = volume.value("albedo", cell).unwrap().truncate();
            assert!((albedo - Vec3::new(u, 0.5, 0.5 * v)).abs().max_element() < 0.003, "{albedo} {u} {v}");
            let emission = volume.value("emission", cell).unwrap().truncate();
            assert!((emission - Vec3::new(100.0 * u, 0.0, v)).abs().max_element() < 0.03, "{emission}");
        }
    }
    assert!(matches!(
        run(&model, 16, Coverage::Exact, vec![Channel::albedo()]).channels()[0].values(),
        Values::U8(_)
    ));
}

/// The areas that textures are asked about add up to the area of the triangle in the texture.
#[test]
fn textures_are_told_how_much_of_them_is_meant() {
    let soup = Soup::of([[Vec3::new(0.3, 1.2, 0.1), Vec3::new(15.0, 2.5, 3.0), Vec3::new(4.0, 9.0, 15.5)]]);
    let uvs = [[0.25, 0.5], [2.0, 0.75], [-1.0, 3.5]];
    let mesh = MeshView { uvs: Some(&uvs), ..MeshView::new(soup.view()) };
    let model = Model { meshes: vec![mesh], materials: vec![] };
    let channel =
        || Channel::custom("uv", 1, |s| [s.uv_area, 0.0, 0.0, 0.0]).rule(Rule::Sum).format(Format::F32);
    let volume = run(&model, 16, Coverage::Exact, vec![channel()]);
    let sum: f32 = volume.cells().map(|cell| volume.value("uv", cell).unwrap().x).sum();
    let [a, b, c] = uvs.map(Vec2::from);
    assert!((sum - 0.5 * (b - a).perp_dot(c - a).abs()).abs() < 1e-4, "{sum}");
}

#[test]
fn holes_of_a_mask_mark_nothing() {
    let soup = cuboid(Vec3::new(0.01, 3.4, 0.02), Vec3::new(7.97, 3.6, 7.98));
    let uvs: Vec<[f32; 2]> = soup.positions.iter().map(|p| [p[0], p[2]]).collect();
    // Stripes of one cell.
    let stripes =
        |uv: Vec2, _: f32| Vec4::new(1.0, 1.0, 1.0, if uv.x.rem_euclid(2.0) < 1.0 { 1.0 } else { 0.2 });
    let material =
        Material { base_color_texture: Some(&stripes), alpha_cutoff: Some(0.5), ..Material::default() };
    let mesh = MeshView { uvs: Some(&uvs), ..MeshView::new(soup.view()) };
    let model = Model { meshes: vec![mesh], materials: vec![material] };
    for channels in [vec![], vec![Channel::albedo()]] {
        let volume = run(&model, 8, Coverage::Exact, channels);
        assert!(volume.cells().all(|cell| cell.x % 2 == 0 && cell.y == 3));
        assert_eq!(volume.len(), 32);
    }
}

#[test]
fn own_channels_see_the_surface_as_it_is() {
    let soup = walls();
    let meshes = vec![
        MeshView::new(TriangleView { positions: &soup.positions, indices: &soup.indices[..2] }),
        MeshView {
            material: MaterialOf::Mesh(7),
            world_from_local: Mat4::from_translation(Vec3::new(0.0, -3.0, 0.0)),
            ..MeshView::new(TriangleView { positions: &soup.positions, indices: &soup.indices[2..] })
        },
    ];
    let model = Model { meshes, materials: vec![] };
    let which = Channel::custom("which", 4, |s| {
        assert!((s.barycentric.element_sum() - 1.0).abs() < 1e-5 && s.area >= 0.0 && s.color == Vec4::ONE);
        [s.mesh as f32, s.material as f32, s.position.y, s.normal.y]
    });
    let volume = run(&model, 8, Coverage::Exact, vec![which.format(Format::F32)]);
    let near = |y: u32, expected: [f32; 4]| {
        let value = volume.value("which", UVec3::new(2, y, 5)).unwrap();
        assert!((value - Vec4::from(expected)).abs().max_element() < 1e-5, "{value}");
    };
    near(4, [0.0, 0.0, 4.2, 1.0]);
    near(1, [1.0, 7.0, 1.6, 1.0]);
}

#[test]
fn dust_and_lines_without_area_have_values_too() {
    let at = |x: f32| Vec3::splat(x);
    let soup = Soup::of([[at(1.5), at(1.5), at(1.5)], [at(3.2), at(6.9), at(3.2)]]);
    let model = Model::from(soup.view());
    let material = Material { base_color: Vec4::new(0.25, 0.5, 0.75, 1.0), ..Material::default() };
    let model = Model { materials: vec![material], ..model };
    let volume =
        run(&model, 8, Coverage::Exact, vec![Channel::albedo().format(Format::F32), Channel::normal()]);
    assert!(volume.len() >= 5);
    for cell in volume.cells() {
        assert_eq!(volume.value("albedo", cell).unwrap().truncate(), Vec3::new(0.25, 0.5, 0.75));
        assert_eq!(volume.value("normal", cell).unwrap(), Vec4::ZERO);
    }
}
