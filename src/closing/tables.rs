//! A scene's tables with sheets added and leaves taken out.
//!
//! All that is added follows what the file has: sheets' vertices and triangles, and hierarchies over them for the cells that they come near to
//! and for cell 0, whose hierarchy holds all triangles. What is taken out leaves its lane in a block empty.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use glam::DVec3;

use super::Known;
use super::section::{HalfSpace, half_spaces, touches};
use super::sheet::Sheet;
use super::tree::{Item, Tree};
use crate::format::View;
use crate::format::Views;
use crate::format::records::{BlockRecord, CellRecord, LANES, NodeRecord, RunRecord};
use crate::trace::{NONE, Prisms, Step};

/// The tables that are changed, as they were opened.
#[derive(Clone)]
pub(super) struct Base {
    cells: View<CellRecord>,
    steps: View<Step>,
    nodes: View<NodeRecord>,
    blocks: View<BlockRecord>,
    triangles: View<[u32; 3]>,
    runs: View<RunRecord>,
    run_of: View<u32>,
    vertices: View<[f64; 3]>,
    /// Where triangles of leaves are in blocks: element, block, lane.
    leaves: Vec<(u32, u32, u8)>,
}

/// A sheet, and what rays meet on it.
pub(super) struct Placed<'a> {
    pub(super) sheet: &'a Sheet,
    pub(super) element: u32,
    pub(super) material: u32,
}

impl Base {
    pub(super) fn of(tables: &Views, known: &Known) -> Base {
        let all: BTreeSet<u32> = known.leaves.values().flatten().copied().collect();
        let mut is_leaf = vec![false; tables.elements.len()];
        all.into_iter().for_each(|leaf| is_leaf[leaf as usize] = true);
        let mut leaves = Vec::new();
        for (block, record) in tables.blocks.iter().enumerate() {
            for lane in (0..LANES).filter(|&lane| record.triangle[lane] != NONE) {
                let element = tables.record(record.triangle[lane]).element;
                if is_leaf[element as usize] {
                    leaves.push((element, block as u32, lane as u8));
                }
            }
        }
        leaves.sort_unstable();
        Base {
            cells: tables.cells.clone(),
            steps: tables.steps.clone(),
            nodes: tables.nodes.clone(),
            blocks: tables.blocks.clone(),
            triangles: tables.triangles.clone(),
            runs: tables.runs.clone(),
            run_of: tables.run_of.clone(),
            vertices: tables.vertices.clone(),
            leaves,
        }
    }

    pub(super) fn restore(self, tables: &mut Views) {
        tables.cells = self.cells;
        tables.steps = self.steps;
        tables.nodes = self.nodes;
        tables.blocks = self.blocks;
        tables.triangles = self.triangles;
        tables.runs = self.runs;
        tables.run_of = self.run_of;
        tables.vertices = self.vertices;
    }

    /// Makes the tables those of the file, without what is of `hidden` elements, and with sheets. Returns the triangles of each.
    pub(super) fn apply(
        &self,
        tables: &mut Views,
        hidden: &BTreeSet<u32>,
        sheets: &[Placed<'_>],
    ) -> Vec<Range<u32>> {
        let mut ranges = Vec::with_capacity(sheets.len());
        let (first_vertex, first) = (self.vertices.len() as u32, self.triangles.len() as u32);
        let mut items = Vec::new();
        tables.vertices.edit(|vertices| {
            vertices.truncate(self.vertices.len());
            vertices.extend(sheets.iter().flat_map(|placed| &placed.sheet.triangles).flatten());
        });
        tables.triangles.edit(|triangles| {
            triangles.truncate(self.triangles.len());
            for Placed { sheet, .. } in sheets {
                let start = triangles.len() as u32;
                for corners in &sheet.triangles {
                    let triangle = triangles.len() as u32;
                    let vertex = first_vertex + 3 * (triangle - first);
                    triangles.push([vertex, vertex + 1, vertex + 2]);
                    items.push(Item { triangle, corners: corners.map(DVec3::from) });
                }
                ranges.push(start..triangles.len() as u32);
            }
        });
        tables.runs.edit(|runs| {
            runs.truncate(self.runs.len());
            runs.extend(sheets.iter().zip(&ranges).map(|(placed, range)| RunRecord {
                first: range.start,
                element: placed.element,
                material: placed.material,
                volume: NONE,
                facing: 0,
            }));
        });
        tables.run_of.edit(|run_of| {
            run_of.truncate(self.run_of.len());
            for (run, range) in (self.runs.len() as u32..).zip(&ranges) {
                run_of.resize(range.end as usize, run);
            }
        });
        // The cells as they are in the file: only their roots change.
        let of_cells = near(&Prisms::new(tables), &items, tables.scene[0].tolerance);
        let (center, slack) = (DVec3::from(tables.scene[0].center), tables.scene[0].slack);
        let (nodes, cells, steps) = (&mut tables.nodes, &mut tables.cells, &mut tables.steps);
        tables.blocks.edit(|blocks| {
            blocks.truncate(self.blocks.len());
            for &(element, block, lane) in &self.leaves {
                let (block, lane) = (block as usize, lane as usize);
                let source =
                    if hidden.contains(&element) { &BlockRecord::EMPTY } else { &self.blocks[block] };
                blocks[block].take(lane, source);
            }
            nodes.edit(|nodes| {
                nodes.truncate(self.nodes.len());
                let mut tree = Tree { nodes, blocks, center, slack };
                cells.edit(|cells| {
                    cells.copy_from_slice(&self.cells);
                    for (cell, chosen) in of_cells {
                        let mut own: Vec<Item> = chosen.iter().map(|&i| items[i as usize]).collect();
                        let root = &mut cells[cell as usize].root;
                        *root = tree.grow(*root, &mut own);
                    }
                    if !items.is_empty() {
                        cells[0].root = tree.grow(cells[0].root, &mut items);
                    }
                    steps.edit(|steps| {
                        for (step, cell) in steps.iter_mut().zip(cells).filter(|(step, _)| step.is_some()) {
                            step.root = cell.root;
                        }
                    });
                });
            });
        });
        ranges
    }
}

/// For each cell of air that items come near to, which.
fn near(prisms: &Prisms<'_>, items: &[Item], margin: f64) -> BTreeMap<u32, Vec<u32>> {
    let mut spaces: BTreeMap<u32, Vec<HalfSpace>> = BTreeMap::new();
    let mut chosen: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for (item, index) in items.iter().zip(0..) {
        let corners = item.corners.map(|p| prisms.local(p));
        let [a, b, c] = corners;
        let (lo, hi) = (a.min(b).min(c) - margin, a.max(b).max(c) + margin);
        let mut cells = prisms.listed_along(lo, hi);
        cells.sort_unstable();
        cells.dedup();
        for cell in cells {
            let record = &prisms.cells[cell as usize];
            let [from, to] = record.bounds.map(DVec3::from);
            if record.kind != CellRecord::AIR || from.cmpgt(hi).any() || to.cmplt(lo).any() {
                continue;
            }
            let spaces = spaces.entry(cell).or_insert_with(|| half_spaces(prisms, record));
            if touches(spaces, corners, margin) {
                chosen.entry(cell).or_default().push(index);
            }
        }
    }
    chosen
}
