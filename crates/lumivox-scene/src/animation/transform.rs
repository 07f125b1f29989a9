//! A node's place within its parent.

use glam::{Mat4, Quat, Vec3};

/// Scale, then rotation, then translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Metres, in the parent's space.
    pub translation: Vec3,
    /// Unit quaternion.
    pub rotation: Quat,
    /// Factor per axis.
    pub scale: Vec3,
}

impl Default for Transform {
    fn default() -> Self {
        Self { translation: Vec3::ZERO, rotation: Quat::IDENTITY, scale: Vec3::ONE }
    }
}

impl Transform {
    /// A translation alone.
    pub fn at(translation: Vec3) -> Self {
        Self { translation, ..Self::default() }
    }

    /// A rotation and a translation.
    pub fn turned(rotation: Quat, translation: Vec3) -> Self {
        Self { translation, rotation, ..Self::default() }
    }

    /// The matrix `parent_from_local`.
    pub fn matrix(&self) -> Mat4 {
        // Written out: glam asserts unit quaternions, and those that were interpolated are so only nearly.
        let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| self.rotation * axis);
        let s = self.scale;
        Mat4::from_cols(
            (x * s.x).extend(0.0),
            (y * s.y).extend(0.0),
            (z * s.z).extend(0.0),
            self.translation.extend(1.0),
        )
    }

    /// The scale, rotation and translation within a matrix; shear is lost. Identity for one that is not finite or has
    /// no volume.
    pub(crate) fn of_matrix(matrix: &Mat4) -> Self {
        let volume = matrix.determinant();
        if !matrix.is_finite() || volume == 0.0 || !volume.is_finite() {
            return Self { translation: matrix.w_axis.truncate(), ..Self::default() }.or_identity();
        }
        let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
        Self { translation, rotation, scale }.or_identity()
    }

    fn or_identity(self) -> Self {
        if self.matrix().is_finite() { self } else { Self::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_matrix_is_the_usual_one_and_comes_apart_again() {
        let t = Transform {
            translation: Vec3::new(1.0, 2.0, 3.0),
            rotation: Quat::from_rotation_y(0.7),
            scale: Vec3::new(2.0, 3.0, 0.5),
        };
        let expected = Mat4::from_scale_rotation_translation(t.scale, t.rotation, t.translation);
        assert!(t.matrix().abs_diff_eq(expected, 1e-6));
        assert!(Transform::of_matrix(&expected).matrix().abs_diff_eq(expected, 1e-5));
        assert_eq!(Transform::of_matrix(&Mat4::ZERO), Transform::default());
        assert_eq!(Transform::of_matrix(&Mat4::from_cols_array(&[f32::NAN; 16])), Transform::default());
    }
}
