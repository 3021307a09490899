//! Meshes: which triangles a mesh has, before and while its accessors are read.

use gltf::json;
use gltf::json::mesh::{Mode, Semantic};
use gltf::json::validation::Checked;

use super::accessors::{Accessors, Indices, Vectors};
use super::{fault, malformed};
use crate::builder::ModelBuilder;
use crate::error::{ImportError, ImportErrorKind};

/// What a mesh holds, by its accessors' counts.
#[derive(Debug, Default)]
pub(super) struct Plan {
    /// Primitives with triangles.
    pub parts: Vec<Part>,
    /// Triangles of all parts.
    pub triangles: u64,
    /// Points of point primitives.
    pub points: u64,
    /// Segments of line primitives.
    pub lines: u64,
}

/// A primitive with triangles.
#[derive(Debug)]
pub(super) struct Part {
    mesh: usize,
    primitive: usize,
    /// Accessor of its points.
    pub positions: usize,
    indices: Option<usize>,
    mode: Mode,
    /// Its material in the file.
    pub material: Option<usize>,
}

/// Three vertices, in order.
pub(super) type Corners = [u32; 3];

impl Plan {
    /// What mesh `index` holds. Warns about what is odd.
    ///
    /// # Errors
    /// Compressed triangles, or counts beyond 32 bits.
    pub fn of(
        root: &json::Root,
        index: usize,
        accessors: &Accessors<'_>,
        builder: &mut ModelBuilder,
    ) -> Result<Plan, ImportError> {
        let mesh = &root.meshes[index];
        let mut plan = Plan::default();
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            plan.add(primitive, [index, p], accessors, builder)?;
        }
        if mesh.primitives.iter().any(|p| p.targets.as_ref().is_some_and(|targets| !targets.is_empty())) {
            builder.warn(format!("meshes[{index}]"), "its morph targets are ignored");
        }
        Ok(plan)
    }

    fn add(
        &mut self,
        primitive: &json::mesh::Primitive,
        [mesh, p]: [usize; 2],
        accessors: &Accessors<'_>,
        builder: &mut ModelBuilder,
    ) -> Result<(), ImportError> {
        let place = || format!("meshes[{mesh}].primitives[{p}]");
        let Some(positions) = primitive.attributes.get(&Checked::Valid(Semantic::Positions)) else {
            builder.warn(place(), "the primitive has no POSITION, and is left out");
            return Ok(());
        };
        let positions = positions.value();
        // A compressed primitive may come with a plain twin. If it does not, its accessors are bare.
        let draco = "KHR_draco_mesh_compression";
        let compressed = primitive.extensions.as_ref().is_some_and(|e| e.others.contains_key(draco));
        if compressed && accessors.is_zeros(positions) {
            return Err(fault(place(), ImportErrorKind::RequiredExtension(draco.to_owned())));
        }
        let indices = primitive.indices.map(|indices| indices.value());
        let count = u64::from(accessors.count(indices.unwrap_or(positions))?);
        let mode = match primitive.mode {
            Checked::Valid(mode) => mode,
            Checked::Invalid => return Err(malformed(place(), "unknown mode")),
        };
        let triangles = match mode {
            Mode::Points => {
                self.points += count;
                return Ok(());
            }
            Mode::Lines | Mode::LineLoop | Mode::LineStrip => {
                self.lines += match mode {
                    Mode::Lines => count / 2,
                    Mode::LineStrip => count.saturating_sub(1),
                    _ => count,
                };
                return Ok(());
            }
            Mode::Triangles => count / 3,
            Mode::TriangleStrip | Mode::TriangleFan => count.saturating_sub(2),
        };
        let left = if mode == Mode::Triangles { count % 3 } else { 0 };
        if left > 0 {
            let what = if indices.is_some() { "indices" } else { "vertices" };
            let text =
                format!("{count} {what} are no whole number of triangles: the last {left} are left out");
            builder.warn(place(), text);
        }
        if triangles > 0 {
            let material = primitive.material.map(|material| material.value());
            self.parts.push(Part { mesh, primitive: p, positions, indices, mode, material });
            self.triangles += triangles;
        }
        Ok(())
    }
}

impl Part {
    /// Where the file has attribute or index list `what` of this primitive.
    pub fn place(&self, what: &str) -> String {
        format!("meshes[{}].primitives[{}].{what}", self.mesh, self.primitive)
    }

    /// The stream of vertex indices, for so many vertices; not yet checked against them.
    ///
    /// # Errors
    /// The indices cannot be read.
    pub fn indices<'a>(&self, accessors: &Accessors<'a>, vertices: u32) -> Result<Indices<'a>, ImportError> {
        match self.indices {
            None => Ok(Indices::Counting(0..vertices)),
            Some(accessor) => accessors.indices(accessor).map_err(|error| {
                malformed(self.place("indices"), format!("{}: {}", error.place, error.kind))
            }),
        }
    }

    /// Hands each triangle to `take`, counter-clockwise as seen from the front in the mesh's own axes.
    ///
    /// # Errors
    /// The indices cannot be read or are out of range of `points`, or an error of `take`'s.
    pub fn for_each_triangle(
        &self,
        accessors: &Accessors<'_>,
        points: &Vectors<3>,
        mut take: impl FnMut(Corners) -> Result<(), ImportError>,
    ) -> Result<(), ImportError> {
        let indices = self.indices(accessors, points.len())?;
        let count = points.len();
        let mut position = 0u64;
        let mut next = indices.map(|index| {
            position += 1;
            if index < count {
                return Ok(index);
            }
            let text =
                format!("index {index} (number {position}) is out of range: there are {count} vertices");
            Err(malformed(self.place("indices"), text))
        });
        let mut next = || next.next().transpose();
        match self.mode {
            Mode::TriangleStrip | Mode::TriangleFan => {
                let (Some(mut a), Some(mut b)) = (next()?, next()?) else { return Ok(()) };
                let mut odd = false;
                while let Some(c) = next()? {
                    if self.mode == Mode::TriangleFan {
                        // As the specification orders them: the hub last.
                        take([b, c, a])?;
                    } else {
                        take(if odd { [a, c, b] } else { [a, b, c] })?;
                        odd = !odd;
                        a = b;
                    }
                    b = c;
                }
            }
            _ => {
                while let (Some(a), Some(b), Some(c)) = (next()?, next()?, next()?) {
                    take([a, b, c])?;
                }
            }
        }
        Ok(())
    }
}
