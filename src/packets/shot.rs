//! A picture under way: what is the same for all its packets.

use crate::beam::backs::Hidden;
use crate::beam::fringe::Fringe;
use crate::beam::joined::Joined;
use crate::beam::kernels::Kernels;
use crate::beam::outer::Outer;
use crate::beam::parting::By;
use crate::beam::screen::{Plane, Screen};
use crate::beam::shade::{self, Looks, Shading};
use crate::beam::walk::Known;
use crate::format::Views;
use crate::trace::Prisms;

/// What pixels become.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Show {
    /// Colours.
    Light,
    /// Numbers of what they show.
    Surfaces,
    /// How large the packet was that told.
    Sizes,
}

impl Show {
    /// What the pixels of triangles become, and of what is left to rays.
    pub(super) fn of_canvas(self) -> shade::Show {
        if self == Show::Light { shade::Show::Light } else { shade::Show::Surfaces }
    }
}

/// A picture under way.
pub(super) struct Shot<'s> {
    /// Which picture of its maker.
    pub(super) number: u64,
    pub(super) tables: &'s Views,
    pub(super) prisms: Prisms<'s>,
    pub(super) screen: Screen,
    /// Along the internal frame's axes.
    pub(super) internal: Screen,
    pub(super) kernels: Kernels,
    /// The square of the size of a ray, as [`Shading::square`].
    pub(super) square: [f32; 5],
    pub(super) known: &'s Known,
    pub(super) looks: &'s Looks,
    pub(super) joined: &'s Joined,
    pub(super) hidden: Hidden<'s>,
    pub(super) width: u32,
    pub(super) show: Show,
    /// The cell of the eye; none in a solid.
    pub(super) start: Option<u32>,
    /// What lies around the prisms.
    pub(super) outer: &'s Outer,
}

impl Shot<'_> {
    /// The plane that splits a surface.
    pub(super) fn splitting(&self, by: By) -> Plane {
        match by {
            By::Upright([a, b]) => self.screen.upright(a, b),
            By::Level(plane) => self.screen.level(self.prisms.plane(plane), 1.0),
        }
    }

    /// How far off the planes of a cell are.
    pub(super) fn fringe(&self, cell: u32) -> &Fringe {
        self.known.fringes.of(self.tables, cell)
    }

    /// How a source of faces looks in a plane.
    pub(super) fn shading(&self, source: u32, plane: &Plane) -> Shading {
        let first = self.tables.sources[source as usize].first;
        let color = self.looks.of(self.tables, self.tables.surfaces[first as usize]);
        Shading::new(plane.grows.map(|c| (c / plane.size) as f32), self.square, color)
    }
}
