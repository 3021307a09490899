//! What it takes to find a hit.

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
    /// Of the prisms, those with nothing in them: no hierarchy was entered.
    pub empty: u32,
    /// Faces whose plane was met without a look at triangles.
    pub plain: u32,
}

impl Cost {
    /// All steps: what is skipped is none.
    pub const fn total(self) -> u32 {
        let detail = self.nodes.saturating_add(self.blocks).saturating_add(self.tests);
        detail.saturating_add(self.cells).saturating_add(self.unsure)
    }
}

/// What is told of each step of a ray. The unit type counts nothing, and costs nothing.
pub(super) trait Count {
    /// A node was opened: eight boxes.
    #[inline(always)]
    fn node(&mut self) {}
    /// A leaf was opened: up to eight triangles, in f32.
    #[inline(always)]
    fn block(&mut self) {}
    /// A triangle was tested in f64.
    #[inline(always)]
    fn test(&mut self) {}
    /// A prism was entered.
    #[inline(always)]
    fn cell(&mut self) {}
    /// There is nothing in the prism, and nothing was opened.
    #[inline(always)]
    fn empty(&mut self) {}
    /// A plane was met, and no triangle tested.
    #[inline(always)]
    fn plain(&mut self) {}
    /// A walk from cell to cell could not tell, and all triangles are asked.
    #[inline(always)]
    fn unsure(&mut self) {}
}

impl Count for () {}

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
    fn cell(&mut self) {
        self.cells = self.cells.saturating_add(1);
    }
    fn empty(&mut self) {
        self.empty = self.empty.saturating_add(1);
    }
    fn plain(&mut self) {
        self.plain = self.plain.saturating_add(1);
    }
    fn unsure(&mut self) {
        self.unsure = self.unsure.saturating_add(1);
    }
}
