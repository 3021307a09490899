//! Makes an element of every shown node with a mesh.

use std::collections::HashMap;
use std::rc::Rc;

use gltf::Document;
use gltf::json;

use super::accessors::{Accessors, Vectors};
use super::buffers::Buffers;
use super::document::Placement;
use super::graph::{self, Graph};
use super::identity::Identities;
use super::instancing;
use super::lights;
use super::materials::{self, Materials};
use super::mesh::{Part, Plan};
use super::transform::Affine;
use super::uri::Uris;
use super::whole::Wholes;
use super::{fault, malformed};
use crate::builder::{ModelBuilder, NewElement};
use crate::error::{ImportError, ImportErrorKind};
use crate::import::ImportOptions;
use crate::limits::Budget;
use crate::model::{ElementId, LeftOut, LeftOutReason, MaterialId, Model};

/// Bytes that a triangle takes in the builder, at most.
const TRIANGLE: usize = 160;

/// More triangles than this are no count that a file can mean.
const COUNTABLE: u64 = 1 << 53;

/// Fills `builder` with all that the file shows.
///
/// # Errors
/// See [`super::read`].
pub(super) fn fill(
    mut builder: ModelBuilder,
    document: &Document,
    placements: &[Placement],
    buffers: &Buffers<'_>,
    uris: &Uris,
    options: &ImportOptions,
) -> Result<Model, ImportError> {
    let root = document.as_json();
    let graph = graph::walk(root, placements, builder.budget())?;
    let materials = materials::load(root, buffers, uris, &options.limits, &options.watch, &mut builder)?;
    let mut reader = Reader {
        root,
        graph: &graph,
        accessors: Accessors::new(document, buffers),
        identities: Identities::new(root, &graph),
        wholes: Wholes::find(root, &graph),
        options,
        builder,
        materials,
        plans: vec![None; root.meshes.len()],
        points: HashMap::new(),
        uses: vec![0; root.accessors.len()],
        work: Budget::new(&options.limits),
        skins: None,
    };
    reader.count_uses()?;
    for visit in 0..graph.visits.len() {
        if visit % 64 == 0 {
            options.watch.report("read", visit as f64 / graph.visits.len() as f64);
        }
        reader.check_cancelled()?;
        reader.visit(visit)?;
    }
    reader.note_hidden()?;
    reader.note_skins();
    options.watch.report("read", 1.0);
    reader.builder.finish()
}

struct Reader<'a> {
    root: &'a json::Root,
    graph: &'a Graph,
    accessors: Accessors<'a>,
    identities: Identities<'a>,
    wholes: Wholes,
    options: &'a ImportOptions,
    builder: ModelBuilder,
    materials: Materials,
    /// By mesh, once needed.
    plans: Vec<Option<Rc<Plan>>>,
    /// Points that were read and will be needed again, by accessor. Many primitives may share one accessor, and
    /// many nodes one mesh: each accessor is read once, and kept until its last use.
    points: HashMap<usize, Rc<Vectors<3>>>,
    /// By accessor: how often its points will still be needed.
    uses: Vec<u64>,
    /// What all triangles would take if none were left out. Triangles without area cost no memory, but time:
    /// without this account a small file with many nodes on one mesh could take hours.
    work: Budget,
    /// Nodes with skins, and the first of them.
    skins: Option<(u64, usize)>,
}

/// A part of a mesh, read.
struct Surface<'p> {
    part: &'p Part,
    points: Rc<Vectors<3>>,
    material: MaterialId,
}

impl Reader<'_> {
    /// Counts how often the points of each accessor will be needed.
    fn count_uses(&mut self) -> Result<(), ImportError> {
        let mut mesh_uses = vec![0u64; self.root.meshes.len()];
        for visit in &self.graph.visits {
            if let Some(mesh) = self.root.nodes[visit.node].mesh {
                mesh_uses[mesh.value()] += 1;
            }
        }
        for (mesh, uses) in mesh_uses.into_iter().enumerate().filter(|(_, uses)| *uses > 0) {
            for part in &self.plan(mesh)?.parts {
                self.uses[part.positions] += uses;
            }
        }
        Ok(())
    }

    fn visit(&mut self, visit: usize) -> Result<(), ImportError> {
        let shown = &self.graph.visits[visit];
        let node = &self.root.nodes[shown.node];
        lights::read(self.root, shown, &mut self.builder);
        let parts = self.wholes.take_parts(visit);
        let is_part = self.wholes.is_part(visit);
        let is_element = !parts.is_empty() || (node.mesh.is_some() && !is_part);
        let element = self.identities.visit(visit, is_element, self.builder.budget())?;
        if !parts.is_empty() {
            return self.add_whole(visit, &parts, element);
        }
        // The parts of an element were read with the first of their nodes, so that they lie together.
        let Some(mesh) = node.mesh.filter(|_| !is_part) else { return Ok(()) };
        self.note_skin(shown.node);
        let plan = self.plan(mesh.value())?;
        let result = match instancing::of(node, shown.node, &self.accessors) {
            Ok(None) => self.add_copies(&plan, element, &[shown.world], false),
            Ok(Some(instances)) => self.add_instances(&plan, element, &instances, &shown.world),
            Err(error) => Err(error),
        };
        self.release(&plan);
        result.map_err(|error| match &error.element {
            Some(_) => error,
            None => error.of_element(self.element_name(visit)),
        })
    }

    /// Adds the element of `owner`, of which each of `parts` has some triangles.
    fn add_whole(
        &mut self,
        owner: usize,
        parts: &[usize],
        mut element: NewElement,
    ) -> Result<(), ImportError> {
        for &part in parts {
            self.identities.add_part(part, &mut element);
        }
        let id = self.builder.element(element)?;
        for &part in parts {
            let shown = &self.graph.visits[part];
            let Some(mesh) = self.root.nodes[shown.node].mesh else { continue };
            self.note_skin(shown.node);
            let plan = self.plan(mesh.value())?;
            let place = format!("nodes[{}]", shown.node);
            let result = match self.note_if_empty(&plan, Some(id), &place, 1) {
                true => Ok(()),
                false => self.surfaces(&plan).and_then(|surfaces| {
                    self.account(&plan, &place)?;
                    self.add_surfaces(&surfaces, id, &shown.world)?;
                    self.leave_out(&plan, Some(id), &place, 1);
                    Ok(())
                }),
            };
            self.release(&plan);
            result.map_err(|error| match &error.element {
                Some(_) => error,
                None => error.of_element(self.element_name(owner)),
            })?;
            self.check_cancelled()?;
        }
        Ok(())
    }

    fn note_skin(&mut self, node: usize) {
        if self.root.nodes[node].skin.is_some() {
            self.skins.get_or_insert((0, node)).0 += 1;
        }
    }

    /// The name of a node's element in errors; the path of one without name.
    fn element_name(&self, visit: usize) -> String {
        let name = self.root.nodes[self.graph.visits[visit].node].name.clone();
        name.filter(|name| !name.is_empty()).unwrap_or_else(|| self.graph.path(visit))
    }

    fn add_instances(
        &mut self,
        plan: &Plan,
        element: NewElement,
        instances: &instancing::Instances,
        world: &Affine,
    ) -> Result<(), ImportError> {
        let most = self.options.limits.max_elements;
        if u64::from(instances.count) > most {
            return Err(fault(element.place, ImportErrorKind::TooManyElements(most)));
        }
        let before = self.builder.budget().used();
        let mut copies = instances.transforms(&self.accessors, self.builder.budget())?;
        // The accessors' own values are gone again.
        let kept = (copies.len() * size_of::<Affine>()) as u64;
        let used = self.builder.budget().used();
        self.builder.budget().give_back((used - before).saturating_sub(kept));
        for copy in &mut copies {
            *copy = world.after(copy).map_err(|text| malformed(element.place.clone(), text))?;
        }
        let result = self.add_copies(plan, element, &copies, true);
        self.builder.budget().give_back(kept);
        result
    }

    /// Adds an element for each transform. `numbered` ones get `[1]`, `[2]`... behind id and path.
    fn add_copies(
        &mut self,
        plan: &Plan,
        element: NewElement,
        copies: &[Affine],
        numbered: bool,
    ) -> Result<(), ImportError> {
        if self.note_if_empty(plan, None, &element.place, copies.len() as u64) {
            return Ok(());
        }
        let surfaces = self.surfaces(plan)?;
        for (index, world) in copies.iter().enumerate() {
            self.account(plan, &element.place)?;
            let mut new = element.clone();
            if numbered {
                let number = index + 1;
                new.id = format!("{}[{number}]", new.id);
                new.path = format!("{}[{number}]", new.path);
                new.place = format!("{} instance {number}", new.place);
            }
            let place = new.place.clone();
            let id = self.builder.element(new)?;
            self.add_surfaces(&surfaces, id, world)?;
            self.leave_out(plan, Some(id), &place, 1);
            self.check_cancelled()?;
        }
        Ok(())
    }

    /// Whether a mesh has no triangles; if so, says what it has.
    fn note_if_empty(&mut self, plan: &Plan, element: Option<ElementId>, place: &str, copies: u64) -> bool {
        if plan.triangles > 0 {
            return false;
        }
        self.leave_out(plan, element, place, copies);
        if plan.points == 0 && plan.lines == 0 {
            self.builder.warn(place, "the node's mesh has no triangles");
        }
        true
    }

    /// The parts of a mesh with their points and materials.
    fn surfaces<'p>(&mut self, plan: &'p Plan) -> Result<Vec<Surface<'p>>, ImportError> {
        let mut surfaces = Vec::with_capacity(plan.parts.len());
        for part in &plan.parts {
            let points = self.points(part)?;
            // Damaged indices are better called that than too many.
            part.indices(&self.accessors, points.len())?;
            let material = self.materials.get(part.material, &mut self.builder);
            surfaces.push(Surface { part, points, material });
        }
        Ok(surfaces)
    }

    /// Books the work of one copy of a mesh.
    fn account(&mut self, plan: &Plan, place: &str) -> Result<(), ImportError> {
        let items = plan.triangles.saturating_add(plan.parts.len() as u64);
        self.work.take_items(items, TRIANGLE, "triangles").map_err(|e| fault(place, e.into()))
    }

    fn add_surfaces(
        &mut self,
        surfaces: &[Surface<'_>],
        element: ElementId,
        world: &Affine,
    ) -> Result<(), ImportError> {
        surfaces.iter().try_for_each(|s| self.add_part(s.part, &s.points, s.material, element, world))
    }

    fn add_part(
        &mut self,
        part: &Part,
        points: &Vectors<3>,
        material: MaterialId,
        element: ElementId,
        world: &Affine,
    ) -> Result<(), ImportError> {
        let mirrors = world.mirrors();
        let builder = &mut self.builder;
        let watch = &self.options.watch;
        let mut count = 0u32;
        part.for_each_triangle(&self.accessors, points, |[a, b, c]| {
            count = count.wrapping_add(1);
            if count.is_multiple_of(1 << 16) {
                watch.check().map_err(|e| fault("", e.into()))?;
            }
            let mut corners = [[0.0; 3]; 3];
            for (corner, vertex) in corners.iter_mut().zip(if mirrors { [a, c, b] } else { [a, b, c] }) {
                // In range: `for_each_triangle` checks.
                let point = points.get(vertex).unwrap_or_default();
                *corner = world.point(point);
                // The file's own value says more than what the transform makes of it.
                if let Some(value) = corner.iter().find(|c| !c.is_finite()) {
                    let value = *point.iter().find(|c| !c.is_finite()).unwrap_or(value);
                    let kind = ImportErrorKind::NotFinite { vertex: u64::from(vertex), value };
                    return Err(fault(part.place("attributes.POSITION"), kind));
                }
            }
            builder.triangle(element, corners, material)
        })
    }

    /// Notes the points and lines of `copies` copies of a mesh.
    fn leave_out(&mut self, plan: &Plan, element: Option<ElementId>, place: &str, copies: u64) {
        for (reason, count) in [(LeftOutReason::Points, plan.points), (LeftOutReason::Lines, plan.lines)] {
            let count = count.saturating_mul(copies);
            if count > 0 {
                self.builder.left_out(LeftOut { element, place: place.to_owned(), reason, count });
            }
        }
    }

    fn plan(&mut self, mesh: usize) -> Result<Rc<Plan>, ImportError> {
        if let Some(plan) = &self.plans[mesh] {
            return Ok(Rc::clone(plan));
        }
        let plan = Rc::new(Plan::of(self.root, mesh, &self.accessors, &mut self.builder)?);
        self.plans[mesh] = Some(Rc::clone(&plan));
        Ok(plan)
    }

    fn points(&mut self, part: &Part) -> Result<Rc<Vectors<3>>, ImportError> {
        if let Some(points) = self.points.get(&part.positions) {
            return Ok(Rc::clone(points));
        }
        let points = self.accessors.points(part.positions, self.builder.budget()).map_err(|mut error| {
            if let ImportErrorKind::Malformed(text) = &mut error.kind {
                *text = format!("{}: {text}", error.place);
            }
            error.at(part.place("attributes.POSITION"))
        })?;
        let points = Rc::new(points);
        self.points.insert(part.positions, Rc::clone(&points));
        Ok(points)
    }

    /// Forgets the points that nothing will need again.
    fn release(&mut self, plan: &Plan) {
        for part in &plan.parts {
            let uses = &mut self.uses[part.positions];
            *uses = uses.saturating_sub(1);
            if *uses == 0
                && let Some(points) = self.points.remove(&part.positions)
            {
                self.builder.budget().give_back(points.bytes());
            }
        }
    }

    /// Counts the triangles of nodes outside the scene.
    fn note_hidden(&mut self) -> Result<(), ImportError> {
        let mut total = 0u64;
        for (index, node) in self.root.nodes.iter().enumerate() {
            let Some(mesh) = node.mesh.filter(|_| !self.graph.shown[index]) else { continue };
            let plan = self.plan(mesh.value())?;
            let copies = instancing::of(node, index, &self.accessors)?.map_or(1, |i| u64::from(i.count));
            let count = plan.triangles.saturating_mul(copies);
            let place = format!("nodes[{index}]");
            total = total.saturating_add(count);
            if total > COUNTABLE {
                return Err(malformed(place, "more triangles than can be counted"));
            }
            if count > 0 {
                let reason = LeftOutReason::NotInScene;
                self.builder.left_out(LeftOut { element: None, place, reason, count });
            }
        }
        Ok(())
    }

    fn note_skins(&mut self) {
        if let Some((count, first)) = self.skins {
            let text = format!("{count} nodes have skins: their meshes stay in the pose of their nodes");
            self.builder.warn(format!("nodes[{first}]"), text);
        }
    }

    fn check_cancelled(&self) -> Result<(), ImportError> {
        self.options.watch.check().map_err(|e| fault("", e.into()))
    }
}
