//! The measured tables of `docs/accuracy.md`: `cargo bench --bench accuracy` prints them,
//! with `-- --write` it puts them into the page.
//!
//! Everything but the device and the date is the same in every run on a device. Columns in
//! f64 on the adapter are left out, with a note, where the adapter has no f64.
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
    pub mod random;
    pub mod setups;
    pub mod solved;
    pub mod strain;
}

use std::fmt::Write as _;
use std::time::{SystemTime, UNIX_EPOCH};

use anyhow::{Context, Result};
use common::groups::GROUPS;
use common::hard;
use common::precision::{Sample, has_f64, quantiles, samples};
use common::strain::{Outcome, strain};
use conemarch::formula::mandelbox::Mandelbox;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/accuracy.md");
const BEGIN: &str = "<!-- cargo bench --bench accuracy -- --write: begin -->";
const END: &str = "<!-- cargo bench --bench accuracy -- --write: end -->";

fn main() -> Result<()> {
    let tables = tables()?;
    println!("{tables}");
    if std::env::args().any(|a| a == "--write") {
        let page = std::fs::read_to_string(PAGE)?;
        let (head, rest) = page.split_once(BEGIN).context("no place for the tables")?;
        let (_, tail) = rest.split_once(END).context("no end of that place")?;
        std::fs::write(PAGE, format!("{head}{BEGIN}\n\n{tables}\n{END}{tail}"))?;
    }
    Ok(())
}

fn tables() -> Result<String> {
    let mut text = String::new();
    let name = adapter::with(|r| r.device.info.name.clone());
    writeln!(text, "Measured on {name}, {}.", today()?)?;
    if !has_f64() {
        writeln!(text, "\nThis adapter has no f64: its columns are left out.")?;
    }
    for scale in [2.0, -1.5] {
        let m = Mandelbox {
            scale,
            ..Mandelbox::default()
        };
        let all = samples(&m);
        writeln!(text, "\n### The estimate at scale {scale}, by distance\n")?;
        let rows = (1..=9).map(|n| (format!("1e-{n}"), move |s: &&Sample| s.power == -n));
        for (i, (label, of)) in rows.enumerate() {
            row(&mut text, i == 0, "distance", &label, all.iter().filter(of))?;
        }
        writeln!(text, "\n### The estimate at scale {scale}, by iterations\n")?;
        let bins = [(1, 2), (3, 4), (5, 8), (9, 16), (17, 32), (33, 64)];
        for (i, (low, high)) in bins.into_iter().enumerate() {
            let of = all.iter().filter(|s| (low..=high).contains(&s.spent));
            row(
                &mut text,
                i == 0,
                "iterations",
                &format!("{low} to {high}"),
                of,
            )?;
        }
    }
    near(&mut text)?;
    groups(&mut text)?;
    Ok(text)
}

/// A row of relative errors, and the head before the first.
fn row<'a>(
    text: &mut String,
    first: bool,
    what: &str,
    label: &str,
    samples: impl Iterator<Item = &'a Sample>,
) -> Result<()> {
    let all: Vec<&Sample> = samples.collect();
    let double = has_f64();
    if first {
        write!(
            text,
            "| {what} | points | f32, at its own point: median | 99 % "
        )?;
        write!(text, "| f32, in all: median | 99 % ")?;
        if double {
            write!(text, "| f64 on the adapter: median | 99 % ")?;
        }
        let columns = if double { 7 } else { 5 };
        writeln!(text, "|\n|---{}|", "|---:".repeat(columns))?;
    }
    if all.is_empty() {
        return Ok(());
    }
    write!(text, "| {label} | {} ", all.len())?;
    let mut pair = |[median, most]: [f64; 2]| write!(text, "| {median:.0e} | {most:.0e} ");
    pair(quantiles(all.iter().map(|s| s.computed)))?;
    pair(quantiles(all.iter().map(|s| s.in_all)))?;
    if double {
        pair(quantiles(all.iter().filter_map(|s| s.doubled)))?;
    }
    writeln!(text, "|")?;
    Ok(())
}

/// Cameras near the surface, one by one.
fn near(text: &mut String) -> Result<()> {
    writeln!(text, "\n### Cameras near the surface\n")?;
    writeln!(
        text,
        "| view | executors apart | wrong, f32 | wrong, f64 | warned |"
    )?;
    writeln!(text, "|---|---:|---:|---:|---|")?;
    for (name, plan) in hard::near() {
        let o = strain(&name, &plan);
        let [apart, gpu, cpu] = [o.apart, o.wrong_gpu, o.wrong_cpu].map(percent);
        let warned = if o.warned { "yes" } else { "no" };
        writeln!(text, "| {name} | {apart} | {gpu} | {cpu} | {warned} |")?;
    }
    Ok(())
}

/// Every group's worst, beside its bounds. Of f32 only where no warning is due.
fn groups(text: &mut String) -> Result<()> {
    writeln!(text, "\n### The worst of each kind, and its bound\n")?;
    write!(
        text,
        "| what is hard | plans | warned | executors apart | bound "
    )?;
    writeln!(
        text,
        "| wrong, f32 | wrong, f64 | bound | unconverged | test |"
    )?;
    writeln!(text, "|---|{}---|", "---:|".repeat(8))?;
    for group in GROUPS {
        let all: Vec<Outcome> = (group.cases)()
            .iter()
            .map(|(name, plan)| strain(name, plan))
            .collect();
        let worst = |of: fn(&Outcome) -> f64| percent(all.iter().map(of).fold(0.0, f64::max));
        let unwarned = |o: &Outcome, x: f64| if o.warned { 0.0 } else { x };
        let warned = all.iter().filter(|o| o.warned).count();
        writeln!(
            text,
            "| {} | {} | {warned} | {} | {} | {} | {} | {} | {} | `{}` |",
            group.what,
            all.len(),
            percent(all.iter().map(|o| unwarned(o, o.apart)).fold(0.0, f64::max)),
            percent(group.apart),
            percent(
                all.iter()
                    .map(|o| unwarned(o, o.wrong_gpu))
                    .fold(0.0, f64::max)
            ),
            worst(|o| o.wrong_cpu),
            percent(group.wrong),
            worst(|o| o.unconverged),
            group.test
        )?;
    }
    Ok(())
}

fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}

/// The day, as year-month-day in UTC (Hinnant's civil calendar from days since 1970).
fn today() -> Result<String> {
    let days = SystemTime::now().duration_since(UNIX_EPOCH)?.as_secs() / 86_400 + 719_468;
    let (era, of_era) = (days / 146_097, days % 146_097);
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let day = of_year - (153 * month + 2) / 5 + 1;
    let (month, late) = if month < 10 {
        (month + 3, 0)
    } else {
        (month - 9, 1)
    };
    Ok(format!("{}-{month:02}-{day:02}", year + era * 400 + late))
}
