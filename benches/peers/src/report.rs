//! The figures as lines, Markdown, JSON and a plot.

use std::fmt::Write;
use std::path::Path;

use anyhow::anyhow;
use plotters::prelude::*;
use serde::Serialize;

use crate::Arguments;
use crate::embree::Embree;
use crate::floor::Floor;
use crate::run::Row;

/// All that was measured, and where.
#[derive(Serialize)]
pub struct Report {
    /// The processor's name and what of its instruction sets matters.
    pub machine: String,
    pub embree: Option<String>,
    pub size: u32,
    pub repeat: usize,
    /// Nanoseconds a pixel to shade one plane over a picture of 1024 x 1024.
    pub shading_ns: f64,
    /// Nanoseconds a pixel to fill that picture's memory.
    pub fill_ns: f64,
    pub rows: Vec<Row>,
}

/// The processor, as the system names it.
pub fn machine() -> String {
    let about = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = about.lines().find_map(|line| line.strip_prefix("model name")).unwrap_or("a processor");
    let name = name.trim_start_matches(['\t', ' ', ':']).to_owned();
    #[cfg(target_arch = "x86_64")]
    {
        let known = [
            ("AVX2", std::arch::is_x86_feature_detected!("avx2")),
            ("FMA", std::arch::is_x86_feature_detected!("fma")),
            ("AVX-512", std::arch::is_x86_feature_detected!("avx512f")),
        ];
        let sets: Vec<&str> = known.iter().filter(|(_, has)| *has).map(|(name, _)| *name).collect();
        format!("{name} with {}", sets.join(", "))
    }
    #[cfg(not(target_arch = "x86_64"))]
    name
}

impl Report {
    pub fn new(arguments: &Arguments, embree: Option<&Embree>, floor: Floor) -> Report {
        let per_pixel = |seconds: f64| seconds * 1e9 / (1024.0 * 1024.0);
        Report {
            machine: machine(),
            embree: embree.map(|embree| embree.version.clone()),
            size: arguments.size,
            repeat: arguments.repeat,
            shading_ns: per_pixel(floor.shading),
            fill_ns: per_pixel(floor.fill),
            rows: Vec::new(),
        }
    }

    /// What was measured where.
    pub fn head(&self) -> String {
        format!(
            "{}, one thread; frames of {} x {}; medians of {} interleaved repeats.\n\
             Shading one plane over a picture {:.3} ns a pixel, filling its memory {:.3} ns.",
            self.machine, self.size, self.size, self.repeat, self.shading_ns, self.fill_ns
        )
    }

    /// The scenes, in order.
    fn scenes(&self) -> Vec<&str> {
        let mut scenes: Vec<&str> = self.rows.iter().map(|row| row.scene.as_str()).collect();
        scenes.dedup();
        scenes
    }

    fn find(&self, scene: &str, rays: &str, way: &str) -> Option<&Row> {
        self.rows.iter().find(|row| row.scene == scene && row.rays == rays && row.way == way)
    }

    /// The ways for a kind of rays, in order.
    fn ways(&self, rays: &str) -> Vec<&str> {
        let mut ways: Vec<&str> = Vec::new();
        for row in self.rows.iter().filter(|row| row.rays == rays) {
            if !ways.contains(&row.way.as_str()) {
                ways.push(&row.way);
            }
        }
        ways
    }

    /// A table for each kind of rays: nanoseconds a ray, and how many answers differ.
    pub fn markdown(&self) -> String {
        let mut out = format!("{}\n", self.head());
        for (rays, about) in [
            ("primary", "Rays of frames, ns each"),
            ("random", "Rays from random points of rooms in random directions, ns each"),
            ("pairs", "Whether two random points of rooms see each other, ns each"),
            ("onward", "Rays on from hits in rooms, ns each"),
            ("lamps", "Whether a hit in a room sees a point, ns each"),
            ("outside", "Rays from eyes around a building, ns each"),
            ("facades", "Rays on from facades, ns each"),
            ("points", "Where random points lie, ns each"),
        ] {
            let ways = self.ways(rays);
            if ways.is_empty() {
                continue;
            }
            // Writing to a String cannot fail.
            let _ = writeln!(
                out,
                "\n### {about}\n\n| scene | {} |\n|---|{}",
                ways.join(" | "),
                "---:|".repeat(ways.len())
            );
            for scene in self.scenes() {
                let cells: Vec<String> = ways
                    .iter()
                    .map(|way| match self.find(scene, rays, way) {
                        Some(row) if row.differing > 0 => {
                            format!("{:.1} ({})", row.ns_per_ray, row.differing)
                        }
                        Some(row) => format!("{:.1}", row.ns_per_ray),
                        None => String::new(),
                    })
                    .collect();
                let _ = writeln!(out, "| {scene} | {} |", cells.join(" | "));
            }
        }
        out
    }

    /// Bars of nanoseconds for the rays of frames, a group for each scene.
    pub fn plot(&self, path: &Path) -> anyhow::Result<()> {
        /// Below the bars stand the names, in two rows; right of them, so much of their width, what they are.
        const LEAST: f64 = 10.0;
        const LEGEND: f64 = 0.38;
        let (scenes, ways) = (self.scenes(), self.ways("primary"));
        let (scene_count, way_count) = (scenes.len(), ways.len());
        let most = self.rows.iter().filter(|row| row.rays == "primary").map(|row| row.ns_per_ray);
        let most = most.fold(1.0, f64::max) * 1.1;
        let step = way_count as f64 + 1.5;
        let area = SVGBackend::new(path, (1200, 420)).into_drawing_area();
        let failed = |error: &dyn std::fmt::Display| anyhow!("{}: {error}", path.display());
        area.fill(&WHITE).map_err(|e| failed(&e))?;
        let mut chart = ChartBuilder::on(&area)
            .margin(12)
            .caption("Rays of frames, ns each, one thread (logarithmic)", ("sans-serif", 18))
            .x_label_area_size(8)
            .y_label_area_size(56)
            .build_cartesian_2d(
                0.0..step * scene_count as f64 * (1.0 + LEGEND),
                (LEAST / 2.0..most).log_scale(),
            )
            .map_err(|e| failed(&e))?;
        chart
            .configure_mesh()
            .disable_x_mesh()
            .x_labels(0)
            .y_desc("ns a ray")
            .draw()
            .map_err(|e| failed(&e))?;
        for (i, way) in ways.iter().enumerate() {
            let color = Palette99::pick(i).to_rgba();
            let bars = scenes.iter().enumerate().filter_map(|(s, scene)| {
                let row = self.find(scene, "primary", way)?;
                let x = s as f64 * step + i as f64 + 0.5;
                Some(Rectangle::new([(x, LEAST), (x + 0.9, row.ns_per_ray)], color.filled()))
            });
            chart
                .draw_series(bars)
                .map_err(|e| failed(&e))?
                .label(*way)
                .legend(move |(x, y)| Rectangle::new([(x, y - 5), (x + 10, y + 5)], color.filled()));
        }
        let names = scenes.iter().enumerate().map(|(s, scene)| {
            let below = if s % 2 == 0 { 0.92 } else { 0.75 };
            Text::new((*scene).to_owned(), (s as f64 * step + 0.5, LEAST * below), ("sans-serif", 12))
        });
        chart.draw_series(names).map_err(|e| failed(&e))?;
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .background_style(WHITE.mix(0.8))
            .draw()
            .map_err(|e| failed(&e))?;
        area.present().map_err(|e| failed(&e))
    }
}

/// Rows as lines of text.
pub fn lines(rows: &[Row]) -> String {
    let mut out = String::new();
    for row in rows {
        // Beside the first way of the same kind of rays.
        let first = rows.iter().find(|first| first.rays == row.rays).map_or(row.ns_per_ray, |r| r.ns_per_ray);
        // Writing to a String cannot fail.
        let _ = writeln!(
            out,
            "{:<14} {:<8} {:<46} {:>9.1} ns {:>7.2} x {:>8} of {} differ",
            row.scene,
            row.rays,
            row.way,
            row.ns_per_ray,
            row.ns_per_ray / first,
            row.differing,
            row.count
        );
    }
    out
}
