//! Functions of the shaders asked one by one: a kernel that answers a list of questions,
//! and a measure of how far the answers lie from those in f64.

use std::collections::HashMap;
use std::sync::{Arc, LazyLock};

use conemarch::base::shader::{Module, Program};
use conemarch::gpu::buffer::Buffer;
use conemarch::gpu::device::Device;
use conemarch::gpu::kernel::Kernel;

/// Twelve numbers of a question, and as many of an answer.
pub type Numbers = [[f32; 4]; 3];

/// A probe's file beside the tests, as a module.
macro_rules! probe {
    ($name:literal) => {
        conemarch::base::shader::Module {
            path: concat!("tests/probe/", $name, ".wgsl"),
            source: include_str!(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/tests/probe/",
                $name,
                ".wgsl"
            ))
            .into(),
            constants: Vec::new(),
            replaces: None,
        }
    };
}
pub(crate) use probe;

static DEVICE: LazyLock<Arc<Device>> = LazyLock::new(|| crate::adapter::open().device);

/// Whether a processor answers.
#[allow(
    dead_code,
    reason = "only some tests know it from measurements of other devices"
)]
pub fn is_software() -> bool {
    DEVICE.info.device_type == wgpu::DeviceType::Cpu
}

/// Modules to ask, and the parameters that they read.
#[derive(Clone, Default)]
pub struct Probe {
    /// Everything that is joined, but the frame of the probe.
    pub modules: Vec<Module>,
    /// Bytes by the names of the WGSL variables.
    pub parameters: Vec<(&'static str, Vec<u8>)>,
}

impl Probe {
    /// The same with a constant of the shaders multiplied by a factor.
    pub fn with_constant_scaled(mut self, name: &str, factor: f64) -> Self {
        let mut constants = self.modules.iter_mut().flat_map(|m| &mut m.constants);
        let found = constants.find(|c| c.0 == name);
        found.expect("the constant is in a module").1 *= factor;
        self
    }

    /// The answer of `answer` to each question.
    pub fn ask(&self, questions: &[Numbers]) -> Vec<Numbers> {
        let device = &*DEVICE;
        let mut modules = self.modules.clone();
        modules.push(probe!("frame"));
        let program = Program::new("probe", modules);
        let kernel = Kernel::new(device, &program).unwrap_or_else(|e| panic!("{e}"));
        let asked = Buffer::<Numbers>::new(device, "asked", questions.len());
        asked.write(device, questions);
        let told = Buffer::<Numbers>::new(device, "told", questions.len());
        let mut arrays = HashMap::new();
        for (name, bytes) in self
            .parameters
            .iter()
            .filter(|(name, _)| kernel.reads(name))
        {
            let array = kernel.array(device, name, bytes);
            arrays.insert(*name, array.unwrap_or_else(|e| panic!("{e}")));
        }
        let groups = kernel.bind(device, |name| match name {
            "asked" => Some(asked.raw.as_entire_binding()),
            "told" => Some(told.raw.as_entire_binding()),
            own => Some(arrays.get(own)?.binding()),
        });
        let groups = groups.unwrap_or_else(|e| panic!("{e}"));
        let mut encoder = device.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        let count = u32::try_from(questions.len().div_ceil(64)).expect("a short list");
        kernel.dispatch(&mut pass, &groups, [count, 1]);
        drop(pass);
        device.queue.submit([encoder.finish()]);
        let read = told.read(device, questions.len());
        read.unwrap_or_else(|e| panic!("{e}"))
    }
}

/// How far answers lie from the expected ones, by quantile. The largest error says
/// little: next to a fold or a threshold f32 may well take the other side.
#[derive(Clone, Copy, Debug)]
pub struct Errors {
    /// Half of the answers are closer.
    pub median: f64,
    /// All but one in a hundred are.
    pub p99: f64,
}

impl std::fmt::Display for Errors {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "median {:.1e} p99 {:.1e}", self.median, self.p99)
    }
}

impl Errors {
    /// Errors of pairs of got and wanted, relative to the wanted number or to `floor`
    /// where that is larger.
    pub fn of(pairs: impl IntoIterator<Item = (f32, f64)>, floor: f64) -> Self {
        let error = |(got, want): (f32, f64)| {
            let e = (f64::from(got) - want).abs() / want.abs().max(floor);
            if e.is_nan() { f64::INFINITY } else { e }
        };
        let mut all: Vec<f64> = pairs.into_iter().map(error).collect();
        assert!(all.len() >= 4096, "only {} answers", all.len());
        all.sort_by(f64::total_cmp);
        Self {
            median: all[all.len() / 2],
            p99: all[all.len() * 99 / 100],
        }
    }
}
