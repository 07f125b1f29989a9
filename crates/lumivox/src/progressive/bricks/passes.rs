//! The passes over bricks.
//!
//! | pass | goes over | does |
//! | --- | --- | --- |
//! | `keep` | bricks of the last frame's list | age, the window, and this frame's list |
//! | `clean` | bricks of this frame's list, once per view | cells that the view proves empty |
//! | `mark` | points of a view | makes bricks, and lists those that points fall into |
//! | `add` | points of a view | sums |
//! | `resolve` | bricks that points fell into | means |
//! | `plan` | nothing | sizes of the dispatches, three times |

use crate::gpu::{Bindings, ComputePass, GeneratedText, Gpu, GpuError, Shader};
use crate::progressive::channel::{self, ADD, AttributeChannel, MEAN, PICTURES};
use crate::progressive::cleanup::{CENTER, FOOTPRINT, by_rays};
use crate::progressive::nearest::NearestDepth;
use crate::progressive::{AttributeView, CleanupRule, SURFACE_SHIFT};
use crate::wgsl::{GRID, PACK, POINT, VIEW, VISIBILITY, linear_groups};

use super::statics::SLOTS;
use super::store::Store;

pub(super) const BRICK: &str = include_str!("brick.wgsl");
const BOXES: &str = include_str!("boxes.wgsl");

pub(super) const PLAN: Shader = Shader { name: "bricks/plan", parts: &[BRICK, include_str!("plan.wgsl")] };
pub(super) const KEEP: Shader =
    Shader { name: "bricks/keep", parts: &[GRID, BRICK, BOXES, include_str!("keep.wgsl")] };
const CLEAN: &str = include_str!("clean.wgsl");
pub(super) const CLEAN_BY_CENTER: Shader =
    Shader { name: "bricks/clean by center", parts: &[GRID, VIEW, VISIBILITY, BRICK, BOXES, CENTER, CLEAN] };
pub(super) const CLEAN_BY_FOOTPRINT: Shader =
    Shader { name: "bricks/clean by footprint", parts: &[GRID, VIEW, BRICK, BOXES, FOOTPRINT, CLEAN] };
pub(super) const MARK: Shader =
    Shader { name: "bricks/mark", parts: &[GRID, VIEW, POINT, BRICK, SLOTS, include_str!("mark.wgsl")] };

/// The text of `add` for these channels.
pub(super) fn add_text(channels: &[AttributeChannel]) -> GeneratedText {
    let (sizes, pictures) = (channel::sizes_text(channels), channel::pictures_text(channels));
    let parts = [GRID, VIEW, POINT, BRICK, &sizes, ADD, include_str!("add.wgsl"), &pictures];
    GeneratedText { name: "bricks/add", source: parts.join("\n") }
}

/// The text of `resolve` for these channels.
pub(super) fn resolve_text(channels: &[AttributeChannel]) -> GeneratedText {
    let sizes = channel::sizes_text(channels);
    let parts = [VIEW, PACK, BRICK, &sizes, MEAN, include_str!("resolve.wgsl")];
    GeneratedText { name: "bricks/resolve", source: parts.join("\n") }
}

/// Where the sizes of dispatches stand, in bytes.
const OVER_KEPT: u64 = 0;
const OVER_LISTED: u64 = 12;
const OVER_TOUCHED: u64 = 24;

#[derive(Debug)]
pub(super) struct Passes {
    begin: ComputePass,
    plan: ComputePass,
    keep: ComputePass,
    clean: ComputePass,
    nearest: Option<NearestDepth>,
    mark: ComputePass,
    add: ComputePass,
    resolve: ComputePass,
}

impl Passes {
    pub(super) fn new(gpu: &Gpu, channels: &[AttributeChannel], rule: CleanupRule) -> Result<Self, GpuError> {
        let shift = [("SURFACE_SHIFT", SURFACE_SHIFT)];
        let plan = |begins: f64| ComputePass::new(gpu, &PLAN, &[("BEGINS", begins)]);
        let (clean, nearest) = match rule {
            CleanupRule::Center => (ComputePass::new(gpu, &CLEAN_BY_CENTER, &[]), None),
            CleanupRule::Footprint | CleanupRule::Rays => {
                let constants = [shift[0], by_rays(rule)];
                (ComputePass::new(gpu, &CLEAN_BY_FOOTPRINT, &constants), Some(NearestDepth::new(gpu)))
            }
        };
        Ok(Self {
            begin: plan(1.0),
            plan: plan(0.0),
            keep: ComputePass::new(gpu, &KEEP, &[]),
            clean,
            nearest,
            mark: ComputePass::new(gpu, &MARK, &shift),
            add: ComputePass::of_text(gpu, &add_text(channels), &shift),
            resolve: ComputePass::of_text(gpu, &resolve_text(channels), &[]),
        })
    }

    /// Begins a frame: what stays, and what goes by age or with the window.
    pub(super) fn record_keep(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        store: &mut Store,
    ) -> Result<(), GpuError> {
        record_plan(&self.begin, gpu, encoder, store)?;
        let bindings = Bindings::new()
            .read("grid", &store.grid)
            .read("bricks", &store.bricks)
            .write("table", &mut store.table)
            .write("headers", &mut store.headers)
            .write("lists", &mut store.lists)
            .write("counters", &mut store.counters)
            .read("shown", &store.shown)
            .read("boxes", &store.boxes);
        self.keep.record_indirect(gpu, encoder, &bindings, &store.groups, OVER_KEPT)?;
        record_plan(&self.plan, gpu, encoder, store)
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
        let mut bindings = Bindings::new()
            .read("grid", &store.grid)
            .read("view", &view.uniform)
            .read("bricks", &store.bricks)
            .read("depth", &view.depth)
            .write("headers", &mut store.headers)
            .read("lists", &store.lists)
            .write("counters", &mut store.counters)
            .read("boxes", &store.boxes);
        if let Some(levels) = levels {
            bindings = bindings.read("levels", levels);
        }
        self.clean.record_indirect(gpu, encoder, &bindings, &store.groups, OVER_LISTED)
    }

    /// Makes and lists the bricks that a view's points fall into.
    pub(super) fn record_mark(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &AttributeView,
        store: &mut Store,
    ) -> Result<(), GpuError> {
        let Some(surfaces) = &view.surfaces else { return Ok(()) };
        let bindings = Bindings::new()
            .read("grid", &store.grid)
            .read("view", &view.uniform)
            .read("bricks", &store.bricks)
            .read("depth", &view.depth)
            .read("normal", &surfaces.normal)
            .write("table", &mut store.table)
            .write("headers", &mut store.headers)
            .write("lists", &mut store.lists)
            .write("counters", &mut store.counters);
        self.mark.record(gpu, encoder, &bindings, linear_groups(view.invocations()))
    }

    /// Adds a view's points to the sums.
    pub(super) fn record_add(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &AttributeView,
        store: &mut Store,
    ) -> Result<(), GpuError> {
        let Some(surfaces) = &view.surfaces else { return Ok(()) };
        let mut bindings = Bindings::new()
            .read("grid", &store.grid)
            .read("view", &view.uniform)
            .read("bricks", &store.bricks)
            .read("depth", &view.depth)
            .read("normal", &surfaces.normal)
            .read("table", &store.table)
            .read("headers", &store.headers)
            .write("sums", &mut store.sums);
        for (name, picture) in PICTURES.into_iter().zip(&surfaces.pictures) {
            bindings = bindings.read(name, picture);
        }
        self.add.record(gpu, encoder, &bindings, linear_groups(view.invocations()))
    }

    /// Ends a frame's injection. All its views were updated with the same number of points; `view` is any of them.
    pub(super) fn record_resolve(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &AttributeView,
        store: &mut Store,
    ) -> Result<(), GpuError> {
        record_plan(&self.plan, gpu, encoder, store)?;
        let bindings = Bindings::new()
            .read("bricks", &store.bricks)
            .read("view", &view.uniform)
            .write("headers", &mut store.headers)
            .read("lists", &store.lists)
            .write("counters", &mut store.counters)
            .write("sums", &mut store.sums)
            .write("values", &mut store.values)
            .write("shown", &mut store.shown);
        self.resolve.record_indirect(gpu, encoder, &bindings, &store.groups, OVER_TOUCHED)
    }
}

fn record_plan(
    plan: &ComputePass,
    gpu: &Gpu,
    encoder: &mut wgpu::CommandEncoder,
    store: &mut Store,
) -> Result<(), GpuError> {
    let bindings = Bindings::new()
        .read("bricks", &store.bricks)
        .write("counters", &mut store.counters)
        .write("groups", &mut store.groups);
    plan.record(gpu, encoder, &bindings, [1, 1, 1])
}
