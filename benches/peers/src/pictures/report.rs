//! The figures of pictures as lines, Markdown and JSON.

use std::fmt::Write;

use serde::Serialize;

use super::{Painted, View};
use crate::embree::Embree;
use crate::{Arguments, median};

/// All pictures of one scene from inside, or from outside, in one way.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    pub scene: String,
    /// `inside` or `outside`.
    pub from: &'static str,
    pub way: String,
    pub views: usize,
    /// Embree's time beside ours for the same picture.
    pub embree: Option<Spread>,
    /// Our time beside the floor's.
    pub floor: Spread,
    /// Milliseconds a picture, the median.
    pub ms: f64,
    /// Million pixels a second, the median.
    pub mpixels_per_s: f64,
    /// Of all pixels, the share that was left to rays.
    pub unsure: f64,
    /// A picture, on average.
    pub cells: f64,
    /// A picture, on average; none by packets.
    pub spans: Option<f64>,
    /// A picture, on average.
    pub triangles: f64,
    /// Nanoseconds a ray, the median.
    pub embree_ns: Option<f64>,
    /// Nanoseconds a pixel, the median.
    pub floor_ns: f64,
}

/// Of ratios.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Spread {
    pub median: f64,
    /// The one that is worst for us.
    pub worst: f64,
}

/// The rows of one scene's views: from inside and from outside, for each way.
pub fn rows(views: &[View]) -> Vec<Row> {
    let mut rows = Vec::new();
    for from in ["inside", "outside"] {
        let views: Vec<&View> = views.iter().filter(|view| view.from == from).collect();
        let ways = views.first().map_or(0, |view| view.painted.len());
        rows.extend((0..ways).map(|way| row(&views, way)));
    }
    rows
}

/// Of views, of which there are some, in the way of this number.
fn row(views: &[&View], way: usize) -> Row {
    let middle =
        |of: &dyn Fn(&View) -> f64| median(&mut views.iter().map(|view| of(view)).collect::<Vec<f64>>());
    let mean = |of: &dyn Fn(&Painted) -> u64| {
        views.iter().map(|view| of(&view.painted[way]) as f64).sum::<f64>() / views.len() as f64
    };
    let mut floor: Vec<f64> = views.iter().map(|view| view.painted[way].seconds / view.floor).collect();
    let ratio = |view: &&View| Some(view.embree? / view.painted[way].seconds);
    let embree: Option<Vec<f64>> = views.iter().map(ratio).collect();
    let ns = |seconds: f64, view: &View| seconds * 1e9 / view.pixels as f64;
    let pixels = views.iter().map(|view| view.pixels as f64).sum::<f64>() / views.len() as f64;
    Row {
        scene: views[0].scene.clone(),
        from: views[0].from,
        way: views[0].painted[way].way.clone(),
        views: views.len(),
        embree: embree.map(|mut ratios| Spread {
            median: median(&mut ratios),
            worst: ratios.iter().copied().fold(f64::INFINITY, f64::min),
        }),
        floor: Spread { median: median(&mut floor), worst: floor.iter().copied().fold(0.0, f64::max) },
        ms: middle(&|view| view.painted[way].seconds * 1e3),
        mpixels_per_s: middle(&|view| view.pixels as f64 / view.painted[way].seconds / 1e6),
        unsure: mean(&|painted| painted.unsure) / pixels,
        cells: mean(&|painted| painted.cells),
        spans: views[0].painted[way].spans.map(|_| mean(&|painted| painted.spans.unwrap_or(0))),
        triangles: mean(&|painted| painted.triangles),
        embree_ns: views[0].embree.map(|_| middle(&|view| ns(view.embree.unwrap_or(f64::NAN), view))),
        floor_ns: middle(&|view| ns(view.floor, view)),
    }
}

/// The columns of [`Row::cells`], the first three of them words.
const COLUMNS: [&str; 16] = [
    "scene",
    "from",
    "way",
    "views",
    "Embree / ours",
    "worst",
    "ours / floor",
    "worst",
    "ms",
    "Mpixels/s",
    "to rays, %",
    "cells",
    "spans",
    "triangles",
    "Embree, ns",
    "floor, ns",
];

impl Row {
    fn cells(&self) -> [String; 16] {
        let embree =
            |of: fn(&Spread) -> f64| self.embree.map_or_else(String::new, |s| format!("{:.2}", of(&s)));
        [
            self.scene.clone(),
            self.from.to_owned(),
            self.way.clone(),
            self.views.to_string(),
            embree(|spread| spread.median),
            embree(|spread| spread.worst),
            format!("{:.2}", self.floor.median),
            format!("{:.2}", self.floor.worst),
            format!("{:.3}", self.ms),
            format!("{:.0}", self.mpixels_per_s),
            format!("{:.3}", self.unsure * 100.0),
            format!("{:.0}", self.cells),
            self.spans.map_or_else(String::new, |spans| format!("{spans:.0}")),
            format!("{:.0}", self.triangles),
            self.embree_ns.map_or_else(String::new, |ns| format!("{ns:.1}")),
            format!("{:.3}", self.floor_ns),
        ]
    }
}

/// Rows as lines of text, below [`Report::head`]; a column is as wide as its name, and the first three as long names
/// need.
pub fn lines(rows: &[Row]) -> String {
    rows.iter().map(|row| line(&row.cells().each_ref().map(String::as_str))).collect()
}

fn line(cells: &[&str]) -> String {
    let mut out = String::new();
    for (i, (cell, name)) in cells.iter().zip(COLUMNS).enumerate() {
        // Writing to a String cannot fail.
        let _ = match i {
            0 => write!(out, "{cell:<20}"),
            1 => write!(out, "  {cell:<8}"),
            2 => write!(out, "  {cell:<16}"),
            _ => write!(out, "  {cell:>width$}", width = name.len().max(6)),
        };
    }
    out.push('\n');
    out
}

/// All that was measured, and where.
#[derive(Serialize)]
pub struct Report {
    /// The processor's name and what of its instruction sets matters.
    pub machine: String,
    /// Its version.
    pub embree: Option<String>,
    /// Pixels along a side.
    pub size: u32,
    pub repeat: usize,
    pub rows: Vec<Row>,
    /// Each picture for itself.
    pub views: Vec<View>,
}

impl Report {
    /// Of nothing yet.
    pub fn new(arguments: &Arguments, embree: Option<&Embree>) -> Report {
        Report {
            machine: crate::report::machine(),
            embree: embree.map(|embree| embree.version.clone()),
            size: arguments.picture_size,
            repeat: arguments.repeat.max(1),
            rows: Vec::new(),
            views: Vec::new(),
        }
    }

    fn about(&self) -> String {
        let embree = match &self.embree {
            Some(version) => format!(
                "Embree {version}: coherent packets of 16 rays, one for each 4 x 4 pixels, \
                 the better of high and medium quality."
            ),
            None => "Without Embree.".to_owned(),
        };
        format!(
            "{}, one thread, or two where it says so; pictures of {} x {}; medians of {} interleaved repeats.\n{embree}\n\
             Worst: the view that is worst for us; other figures are medians of the views, \
             and shares and counts their means.",
            self.machine, self.size, self.size, self.repeat
        )
    }

    /// What was measured where, and the columns of [`lines`].
    pub fn head(&self) -> String {
        format!("{}\n\n{}", self.about(), line(&COLUMNS))
    }

    /// As a table.
    pub fn markdown(&self) -> String {
        let mut out = format!("{}\n\n| {} |\n", self.about(), COLUMNS.join(" | "));
        // Writing to a String cannot fail.
        let _ = writeln!(out, "|{}{}", "---|".repeat(3), "---:|".repeat(COLUMNS.len() - 3));
        for row in &self.rows {
            let _ = writeln!(out, "| {} |", row.cells().join(" | "));
        }
        out
    }
}
