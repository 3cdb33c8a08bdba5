//! Adapters: how one is chosen and opened.

use wgpu::{Adapter, AdapterInfo, Backends, DeviceType, Features, Instance, Limits};

use crate::base::clock::clock;
use crate::gpu::device::{Device, DeviceError};

/// The device to render on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Choice {
    /// The best hardware adapter, else a software adapter, else the CPU executor.
    #[default]
    Auto,
    /// A hardware adapter, or an error.
    Hardware,
    /// A software Vulkan adapter, or an error.
    Software,
    /// The CPU executor.
    Cpu,
    /// An index of `conemarch devices`.
    Index(usize),
    /// A part of an adapter's name.
    Name(String),
}

impl Choice {
    /// Reads `auto`, `gpu`, `software`, `cpu`, an index or a part of a name. Returns `None` for
    /// blanks, as these are a part of every name.
    pub fn read(text: &str) -> Option<Self> {
        Some(match text.trim() {
            "" => return None,
            "auto" => Self::Auto,
            "gpu" => Self::Hardware,
            "software" => Self::Software,
            "cpu" => Self::Cpu,
            other => other
                .parse()
                .map_or_else(|_| Self::Name(other.to_string()), Self::Index),
        })
    }
}

/// All adapters of this machine, in the order of their indices.
pub struct Adapters {
    instance: Instance,
    list: Vec<Adapter>,
}

impl Adapters {
    /// Finds all adapters of Vulkan, Metal and Direct3D 12.
    pub fn find() -> Self {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = Backends::VULKAN | Backends::METAL | Backends::DX12;
        // The validation of indirect dispatches costs time. The sizes of these are bounded in
        // `wgsl/pass/arrange.wgsl`.
        descriptor.flags = wgpu::InstanceFlags::default()
            .difference(wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL);
        let instance = Instance::new(descriptor);
        let list = pollster::block_on(instance.enumerate_adapters(Backends::all()));
        Self { instance, list }
    }

    /// What the adapters belong to, for the surface of a window.
    pub fn instance(&self) -> &Instance {
        &self.instance
    }

    /// Each adapter.
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

    /// All adapters, best first: discrete and integrated hardware, other hardware, software.
    /// Each has the reason to choose it.
    pub fn in_order(&self) -> Vec<(&Adapter, &'static str)> {
        let of = |adapter: &Adapter| match adapter.get_info().device_type {
            DeviceType::DiscreteGpu => (0, HARDWARE),
            DeviceType::IntegratedGpu => (1, HARDWARE),
            DeviceType::Cpu => (3, SOFTWARE),
            _ => (2, HARDWARE),
        };
        let mut all: Vec<&Adapter> = self.list.iter().collect();
        all.sort_by_key(|adapter| of(adapter).0);
        all.into_iter().map(|a| (a, of(a).1)).collect()
    }

    /// Opens the first adapter in order that opens, with the reason to choose it. Software adapters count only if `software` is set.
    ///
    /// # Errors
    /// Why no adapter was opened.
    pub fn open_first(&self, software: bool) -> Result<(Device, String), String> {
        let mut failed = None;
        let serves = |a: &&Adapter| software || a.get_info().device_type != DeviceType::Cpu;
        for (adapter, why) in self.in_order().into_iter().filter(|(a, _)| serves(a)) {
            match Device::open(adapter) {
                Ok(device) => return Ok((device, failed.unwrap_or_else(|| why.to_string()))),
                Err(e) => {
                    let name = adapter.get_info().name;
                    failed.get_or_insert(format!("as {name} did not open: {e}"));
                }
            }
        }
        let kind = if software { "" } else { "hardware " };
        Err(failed.unwrap_or_else(|| format!("as there is no {kind}adapter")))
    }

    /// The adapter of a choice, with the reason; `None` for the CPU executor.
    ///
    /// # Errors
    /// No adapter fits.
    pub fn choose(&self, choice: &Choice) -> Result<Option<(&Adapter, String)>, DeviceError> {
        let ordered = self.in_order();
        let first = |hardware: bool| {
            let mut all = ordered.iter().map(|(adapter, _)| *adapter);
            all.find(|a| (a.get_info().device_type != DeviceType::Cpu) == hardware)
        };
        let (found, asked) = match choice {
            Choice::Cpu => return Ok(None),
            Choice::Auto => {
                let best = ordered.first();
                return Ok(best.map(|(adapter, why)| (*adapter, why.to_string())));
            }
            Choice::Hardware => (first(true), "hardware adapter".into()),
            Choice::Software => (first(false), "software adapter".into()),
            Choice::Index(i) => (self.list.get(*i), format!("adapter {i}")),
            Choice::Name(part) => {
                let part_of = |name: String| name.to_lowercase().contains(&part.to_lowercase());
                let found = self.list.iter().find(|a| part_of(a.get_info().name));
                (found, format!("adapter called `{part}`"))
            }
        };
        let found = found.map(|adapter| Some((adapter, "as asked".to_string())));
        found.ok_or_else(|| DeviceError::NoMatch {
            choice: asked,
            there_is: self.there_is(),
        })
    }
}

/// Why a hardware adapter is chosen.
const HARDWARE: &str = "the best hardware adapter";
/// Why a software adapter is chosen.
const SOFTWARE: &str = "software Vulkan, as there is no hardware adapter";

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

impl Device {
    /// Opens an adapter. Its programs need no more than what WebGPU promises, but buffers may be
    /// as large as the adapter allows. Timestamps and f64 are on if the adapter has them.
    ///
    /// # Errors
    /// It does not open.
    pub fn open(adapter: &Adapter) -> Result<Self, DeviceError> {
        let limits = adapter.limits();
        let larger = Limits {
            max_buffer_size: limits.max_buffer_size,
            max_storage_buffer_binding_size: limits.max_storage_buffer_binding_size,
            ..Limits::default()
        };
        Self::open_with(adapter, larger)
    }

    /// As [`Device::open`], with other limits.
    ///
    /// # Errors
    /// It does not open with them.
    pub fn open_with(adapter: &Adapter, required_limits: Limits) -> Result<Self, DeviceError> {
        let info = adapter.get_info();
        let wanted = Features::TIMESTAMP_QUERY | Features::SHADER_F64;
        let features = adapter.features() & wanted;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("conemarch"),
            required_features: features,
            required_limits,
            ..Default::default()
        };
        let opened = pollster::block_on(adapter.request_device(&descriptor));
        let (device, queue) = opened.map_err(|e| DeviceError::Open {
            name: info.name,
            why: e.to_string(),
        })?;
        let mut opened = Self::adopt(adapter, device, queue, clock);
        opened.opened = Some(adapter.clone());
        Ok(opened)
    }

    /// Opens the adapter of a lost device again, with the same limits.
    ///
    /// # Errors
    /// The adapter does not open, or a host has lent the device. Then this is the error of the
    /// device.
    pub fn reopen(&self) -> Result<Self, DeviceError> {
        match &self.opened {
            Some(adapter) => Self::open_with(adapter, self.device.limits()),
            None => Err(self
                .trouble()
                .err()
                .unwrap_or_else(|| self.lost("lent by a host"))),
        }
    }
}
