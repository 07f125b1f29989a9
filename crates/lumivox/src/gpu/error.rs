//! What can go wrong on the GPU side.

/// An error of the GPU layer. Every message names the thing concerned.
#[derive(Clone, Debug, thiserror::Error)]
pub enum GpuError {
    /// No adapter at all, or none that matches the request.
    #[error(
        "no graphics adapter found{0}: a Vulkan, Metal or Direct3D 12 driver is needed (on Linux without a GPU, Mesa's software driver will do)"
    )]
    NoAdapter(String),
    /// The adapter would not give a device.
    #[error("the adapter {adapter} refused a device: {reason}")]
    NoDevice {
        /// Its name.
        adapter: String,
        /// What it said.
        reason: String,
    },
    /// The device was lost or destroyed; nothing recorded since will run.
    #[error("the graphics device is lost: {0}")]
    DeviceLost(String),
    /// A pass was given a resource it does not have, or lacks one, or reads what it writes.
    #[error("pass {pass}: {reason}")]
    Binding {
        /// Label of the pass.
        pass: &'static str,
        /// What does not fit.
        reason: String,
    },
    /// Something is larger than the device allows.
    #[error("{what} needs {needed} bytes, but this device binds at most {limit}{hint}")]
    TooLarge {
        /// What was asked for.
        what: String,
        /// Bytes it would take.
        needed: u64,
        /// Bytes there may be.
        limit: u64,
        /// The largest that would fit, as the end of the sentence; may be empty.
        hint: String,
    },
    /// wgpu rejected something; a bug of Lumivox or of its host.
    #[error("the graphics device reported: {0}")]
    Validation(String),
    /// Reading back failed.
    #[error("reading back {what} failed: {reason}")]
    Readback {
        /// Label of the resource.
        what: String,
        /// What went wrong.
        reason: String,
    },
}
