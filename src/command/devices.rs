//! `conemarch devices`

use anyhow::Result;
use wgpu::{Adapter, Features};

use crate::command::executor::Executor;
use crate::command::print::print;
use crate::gpu::device::{Adapters, kind};

const HEAD: [&str; 10] = [
    "index",
    "name",
    "backend",
    "type",
    "driver",
    "PCI id",
    "max buffer",
    "max binding",
    "f64",
    "timestamps",
];

/// Lists what `--device` can choose.
pub fn run() -> Result<()> {
    let mut rows = vec![HEAD.map(str::to_string)];
    let adapters = Adapters::find();
    rows.extend(adapters.iter().enumerate().map(|(i, a)| row(i, a)));
    let cpu = [
        "cpu",
        &Executor::Cpu.name(),
        "cpu",
        "executor",
        "-",
        "-",
        "-",
        "-",
        "yes",
        "-",
    ];
    rows.push(cpu.map(str::to_string));
    print(table(&rows).as_bytes())
}

fn row(index: usize, adapter: &Adapter) -> [String; 10] {
    let info = adapter.get_info();
    let limits = adapter.limits();
    let has = |f: Features| {
        if adapter.features().contains(f) {
            "yes"
        } else {
            "no"
        }
    };
    let driver = format!("{} {}", info.driver, info.driver_info);
    let driver = driver.trim();
    [
        index.to_string(),
        info.name.clone(),
        format!("{:?}", info.backend).to_lowercase(),
        kind(&info).into(),
        if driver.is_empty() { "-" } else { driver }.into(),
        format!("{:04x}:{:04x}", info.vendor, info.device),
        size(limits.max_buffer_size),
        size(limits.max_storage_buffer_binding_size),
        has(Features::SHADER_F64).into(),
        has(Features::TIMESTAMP_QUERY).into(),
    ]
}

/// Bytes in the largest unit that keeps three figures.
fn size(bytes: u64) -> String {
    match bytes {
        b if b >> 40 > 0 => format!("{} GiB+", 1 << 10),
        b if b >> 30 > 0 => format!("{:.1} GiB", b as f64 / f64::from(1 << 30)),
        b => format!("{:.1} MiB", b as f64 / f64::from(1 << 20)),
    }
}

/// Rows in columns, two blanks apart.
fn table(rows: &[[String; 10]]) -> String {
    let width = |i: usize| rows.iter().map(|r| r[i].chars().count()).max();
    let widths: Vec<usize> = (0..HEAD.len()).map(|i| width(i).unwrap_or(0)).collect();
    let mut text = String::new();
    for row in rows {
        let cells = row.iter().zip(&widths);
        let line: Vec<String> = cells.map(|(cell, w)| format!("{cell:<w$}")).collect();
        text.push_str(line.join("  ").trim_end());
        text.push('\n');
    }
    text
}
