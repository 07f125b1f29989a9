//! Fields kept in a folder, by the mesh and the settings that they were baked with.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use crate::{Baker, Field, FieldError, Mesh, Progress, Settings};

/// A folder of fields.
#[derive(Clone, Debug)]
pub struct Cache {
    folder: PathBuf,
}

/// A field from a cache.
#[derive(Clone, Debug)]
pub struct Cached {
    /// The field.
    pub field: Field,
    /// Whether it was there already.
    pub was_kept: bool,
}

impl Cache {
    /// A cache in a folder, which is made when the first field is baked.
    pub fn new(folder: impl AsRef<Path>) -> Self {
        Self { folder: folder.as_ref().to_owned() }
    }

    /// The file of a field.
    pub fn path(&self, mesh: &Mesh<'_>, settings: &Settings) -> PathBuf {
        let Settings { points, directions, mapping, storage, normals } = settings;
        let normals = if *normals { "-normals" } else { "" };
        let (key, mapping, bits) = (mesh.key(), mapping.name(), storage.bits());
        self.folder.join(format!("{key:032x}-{points}x{directions}-{mapping}-{bits}{normals}.lvf"))
    }

    /// The field of a mesh, read or else baked. A file that cannot be read, or that holds another field, is replaced.
    ///
    /// # Errors
    /// Those of [`Baker::new`] and [`Baker::bake_to_file`].
    pub fn field(
        &self,
        mesh: Mesh<'_>,
        settings: Settings,
        observe: impl FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Cached, FieldError> {
        let path = self.path(&mesh, &settings);
        if let Ok(field) = Field::load(&path)
            && field.mesh_key() == mesh.key()
            && *field.settings() == settings
        {
            return Ok(Cached { field, was_kept: true });
        }
        let baker = Baker::new(mesh, settings)?;
        fs::create_dir_all(&self.folder)
            .map_err(|error| FieldError::io(&self.folder, "making the folder", &error))?;
        baker.bake_to_file(&path, observe)?;
        Ok(Cached { field: Field::load(&path)?, was_kept: false })
    }
}
