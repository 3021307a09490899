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
    /// Times that the hierarchy of all triangles was asked, since it was in doubt what cells tell.
    pub unsure: u32,
    /// Of the prisms, those with nothing in them: no hierarchy was entered.
    pub empty: u32,
    /// Faces whose plane was met without a look at triangles: on the quick way only.
    pub plain: u32,
    /// Of the prisms, those that were left by the kernel for sloped floors and ceilings: on the quick way only.
    pub sloped: u32,
}

impl Cost {
    /// All steps: what is skipped is none.
    pub const fn total(self) -> u32 {
        let detail = self.nodes.saturating_add(self.blocks).saturating_add(self.tests);
        detail.saturating_add(self.cells).saturating_add(self.unsure)
    }
}

/// Steps of many rays together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Costs {
    /// Rays.
    pub rays: u64,
    /// See [`Cost::nodes`].
    pub nodes: u64,
    /// See [`Cost::blocks`].
    pub blocks: u64,
    /// See [`Cost::tests`].
    pub tests: u64,
    /// See [`Cost::cells`].
    pub cells: u64,
    /// See [`Cost::unsure`].
    pub unsure: u64,
    /// See [`Cost::empty`].
    pub empty: u64,
    /// See [`Cost::plain`].
    pub plain: u64,
    /// See [`Cost::sloped`].
    pub sloped: u64,
}

impl Costs {
    /// Adds a ray's.
    pub fn add(&mut self, cost: &Cost) {
        let Cost { nodes, blocks, tests, cells, unsure, empty, plain, sloped } = *cost;
        let one = [1, nodes, blocks, tests, cells, unsure, empty, plain, sloped].map(u64::from);
        self.add_all(one);
    }

    /// Adds those of other rays.
    pub fn merge(&mut self, other: &Costs) {
        let Costs { rays, nodes, blocks, tests, cells, unsure, empty, plain, sloped } = *other;
        self.add_all([rays, nodes, blocks, tests, cells, unsure, empty, plain, sloped]);
    }

    fn add_all(&mut self, steps: [u64; 9]) {
        let Costs { rays, nodes, blocks, tests, cells, unsure, empty, plain, sloped } = self;
        for (sum, steps) in
            [rays, nodes, blocks, tests, cells, unsure, empty, plain, sloped].into_iter().zip(steps)
        {
            *sum += steps;
        }
    }

    /// A number of steps as the mean of a ray.
    pub fn mean(&self, steps: u64) -> f64 {
        steps as f64 / self.rays.max(1) as f64
    }
}

impl std::fmt::Display for Costs {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mean = |steps: u64| self.mean(steps);
        writeln!(f, "{} rays; in the mean each", self.rays)?;
        writeln!(
            f,
            "  crosses {:.3} cells, {:.3} of them with nothing in them, {:.3} between slopes",
            mean(self.cells),
            mean(self.empty),
            mean(self.sloped)
        )?;
        writeln!(
            f,
            "  opens {:.3} nodes of eight boxes, {:.3} blocks of up to eight triangles",
            mean(self.nodes),
            mean(self.blocks)
        )?;
        writeln!(
            f,
            "  tests {:.3} triangles, and meets {:.3} planes without a test of any",
            mean(self.tests),
            mean(self.plain)
        )?;
        write!(f, "  asks the hierarchy of all triangles, in doubt: {:.6}", mean(self.unsure))
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
    /// A prism was entered, to be left by the kernel for slopes, or not: not asked where nothing is counted.
    #[inline(always)]
    fn cell(&mut self, _is_sloped: impl FnOnce() -> bool) {}
    /// There is nothing in the prism, and nothing was opened.
    #[inline(always)]
    fn empty(&mut self) {}
    /// A plane was met, and no triangle tested.
    #[inline(always)]
    fn plain(&mut self) {}
    /// It is in doubt what cells tell, and all triangles are asked.
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
    fn cell(&mut self, is_sloped: impl FnOnce() -> bool) {
        self.cells = self.cells.saturating_add(1);
        self.sloped = self.sloped.saturating_add(u32::from(is_sloped()));
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
