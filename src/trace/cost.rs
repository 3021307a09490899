//! What it takes to find a hit.

use super::walk::Count;

/// How many steps a ray took: the same on every machine and kernel, unlike time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Cost {
    /// Nodes opened: eight boxes each.
    pub nodes: u32,
    /// Blocks opened: up to eight triangles each, looked at in f32.
    pub blocks: u32,
    /// Triangles tested in f64.
    pub tests: u32,
    /// Prisms crossed.
    pub cells: u32,
    /// Walks from cell to cell that could not tell, and were answered by the hierarchy of all triangles.
    pub unsure: u32,
}

impl Cost {
    /// All steps.
    pub const fn total(self) -> u32 {
        let detail = self.nodes.saturating_add(self.blocks).saturating_add(self.tests);
        detail.saturating_add(self.cells).saturating_add(self.unsure)
    }
}

impl Count for Cost {
    fn node(&mut self) {
        self.nodes = self.nodes.saturating_add(1);
    }
    fn block(&mut self) {
        self.blocks = self.blocks.saturating_add(1);
    }
    fn test(&mut self) {
        self.tests = self.tests.saturating_add(1);
    }
}
