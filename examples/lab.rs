//! Scratch: variants of shaders against the usual ones, in turns.
use anyhow::{Context, Result};
use conemarch::gpu::adapters::{Adapters, Choice};
use conemarch::gpu::device::Device;
use conemarch::gpu::render::Renderer;
use conemarch::plan::{Extras, Pass};
use conemarch::preset::{self, Override};
use conemarch::scene::Assets;
use std::sync::Arc;

fn main() -> Result<()> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let runs: usize = std::env::var("RUNS")
        .ok()
        .and_then(|r| r.parse().ok())
        .unwrap_or(9);
    let dirs: Vec<_> = args
        .iter()
        .filter(|a| a.starts_with('/'))
        .cloned()
        .collect();
    let changes: Result<Vec<_>, _> = args
        .iter()
        .filter(|a| a.contains('='))
        .map(|c| Override::read(c))
        .collect();
    let changes = changes?;
    let names = args
        .iter()
        .filter(|a| !a.starts_with('/') && !a.contains('='));
    let adapters = Adapters::find();
    let (adapter, _) = adapters.choose(&Choice::Auto)?.context("no adapter")?;
    let mut renderers = vec![Renderer::new(Device::open(adapter)?)];
    for dir in &dirs {
        let mut other = Renderer::new(Device::open(adapter)?);
        let dir = dir.clone();
        other.sources = Some(Arc::new(move |path: &str| {
            std::fs::read_to_string(format!("{dir}/{path}")).ok()
        }));
        renderers.push(other);
    }
    let counts = std::env::var("COUNT").is_ok();
    for name in names {
        let mut plan = preset::load(name, &changes)?.plan.one_sample();
        if let Ok(size) = std::env::var("SIZE") {
            let (w, h) = size.split_once('x').context("size")?;
            plan.size = [w.parse()?, h.parse()?];
        }
        let assets = Assets::default();
        let mut times = vec![[vec![], vec![], vec![]]; renderers.len()];
        let mut base: Option<Vec<[f32; 3]>> = None;
        for run in 0..=runs {
            let extras = Extras {
                count: counts && run == 0,
                time: true,
                ..Extras::default()
            };
            for (n, renderer) in renderers.iter_mut().enumerate() {
                let frame = renderer.render(&plan, &assets, extras, &mut |_| true)?;
                if run == 0 {
                    if counts {
                        for p in &frame.passes {
                            eprintln!(
                                "{name} {n} {:?} cells {:?} ev {:?} it {:?}",
                                p.pass, p.cells, p.evaluations, p.iterations
                            );
                        }
                    }
                    match &base {
                        None => base = Some(frame.radiance.clone()),
                        Some(b) => {
                            let d: Vec<f64> = b
                                .iter()
                                .flatten()
                                .zip(frame.radiance.iter().flatten())
                                .map(|(a, b)| f64::from((a - b).abs()))
                                .collect();
                            let most = d.iter().copied().fold(0.0, f64::max);
                            eprintln!(
                                "{name} {}: mean difference {:.2e}, most {:.2e}",
                                dirs[n - 1],
                                d.iter().sum::<f64>() / d.len() as f64,
                                most
                            );
                        }
                    }
                    continue;
                }
                let of = |which: fn(&Pass) -> bool| {
                    frame
                        .passes
                        .iter()
                        .filter(|p| which(&p.pass))
                        .map(|p| p.gpu_ms.unwrap_or(0.0))
                        .sum::<f64>()
                };
                times[n][0].push(of(|p| matches!(p, Pass::March(_))));
                times[n][1].push(of(|p| *p == Pass::Trace));
                times[n][2].push(of(|p| *p == Pass::Color));
            }
        }
        let med = |mut v: Vec<f64>| {
            v.sort_by(f64::total_cmp);
            v[v.len() / 2]
        };
        let usual = times[0].clone();
        print!(
            "{name}: march {:.1} trace {:.1} colour {:.1} ms;",
            med(usual[0].clone()),
            med(usual[1].clone()),
            med(usual[2].clone())
        );
        for (n, t) in times.iter().enumerate().skip(1) {
            let r: Vec<f64> = (0..3)
                .map(|k| {
                    med(t[k]
                        .iter()
                        .zip(&usual[k])
                        .map(|(a, b)| a / b.max(1e-9))
                        .collect())
                })
                .collect();
            print!(
                " {}: march {:.3} trace {:.3} colour {:.3};",
                dirs[n - 1].rsplit('/').next().unwrap_or(""),
                r[0],
                r[1],
                r[2]
            );
        }
        println!();
    }
    Ok(())
}
