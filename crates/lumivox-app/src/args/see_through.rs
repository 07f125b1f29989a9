//! What light comes through: glass, and the shadows of leaves.

use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use lumivox_render::{Environment, GlassIssue, GlassNote, GlassSettings, Layer, Renderer, Settings};

#[derive(Debug, Args)]
pub(crate) struct SeeThroughArgs {
    /// What materials of glass are like.
    #[arg(long, value_enum, default_value = "refract")]
    pub(crate) glass: GlassArg,
    /// Cells between the nearest and the farthest glass of a pixel, of which its thickness is counted.
    #[arg(long, value_name = "N", default_value_t = GlassSettings::default().slices, value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub(crate) glass_slices: u32,
    /// What glass mirrors, and sees where it looks out of the picture.
    #[arg(long, value_enum, default_value = "sky")]
    pub(crate) environment: EnvironmentArg,
    /// All glass sees the environment alone, and not what stands behind it.
    #[arg(long)]
    pub(crate) environment_only: bool,
    /// Index of refraction of all glass, in place of the scene's.
    #[arg(long, value_name = "1..4")]
    pub(crate) ior: Option<f32>,
    /// How often a metre of any glass bends light as much as its first surface does, in place of the scene's.
    #[arg(long, value_name = "1/METRE")]
    pub(crate) bend: Option<f32>,
    /// Radians by which a metre of any glass blurs, in place of the scene's.
    #[arg(long, value_name = "RADIANS/METRE")]
    pub(crate) frost: Option<f32>,
    /// With --shadows transmittance light takes the colour of the leaves that it comes through.
    #[arg(long)]
    pub(crate) shadow_colors: bool,
    /// With --shadows volumes slicemaps find what no pixel needs, which is then not drawn; the picture is the same.
    #[arg(long)]
    pub(crate) cull_volumes: bool,
    /// How --shadows transmittance counts the slice that a point lies in.
    #[arg(long, value_enum, default_value = "steps")]
    pub(crate) shadow_filter: ShadowFilterArg,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum GlassArg {
    /// Surfaces like any other.
    Opaque,
    /// Seen through, by how much of it a ray crosses.
    Refract,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum EnvironmentArg {
    /// The scene's sky.
    Sky,
    /// A made one: bright above, dark below, two lamps.
    Studio,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ShadowFilterArg {
    /// Not at all: whole slices, as the paper.
    Steps,
    /// In part, by how deep the point lies in it.
    Linear,
}

impl SeeThroughArgs {
    /// Refuses numbers that no glass has.
    pub(crate) fn check(&self) -> Result<()> {
        if self.ior.is_some_and(|ior| !(1.0..=4.0).contains(&ior)) {
            bail!("--ior must be 1 to 4");
        }
        if [self.bend, self.frost].into_iter().flatten().any(|v| !(0.0..=1e6).contains(&v)) {
            bail!("--bend and --frost must be 0 to 1e6");
        }
        Ok(())
    }

    /// The settings with what is said here.
    pub(crate) fn with(&self, settings: Settings) -> Settings {
        let glass = GlassSettings {
            slices: self.glass_slices,
            uses_picture: !self.environment_only,
            environment: match self.environment {
                EnvironmentArg::Sky => Environment::Sky,
                EnvironmentArg::Studio => Environment::Studio,
            },
            ..GlassSettings::default()
        };
        Settings {
            glass: (self.glass == GlassArg::Refract).then_some(glass),
            culls_volumes: self.cull_volumes,
            leaf_shadows: settings.leaf_shadows.map(|leaves| lumivox_render::LeafShadowSettings {
                is_colored: self.shadow_colors,
                interpolates: self.shadow_filter == ShadowFilterArg::Linear,
                ..leaves
            }),
            ..settings
        }
    }

    /// Whether anything is said of glass.
    pub(crate) fn speaks_of_glass(&self) -> bool {
        [self.ior, self.bend, self.frost].iter().any(Option::is_some)
            || self.glass_slices != GlassSettings::default().slices
            || self.environment != EnvironmentArg::Sky
            || self.environment_only
    }

    /// Warns of what is said of glass and shadows that the scene does not have.
    fn warn_of_nothing(&self, renderer: &Renderer) {
        let Settings { glass, leaf_shadows, volume_shadows, layer, .. } = renderer.settings();
        let asks = self.speaks_of_glass() || *layer == Layer::Thickness;
        if asks && glass.is_some() && renderer.glass().is_empty() {
            tracing::warn!("the scene has no glass: its options do nothing, and --layer thickness is black");
        }
        if *volume_shadows && !renderer.has_volume_shadows() {
            tracing::warn!(
                "--shadows volumes does nothing: the scene has no sun, spot or point light, or nothing opaque"
            );
        }
        if leaf_shadows.is_some() && !renderer.has_leaf_shadows() {
            tracing::warn!(
                "--shadows transmittance does nothing: no surface of the scene has holes or is an absorber, or it has no sun, spot or \
                 point light"
            );
        }
    }

    /// Puts what is said here in place of what the scene says, and warns of glass that is not shown as it is described.
    pub(crate) fn apply(&self, renderer: &mut Renderer, scene: &lumivox_scene::Scene) {
        self.warn_of_nothing(renderer);
        let name = |material: usize| match scene.materials.get(material).map_or("", |m| m.name.as_str()) {
            "" => format!("number {material}"),
            name => format!("'{name}'"),
        };
        for GlassNote { material, issue } in renderer.glass_notes() {
            let what = match *issue {
                GlassIssue::Open { edges } => format!(
                    "is not closed ({edges} open edges): it is shown as a thin pane; \"close_holes\" in a scene file puts lids on holes"
                ),
                GlassIssue::InsideOut { meshes: 1 } => {
                    "has a mesh whose faces look inward: it is shown turned round".to_owned()
                }
                GlassIssue::InsideOut { meshes } => {
                    format!("has {meshes} meshes whose faces look inward: they are shown turned round")
                }
                GlassIssue::LooksLike { material } => {
                    format!("is shown like {}: a picture has four kinds of glass", name(material))
                }
            };
            tracing::warn!("glass {} {what}", name(*material));
        }
        for (n, kind) in renderer.glass().to_vec().into_iter().enumerate() {
            let mut glass = kind.glass;
            glass.ior = self.ior.unwrap_or(glass.ior);
            glass.bend = self.bend.unwrap_or(glass.bend);
            glass.frost = self.frost.unwrap_or(glass.frost);
            renderer.set_glass(n, glass);
        }
    }
}
