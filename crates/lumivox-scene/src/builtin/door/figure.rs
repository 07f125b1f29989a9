//! The jointed figure: rigid parts on a hierarchy of nodes. It looks along +z with its left side at +x; the root is the
//! middle between the hips.

use glam::{Mat4, Vec3};

use crate::builtin::builder::{Builder, SceneBuilder};
use crate::{NodeId, Transform};

/// Lengths of thigh and shin, and height of the ankle over the sole.
pub(super) const THIGH: f32 = 0.43;
pub(super) const SHIN: f32 = 0.42;
pub(super) const ANKLE: f32 = 0.08;
/// Hips are at plus and minus this in x.
pub(super) const HIP: f32 = 0.095;
/// Reach of the sole from the ankle to the toes and to the heel.
pub(super) const TOES: f32 = 0.19;
pub(super) const HEEL: f32 = 0.075;
/// Joints in the axes of the part above: torso in the root, head and (left) shoulder in the torso, elbow, wrist.
const TORSO: Vec3 = Vec3::new(0.0, 0.06, 0.0);
const NECK: Vec3 = Vec3::new(0.0, 0.52, 0.0);
const SHOULDER: Vec3 = Vec3::new(0.215, 0.43, 0.0);
const ELBOW: Vec3 = Vec3::new(0.0, -0.28, 0.0);
const WRIST: Vec3 = Vec3::new(0.0, -0.25, 0.0);

/// Nodes of the figure; pairs are left (+x) and right.
pub(super) struct Figure {
    pub(super) root: NodeId,
    pub(super) torso: NodeId,
    pub(super) head: NodeId,
    pub(super) thighs: [NodeId; 2],
    pub(super) shins: [NodeId; 2],
    pub(super) feet: [NodeId; 2],
    pub(super) arms: [NodeId; 2],
    pub(super) forearms: [NodeId; 2],
}

/// Material indices.
pub(super) struct Clothes {
    pub(super) skin: usize,
    pub(super) shirt: usize,
    pub(super) trousers: usize,
    pub(super) shoes: usize,
    pub(super) hair: usize,
}

pub(super) fn add(scene: &mut SceneBuilder, clothes: &Clothes, place: Vec3, sides: u32) -> Figure {
    let root = scene.node(None, Transform::at(place));
    let torso = scene.node(Some(root), Transform::at(TORSO));
    let head = scene.node(Some(torso), Transform::at(NECK));
    let mirrored = |v: Vec3, side: f32| Vec3::new(side * v.x, v.y, v.z);
    let mut pair = |parents: [NodeId; 2], joint: Vec3| {
        [(0, 1.0), (1, -1.0)]
            .map(|(i, side)| scene.node(Some(parents[i]), Transform::at(mirrored(joint, side))))
    };
    let thighs = pair([root; 2], Vec3::new(HIP, 0.0, 0.0));
    let shins = pair(thighs, Vec3::new(0.0, -THIGH, 0.0));
    let feet = pair(shins, Vec3::new(0.0, -SHIN, 0.0));
    let arms = pair([torso; 2], SHOULDER);
    let forearms = pair(arms, ELBOW);
    let hands = pair(forearms, WRIST);

    let part = |make: &dyn Fn(&mut Builder)| {
        let mut b = Builder::default();
        make(&mut b);
        b
    };
    let pelvis = part(&|b| {
        b.ball(Mat4::from_scale(Vec3::new(0.175, 0.125, 0.12)), sides, Vec3::ONE);
    });
    scene.hang("figure pelvis", pelvis, clothes.trousers, root);
    let chest = part(&|b| {
        let outline = [
            [0.0, -0.04],
            [0.11, -0.03],
            [0.145, 0.06],
            [0.15, 0.16],
            [0.185, 0.34],
            [0.18, 0.42],
            [0.11, 0.48],
        ];
        let outline: Vec<_> = outline.into_iter().chain([[0.0, 0.5]]).collect();
        b.turned(Mat4::from_scale(Vec3::new(1.0, 1.0, 0.68)), &outline, sides, Vec3::ONE);
    });
    scene.hang("figure torso", chest, clothes.shirt, torso);
    let face = part(&|b| {
        b.bar(Mat4::from_translation(-0.06 * Vec3::Y), 0.055, 0.14, sides, Vec3::ONE);
        let skull = Mat4::from_translation(Vec3::new(0.0, 0.15, 0.01));
        b.ball(skull * Mat4::from_scale(Vec3::new(0.085, 0.125, 0.10)), sides, Vec3::ONE);
        let nose = Mat4::from_translation(Vec3::new(0.0, 0.135, 0.11));
        b.ball(nose * Mat4::from_scale(Vec3::new(0.014, 0.025, 0.02)), sides.div_ceil(2), Vec3::ONE);
    });
    scene.hang("figure head", face, clothes.skin, head);
    let hair = part(&|b| {
        let crown = Mat4::from_translation(Vec3::new(0.0, 0.185, -0.018));
        b.ball(crown * Mat4::from_scale(Vec3::new(0.093, 0.105, 0.103)), sides, Vec3::ONE);
    });
    scene.hang("figure hair", hair, clothes.hair, head);

    // Limbs are thickest near their upper joint and reach a little beyond both, so that no joint shows a gap.
    let limb = |length: f32, upper: f32, lower: f32| {
        part(&|b| {
            let outline = [
                [0.0, -length - lower],
                [0.8 * lower, -length - 0.6 * lower],
                [lower, -length],
                [1.08 * upper, -0.3 * length],
                [upper, 0.0],
                [0.8 * upper, 0.6 * upper],
                [0.0, upper],
            ];
            b.turned(Mat4::IDENTITY, &outline, sides, Vec3::ONE);
        })
    };
    scene.hang_all("figure thigh", limb(THIGH, 0.085, 0.06), clothes.trousers, &thighs);
    scene.hang_all("figure shin", limb(SHIN, 0.058, 0.042), clothes.trousers, &shins);
    scene.hang_all("figure upper arm", limb(-ELBOW.y, 0.058, 0.043), clothes.shirt, &arms);
    scene.hang_all("figure forearm", limb(-WRIST.y, 0.042, 0.03), clothes.skin, &forearms);
    let hand = part(&|b| {
        let palm = Mat4::from_translation(Vec3::new(0.0, -0.075, 0.01));
        b.ball(palm * Mat4::from_scale(Vec3::new(0.022, 0.09, 0.045)), sides, Vec3::ONE);
    });
    scene.hang_all("figure hand", hand, clothes.skin, &hands);
    let shoe = part(&|b| {
        // Drawn sideways, x to the toes, and extruded across.
        let columns = [Vec3::Z, Vec3::Y, Vec3::NEG_X].map(|v| v.extend(0.0));
        let place =
            Mat4::from_cols(columns[0], columns[1], columns[2], Vec3::new(0.045, -ANKLE, 0.0).extend(1.0));
        let outline = [[-HEEL, 0.0], [TOES, 0.0], [TOES, 0.03], [0.06, 0.1], [-0.06, 0.1]];
        b.prism(place, &outline, 0.09, 1, Vec3::ONE);
    });
    scene.hang_all("figure foot", shoe, clothes.shoes, &feet);
    Figure { root, torso, head, thighs, shins, feet, arms, forearms }
}
