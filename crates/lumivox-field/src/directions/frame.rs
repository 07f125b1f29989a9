//! The frame that local directions are in.

use glam::Vec3;

/// Two tangents and the inward normal of a sample point, right-handed and orthonormal (Duff et al., *Building an
/// Orthonormal Basis, Revisited*, 2017). It depends on the point alone, so a field needs to store none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    x: Vec3,
    y: Vec3,
    inward: Vec3,
}

impl Frame {
    /// The frame of a point of the unit sphere.
    #[inline(always)]
    pub fn at(point: Vec3) -> Self {
        let n = -point;
        let sign = 1f32.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            x: Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
            y: Vec3::new(b, sign + n.y * n.y * a, -n.y),
            inward: n,
        }
    }

    /// A direction of the sphere's space in this frame.
    #[inline(always)]
    pub fn local_from_object(&self, direction: Vec3) -> Vec3 {
        Vec3::new(self.x.dot(direction), self.y.dot(direction), self.inward.dot(direction))
    }

    /// A local direction in the sphere's space.
    #[inline]
    pub fn object_from_local(&self, local: Vec3) -> Vec3 {
        local.x * self.x + local.y * self.y + local.z * self.inward
    }
}
