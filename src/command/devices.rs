//! `conemarch devices`: what `--device` can choose.

use anyhow::Result;
use indicatif::BinaryBytes;
use wgpu::{Adapter, Features};

use crate::command::executor::Executor;
use crate::command::print::print;
use crate::command::table::columns;
use crate::gpu::adapters::{Adapters, kind};

const HEAD: &str = "index,name,backend,type,driver,PCI id,max buffer,max binding,f64,timestamps";

/// Prints a table of all devices.
pub fn run() -> Result<()> {
    let mut rows = vec![HEAD.split(',').map(str::to_string).collect()];
    let adapters = Adapters::find();
    rows.extend(adapters.iter().enumerate().map(|(i, a)| row(i, a)));
    let name = Executor::Cpu.name();
    let cpu = [
        "cpu", &name, "cpu", "executor", "-", "-", "-", "-", "yes", "-",
    ];
    rows.push(cpu.map(str::to_string).to_vec());
    print(columns(rows).as_bytes())
}

fn row(index: usize, adapter: &Adapter) -> Vec<String> {
    let info = adapter.get_info();
    let limits = adapter.limits();
    let has = |feature| match adapter.features().contains(feature) {
        true => "yes".to_string(),
        false => "no".to_string(),
    };
    let driver = format!("{} {}", info.driver, info.driver_info);
    let driver = driver.trim();
    vec![
        index.to_string(),
        info.name.clone(),
        format!("{:?}", info.backend).to_lowercase(),
        kind(&info).into(),
        if driver.is_empty() { "-" } else { driver }.into(),
        format!("{:04x}:{:04x}", info.vendor, info.device),
        BinaryBytes(limits.max_buffer_size).to_string(),
        BinaryBytes(limits.max_storage_buffer_binding_size).to_string(),
        has(Features::SHADER_F64),
        has(Features::TIMESTAMP_QUERY),
    ]
}
