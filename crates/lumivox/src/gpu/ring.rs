//! Small numbers of each frame back to memory, frames later and without waiting.

use std::collections::VecDeque;
use std::sync::{Arc, OnceLock};

use super::{Gpu, GpuError};

/// Frames that a ring holds: as many as are under way at most on usual hosts, and one.
const SLOTS: usize = 4;

/// Buffers that frames are copied to, mapped when their commands are done, and read in the order they were recorded in.
#[derive(Debug)]
pub(crate) struct ReadbackRing<T> {
    free: Vec<wgpu::Buffer>,
    /// Oldest first.
    flights: VecDeque<Flight<T>>,
}

#[derive(Debug)]
struct Flight<T> {
    buffer: wgpu::Buffer,
    /// Whether mapping went well, once that is known. Commands that are yet to be done hold it too.
    mapped: Arc<OnceLock<bool>>,
    about: T,
}

/// What has become of a frame.
enum State {
    UnderWay,
    Mapped,
    /// Its commands were thrown away, or failed.
    Lost,
}

impl<T> Flight<T> {
    fn state(&mut self) -> State {
        match Arc::get_mut(&mut self.mapped).map(|mapped| mapped.get()) {
            None => State::UnderWay,
            Some(Some(true)) => State::Mapped,
            Some(_) => State::Lost,
        }
    }
}

impl<T> ReadbackRing<T> {
    /// Room for frames of so many bytes, a multiple of 4.
    pub(crate) fn new(gpu: &Gpu, label: &str, bytes: u64) -> Self {
        let buffer = |_| {
            gpu.count_created();
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: bytes,
                usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        Self { free: (0..SLOTS).map(buffer).collect(), flights: VecDeque::with_capacity(SLOTS) }
    }

    /// Lets a frame copy what it has to say. Frames that are done and that nobody has asked for give way; while all are
    /// under way, this one is passed over.
    pub(crate) fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        about: T,
        copy: impl FnOnce(&mut wgpu::CommandEncoder, &wgpu::Buffer),
    ) {
        let Some(buffer) = self.free.pop().or_else(|| self.oldest_done()) else { return };
        copy(encoder, &buffer);
        let mapped = Arc::new(OnceLock::new());
        let answer = mapped.clone();
        encoder.map_buffer_on_submit(&buffer, wgpu::MapMode::Read, .., move |result| {
            // It is set once, here.
            let _ = answer.set(result.is_ok());
        });
        self.flights.push_back(Flight { buffer, mapped, about });
    }

    /// Takes the room of the oldest frame that is not under way.
    fn oldest_done(&mut self) -> Option<wgpu::Buffer> {
        let n = self.flights.iter_mut().position(|flight| !matches!(flight.state(), State::UnderWay))?;
        let mut flight = self.flights.remove(n)?;
        if let State::Mapped = flight.state() {
            flight.buffer.unmap();
        }
        Some(flight.buffer)
    }

    /// The oldest frame, if it is done.
    pub(crate) fn front(&mut self, gpu: &Gpu) -> Result<Option<&T>, GpuError> {
        gpu.check()?;
        // Runs what is due and does not wait; browsers do it by themselves.
        if let Err(e) = gpu.device.poll(wgpu::PollType::Poll) {
            gpu.report_failure(GpuError::DeviceLost(e.to_string()));
            gpu.check()?;
        }
        while let Some(mut flight) = self.flights.pop_front() {
            match flight.state() {
                State::Lost => self.free.push(flight.buffer),
                State::UnderWay => {
                    self.flights.push_front(flight);
                    return Ok(None);
                }
                State::Mapped => {
                    self.flights.push_front(flight);
                    return Ok(self.flights.front().map(|flight| &flight.about));
                }
            }
        }
        Ok(None)
    }

    /// Takes the oldest frame, if it is done, with its bytes.
    pub(crate) fn take(&mut self, gpu: &Gpu) -> Result<Option<(T, Vec<u8>)>, GpuError> {
        if self.front(gpu)?.is_none() {
            return Ok(None);
        }
        let Some(Flight { buffer, about, .. }) = self.flights.pop_front() else { return Ok(None) };
        let bytes = buffer.get_mapped_range(..).map(|bytes| bytes.to_vec());
        buffer.unmap();
        self.free.push(buffer);
        let failed = |e: wgpu::MapRangeError| GpuError::Readback {
            what: "a frame's numbers".to_owned(),
            reason: e.to_string(),
        };
        Ok(Some((about, bytes.map_err(failed)?)))
    }
}
