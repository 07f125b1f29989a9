//! Volumes in memory: what a GPU volume reads back to, and what files are written from.

use glam::Vec4;

use crate::Grid;

/// Named channels of four numbers per cell over one grid, cells in the order of [`Grid::index`].
#[derive(Clone, Debug, PartialEq)]
pub struct HostVolume {
    /// The cells.
    pub grid: Grid,
    channels: Vec<(String, Vec<Vec4>)>,
}

impl HostVolume {
    /// A volume without channels.
    pub fn new(grid: Grid) -> Self {
        Self { grid, channels: Vec::new() }
    }

    /// Adds a channel, or replaces the one of the same name.
    ///
    /// # Panics
    /// When `values` does not have one entry per cell.
    pub fn insert(&mut self, name: &str, values: Vec<Vec4>) {
        assert_eq!(values.len() as u64, self.grid.cell_count(), "channel {name} needs one value per cell");
        self.channels.retain(|(n, _)| n != name);
        self.channels.push((name.to_owned(), values));
    }

    /// The values of a channel, one per cell.
    pub fn channel(&self, name: &str) -> Option<&[Vec4]> {
        self.channels.iter().find(|(n, _)| n == name).map(|(_, values)| values.as_slice())
    }

    /// The names of the channels.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.channels.iter().map(|(name, _)| name.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Bounds;
    use glam::Vec3;

    #[test]
    fn channels_are_found_by_name_and_replaced() {
        let grid = Grid::fit(&Bounds::new(Vec3::ZERO, Vec3::ONE), 2).unwrap();
        let mut volume = HostVolume::new(grid);
        volume.insert("normal", vec![Vec4::ZERO; 8]);
        volume.insert("normal", vec![Vec4::ONE; 8]);
        assert_eq!(volume.channel("normal"), Some(&[Vec4::ONE; 8][..]));
        assert_eq!(volume.names().count(), 1);
        assert_eq!(volume.channel("albedo"), None);
    }
}
