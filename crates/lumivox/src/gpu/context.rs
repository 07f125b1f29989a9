//! The device, where it comes from, and what it may be asked to do.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock};

use super::{GpuError, Sampler, Texture, TextureOptions};

/// What the device is asked for.
///
/// | tier | limits | features | runs on |
/// | --- | --- | --- | --- |
/// | `Core` | WebGPU's defaults: 128 MiB a binding, 8 storage buffers a stage, 32 colour bytes a sample | none | everything, browsers too |
/// | `Native` | all the adapter has | timestamps where it has them | desktop adapters |
///
/// Everything Lumivox promises runs on `Core`; `Native` allows larger grids and GPU timestamps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tier {
    /// WebGPU with default limits and no optional feature.
    Core,
    /// More, when the adapter has it.
    Native,
}

/// Which adapter to take.
#[derive(Clone, Debug, Default)]
pub struct AdapterChoice {
    /// Part of the adapter's name, upper or lower case alike. Without it: a discrete GPU before an integrated one
    /// before a software driver.
    pub name: Option<String>,
}

/// A device and its queue, shared by cloning.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The wgpu device.
    pub device: wgpu::Device,
    /// The wgpu queue.
    pub queue: wgpu::Queue,
    tier: Tier,
    failure: Arc<Mutex<Option<GpuError>>>,
    created: Arc<AtomicU64>,
    white: Arc<OnceLock<(Texture, Sampler)>>,
}

impl Gpu {
    /// A device of our own on the best adapter that matches.
    pub async fn new(choice: &AdapterChoice, tier: Tier) -> Result<Self, GpuError> {
        let mut adapters = Self::adapters().await;
        if let Some(name) = &choice.name {
            let wanted = name.to_lowercase();
            adapters.retain(|a| a.get_info().name.to_lowercase().contains(&wanted));
        }
        let wanted = choice.name.as_ref().map(|n| format!(" with {n:?} in its name")).unwrap_or_default();
        let adapter = adapters.into_iter().next().ok_or(GpuError::NoAdapter(wanted))?;
        let descriptor = device_descriptor(&adapter, tier);
        let (device, queue) = adapter
            .request_device(&descriptor)
            .await
            .map_err(|e| GpuError::NoDevice { adapter: adapter.get_info().name, reason: e.to_string() })?;
        let gpu = Self::from_device(device, queue, tier);
        gpu.watch();
        Ok(gpu)
    }

    /// As [`Self::new`], waiting for it. Native only.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn new_blocking(choice: &AdapterChoice, tier: Tier) -> Result<Self, GpuError> {
        pollster::block_on(Self::new(choice, tier))
    }

    /// A device that the host already has. Its error and device-lost callbacks stay the host's; a host that learns
    /// of a loss says so with [`Self::report_failure`], and every later `record` call returns the error.
    pub fn from_device(device: wgpu::Device, queue: wgpu::Queue, tier: Tier) -> Self {
        Self { device, queue, tier, failure: Arc::default(), created: Arc::default(), white: Arc::default() }
    }

    /// All adapters, the most capable kind first.
    pub async fn adapters() -> Vec<wgpu::Adapter> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let mut adapters = instance.enumerate_adapters(wgpu::Backends::all()).await;
        adapters.sort_by_key(|a| match a.get_info().device_type {
            wgpu::DeviceType::DiscreteGpu => 0,
            wgpu::DeviceType::IntegratedGpu => 1,
            wgpu::DeviceType::VirtualGpu => 2,
            wgpu::DeviceType::Other => 3,
            wgpu::DeviceType::Cpu => 4,
        });
        adapters
    }

    /// The tier this device was opened with.
    pub fn tier(&self) -> Tier {
        self.tier
    }

    /// Whether the adapter is a software driver, whose compute timestamps cannot be trusted.
    pub fn is_software(&self) -> bool {
        self.device.adapter_info().device_type == wgpu::DeviceType::Cpu
    }

    /// The first failure since the device was made, if any. Called by every `record`; costs a lock and no GPU work.
    pub fn check(&self) -> Result<(), GpuError> {
        let failure = self.failure.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        failure.as_ref().map_or(Ok(()), |e| Err(e.clone()))
    }

    /// Tells Lumivox that the device failed. The first report is kept.
    pub fn report_failure(&self, error: GpuError) {
        report(&self.failure, error);
    }

    /// Waits until the device has done all it was given, and returns what went wrong meanwhile. Never called inside a
    /// frame. Native only: a browser does not let a page wait.
    pub fn wait(&self) -> Result<(), GpuError> {
        if let Err(e) = self.device.poll(wgpu::PollType::wait_indefinitely()) {
            self.report_failure(GpuError::DeviceLost(e.to_string()));
        }
        self.check()
    }

    /// How many GPU objects (buffers, textures, samplers, bind groups) Lumivox has made on this device so far.
    /// Stands still while frames are recorded with the same resources.
    pub fn created_objects(&self) -> u64 {
        self.created.load(Ordering::Relaxed)
    }

    /// A white texel and a sampler that filters, made once: what stands where a material has no texture.
    pub(crate) fn white(&self) -> Result<&(Texture, Sampler), GpuError> {
        if let Some(white) = self.white.get() {
            return Ok(white);
        }
        let options = TextureOptions {
            size: [1, 1],
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            mips: 1,
        };
        let texture = Texture::new(self, "white", options)?;
        self.queue.write_texture(
            texture.raw.as_image_copy(),
            &[255; 4],
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4), rows_per_image: None },
            wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
        );
        let descriptor = wgpu::SamplerDescriptor {
            label: Some("linear"),
            address_mode_u: wgpu::AddressMode::Repeat,
            address_mode_v: wgpu::AddressMode::Repeat,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        };
        Ok(self.white.get_or_init(|| (texture, Sampler::new(self, &descriptor))))
    }

    pub(crate) fn count_created(&self) -> u64 {
        self.created.fetch_add(1, Ordering::Relaxed)
    }

    /// Fails when a storage buffer of `bytes` cannot be bound, with the numbers.
    pub fn check_binding_size(&self, what: &str, bytes: u64, hint: &str) -> Result<(), GpuError> {
        let limits = self.device.limits();
        let limit = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        if bytes > limit {
            return Err(GpuError::TooLarge {
                what: what.to_owned(),
                needed: bytes,
                limit,
                hint: hint.to_owned(),
            });
        }
        Ok(())
    }

    fn watch(&self) {
        let failure = self.failure.clone();
        self.device.set_device_lost_callback(move |reason, message| {
            report(&failure, GpuError::DeviceLost(format!("{reason:?}. {message}")));
        });
        let failure = self.failure.clone();
        self.device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            report(&failure, GpuError::Validation(error.to_string()));
        }));
    }
}

fn report(failure: &Mutex<Option<GpuError>>, error: GpuError) {
    failure.lock().unwrap_or_else(std::sync::PoisonError::into_inner).get_or_insert(error);
}

fn device_descriptor(adapter: &wgpu::Adapter, tier: Tier) -> wgpu::DeviceDescriptor<'static> {
    let (required_features, required_limits) = match tier {
        Tier::Core => (wgpu::Features::empty(), wgpu::Limits::default()),
        Tier::Native => (adapter.features() & wgpu::Features::TIMESTAMP_QUERY, adapter.limits()),
    };
    wgpu::DeviceDescriptor {
        label: Some("lumivox"),
        required_features,
        required_limits,
        ..Default::default()
    }
}
