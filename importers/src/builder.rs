//! Building a [`Model`] triangle by triangle: the one door through which every reader, and any program, goes.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
#[cfg(feature = "obj")]
use std::ops::Range;

use crate::error::{ImportError, ImportErrorKind};
use crate::frame::Frame;
use crate::limits::{Budget, Limits};
use crate::model::{
    Camera, Element, ElementId, LeftOut, LeftOutReason, Light, Material, MaterialId, Model, TagSource,
    Warning,
};
use crate::semantic::Semantic;

/// Beyond this distance of the model's middle from the origin, metres, an offset is taken off.
const FAR: f64 = 1000.0;

/// Coordinates beyond this, metres, are refused: their f64 spacing is over 0.1 mm.
const TOO_FAR: f64 = 1e12;

/// Makes a [`Model`] that keeps its promises: finite coordinates, no zero areas, indices in range, unique ids.
///
/// Coordinates go in in the source's frame; [`ModelBuilder::finish`] turns them into the internal one.
///
/// ```
/// use enfilade_importers::{Frame, Material, ModelBuilder, NewElement, Semantic};
///
/// let mut builder = ModelBuilder::new("hand-made", Frame::default());
/// let white = builder.material(Material::default());
/// let wall = builder.element(NewElement { name: "wall".into(), ..NewElement::default() })?;
/// builder.semantic(wall, Semantic::Wall);
/// builder.triangle(wall, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], white)?;
/// let model = builder.finish()?;
/// assert_eq!(model.triangle_count(), 1);
/// # Ok::<(), enfilade_importers::ImportError>(())
/// ```
#[derive(Debug)]
pub struct ModelBuilder {
    model: Model,
    limits: Limits,
    budget: Budget,
    /// Vertices of the element that is being filled, by the bits of their coordinates.
    seen: HashMap<[u64; 3], u32>,
    filling: Option<ElementId>,
    degenerate: u64,
    /// Elements that became parts of another, by index.
    joined: HashMap<usize, usize>,
}

/// What [`ModelBuilder::element`] wants to know. An empty id becomes the path, an empty path the name.
#[derive(Clone, Debug, Default)]
pub struct NewElement {
    /// See [`Element::id`].
    pub id: String,
    /// See [`Element::name`].
    pub name: String,
    /// See [`Element::source_name`]; the name if empty.
    pub source_name: String,
    /// See [`Element::other_names`].
    pub other_names: Vec<String>,
    /// See [`Element::path`].
    pub path: String,
    /// See [`Element::place`].
    pub place: String,
    /// See [`Element::class`].
    pub class: Option<String>,
    /// See [`Element::storey`].
    pub storey: Option<String>,
    /// See [`Element::host`].
    pub host: Option<String>,
    /// See [`Element::filling`].
    pub filling: Option<String>,
    /// See [`Element::opening`].
    pub opening: Option<String>,
    /// See [`Element::extras`].
    pub extras: std::collections::BTreeMap<String, String>,
    /// See [`Element::inherited`].
    pub inherited: std::collections::BTreeMap<String, String>,
}

impl ModelBuilder {
    /// A builder under the default [`Limits`]. `source` is the file's name, for errors and reports.
    pub fn new(source: impl Into<String>, frame: Frame) -> ModelBuilder {
        ModelBuilder::with_budget(source, frame, &Limits::default(), Budget::new(&Limits::default()))
    }

    /// A builder that goes on with a reader's `budget`.
    pub fn with_budget(
        source: impl Into<String>,
        frame: Frame,
        limits: &Limits,
        budget: Budget,
    ) -> ModelBuilder {
        ModelBuilder {
            model: Model { source: source.into(), frame, ..Model::default() },
            limits: *limits,
            budget,
            seen: HashMap::new(),
            filling: None,
            degenerate: 0,
            joined: HashMap::new(),
        }
    }

    /// The account of memory, for readers that allocate beside the builder.
    pub fn budget(&mut self) -> &mut Budget {
        &mut self.budget
    }

    /// Notes the hash of the source's bytes.
    pub fn source_hash(&mut self, hash: u64) {
        self.model.source_hash = hash;
    }

    /// Adds a material.
    pub fn material(&mut self, material: Material) -> MaterialId {
        self.model.materials.push(material);
        MaterialId(self.model.materials.len() as u32 - 1)
    }

    /// Adds an element without triangles yet. Fill one element after the other: going back to an earlier one is
    /// right, but costs a look through its vertices.
    ///
    /// # Errors
    /// Over the limit on elements or on memory.
    pub fn element(&mut self, new: NewElement) -> Result<ElementId, ImportError> {
        let count = self.model.elements.len() as u64;
        if count >= self.limits.max_elements.min(u64::from(u32::MAX) - 1) {
            return Err(self.error(ImportErrorKind::TooManyElements(self.limits.max_elements)).at(new.place));
        }
        let text = new.id.len()
            + new.path.len()
            + new.name.len()
            + new.extras.iter().chain(&new.inherited).map(|(k, v)| k.len() + v.len() + 64).sum::<usize>()
            + new.other_names.iter().map(|n| n.len() + 24).sum::<usize>();
        self.take((std::mem::size_of::<Element>() + text) as u64, "elements")?;
        let source_name = if new.source_name.is_empty() { new.name.clone() } else { new.source_name };
        let path = if new.path.is_empty() { source_name.clone() } else { new.path };
        let id = if new.id.is_empty() { path.clone() } else { new.id };
        self.model.elements.push(Element {
            id,
            name: new.name,
            source_name,
            other_names: new.other_names,
            path,
            place: new.place,
            class: new.class,
            storey: new.storey,
            host: new.host,
            filling: new.filling,
            opening: new.opening,
            extras: new.extras,
            inherited: new.inherited,
            ..Element::default()
        });
        Ok(ElementId(count as u32))
    }

    /// Says what an element is. Tagging leaves such elements alone.
    ///
    /// # Panics
    /// If `element` is not of this builder.
    pub fn semantic(&mut self, element: ElementId, semantic: Semantic) {
        let element = &mut self.model.elements[element.0 as usize];
        element.semantic = semantic;
        element.tagged_by = TagSource::Program;
    }

    /// Adds a triangle with corners in the source's frame (unit and axes), counter-clockwise seen from the front.
    /// A triangle of zero area is counted and left out.
    ///
    /// # Errors
    /// A coordinate that is not finite or beyond 1e12 m, or too much memory.
    ///
    /// # Panics
    /// If `element` or `material` is not of this builder.
    pub fn triangle(
        &mut self,
        element: ElementId,
        corners: [[f64; 3]; 3],
        material: MaterialId,
    ) -> Result<(), ImportError> {
        assert!((material.0 as usize) < self.model.materials.len(), "unknown material");
        if self.filling != Some(element) {
            self.turn_to(element);
        }
        self.model.triangles_read += 1;
        let frame = self.model.frame;
        let mut points = [[0.0; 3]; 3];
        for (corner, point) in corners.iter().zip(&mut points) {
            let q = frame.direction_to_internal(*corner);
            for axis in 0..3 {
                // Adding zero turns -0 into +0, so that equal points have equal bits.
                point[axis] = q[axis] * frame.unit + 0.0;
                if !point[axis].is_finite() || point[axis].abs() > TOO_FAR {
                    let vertex = self.model.elements[element.0 as usize].mesh.positions.len() as u64;
                    let kind = ImportErrorKind::NotFinite { vertex, value: point[axis] };
                    return Err(self.error_of(element, kind));
                }
            }
        }
        if is_degenerate(points) {
            self.degenerate += 1;
            return Ok(());
        }
        // Triangle, material, and at most three new vertices with their entry in the table.
        self.budget.take(160, "triangles").map_err(|e| self.error_of(element, e.into()))?;
        let mesh = &mut self.model.elements[element.0 as usize].mesh;
        let mut indices = [0u32; 3];
        for (point, index) in points.iter().zip(&mut indices) {
            *index = match self.seen.entry(point.map(f64::to_bits)) {
                Entry::Occupied(known) => *known.get(),
                Entry::Vacant(new) => {
                    let next = mesh.positions.len() as u32;
                    mesh.positions.push(*point);
                    *new.insert(next)
                }
            };
        }
        mesh.triangles.push(indices);
        mesh.materials.push(material);
        Ok(())
    }

    /// Notes what a reader left out. Triangles left out this way count as read.
    pub fn left_out(&mut self, left_out: LeftOut) {
        if left_out.reason.is_triangles() {
            self.model.triangles_read += left_out.count;
        }
        self.model.left_out.push(left_out);
    }

    /// Adds a light, in the source's frame; its range in the source's unit.
    pub fn light(&mut self, mut light: Light) {
        let frame = self.model.frame;
        light.position = frame.point_to_internal(light.position);
        light.direction = frame.direction_to_internal(light.direction);
        light.range = frame.length_to_internal(light.range);
        self.model.lights.push(light);
    }

    /// Adds a camera, in the source's frame.
    pub fn camera(&mut self, mut camera: Camera) {
        let frame = self.model.frame;
        camera.eye = frame.point_to_internal(camera.eye);
        camera.direction = frame.direction_to_internal(camera.direction);
        camera.up = frame.direction_to_internal(camera.up);
        self.model.cameras.push(camera);
    }

    /// Adds a warning.
    pub fn warn(&mut self, place: impl Into<String>, text: impl Into<String>) {
        self.model.warnings.push(Warning { place: place.into(), text: text.into() });
    }

    /// How many materials there are so far.
    pub fn material_count(&self) -> usize {
        self.model.materials.len()
    }

    /// The elements so far.
    #[cfg(feature = "obj")]
    pub(crate) fn elements(&self) -> &[Element] {
        &self.model.elements
    }

    /// The materials so far.
    #[cfg(feature = "obj")]
    pub(crate) fn materials(&self) -> &[Material] {
        &self.model.materials
    }

    /// Makes one element of several: the first, without the last `ending` bytes of its names, with the triangles of
    /// all. The others are gone when the model is finished.
    #[cfg(feature = "obj")]
    pub(crate) fn join(&mut self, parts: Range<usize>, ending: usize) {
        let Some(first) = parts.clone().next() else { return };
        self.close();
        self.turn_to(ElementId(first as u32));
        for part in parts.clone().skip(1) {
            let mesh = std::mem::take(&mut self.model.elements[part].mesh);
            let whole = &mut self.model.elements[first].mesh;
            for triangle in mesh.triangles {
                whole.triangles.push(triangle.map(|vertex| {
                    let point = mesh.positions[vertex as usize];
                    *self.seen.entry(point.map(f64::to_bits)).or_insert_with(|| {
                        whole.positions.push(point);
                        whole.positions.len() as u32 - 1
                    })
                }));
            }
            whole.materials.extend(mesh.materials);
            self.joined.insert(part, first);
        }
        self.close();
        let whole = &mut self.model.elements[first];
        for name in [&mut whole.id, &mut whole.path, &mut whole.name, &mut whole.source_name] {
            name.truncate(name.len().saturating_sub(ending));
        }
    }

    /// The model. Takes the offset off if its middle is over 1 km from the origin, makes ids unique (`id~2`...; with
    /// a warning), and drops elements without triangles (with a warning).
    ///
    /// # Errors
    /// If there is no triangle at all.
    pub fn finish(mut self) -> Result<Model, ImportError> {
        self.close();
        if self.model.triangle_count() == 0 {
            let text = if self.model.triangles_read > 0 {
                format!("all {} have zero area", self.model.triangles_read)
            } else {
                "the file has no mesh that the scene shows".to_owned()
            };
            return Err(self.error(ImportErrorKind::Empty(text)));
        }
        self.drop_empty_elements();
        self.make_ids_unique();
        self.take_offset_off();
        if self.model.materials.is_empty() {
            self.model.materials.push(Material::default());
        }
        Ok(self.model)
    }

    /// An error about the source.
    pub fn error(&self, kind: impl Into<ImportErrorKind>) -> ImportError {
        ImportError::new(self.model.source.clone(), kind)
    }

    /// An error about an element of the source.
    fn error_of(&self, element: ElementId, kind: ImportErrorKind) -> ImportError {
        let element = &self.model.elements[element.0 as usize];
        self.error(kind).at(element.place.clone()).of_element(element.source_name.clone())
    }

    fn take(&mut self, bytes: u64, what: &str) -> Result<(), ImportError> {
        self.budget.take(bytes, what).map_err(|e| self.error(e))
    }

    /// Notes what the element in hand left out, and forgets its vertices.
    fn close(&mut self) {
        if let (Some(element), true) = (self.filling, self.degenerate > 0) {
            let place = self.model.elements[element.0 as usize].place.clone();
            self.model.left_out.push(LeftOut {
                element: Some(element),
                place,
                reason: LeftOutReason::Degenerate,
                count: self.degenerate,
            });
        }
        self.degenerate = 0;
        self.seen.clear();
        self.filling = None;
    }

    fn turn_to(&mut self, element: ElementId) {
        self.close();
        self.filling = Some(element);
        for (index, p) in self.model.elements[element.0 as usize].mesh.positions.iter().enumerate() {
            self.seen.insert(p.map(f64::to_bits), index as u32);
        }
    }

    fn drop_empty_elements(&mut self) {
        if self.model.elements.iter().all(|e| !e.mesh.triangles.is_empty()) {
            return;
        }
        let mut new_index = vec![None; self.model.elements.len()];
        let mut kept = Vec::with_capacity(self.model.elements.len());
        for (old, element) in std::mem::take(&mut self.model.elements).into_iter().enumerate() {
            if element.mesh.triangles.is_empty() {
                if self.joined.contains_key(&old) {
                    continue;
                }
                let text = format!("element '{}' has no triangles, and is left out", element.source_name);
                self.model.warnings.push(Warning { place: element.place, text });
            } else {
                new_index[old] = Some(ElementId(kept.len() as u32));
                kept.push(element);
            }
        }
        self.model.elements = kept;
        for left_out in &mut self.model.left_out {
            left_out.element = left_out.element.and_then(|e| {
                let old = e.0 as usize;
                new_index[self.joined.get(&old).copied().unwrap_or(old)]
            });
        }
    }

    fn make_ids_unique(&mut self) {
        let mut taken: HashMap<String, u32> = HashMap::new();
        let mut doubled = 0u64;
        let mut example = None;
        for element in &mut self.model.elements {
            if element.id.is_empty() {
                element.id = "unnamed".to_owned();
            }
            let mut count = taken.get(&element.id).copied().unwrap_or(0) + 1;
            if count > 1 {
                doubled += 1;
                example.get_or_insert_with(|| element.id.clone());
                let base = element.id.clone();
                loop {
                    let candidate = format!("{base}~{count}");
                    if !taken.contains_key(&candidate) {
                        taken.insert(base, count);
                        element.id = candidate;
                        break;
                    }
                    count += 1;
                }
                count = 1;
            }
            taken.insert(element.id.clone(), count);
        }
        if let Some(example) = example {
            let text = format!(
                "{doubled} elements had an id that an earlier one has ('{example}'): '~2' and so on was added"
            );
            self.model.warnings.push(Warning { place: String::new(), text });
        }
    }

    fn take_offset_off(&mut self) {
        let Some([lo, hi]) = self.model.bounds() else { return };
        let middle = [0, 1, 2].map(|axis| lo[axis] + (hi[axis] - lo[axis]) / 2.0);
        let distance = (middle[0] * middle[0] + middle[1] * middle[1] + middle[2] * middle[2]).sqrt();
        if distance <= FAR {
            return;
        }
        let offset = middle.map(|c| c.round() + 0.0);
        let subtract = |p: &mut [f64; 3]| {
            for axis in 0..3 {
                p[axis] = p[axis] - offset[axis] + 0.0;
            }
        };
        self.model.frame.offset = offset;
        for element in &mut self.model.elements {
            element.mesh.positions.iter_mut().for_each(subtract);
        }
        self.model.lights.iter_mut().for_each(|light| subtract(&mut light.position));
        self.model.cameras.iter_mut().for_each(|camera| subtract(&mut camera.eye));
    }
}

/// Whether the triangle has no area at all: two equal corners, or an exactly zero cross product.
fn is_degenerate([a, b, c]: [[f64; 3]; 3]) -> bool {
    let u = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
    let v = [c[0] - a[0], c[1] - a[1], c[2] - a[2]];
    u[1] * v[2] - u[2] * v[1] == 0.0 && u[2] * v[0] - u[0] * v[2] == 0.0 && u[0] * v[1] - u[1] * v[0] == 0.0
        || a == b
        || b == c
        || a == c
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::UpAxis;

    fn one_triangle(frame: Frame, corners: [[f64; 3]; 3]) -> Result<Model, ImportError> {
        let mut builder = ModelBuilder::new("test", frame);
        let material = builder.material(Material::default());
        let element = builder.element(NewElement { name: "a".into(), ..NewElement::default() })?;
        builder.triangle(element, corners, material)?;
        builder.finish()
    }

    #[test]
    fn far_models_lose_a_whole_offset() {
        let frame = Frame { unit: 1.0, up: UpAxis::Y, offset: [0.0; 3] };
        let model = one_triangle(frame, [[5e6, 0.0, 0.5], [5e6 + 1.0, 0.0, 0.5], [5e6, 1.0, 0.5]]).unwrap();
        assert_eq!(model.frame.offset, [5_000_001.0, -1.0, 1.0]);
        assert_eq!(model.elements[0].mesh.positions[0], [-1.0, 0.5, -1.0]);
        assert_eq!(model.frame.point_to_source(model.elements[0].mesh.positions[0]), [5e6, 0.0, 0.5]);
    }

    #[test]
    fn zero_areas_and_bad_numbers_are_caught() {
        let flat = one_triangle(Frame::default(), [[0.0; 3], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0]]);
        assert!(matches!(flat.unwrap_err().kind, ImportErrorKind::Empty(_)));
        let nan = one_triangle(Frame::default(), [[0.0; 3], [f64::NAN, 1.0, 1.0], [2.0, 2.0, 2.0]]);
        let error = nan.unwrap_err();
        assert!(matches!(error.kind, ImportErrorKind::NotFinite { .. }));
        assert_eq!(error.element.as_deref(), Some("a"));
    }

    #[test]
    fn ids_become_unique_and_equal_points_one_vertex() {
        let mut builder = ModelBuilder::new("test", Frame::default());
        let material = builder.material(Material::default());
        for id in ["x", "x", "x~2", "x", "y"] {
            let new = NewElement { id: id.into(), ..NewElement::default() };
            let element = builder.element(new).unwrap();
            builder
                .triangle(element, [[-0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], material)
                .unwrap();
            builder
                .triangle(element, [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]], material)
                .unwrap();
        }
        let model = builder.finish().unwrap();
        let ids: Vec<&str> = model.elements.iter().map(|e| e.id.as_str()).collect();
        assert_eq!(ids, ["x", "x~2", "x~2~2", "x~3", "y"]);
        assert_eq!(model.elements[0].mesh.positions.len(), 4);
        assert_eq!(model.warnings.len(), 1);
    }
}
