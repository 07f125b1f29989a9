//! What a frame did, waited for or frames later.

use crate::gpu::{Gpu, GpuError, ReadbackRing, STAMP_BYTES, Stamps, read_buffer};
use crate::progressive::channel::sum_words;

use super::ProgressiveVoxelizer;
use super::store::{BRICK_CELLS, COUNTERS, Store};

/// What a recorded frame did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameDiagnostics {
    /// The frame's number, from 1, as [`ProgressiveVoxelizer::frame`].
    pub frame: u32,
    /// Cells that hold a surface.
    pub occupied: u32,
    /// Those of them that belong to what stands still.
    pub pinned: u32,
    /// Points that fell into cells.
    pub points: u32,
    /// Cells that points fell into.
    pub injected: u32,
    /// Those of them that were empty before.
    pub new: u32,
    /// Cells that a view proved empty.
    pub cleaned: u32,
    /// Cells that no view had shown for too long.
    pub died: u32,
    /// Bricks in use, made and given back.
    pub bricks: u32,
    /// Bricks that were made.
    pub entered: u32,
    /// Bricks that were given back.
    pub left: u32,
    /// Points, and bricks of points, that found no room.
    pub refused: u32,
    /// Bytes of the volume that were read and written, where caches hold what points look up and add to, by the counts above:
    /// headers, lists and ages of all bricks in use, headers of each for each view, and of cells that points fell into the sums
    /// (added to once, read, zeroed), values, bits and age. Left out are the views' pictures and nearest depths, the boxes, and the few numbers
    /// that size the dispatches.
    pub bytes: u64,
    /// What comes on top without any cache: each point's look-ups in table and headers, twice, and its own additions to the sums, read and
    /// written, in place of one. Points on what stands still and points without room are left out.
    pub point_bytes: u64,
    /// Milliseconds: the host's own, or those between two timestamps of the device ([`FrameClock`]).
    pub milliseconds: Option<f64>,
}

/// Whether the device times frames, by a timestamp before a frame's commands and one behind them. The device must have been opened with
/// `wgpu::Features::TIMESTAMP_QUERY`; on others there are none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FrameClock {
    /// It does not: no cost.
    #[default]
    Off,
    /// It does, unless its driver is a software one ([`Gpu::is_software`]): timestamps of those are wrong for compute work.
    Timestamps,
    /// It does whatever the driver is.
    AnyTimestamps,
}

/// What a frame was recorded with.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Recorded {
    frame: u32,
    side: usize,
    views: u64,
    channels: u64,
    seen_capacity: u32,
    ages: bool,
}

/// Frames on their way to memory.
#[derive(Debug)]
pub(super) struct Watch {
    ring: ReadbackRing<Recorded>,
    stamps: Option<Stamps>,
}

const COUNTER_BYTES: u64 = 4 * COUNTERS;

impl Watch {
    pub(super) fn begin(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some(stamps) = &self.stamps {
            stamps.begin(encoder);
        }
    }

    pub(super) fn end(&mut self, encoder: &mut wgpu::CommandEncoder, store: &Store, recorded: Recorded) {
        let Self { ring, stamps } = self;
        ring.record(encoder, recorded, |encoder, to| {
            encoder.copy_buffer_to_buffer(&store.counters.raw, 0, to, 0, COUNTER_BYTES);
            if let Some(stamps) = stamps {
                stamps.end(encoder, to, COUNTER_BYTES);
            }
        });
    }

    /// The number of the oldest frame, if it is done.
    fn front(&mut self, gpu: &Gpu) -> Result<Option<u32>, GpuError> {
        Ok(self.ring.front(gpu)?.map(|recorded| recorded.frame))
    }

    fn take(&mut self, gpu: &Gpu) -> Result<Option<FrameDiagnostics>, GpuError> {
        let Some((recorded, bytes)) = self.ring.take(gpu)? else { return Ok(None) };
        let (counters, stamps) = bytes.split_at(COUNTER_BYTES as usize);
        let milliseconds = self.stamps.as_ref().and_then(|s| s.milliseconds(stamps));
        Ok(recorded.diagnostics(&bytemuck::pod_collect_to_vec(counters), milliseconds))
    }
}

impl Recorded {
    pub(super) fn new(volume: &ProgressiveVoxelizer, views: usize) -> Self {
        Self {
            frame: volume.frame,
            side: volume.side() as usize,
            views: views as u64,
            channels: volume.channels.len() as u64,
            seen_capacity: volume.settings.bricks_in_view,
            ages: volume.settings.max_age > 0,
        }
    }

    /// None of fewer counters than there are.
    fn diagnostics(&self, counters: &[u32], milliseconds: Option<f64>) -> Option<FrameDiagnostics> {
        let [
            _,
            _,
            _,
            touched,
            kept,
            injected,
            new,
            cleaned,
            died,
            entered,
            left,
            refused,
            pinned,
            points,
            ..,
        ] = *counters
        else {
            return None;
        };
        let bricks = counters[self.side];
        let touched = touched.min(self.seen_capacity);
        Some(FrameDiagnostics {
            frame: self.frame,
            occupied: kept + new - cleaned,
            pinned,
            points,
            injected,
            new,
            cleaned,
            died,
            bricks,
            entered,
            left,
            refused,
            bytes: self.bytes([bricks, touched, injected, kept]),
            point_bytes: self.point_bytes(points, injected),
            milliseconds,
        })
    }

    fn sum_bytes(&self) -> u64 {
        4 * sum_words(self.channels)
    }

    fn bytes(&self, counts: [u32; 4]) -> u64 {
        let [bricks, touched, injected, kept] = counts.map(u64::from);
        // Slot and header, and the next list.
        let keep = bricks * (4 + 20 + 4) + if self.ages { 4 * kept } else { 0 };
        // Slot, bits and number of each brick.
        let clean = self.views * bricks * (4 + 20);
        // The counts of touched bricks; of cells with points the sums added to, read and zeroed, values, bits and age.
        let resolve =
            touched * (4 + 4 * BRICK_CELLS) + injected * (3 * self.sum_bytes() + 8 * self.channels + 8 + 8);
        keep + clean + resolve
    }

    fn point_bytes(&self, points: u32, injected: u32) -> u64 {
        // `mark` reads the table, a word of pinned bits, and the last frame that the brick was touched in, which it writes.
        let mark = 4 + 4 + 8;
        // `add` reads the table, such a word again, and the place of the sums.
        let add = 4 + 4 + 4 + 2 * self.sum_bytes();
        u64::from(points) * (mark + add) - u64::from(injected) * self.sum_bytes()
    }
}

impl ProgressiveVoxelizer {
    /// What the last recorded frame did. Waits; [`Self::poll_diagnostics`] does not.
    pub fn diagnostics(&self, gpu: &Gpu, milliseconds: Option<f64>) -> Result<FrameDiagnostics, GpuError> {
        let counters: Vec<u32> = read_buffer(gpu, &self.store.counters)?;
        Ok(self.last.diagnostics(&counters, milliseconds).unwrap_or_default())
    }

    /// From the next frame on, what frames did comes to memory by itself, for [`Self::poll_diagnostics`]: by a copy of 64 bytes a frame, which
    /// nothing waits for, and by two timestamps if `clock` says so.
    pub fn keep_diagnostics(&mut self, gpu: &Gpu, clock: FrameClock) {
        let is_timed = match clock {
            FrameClock::Off => false,
            FrameClock::Timestamps => !gpu.is_software(),
            FrameClock::AnyTimestamps => true,
        };
        let stamps = is_timed.then(|| Stamps::new(gpu, "bricks/timestamps")).flatten();
        let bytes = COUNTER_BYTES + if stamps.is_some() { STAMP_BYTES } else { 0 };
        self.watch = Some(Watch { ring: ReadbackRing::new(gpu, "bricks/diagnostics", bytes), stamps });
    }

    /// What the oldest frame did that is done and has not been given yet: each frame once, in their order, usually one to three frames
    /// after it was recorded. None where [`Self::keep_diagnostics`] has not been called, and where no such frame is done. Never waits.
    ///
    /// Four frames are held. Of a host that asks less often than it records, the oldest are left out; while the device is four frames
    /// behind, the newest are. Frames whose commands are never submitted have none.
    ///
    /// # Errors
    /// A failure of the device.
    pub fn poll_diagnostics(&mut self, gpu: &Gpu) -> Result<Option<FrameDiagnostics>, GpuError> {
        self.watch.as_mut().map_or(Ok(None), |watch| watch.take(gpu))
    }

    /// The number of the frame that [`Self::poll_diagnostics`] would give.
    pub(in crate::progressive) fn polled_frame(&mut self, gpu: &Gpu) -> Result<Option<u32>, GpuError> {
        self.watch.as_mut().map_or(Ok(None), |watch| watch.front(gpu))
    }
}
