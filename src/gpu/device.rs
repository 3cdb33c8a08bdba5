//! A device, and how its loss is noticed.

use std::pin::pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll, Waker};

use thiserror::Error;
use wgpu::{Adapter, AdapterInfo, DeviceType, Features};

use crate::base::clock::Clock;

/// What can go wrong with a device.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum DeviceError {
    /// No adapter fits the choice.
    #[error("there is no {choice}; there is: {there_is}")]
    NoMatch {
        /// The choice, in words.
        choice: String,
        /// The adapters of this machine.
        there_is: String,
    },
    /// The adapter refused to open.
    #[error(
        "adapter `{name}` could not be opened: {why}; choose another with --device, or use --device cpu"
    )]
    Open {
        /// Its name.
        name: String,
        /// The reason.
        why: String,
    },
    /// The device stopped working.
    #[error(
        "the device `{name}` was lost while rendering ({why}); nothing was written. Try a smaller --size, another --device, or --device cpu"
    )]
    Lost {
        /// Its name.
        name: String,
        /// The driver's reason.
        why: String,
    },
    /// The device reported an error of memory or validation.
    #[error("the device `{name}` reported: {why}")]
    Reported {
        /// Its name.
        name: String,
        /// The reason.
        why: String,
    },
}

/// An open device with its queue.
pub struct Device {
    /// The wgpu device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// The adapter's description of itself.
    pub info: AdapterInfo,
    /// Nanoseconds per timestamp tick, if the adapter has timestamps.
    pub tick_ns: Option<f32>,
    /// The adapter, if this program has opened the device.
    #[cfg(feature = "cli")]
    pub(super) opened: Option<Adapter>,
    /// Milliseconds since any fixed time.
    pub(super) clock: Clock,
    trouble: Arc<Mutex<Option<DeviceError>>>,
    /// Four bytes, which are written to ask whether the device is there.
    probe: wgpu::Buffer,
    /// Held by the thread that submits, or that configures a surface.
    turn: Mutex<()>,
}

impl Device {
    /// Whether this is a graphics card of its own.
    pub fn is_discrete(&self) -> bool {
        self.info.device_type == DeviceType::DiscreteGpu
    }

    /// Takes over a device that a host has opened, a window for example. Its callbacks for a
    /// loss and for errors are replaced.
    pub fn adopt(
        adapter: &Adapter,
        device: wgpu::Device,
        queue: wgpu::Queue,
        clock: Clock,
    ) -> Self {
        let info = adapter.get_info();
        let trouble = Arc::new(Mutex::new(None));
        let (slot, name) = (trouble.clone(), info.name.clone());
        device.set_device_lost_callback(move |reason, why| {
            let why = format!("{reason:?}: {why}").to_lowercase();
            let name = name.clone();
            note(&slot, DeviceError::Lost { name, why });
        });
        let (slot, name) = (trouble.clone(), info.name.clone());
        device.on_uncaptured_error(Arc::new(move |e: wgpu::Error| {
            let text = e.to_string();
            let words: Vec<&str> = text.split_whitespace().collect();
            let (name, why) = (name.clone(), words.join(" "));
            note(&slot, DeviceError::Reported { name, why });
        }));
        let probe = probe(&device, wgpu::BufferUsages::COPY_DST);
        let timed = device.features().contains(Features::TIMESTAMP_QUERY);
        Self {
            tick_ns: timed.then(|| queue.get_timestamp_period()),
            device,
            queue,
            info,
            #[cfg(feature = "cli")]
            opened: None,
            clock,
            trouble,
            probe,
            turn: Mutex::default(),
        }
    }

    /// Whether the device is lost already, though it has not told so. It tells that once it has
    /// nothing more to do, and reports other errors before. A browser answers too late, and then
    /// this is `false`.
    fn is_gone(&self) -> bool {
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        self.queue.write_buffer(&self.probe, 0, &[0; 4]);
        now(scope.pop()).flatten().is_some()
    }

    /// The same, once an error has come: it makes a buffer. A lost device makes invalid ones, and
    /// only their use is an error.
    fn makes_nothing(&self) -> bool {
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let buffer = probe(&self.device, wgpu::BufferUsages::MAP_READ);
        buffer.map_async(wgpu::MapMode::Read, .., |_| {});
        now(scope.pop()).flatten().is_some()
    }

    /// Does something while no other thread submits. wgpu fails if a surface is configured at the
    /// time of a submission, and a map may be in the making.
    pub fn alone<T>(&self, does: impl FnOnce() -> T) -> T {
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        does()
    }

    /// Submits commands.
    pub fn submit(&self, encoder: wgpu::CommandEncoder) -> wgpu::SubmissionIndex {
        let commands = encoder.finish();
        self.alone(|| self.queue.submit([commands]))
    }

    /// Bytes of the largest buffer that a program can bind.
    pub fn most_bound(&self) -> u64 {
        let limits = self.device.limits();
        limits
            .max_storage_buffer_binding_size
            .min(limits.max_buffer_size)
    }

    /// Takes in what the device reports, without waiting.
    ///
    /// # Errors
    /// The device was lost or reported an error.
    pub fn check(&self) -> Result<(), DeviceError> {
        let polled = self.device.poll(wgpu::PollType::Poll);
        if let Some(error) = self.noted()? {
            return Err(error);
        }
        polled.map(|_| ()).map_err(|e| self.lost(e.to_string()))
    }

    /// The same, and asks the device whether it is lost.
    ///
    /// # Errors
    /// The device was lost or reported an error.
    pub(super) fn check_well(&self) -> Result<(), DeviceError> {
        self.check()?;
        match self.is_gone() {
            true => Err(self.note_loss("it was destroyed")),
            false => Ok(()),
        }
    }

    /// Whether this program has opened the device, so that it can open it again.
    pub(super) fn is_opened_here(&self) -> bool {
        #[cfg(feature = "cli")]
        return self.opened.is_some();
        #[cfg(not(feature = "cli"))]
        false
    }

    /// Forgets a reported error. A loss stays.
    pub(super) fn forget_reported(&self) {
        if let Ok(Some(DeviceError::Reported { .. })) = self.noted()
            && let Ok(mut slot) = self.trouble.lock()
        {
            *slot = None;
        }
    }

    pub(super) fn lost(&self, why: impl AsRef<str>) -> DeviceError {
        let words: Vec<&str> = why.as_ref().split_whitespace().collect();
        DeviceError::Lost {
            name: self.info.name.clone(),
            why: words.join(" "),
        }
    }

    fn note_loss(&self, why: &str) -> DeviceError {
        let error = self.lost(why);
        note(&self.trouble, error.clone());
        error
    }

    /// Checks that the device works. A loss is reported before any other error.
    ///
    /// # Errors
    /// The device was lost or reported an error.
    pub fn trouble(&self) -> Result<(), DeviceError> {
        self.noted()?.map_or(Ok(()), Err)
    }

    fn noted(&self) -> Result<Option<DeviceError>, DeviceError> {
        // The lock is poisoned if a callback panicked.
        let slot = self.trouble.lock();
        let slot = slot.map_err(|_| self.lost("its error report was interrupted"))?;
        let noted = slot.clone();
        drop(slot);
        Ok(match noted {
            Some(DeviceError::Reported { why, .. }) if self.is_gone() || self.makes_nothing() => {
                Some(self.note_loss(&why))
            }
            other => other,
        })
    }
}

/// The answer of a future that is ready at once, as an error scope is outside of browsers. In a
/// browser the device reports the error later.
pub(super) fn now<T>(future: impl Future<Output = T>) -> Option<T> {
    let mut context = Context::from_waker(Waker::noop());
    match pin!(future).poll(&mut context) {
        Poll::Ready(answer) => Some(answer),
        Poll::Pending => None,
    }
}

/// A buffer to ask a device with.
fn probe(device: &wgpu::Device, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("probe"),
        size: 4,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// Notes an error of a device. A loss replaces any other error; otherwise the first one stays.
fn note(slot: &Mutex<Option<DeviceError>>, error: DeviceError) {
    if let Ok(mut slot) = slot.lock()
        && (matches!(error, DeviceError::Lost { .. }) || slot.is_none())
    {
        *slot = Some(error);
    }
}
