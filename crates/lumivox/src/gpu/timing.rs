//! How long each stage of a frame takes.
//!
//! Timestamps of software drivers are wrong for compute work, and core WebGPU has none, so a stage is timed from outside: its
//! commands are submitted alone and waited for. That serialises the frame, so a timed frame is slower than one
//! recorded whole; it is switched on only for measuring, and only by the program that owns the queue. The clock is the
//! program's too: this crate has none, so that it runs where the standard library's does not.

use super::{Gpu, GpuError};

/// A stage's name and the milliseconds it took.
#[derive(Clone, Debug, PartialEq)]
pub struct StageTime {
    /// Path-like name: `progressive/cleanup`.
    pub stage: &'static str,
    /// Wall-clock milliseconds from submission to completion.
    pub millis: f64,
}

/// Cuts a frame into stages. Switched off it records everything into one encoder and measures nothing.
#[derive(Debug)]
pub struct StageTimer {
    clock: Option<fn() -> f64>,
    encoder: wgpu::CommandEncoder,
    times: Vec<StageTime>,
}

impl StageTimer {
    /// A frame that begins now. `clock` gives milliseconds since any fixed moment; without it nothing is measured.
    pub fn new(gpu: &Gpu, clock: Option<fn() -> f64>) -> Self {
        Self { clock, encoder: new_encoder(gpu), times: Vec::new() }
    }

    /// Records a stage.
    pub fn stage<E: From<GpuError>>(
        &mut self,
        gpu: &Gpu,
        stage: &'static str,
        record: impl FnOnce(&mut wgpu::CommandEncoder) -> Result<(), E>,
    ) -> Result<(), E> {
        // No debug group around the stage: Mesa 22.3's software driver crashes on some. Every pass has its own label.
        record(&mut self.encoder)?;
        if let Some(clock) = self.clock {
            let millis = self.flush(gpu, clock)?;
            match self.times.iter_mut().find(|t| t.stage == stage) {
                Some(time) => time.millis += millis,
                None => self.times.push(StageTime { stage, millis }),
            }
        }
        Ok(())
    }

    /// Submits what is left and returns the stages in order.
    pub fn finish(mut self, gpu: &Gpu) -> Result<Vec<StageTime>, GpuError> {
        gpu.check()?;
        let encoder = std::mem::replace(&mut self.encoder, new_encoder(gpu));
        gpu.queue.submit([encoder.finish()]);
        Ok(self.times)
    }

    fn flush(&mut self, gpu: &Gpu, clock: fn() -> f64) -> Result<f64, GpuError> {
        let encoder = std::mem::replace(&mut self.encoder, new_encoder(gpu));
        let start = clock();
        gpu.queue.submit([encoder.finish()]);
        gpu.wait()?;
        Ok(clock() - start)
    }
}

fn new_encoder(gpu: &Gpu) -> wgpu::CommandEncoder {
    gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") })
}
