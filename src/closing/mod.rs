//! Doors at run time: openings of a scene closed and opened, their leaves kept in or taken out.
//!
//! A scene holds a building as it was modelled: the air of a doorway, and in it the mesh of the door's leaf, which stands as somebody drew
//! it. [`Scene::set_open`] puts a *sheet* across the opening, which closes it whatever its leaf does, and takes the leaf's triangles out, or
//! back in. Both are detail: what rays meet is as exact as it is without them, and is told by the same code. `docs/GRAPH.md` has how the
//! sheet is found.

mod section;
mod sheet;
mod tables;
mod tree;

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use enfilade_importers::Role;

use crate::format::Views;
use crate::graph::is_opening;
use crate::scene::Scene;
use sheet::{Missing, Sheet};
use tables::{Base, Placed};

/// Whether what fills an opening is in the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Leaf {
    /// As it was modelled.
    #[default]
    In,
    /// Rays do not meet it.
    Out,
}

/// How an opening stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Stand {
    /// Without a sheet across it.
    pub open: bool,
    /// Whether its leaf is in the scene.
    pub leaf: Leaf,
}

impl Stand {
    /// As modelled: no sheet, the leaf where it was drawn.
    pub const MODELLED: Stand = Stand { open: true, leaf: Leaf::In };
    /// Nothing in the way.
    pub const FREE: Stand = Stand { open: true, leaf: Leaf::Out };
    /// The leaf where it was drawn, and a sheet.
    pub const CLOSED: Stand = Stand { open: false, leaf: Leaf::In };
    /// A sheet alone.
    pub const SEALED: Stand = Stand { open: false, leaf: Leaf::Out };
}

impl Default for Stand {
    fn default() -> Stand {
        Stand::MODELLED
    }
}

/// A sheet that closes an opening.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Closure {
    /// Index of the opening's element.
    pub opening: u32,
    /// The sheet's triangles, for [`Scene::triangle`] and [`Hit::triangle`](crate::Hit::triangle). They follow those of the file and change
    /// with every call of [`Scene::set_open`].
    pub triangles: Range<u32>,
    /// Its area within the opening, m2.
    pub area: f64,
    /// The share of its outline that is on matter, or on the sheet of another opening in the same hole, from 0 to 1: where it is less than 1,
    /// air leads around it.
    pub sealed: f64,
}

/// An opening could not be closed or opened.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ClosingError {
    /// The element is no opening, and fills none.
    #[error("element '{0}' is no opening of the building, and fills none")]
    NoOpening(String),
    /// There is no element with this index.
    #[error("there is no element {0}")]
    NoElement(u32),
    /// The opening has no air of its own to put a sheet in: it was not cut from its host, others fill it, or the scene has no cells.
    #[error("opening '{0}' has no air of its own in this scene: there is nothing to close")]
    NoAir(String),
    /// No matter is around the opening: a cupboard's, say, in the middle of a room.
    #[error("no matter is around opening '{0}' in this scene: nothing would hold what closes it")]
    NoMatter(String),
    /// What fills the opening carves space, and cannot be taken out.
    #[error(
        "'{leaf}', which fills opening '{opening}', is a solid that cells were cut around: it cannot be taken out"
    )]
    SolidLeaf {
        /// The opening's identity.
        opening: String,
        /// The leaf's.
        leaf: String,
    },
}

/// Which openings of a scene stand otherwise than modelled.
#[derive(Default)]
pub(crate) struct Closing {
    stands: BTreeMap<u32, Stand>,
    closures: Vec<Closure>,
    /// Cells by opening, and elements that fill it; told when first asked for.
    known: Option<Known>,
    /// By opening: its sheet, or that there can be none; told when first asked for.
    sheets: BTreeMap<u32, Result<Sheet, Missing>>,
    /// The tables as they were opened.
    base: Option<Base>,
    /// Elements that carve space in the file, where the tables no longer tell.
    carving: Option<BTreeSet<u32>>,
}

impl Closing {
    /// The tables as they are without any of this.
    pub(crate) fn modelled(&self, tables: &Views) -> Views {
        let mut tables = tables.clone();
        if let Some(base) = &self.base {
            base.clone().restore(&mut tables);
        }
        tables
    }

    /// The closing of a scene with these tables, of which some solids may have been hidden: that of one where all stand as modelled.
    pub(crate) fn of_hidden(&self, tables: &Views) -> Closing {
        let carving = self.carving.clone().unwrap_or_else(|| carving(tables));
        Closing { carving: Some(carving), ..Closing::default() }
    }

    /// The openings that do not stand as modelled.
    pub(crate) fn stands(&self) -> Vec<(u32, Stand)> {
        self.stands.iter().map(|(&opening, &stand)| (opening, stand)).collect()
    }
}

/// Elements that carve space.
fn carving(tables: &Views) -> BTreeSet<u32> {
    let solids = tables.volumes.iter().filter(|volume| volume.role == Role::Solid as u32);
    solids.map(|volume| volume.element).collect()
}

#[derive(Default)]
struct Known {
    cells: BTreeMap<u32, Vec<u32>>,
    leaves: BTreeMap<u32, BTreeSet<u32>>,
    /// Elements that carve space.
    carving: BTreeSet<u32>,
}

impl Known {
    fn of(scene: &Scene) -> Known {
        let mut known = Known::default();
        for (index, cell) in scene.cells().iter().enumerate() {
            if let Some(opening) = crate::graph::opening_of(cell) {
                known.cells.entry(opening).or_default().push(index as u32);
            }
        }
        known.carving = scene.closing.carving.clone().unwrap_or_else(|| carving(&scene.tables));
        for element in scene.elements() {
            if let Some(leaf) = element.filling() {
                known.leaves.entry(element.index()).or_default().insert(leaf);
            }
            if let Some(opening) = element.opening() {
                known.leaves.entry(opening).or_default().insert(element.index());
            }
        }
        known
    }
}

impl Scene {
    /// Opens or closes an opening, given by its own element or by one that fills it, and keeps its leaf in the scene or takes it out. A
    /// sheet that closes an opening stands in the plane of the leaf, or if that is not within the hole, in the middle of the hole;
    /// rays that meet it meet the element that fills the opening, or the opening where nothing does.
    ///
    /// Answers stay exact, no other answer changes, and opening again as modelled leaves no trace. The first call copies the tables
    /// that it changes.
    ///
    /// ```no_run
    /// use enfilade::Scene;
    /// use enfilade::closing::Leaf;
    ///
    /// let mut scene = Scene::open("house.enf".as_ref())?;
    /// let door = scene.elements().find(|element| element.class() == "IfcDoor").expect("a house has a door");
    /// scene.set_open(door.index(), false, Leaf::In)?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ClosingError`]; then nothing is changed.
    pub fn set_open(&mut self, element: u32, open: bool, leaf: Leaf) -> Result<(), ClosingError> {
        self.set_stands(&[(element, Stand { open, leaf })])
    }

    /// The same for many openings at once, which is much quicker than one by one. Of two that are the same, the last counts.
    ///
    /// # Errors
    /// [`ClosingError`] of one that fails; then nothing is changed.
    pub fn set_stands(&mut self, stands: &[(u32, Stand)]) -> Result<(), ClosingError> {
        let known = self.closing.known.take().unwrap_or_else(|| Known::of(self));
        let result =
            self.wanted(stands).and_then(|next| match self.failing(&next, &known).into_iter().next() {
                Some((_, error)) => Err(error),
                None => {
                    self.stand_as(next, &known);
                    Ok(())
                }
            });
        self.closing.known = Some(known);
        result
    }

    /// As [`Scene::set_stands`], but those that can stand so do, and the others are left as they are and returned: the opening's element, and
    /// why.
    ///
    /// # Errors
    /// [`ClosingError`] for what is no opening; then nothing is changed.
    pub fn set_stands_where_possible(
        &mut self,
        stands: &[(u32, Stand)],
    ) -> Result<Vec<(u32, ClosingError)>, ClosingError> {
        let known = self.closing.known.take().unwrap_or_else(|| Known::of(self));
        let result = self.wanted(stands).map(|mut next| {
            let failing = self.failing(&next, &known);
            for (opening, _) in &failing {
                match self.closing.stands.get(opening) {
                    Some(before) => next.insert(*opening, *before),
                    None => next.remove(opening),
                };
            }
            self.stand_as(next, &known);
            failing
        });
        self.closing.known = Some(known);
        result
    }

    /// How all openings that do not stand as modelled are to stand.
    fn wanted(&self, stands: &[(u32, Stand)]) -> Result<BTreeMap<u32, Stand>, ClosingError> {
        let mut next = self.closing.stands.clone();
        for &(element, stand) in stands {
            next.insert(self.opening_at(element)?, stand);
        }
        next.retain(|_, stand| *stand != Stand::MODELLED);
        Ok(next)
    }

    /// Those that cannot stand so.
    fn failing(&mut self, next: &BTreeMap<u32, Stand>, known: &Known) -> Vec<(u32, ClosingError)> {
        let closed = next.iter().filter(|(_, stand)| !stand.open).map(|(&opening, _)| opening);
        let missing: Vec<u32> = closed.filter(|opening| !self.closing.sheets.contains_key(opening)).collect();
        let found = crate::parallel::map(missing.len(), |i| {
            sheet::sheet(self, missing[i], &known.cells, known.leaves.get(&missing[i]))
        });
        self.closing.sheets.extend(missing.into_iter().zip(found));
        let mut failing = Vec::new();
        for (&opening, stand) in next {
            let id = || self.element(opening).id().to_owned();
            let leaves = known.leaves.get(&opening).into_iter().flatten();
            let mut solid = leaves.filter(|leaf| known.carving.contains(leaf));
            if let (Leaf::Out, Some(&leaf)) = (stand.leaf, solid.next()) {
                let leaf = self.element(leaf).id().to_owned();
                failing.push((opening, ClosingError::SolidLeaf { opening: id(), leaf }));
                continue;
            }
            match self.closing.sheets.get(&opening) {
                _ if stand.open => {}
                Some(Ok(_)) => {}
                Some(Err(Missing::Matter)) => failing.push((opening, ClosingError::NoMatter(id()))),
                Some(Err(Missing::Air)) | None => failing.push((opening, ClosingError::NoAir(id()))),
            }
        }
        failing
    }

    fn stand_as(&mut self, next: BTreeMap<u32, Stand>, known: &Known) {
        let out = next.iter().filter(|(_, stand)| stand.leaf == Leaf::Out);
        let hidden: BTreeSet<u32> =
            out.filter_map(|(opening, _)| known.leaves.get(opening)).flatten().copied().collect();
        self.closing.stands = next;
        self.rebuild(&hidden, known);
    }

    fn sheet_of(&self, opening: u32) -> Option<&Sheet> {
        self.closing.sheets.get(&opening)?.as_ref().ok()
    }

    /// The opening that an element is, or fills.
    fn opening_at(&self, element: u32) -> Result<u32, ClosingError> {
        if element >= self.element_count() {
            return Err(ClosingError::NoElement(element));
        }
        let is = |index: u32| {
            let element = self.element(index);
            is_opening(element.semantic()) && element.role() == Role::Air
        };
        let view = self.element(element);
        match view.opening() {
            _ if is(element) => Ok(element),
            Some(opening) if is(opening) => Ok(opening),
            _ => Err(ClosingError::NoOpening(view.id().to_owned())),
        }
    }

    /// How an opening stands, given by its own element or by one that fills it; anything else stands as modelled.
    pub fn stand(&self, element: u32) -> Stand {
        let opening = self.opening_at(element).ok();
        opening.and_then(|opening| self.closing.stands.get(&opening)).copied().unwrap_or_default()
    }

    /// The sheets in the scene, in the order of their openings.
    pub fn closures(&self) -> &[Closure] {
        &self.closing.closures
    }

    /// The opening that a triangle closes, as index of its element; `None` if it is one of the model's own.
    pub fn closed_by(&self, triangle: u32) -> Option<u32> {
        self.closure_at(triangle).map(|place| self.closing.closures[place].opening)
    }

    /// The place in [`Scene::closures`] of the sheet that a triangle is of.
    pub(crate) fn closure_at(&self, triangle: u32) -> Option<usize> {
        let closures = &self.closing.closures;
        let place = closures.partition_point(|closure| closure.triangles.end <= triangle);
        closures.get(place).is_some_and(|closure| closure.triangles.contains(&triangle)).then_some(place)
    }

    /// What rays meet on a sheet of an opening: the element, and its material.
    fn surface_of(&self, opening: u32, known: &Known) -> (u32, u32) {
        let element =
            known.leaves.get(&opening).and_then(|leaves| leaves.first()).copied().unwrap_or(opening);
        let record = &self.tables.elements[element as usize];
        let own = record.first_triangle..record.first_triangle + record.triangle_count;
        // That of most of its surface.
        let mut areas: BTreeMap<u32, f64> = BTreeMap::new();
        for triangle in own {
            let [a, b, c] = self.triangle(triangle).map(glam::DVec3::from);
            let material = self.tables.record(triangle).material;
            *areas.entry(material).or_default() += (b - a).cross(c - a).length();
        }
        let most = areas.iter().max_by(|a, b| a.1.total_cmp(b.1).then(b.0.cmp(a.0)));
        (element, most.map_or(0, |(material, _)| *material))
    }

    /// Makes the tables say what the stands do.
    fn rebuild(&mut self, hidden: &BTreeSet<u32>, known: &Known) {
        let base = match self.closing.base.take() {
            Some(base) => base,
            None => Base::of(&self.tables, known),
        };
        self.closing.closures.clear();
        if self.closing.stands.is_empty() {
            base.restore(&mut self.tables);
            return;
        }
        let stands = self.closing.stands.iter();
        let closed: Vec<(u32, Sheet)> = stands
            .filter(|(_, stand)| !stand.open)
            .filter_map(|(&opening, _)| Some((opening, self.sheet_of(opening)?.clone())))
            .collect();
        let placed: Vec<Placed<'_>> = closed
            .iter()
            .map(|(opening, sheet)| {
                let (element, material) = self.surface_of(*opening, known);
                Placed { sheet, element, material }
            })
            .collect();
        let ranges = base.apply(&mut self.tables, hidden, &placed);
        let sheet_at = |other: u32| {
            let place = closed.binary_search_by_key(&other, |(opening, _)| *opening).ok()?;
            Some(&closed[place].1)
        };
        for ((opening, sheet), triangles) in closed.iter().zip(ranges) {
            let sealed = sheet.sealed(sheet_at);
            self.closing.closures.push(Closure { opening: *opening, triangles, area: sheet.area, sealed });
        }
        self.closing.base = Some(base);
    }
}
