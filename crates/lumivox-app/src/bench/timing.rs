//! How times are taken.

use anyhow::Result;
use lumivox::gpu::{Gpu, GpuError};
use lumivox::wgpu;

use crate::clock;

/// Takes medians of repeated runs.
#[derive(Debug)]
pub(super) struct Timer<'a> {
    pub(super) gpu: &'a Gpu,
    /// Most runs.
    runs: usize,
    /// After this many milliseconds of runs there is no other.
    patience: f64,
}

/// A median, and of how many runs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Time {
    pub(super) ms: f64,
    pub(super) runs: usize,
}

impl<'a> Timer<'a> {
    pub(super) fn new(gpu: &'a Gpu, quick: bool) -> Self {
        if quick { Self { gpu, runs: 3, patience: 300.0 } } else { Self { gpu, runs: 5, patience: 1000.0 } }
    }

    /// The median of runs after a first one, in which drivers finish their compilation; one that takes longer than eight
    /// times what is spent on repeating is the only one.
    pub(super) fn median(&self, mut run: impl FnMut() -> Result<()>) -> Result<Time> {
        let mut times = Vec::new();
        let mut once = || -> Result<f64> {
            let start = clock::millis();
            run()?;
            Ok(clock::millis() - start)
        };
        let first = once()?;
        if first > 8.0 * self.patience {
            return Ok(Time { ms: first, runs: 1 });
        }
        while times.is_empty() || (times.len() < self.runs && times.iter().sum::<f64>() < self.patience) {
            times.push(once()?);
        }
        times.sort_by(f64::total_cmp);
        let n = times.len();
        Ok(Time { ms: 0.5 * (times[(n - 1) / 2] + times[n / 2]), runs: n })
    }

    /// Records, submits and waits.
    pub(super) fn submit(
        &self,
        record: impl FnOnce(&mut wgpu::CommandEncoder) -> Result<(), GpuError>,
    ) -> Result<()> {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        record(&mut encoder)?;
        self.gpu.queue.submit([encoder.finish()]);
        Ok(self.gpu.wait()?)
    }
}

/// The adapter, and how times were taken, for readers.
pub(super) fn words(gpu: &Gpu, quick: bool) -> String {
    let info = gpu.device.adapter_info();
    let driver = format!("{} {}", info.driver, info.driver_info);
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let kind = if info.device_type == wgpu::DeviceType::Cpu {
        format!("a software driver on {threads} processor threads")
    } else {
        format!("{:?}", info.device_type)
    };
    let build = if cfg!(debug_assertions) {
        " The program is a development build: what runs on the CPU is slower than in a release."
    } else {
        ""
    };
    let load = std::fs::read_to_string("/proc/loadavg").ok();
    let load = load.as_deref().and_then(|words| words.split(' ').next());
    let load = load.map_or(String::new(), |load| {
        format!(" The machine's load was {load} at the start; what others do on it is in the times of a software driver.")
    });
    let runs = if quick { "at most 3" } else { "at most 5" };
    format!(
        "Adapter: {} ({}, {}), {kind}.\n\nTimes are wall clock around recording, submission and the wait for the device; \
         the median of {runs} runs after a first one that is not counted, fewer where they are long. Time stamps of the device are \
         not used, since those of software drivers do not count compute work.{build}{load}",
        info.name,
        info.backend,
        driver.trim(),
    )
}
