//! The passes over all cells of a dense volume.

use std::ops::Range;

use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError};
use crate::progressive::channel::{AttributeChannel, PICTURES};
use crate::progressive::cleanup::by_rays;
use crate::progressive::nearest::NearestDepth;
use crate::progressive::{AttributeView, CleanupRule, SURFACE_SHIFT};
use crate::wgsl::linear_groups;

use super::Storage;
use super::store::Store;
use super::text::{self, CELLS, CELLS_IN};

/// A pass over some of the channels.
#[derive(Debug)]
struct Part {
    channels: Range<usize>,
    clean: ComputePass,
    resolve: ComputePass,
}

#[derive(Debug)]
pub(super) struct Passes {
    parts: Vec<Part>,
    add: ComputePass,
    nearest: Option<NearestDepth>,
    cells: u32,
}

impl Passes {
    pub(super) fn new(
        gpu: &Gpu,
        channels: &[AttributeChannel],
        storage: Storage,
        rule: CleanupRule,
        cells: u32,
    ) -> Self {
        let shift = [("SURFACE_SHIFT", SURFACE_SHIFT)];
        let by_footprint = [shift[0], by_rays(rule)];
        let is_by_center = rule == CleanupRule::Center;
        let constants = if is_by_center { &[][..] } else { &by_footprint };
        let part = |channels_of: Range<usize>| Part {
            clean: ComputePass::of_text(gpu, &text::clean(storage, channels_of.clone(), rule), constants),
            resolve: ComputePass::of_text(gpu, &text::resolve(channels, storage, channels_of.clone()), &[]),
            channels: channels_of,
        };
        Self {
            parts: text::parts(channels.len()).map(part).collect(),
            add: ComputePass::of_text(gpu, &text::add(channels), &shift),
            nearest: (!is_by_center).then(|| NearestDepth::new(gpu)),
            cells,
        }
    }

    /// Clears what a view proves empty.
    pub(super) fn record_clean(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &AttributeView,
        store: &mut Store,
    ) -> Result<(), GpuError> {
        let from = (&view.uniform, &view.depth);
        let levels = self.nearest.as_mut().map(|n| n.record(gpu, encoder, from)).transpose()?;
        for Part { channels, clean, .. } in &self.parts {
            let mut bindings = Bindings::new().read("view", &view.uniform).read("depth", &view.depth);
            if let Some(levels) = levels {
                bindings = bindings.read("levels", levels);
            }
            let bindings = match store {
                Store::Buffers(volume) => bind_buffers(bindings, volume, channels.clone()),
                Store::Textures { grid, current, other } => {
                    bindings = bindings.read("grid", &*grid);
                    if channels.start > 0 {
                        bindings = bindings.read("occupied", &current[0]);
                    }
                    let names = CELLS_IN.into_iter().zip(&current[channels.clone()]);
                    let bindings = names.fold(bindings, |b, (name, texture)| b.read(name, texture));
                    let names = CELLS.into_iter().zip(&mut other[channels.clone()]);
                    names.fold(bindings, |b, (name, texture)| b.write_texture(name, texture))
                }
            };
            clean.record(gpu, encoder, &bindings, linear_groups(self.cells))?;
        }
        if let Store::Textures { current, other, .. } = store {
            std::mem::swap(current, other);
        }
        Ok(())
    }

    /// Adds a view's points to the sums.
    pub(super) fn record_add(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &AttributeView,
        store: &Store,
        sums: &mut Buffer,
    ) -> Result<(), GpuError> {
        let Some(surfaces) = &view.surfaces else { return Ok(()) };
        let bindings = Bindings::new()
            .read("grid", store.grid_uniform())
            .read("view", &view.uniform)
            .read("depth", &view.depth)
            .read("normal", &surfaces.normal)
            .write("sums", sums);
        let names = PICTURES.into_iter().zip(&surfaces.pictures);
        let bindings = names.fold(bindings, |b, (name, picture)| b.read(name, picture));
        self.add.record(gpu, encoder, &bindings, linear_groups(view.invocations()))
    }

    /// Sums to means. All views were updated with the same number of points; `view` is any of them.
    pub(super) fn record_resolve(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &AttributeView,
        store: &mut Store,
        sums: &Buffer,
    ) -> Result<(), GpuError> {
        for Part { channels, resolve, .. } in &self.parts {
            let bindings = Bindings::new().read("view", &view.uniform).read("sums", sums);
            let bindings = match store {
                Store::Buffers(volume) => {
                    let (grid, cells) = volume.current_mut();
                    let cells =
                        CELLS.into_iter().zip(cells.into_iter().skip(channels.start).take(channels.len()));
                    cells.fold(bindings.read("grid", grid), |b, (name, buffer)| b.write(name, buffer))
                }
                Store::Textures { grid, current, .. } => {
                    let names = CELLS.into_iter().zip(&mut current[channels.clone()]);
                    names.fold(bindings.read("grid", &*grid), |b, (name, texture)| {
                        b.write_texture(name, texture)
                    })
                }
            };
            resolve.record(gpu, encoder, &bindings, linear_groups(self.cells))?;
        }
        Ok(())
    }
}

/// The buffers of some channels to write, and the first to read where it is not among them.
fn bind_buffers<'a>(
    bindings: Bindings<'a>,
    volume: &'a mut crate::VolumeBuffer,
    channels: Range<usize>,
) -> Bindings<'a> {
    let (grid, cells) = volume.current_mut();
    let mut bindings = bindings.read("grid", grid);
    for (n, buffer) in cells.into_iter().enumerate() {
        if channels.contains(&n) {
            bindings = bindings.write(CELLS[n - channels.start], buffer);
        } else if n == 0 {
            bindings = bindings.read("occupied", &*buffer);
        }
    }
    bindings
}
