//! From meshes by part to the model.

use crate::builder::ModelBuilder;
use crate::error::ImportError;
use crate::frame::Frame;
use crate::import::ImportOptions;
use crate::limits::Budget;
use crate::model::{LeftOut, LeftOutReason, Material, MaterialId, Model};
use crate::obj::guard::{Note, ObjGuard};
use crate::obj::join::join_parts;
use crate::obj::polygon::{Outcome, Triangulator};

/// Corners of faces between two looks at the cancel token.
const CORNERS_PER_CHECK: usize = 1 << 14;

/// Makes the model of `tobj`'s meshes, one for each part that has faces, in the order of the parts.
pub(super) fn assemble(
    meshes: Vec<tobj::Model>,
    guard: &ObjGuard,
    materials: Vec<Option<Material>>,
    file: &str,
    frame: Frame,
    budget: Budget,
    options: &ImportOptions,
) -> Result<Model, ImportError> {
    let mut builder = ModelBuilder::with_budget(file, frame, &options.limits, budget);
    let ids = materials.into_iter().map(|m| m.map(|m| builder.material(m))).collect();
    let mut assembler = Assembler {
        builder,
        guard,
        options,
        ids,
        frame,
        face: 0,
        switch: 0,
        material: 0,
        unchecked_corners: 0,
        triangulator: Triangulator::default(),
        corners: Vec::new(),
        triangles: Vec::new(),
        rough: Bad::default(),
        too_large: Bad::default(),
    };
    let mut meshes = meshes.into_iter().filter(|m| !m.mesh.indices.is_empty()).peekable();
    let mut notes = guard.notes.iter().peekable();
    for planned in guard.parts.elements() {
        let element = assembler.builder.element(planned.new)?;
        let mut no_area = Bad::default();
        for part in planned.parts {
            // The guard named each mesh after its part; parts without faces have none.
            if let Some(mesh) = meshes.next_if(|m| m.name.parse() == Ok(part)) {
                assembler.mesh(element, &mesh.mesh, &mut no_area)?;
                assembler.builder.budget().give_back(guard.parts.part(part).cost);
            }
            while let Some(&Note { reason, line, count, .. }) = notes.next_if(|n| n.part == part) {
                let place = format!("line {line}");
                assembler.builder.left_out(LeftOut { element: Some(element), place, reason, count });
            }
        }
        if no_area.count > 0 {
            let place = format!("line {}", no_area.line);
            let (reason, count) = (LeftOutReason::BadPolygon, no_area.count);
            assembler.builder.left_out(LeftOut { element: Some(element), place, reason, count });
        }
    }
    debug_assert!(meshes.peek().is_none() && notes.peek().is_none(), "all parts are in elements");
    assembler.warn();
    join_parts(&mut assembler.builder, &options.watch)?;
    assembler.builder.finish()
}

/// How many polygons were bad in one way, and the line of the first.
#[derive(Default)]
struct Bad {
    count: u64,
    line: u32,
}

impl Bad {
    fn add(&mut self, line: u32) {
        if self.count == 0 {
            self.line = line;
        }
        self.count += 1;
    }
}

struct Assembler<'a> {
    builder: ModelBuilder,
    guard: &'a ObjGuard,
    options: &'a ImportOptions,
    /// The builder's materials by the guard's.
    ids: Vec<Option<MaterialId>>,
    frame: Frame,
    /// Faces so far, as the guard counts them; the next change of material; the material in force.
    face: usize,
    switch: usize,
    material: usize,
    unchecked_corners: usize,
    triangulator: Triangulator,
    corners: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    rough: Bad,
    too_large: Bad,
}

impl Assembler<'_> {
    /// Adds a part's faces to its element.
    fn mesh(
        &mut self,
        element: crate::model::ElementId,
        mesh: &tobj::Mesh,
        no_area: &mut Bad,
    ) -> Result<(), ImportError> {
        let faces =
            if mesh.face_arities.is_empty() { mesh.indices.len() / 3 } else { mesh.face_arities.len() };
        let mut start = 0;
        for face in 0..faces {
            // `tobj` lists no arities where all faces are triangles.
            let arity = mesh.face_arities.get(face).map_or(3, |&n| n as usize);
            let indices = &mesh.indices[start..start + arity];
            start += arity;
            self.corners.clear();
            self.corners.extend(indices.iter().map(|&i| {
                let at = 3 * i as usize;
                [mesh.positions[at], mesh.positions[at + 1], mesh.positions[at + 2]]
            }));
            self.face(element, no_area)?;
        }
        Ok(())
    }

    fn face(&mut self, element: crate::model::ElementId, no_area: &mut Bad) -> Result<(), ImportError> {
        while let Some(&(face, material)) = self.guard.switches.get(self.switch)
            && face <= self.face as u64
        {
            self.material = material;
            self.switch += 1;
        }
        let line = self.guard.face_lines.get(self.face).copied().unwrap_or(0);
        self.face += 1;
        self.unchecked_corners += self.corners.len();
        if self.unchecked_corners > CORNERS_PER_CHECK {
            self.unchecked_corners = 0;
            self.options.watch.check().map_err(|e| self.builder.error(e).at(format!("line {line}")))?;
            self.options.watch.report("build", self.face as f64 / self.guard.faces() as f64);
        }
        let material = match self.ids[self.material] {
            Some(id) => id,
            // Materials of faces are made beforehand; this keeps the table right if one were not.
            None => *self.ids[self.material].insert(self.builder.material(Material::default())),
        };
        if self.corners.len() == 3 {
            self.triangles.clear();
            self.triangles.push([0, 1, 2]);
        } else {
            // In internal axes, so that a model is cut the same whichever axis it has up.
            for corner in &mut self.corners {
                *corner = self.frame.direction_to_internal(*corner);
            }
            let outcome = self.triangulator.triangulate(&self.corners, &mut self.triangles);
            for corner in &mut self.corners {
                *corner = self.frame.direction_to_source(*corner);
            }
            match outcome {
                Outcome::Exact => {}
                Outcome::Rough => self.rough.add(line),
                Outcome::NoArea => no_area.add(line),
                Outcome::TooLarge => {
                    no_area.add(line);
                    self.too_large.add(line);
                }
            }
        }
        for triangle in &self.triangles {
            let corners = triangle.map(|v| self.corners[v as usize]);
            self.builder
                .triangle(element, corners, material)
                .map_err(|error| error.at(format!("line {line}")))?;
        }
        Ok(())
    }

    fn warn(&mut self) {
        let texts = [
            (&self.rough, "polygons cross themselves: their triangles are a guess"),
            (&self.too_large, "polygons have over 65536 corners, and are left out"),
        ];
        for (bad, text) in texts {
            if bad.count > 0 {
                self.builder.warn(format!("line {}", bad.line), format!("{} {text}", bad.count));
            }
        }
    }
}
