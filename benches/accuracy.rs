//! The measured tables of `docs/accuracy.md`: `cargo bench --bench accuracy` prints them, and
//! `cargo bench --bench accuracy -- --write` puts them into the page.
//!
//! On one device every run gives the same numbers. If the adapter has no f64, a note replaces
//! the columns of f64.
#![allow(
    missing_docs,
    clippy::expect_used,
    reason = "the tables' measures are those of the tests, which panic"
)]

#[path = "../tests/adapter/mod.rs"]
mod adapter;
#[path = "../tests/common"]
#[allow(dead_code, reason = "tests use the rest")]
mod common {
    pub mod exact;
    pub mod groups;
    pub mod hard;
    pub mod plans;
    pub mod precision;
    pub mod probe;
    pub mod programs;
    pub mod random;
    pub mod setups;
    pub mod solved;
    pub mod strain;
}

#[path = "common/markdown.rs"]
mod markdown;

use std::process::Command;

use anyhow::{Context, Result};
use common::groups::GROUPS;
use common::hard;
use common::precision::{Sample, has_f64, quantiles, samples};
use common::strain::{Outcome, strain};
use conemarch::formula::mandelbox::Mandelbox;
use markdown::table;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/accuracy.md");
const MARKS: [&str; 2] = [
    "<!-- cargo bench --bench accuracy -- --write: begin -->",
    "<!-- cargo bench --bench accuracy -- --write: end -->",
];

fn main() -> Result<()> {
    let name = adapter::with(|r| r.device.info.name.clone());
    let mut text = format!("Measured on {name}, {}.\n", today()?);
    if !has_f64() {
        text += "\nThis adapter has no f64: its columns are left out.\n";
    }
    for scale in [2.0, -1.5] {
        text += &estimates(scale);
    }
    text = text + &near() + &groups();
    println!("{text}");
    if std::env::args().any(|a| a == "--write") {
        let mut page = std::fs::read_to_string(PAGE).context(PAGE)?;
        markdown::replace(&mut page, MARKS, &text)?;
        std::fs::write(PAGE, page).context(PAGE)?;
    }
    Ok(())
}

/// Errors of the estimate at one scale, by distance and by iterations.
fn estimates(scale: f64) -> String {
    let m = Mandelbox {
        scale,
        ..Mandelbox::default()
    };
    let all = samples(&m);
    let by_distance = (1..=9).map(|n| {
        let of = all.iter().filter(move |s| s.power == -n);
        (format!("1e-{n}"), of.collect())
    });
    let bins = [(1, 2), (3, 4), (5, 8), (9, 16), (17, 32), (33, 64)];
    let by_iterations = bins.into_iter().map(|(low, high)| {
        let of = all.iter().filter(|s| (low..=high).contains(&s.spent));
        (format!("{low} to {high}"), of.collect())
    });
    let head = |what| format!("\n### The estimate at scale {scale}, by {what}\n\n");
    head("distance")
        + &errors("distance", by_distance)
        + &head("iterations")
        + &errors("iterations", by_iterations)
}

/// A table of relative errors: the median and the 99th percentile of each group of samples.
fn errors<'a>(what: &str, groups: impl Iterator<Item = (String, Vec<&'a Sample>)>) -> String {
    let mut head = format!("{what} | points | f32, at its own point: median | 99 %");
    head += " | f32, in all: median | 99 %";
    if has_f64() {
        head += " | f64 on the adapter: median | 99 %";
    }
    let groups = groups.filter(|(_, all)| !all.is_empty());
    let rows = groups.map(|(label, all)| {
        let mut pairs = vec![
            quantiles(all.iter().map(|s| s.computed)),
            quantiles(all.iter().map(|s| s.in_all)),
        ];
        if has_f64() {
            pairs.push(quantiles(all.iter().filter_map(|s| s.doubled)));
        }
        let errors = pairs.into_iter().flatten();
        let errors: String = errors.map(|e| format!(" | {e:.0e}")).collect();
        format!("{label} | {}{errors}", all.len())
    });
    table(&head, "lr", rows)
}

/// Cameras near the surface, one by one.
fn near() -> String {
    let rows = hard::near().into_iter().map(|(name, plan)| {
        let o = strain(&name, &plan);
        let [apart, gpu, cpu] = [o.apart, o.wrong_gpu, o.wrong_cpu].map(percent);
        let warned = if o.warned { "yes" } else { "no" };
        format!("{name} | {apart} | {gpu} | {cpu} | {warned}")
    });
    let head = "view | executors apart | wrong, f32 | wrong, f64 | warned";
    let rows = table(head, "lrrrl", rows);
    format!("\n### Cameras near the surface\n\n{rows}")
}

/// The worst of every group beside its bounds. Plans with a warning do not count for f32.
fn groups() -> String {
    let rows = GROUPS.iter().map(|group| {
        let cases = (group.cases)();
        let all: Vec<Outcome> = cases
            .iter()
            .map(|(name, plan)| strain(name, plan))
            .collect();
        let worst = |of: fn(&Outcome) -> f64| percent(all.iter().map(of).fold(0.0, f64::max));
        format!(
            "{} | {} | {} | {} | {} | {} | {} | {} | {} | `{}`",
            group.what,
            all.len(),
            all.iter().filter(|o| o.warned).count(),
            worst(|o| if o.warned { 0.0 } else { o.apart }),
            percent(group.apart),
            worst(|o| if o.warned { 0.0 } else { o.wrong_gpu }),
            worst(|o| o.wrong_cpu),
            percent(group.wrong),
            worst(|o| o.unconverged),
            group.test
        )
    });
    let head = "what is hard | plans | warned | executors apart | bound | wrong, f32 | wrong, f64 | bound | unconverged | test";
    let rows = table(head, "lrrrrrrrrl", rows);
    format!("\n### The worst of each kind, and its bound\n\n{rows}")
}

fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}

/// The day as year-month-day, from the system's `date`.
fn today() -> Result<String> {
    let said = Command::new("date").arg("+%F").output().context("date")?;
    Ok(String::from_utf8(said.stdout)?.trim().to_owned())
}
