//! Choosing an adapter, opening it, and learning when it is lost.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use thiserror::Error;
use wgpu::{Adapter, AdapterInfo, Backends, DeviceType, Features, Instance, Limits};

/// Storage buffers that a pass over pixels may use: twice as many as WebGPU promises, and
/// fewer than desktop adapters have. Parameters are among them: steering branches by uniform
/// buffers makes lavapipe of Mesa 22 inline them, at times past its stack.
/// Most are those of a cone level over a painted relief with four cones to a sample, counted.
pub const STORAGE_BUFFERS: u32 = 16;

/// Storage buffers that WebGPU promises everywhere. To make cone maps takes fewer.
pub const PROMISED_BUFFERS: u32 = 8;

/// What can go wrong between asking for a device and waiting for its work.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum DeviceError {
    /// No adapter fits the choice.
    #[error("there is no {choice}; there is: {there_is}")]
    NoMatch {
        /// What was asked for, in words.
        choice: String,
        /// What there is, in a line.
        there_is: String,
    },
    /// The adapter refused to open.
    #[error(
        "adapter `{name}` could not be opened: {why}; choose another with --device, or use --device cpu"
    )]
    Open {
        /// Its name.
        name: String,
        /// What it said.
        why: String,
    },
    /// The device stopped working.
    #[error(
        "the device `{name}` was lost while rendering ({why}); nothing was written. Try a smaller --size, another --device, or --device cpu"
    )]
    Lost {
        /// Its name.
        name: String,
        /// What the driver said.
        why: String,
    },
    /// The device reported an error of memory or validation.
    #[error("the device `{name}` reported: {why}")]
    Reported {
        /// Its name.
        name: String,
        /// What it said.
        why: String,
    },
}

/// Which device to render on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Choice {
    /// The best hardware adapter, else software, else the CPU executor.
    #[default]
    Auto,
    /// Hardware, or an error.
    Hardware,
    /// A software Vulkan adapter, or an error.
    Software,
    /// The CPU executor.
    Cpu,
    /// Index of `conemarch devices`.
    Index(usize),
    /// Part of an adapter's name.
    Name(String),
}

impl Choice {
    /// Reads `auto`, `gpu`, `software`, `cpu`, an index or a part of a name; `None` of
    /// nothing but blanks, which would be a part of every name.
    pub fn read(text: &str) -> Option<Self> {
        Some(match text.trim() {
            "" => return None,
            "auto" => Self::Auto,
            "gpu" => Self::Hardware,
            "software" => Self::Software,
            "cpu" => Self::Cpu,
            other => match other.parse() {
                Ok(index) => Self::Index(index),
                Err(_) => Self::Name(other.to_string()),
            },
        })
    }
}

/// All adapters of this machine, in the order of their indices.
pub struct Adapters {
    list: Vec<Adapter>,
}

impl Adapters {
    /// Looks for adapters with compute: Vulkan, Metal and Direct3D 12.
    pub fn find() -> Self {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = Backends::VULKAN | Backends::METAL | Backends::DX12;
        // Nothing here dispatches indirectly; its validation would cost a dispatch
        // and build pipelines at device creation.
        descriptor.flags = wgpu::InstanceFlags::default()
            .difference(wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL);
        let instance = Instance::new(descriptor);
        let list = pollster::block_on(instance.enumerate_adapters(Backends::all()));
        Self { list }
    }

    /// What is known of each adapter.
    pub fn iter(&self) -> impl Iterator<Item = &Adapter> {
        self.list.iter()
    }

    fn there_is(&self) -> String {
        let name = |(i, a): (usize, &Adapter)| {
            let info = a.get_info();
            format!("{i} {} ({}), ", info.name, kind(&info))
        };
        let names: String = self.list.iter().enumerate().map(name).collect();
        names + "cpu (the executor in f64, always there)"
    }

    /// All adapters with the reason to take them where none is asked for: hardware first, the
    /// fastest kind first, then software.
    pub fn in_order(&self) -> Vec<(&Adapter, &'static str)> {
        let rank = |adapter: &&Adapter| match adapter.get_info().device_type {
            DeviceType::DiscreteGpu => 0,
            DeviceType::IntegratedGpu => 1,
            DeviceType::Cpu => 3,
            _ => 2,
        };
        let mut all: Vec<&Adapter> = self.list.iter().collect();
        all.sort_by_key(rank);
        let reason = |adapter: &Adapter| match adapter.get_info().device_type {
            DeviceType::Cpu => "software Vulkan, as there is no hardware adapter",
            _ => "the best hardware adapter",
        };
        all.into_iter().map(|a| (a, reason(a))).collect()
    }

    /// Opens the first adapter in order that does, for programs that bind up to so many
    /// storage buffers; software ones are passed over unless they may serve. With the reason
    /// to take it, or that why none is.
    pub fn open_first(
        &self,
        storage_buffers: u32,
        software: bool,
    ) -> Result<(Device, String), String> {
        let mut failed = None;
        let serves = |a: &&Adapter| software || a.get_info().device_type != DeviceType::Cpu;
        for (adapter, why) in self.in_order().into_iter().filter(|(a, _)| serves(a)) {
            match Device::open(adapter, storage_buffers) {
                Ok(device) => return Ok((device, failed.unwrap_or_else(|| why.to_string()))),
                Err(e) => {
                    let name = adapter.get_info().name;
                    failed.get_or_insert(format!("as {name} did not open: {e}"));
                }
            }
        }
        let kind = if software {
            "adapter"
        } else {
            "hardware adapter"
        };
        Err(failed.unwrap_or_else(|| format!("as there is no {kind}")))
    }

    /// The adapter that a choice means, with the reason; `None` for the CPU executor.
    ///
    /// # Errors
    /// No adapter fits.
    pub fn choose(&self, choice: &Choice) -> Result<Option<(&Adapter, String)>, DeviceError> {
        let first = |fits: &dyn Fn(&AdapterInfo) -> bool| {
            let mut all = self.in_order().into_iter().map(|(adapter, _)| adapter);
            all.find(|a| fits(&a.get_info()))
        };
        let (found, asked) = match choice {
            Choice::Cpu => return Ok(None),
            Choice::Auto => {
                let first = self.in_order().into_iter().next();
                return Ok(first.map(|(adapter, why)| (adapter, why.to_string())));
            }
            Choice::Hardware => {
                let found = first(&|i| i.device_type != DeviceType::Cpu);
                (found, "hardware adapter".into())
            }
            Choice::Software => {
                let found = first(&|i| i.device_type == DeviceType::Cpu);
                (found, "software adapter".into())
            }
            Choice::Index(i) => (self.list.get(*i), format!("adapter {i}")),
            Choice::Name(part) => {
                let fits = |a: &&Adapter| {
                    let name = a.get_info().name.to_lowercase();
                    name.contains(&part.to_lowercase())
                };
                (
                    self.list.iter().find(fits),
                    format!("adapter called `{part}`"),
                )
            }
        };
        let found = found.map(|adapter| Some((adapter, "as asked".to_string())));
        found.ok_or_else(|| DeviceError::NoMatch {
            choice: asked,
            there_is: self.there_is(),
        })
    }
}

/// `discrete`, `integrated`, `virtual`, `software` or `other`.
pub fn kind(info: &AdapterInfo) -> &'static str {
    match info.device_type {
        DeviceType::DiscreteGpu => "discrete",
        DeviceType::IntegratedGpu => "integrated",
        DeviceType::VirtualGpu => "virtual",
        DeviceType::Cpu => "software",
        DeviceType::Other => "other",
    }
}

/// An open device with its queue.
pub struct Device {
    /// The wgpu device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// What the adapter says of itself.
    pub info: AdapterInfo,
    /// Nanoseconds per timestamp tick, where the adapter has timestamps.
    pub tick_ns: Option<f32>,
    trouble: Arc<Mutex<Option<DeviceError>>>,
}

impl Device {
    /// Fills a buffer with zeros.
    pub fn clear(&self, buffer: &wgpu::Buffer) {
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.clear_buffer(buffer, 0, None);
        self.queue.submit([encoder.finish()]);
    }

    /// Opens an adapter with its own limits, timestamps and f64 where it has them, for
    /// programs that bind up to so many storage buffers.
    ///
    /// # Errors
    /// It has not as many, or does not open.
    pub fn open(adapter: &Adapter, storage_buffers: u32) -> Result<Self, DeviceError> {
        let info = adapter.get_info();
        let wanted = Features::TIMESTAMP_QUERY | Features::SHADER_F64;
        let features = adapter.features() & wanted;
        let limits = adapter.limits();
        let buffers = limits.max_storage_buffers_per_shader_stage;
        // Told here, where another device or the CPU can still take its place.
        if buffers < storage_buffers {
            return Err(DeviceError::Open {
                name: info.name,
                why: format!(
                    "it has {buffers} storage buffers to a stage, and {storage_buffers} are needed"
                ),
            });
        }
        let required_limits = Limits {
            max_buffer_size: limits.max_buffer_size,
            max_storage_buffer_binding_size: limits.max_storage_buffer_binding_size,
            max_storage_buffers_per_shader_stage: storage_buffers,
            ..Limits::default()
        };
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("conemarch"),
            required_features: features,
            required_limits,
            ..Default::default()
        };
        let opened = pollster::block_on(adapter.request_device(&descriptor));
        let (device, queue) = opened.map_err(|e| DeviceError::Open {
            name: info.name.clone(),
            why: e.to_string(),
        })?;
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
        let timed = features.contains(Features::TIMESTAMP_QUERY);
        Ok(Self {
            tick_ns: timed.then(|| queue.get_timestamp_period()),
            device,
            queue,
            info,
            trouble,
        })
    }

    /// Bytes of the largest buffer that a program can use.
    pub fn most_bound(&self) -> u64 {
        let limits = self.device.limits();
        limits
            .max_storage_buffer_binding_size
            .min(limits.max_buffer_size)
    }

    /// Waits until everything submitted has run, and reports a device that was lost or
    /// complained meanwhile.
    pub fn wait(&self) -> Result<(), DeviceError> {
        let polled = self.device.poll(wgpu::PollType::Wait {
            submission_index: None,
            // No pass submits more than a bounded number of steps; a device that
            // needs longer than this for them has hung.
            timeout: Some(Duration::from_secs(120)),
        });
        self.trouble()?;
        polled.map(|_| ()).map_err(|e| self.lost(e.to_string()))
    }

    pub(super) fn lost(&self, why: impl Into<String>) -> DeviceError {
        DeviceError::Lost {
            name: self.info.name.clone(),
            why: why.into(),
        }
    }

    /// The first loss or complaint so far. What a lost device complains of is the loss.
    ///
    /// # Errors
    /// That loss or complaint.
    pub fn trouble(&self) -> Result<(), DeviceError> {
        let Some(error) = self.noted()? else {
            return Ok(());
        };
        if matches!(error, DeviceError::Reported { .. }) {
            // A loss is told only when the device is polled; its answer is in the note.
            let _ = self.device.poll(wgpu::PollType::Poll);
            if let Some(later) = self.noted()? {
                return Err(later);
            }
        }
        Err(error)
    }

    fn noted(&self) -> Result<Option<DeviceError>, DeviceError> {
        // A poisoned note means that a callback died: treat it as a loss.
        let slot = self.trouble.lock();
        let slot = slot.map_err(|_| self.lost("its error report was interrupted"))?;
        Ok(slot.clone())
    }
}

/// Notes an error of a device. A loss outweighs complaints, the first complaint the later ones.
fn note(slot: &Mutex<Option<DeviceError>>, error: DeviceError) {
    if let Ok(mut slot) = slot.lock()
        && (matches!(error, DeviceError::Lost { .. }) || slot.is_none())
    {
        *slot = Some(error);
    }
}
