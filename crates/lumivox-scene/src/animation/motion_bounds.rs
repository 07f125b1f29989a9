//! The box in which a clip takes place.

use glam::Mat4;
use lumivox_core::Bounds;

use crate::{Instance, Pose, Scene};

/// Moments per second at which a clip is looked at, and their smallest and largest number.
const MOMENTS_PER_SECOND: f32 = 20.0;
const MOMENTS: std::ops::RangeInclusive<f32> = 24.0..=240.0;

/// Vertices that are moved one by one, over all moments; beyond, boxes are moved, which gives a looser result.
const VERTEX_BUDGET: usize = 1 << 26;

impl Scene {
    /// The world box around all instances over a whole clip: the union over 20 moments a second, 24 at least and 240 at
    /// most, and of [`Scene::bounds`]. Equal to that if there is no such clip.
    pub fn bounds_in_motion(&self, clip: usize) -> Bounds {
        let now = self.bounds();
        let Some(duration) = self.clips().get(clip).map(|c| c.duration) else { return now };
        let count = (duration * MOMENTS_PER_SECOND).clamp(*MOMENTS.start(), *MOMENTS.end()).ceil();
        let boxes: Vec<Bounds> = self.meshes.iter().map(|m| bounds(&m.positions)).collect();
        let moving: usize = self.animation.instances.iter().map(|h| self.vertices_of(h.instance)).sum();
        let exact = moving.saturating_mul(count as usize) <= VERTEX_BUDGET;
        let mut sum = now;
        for i in 0..count as usize {
            let pose = self.pose(clip, duration * (i as f32 / count));
            sum = sum.union(&self.moved_bounds(&pose, &boxes, exact));
        }
        sum
    }

    /// Which instances stand elsewhere, or are deformed, at any of these moments of a clip; none if there is no such clip.
    pub fn moving_instances(&self, clip: usize) -> Vec<bool> {
        let mut moves = vec![false; self.instances.len()];
        let Some(duration) = self.clips().get(clip).map(|c| c.duration) else { return moves };
        let count = (duration * MOMENTS_PER_SECOND).clamp(*MOMENTS.start(), *MOMENTS.end()).ceil();
        for i in 0..count as usize {
            let pose = self.pose(clip, duration * (i as f32 / count));
            let places = self.instances.iter().zip(&pose.world_from_local);
            for (moves, (instance, place)) in moves.iter_mut().zip(places) {
                *moves |= instance.world_from_local != *place
                    || pose.deformed.iter().any(|d| d.mesh == instance.mesh);
            }
        }
        moves
    }

    fn vertices_of(&self, instance: usize) -> usize {
        self.instances.get(instance).map_or(0, |i| self.meshes[i.mesh].positions.len())
    }

    /// The box around the instances that stand elsewhere than now, or whose mesh is deformed.
    fn moved_bounds(&self, pose: &Pose, boxes: &[Bounds], exact: bool) -> Bounds {
        let mut deformed = vec![None; self.meshes.len()];
        for d in &pose.deformed {
            if let Some(slot) = deformed.get_mut(d.mesh) {
                *slot = Some(&d.positions);
            }
        }
        let mut sum = Bounds::EMPTY;
        for (Instance { mesh, world_from_local: now }, world) in
            self.instances.iter().zip(&pose.world_from_local)
        {
            let around = match deformed[*mesh] {
                Some(positions) => moved(positions, world),
                None if world == now => continue,
                None if exact => moved(&self.meshes[*mesh].positions, world),
                None => boxes[*mesh].transformed(world),
            };
            sum = sum.union(&around);
        }
        sum
    }
}

fn bounds(positions: &[[f32; 3]]) -> Bounds {
    Bounds::of_points(positions.iter().map(|&p| p.into()))
}

fn moved(positions: &[[f32; 3]], world_from_local: &Mat4) -> Bounds {
    Bounds::of_points(positions.iter().map(|&p| world_from_local.transform_point3(p.into())))
}
