//! Vertices, triangles and closed volumes: which triangles rays can meet, which only label air.

use std::collections::HashMap;

use enfilade_importers::{Element, Model, Role, Untagged};

use super::facing::facing;
use super::outward::{Outward, turn_outward};
use crate::components::{Component, components, rotated};
use crate::format::Tables;
use crate::format::records::{Facing, TriangleRecord, VolumeRecord};
use crate::parallel;
use crate::roles::{asked_role, component_role};
use crate::shells::{Inside, Shell, shells};
use crate::trace::NONE;

/// The components of one element.
pub(super) struct Part {
    pub(super) pieces: Vec<Piece>,
}

/// A component, its role, and, if it is closed and carves or labels, its shells, turned outward.
pub(super) struct Piece {
    pub(super) component: Component,
    pub(super) role: Role,
    shells: Vec<(Shell, Outward)>,
    /// Of each of its triangles, as it is in the mesh.
    facing: Vec<Facing>,
}

impl Piece {
    fn bounds(&self) -> impl Iterator<Item = Bound<'_>> {
        self.shells.iter().map(|shell| Bound { piece: self, shell })
    }

    /// To which side a triangle of the mesh looks.
    fn facing_of(&self, triangle: u32) -> Facing {
        self.component.triangles.binary_search(&triangle).map_or(Facing::Any, |at| self.facing[at])
    }
}

/// What [`gather`] did.
#[derive(Clone, Debug, Default)]
pub(super) struct Gathered {
    /// The first so many triangles can be met.
    pub(super) detail_triangles: u32,
    /// Triangles of air labels.
    pub(super) label_triangles: u64,
    /// Triangles of elements that are left out.
    pub(super) ignored_triangles: u64,
    /// Triangles that stand on the same corners and side as another of their element.
    pub(super) doubled_triangles: u64,
    /// Triangles turned outward.
    pub(super) turned: u64,
    /// Solid components by volume.
    pub(super) solids: u64,
    /// Components of solid elements that are open, and so stay detail.
    pub(super) open_solids: u64,
    /// The scene's triangles of each element, by their index in its mesh; of doubled ones the one that was kept, or
    /// [`NONE`].
    pub(super) index: Vec<Vec<u32>>,
}

impl Gathered {
    /// Counts components by role.
    pub(super) fn count_components(&mut self, parts: &[Part]) {
        for piece in parts.iter().flat_map(|p| &p.pieces) {
            self.solids += u64::from(piece.role == Role::Solid);
        }
    }
}

/// The components and roles of every element.
pub(super) fn split(model: &Model, untagged: Untagged) -> Vec<Part> {
    parallel::map(model.elements.len(), |index| part(&model.elements[index], untagged))
}

fn part(element: &Element, untagged: Untagged) -> Part {
    let asked = asked_role(element, untagged);
    let pieces = components(&element.mesh).into_iter().map(|component| {
        let role = component_role(asked, &component);
        let mut turned = Vec::new();
        if component.closed && matches!(role, Role::Solid | Role::Air) {
            for shell in shells(&element.mesh, &component) {
                let outward = turn_outward(&element.mesh, &shell, component.bounds);
                turned.push((shell, outward));
            }
        }
        let facing = facing(&element.mesh, &component);
        Piece { component, role, shells: turned, facing }
    });
    Part { pieces: pieces.collect() }
}

/// Fills the sections `vertices`, `triangles` and `volumes`. Rooms are not known yet.
pub(super) fn gather(model: &Model, parts: &[Part], tables: &mut Tables) -> Gathered {
    let mut gathered = Gathered {
        index: model.elements.iter().map(|e| vec![NONE; e.mesh.triangles.len()]).collect(),
        ..Gathered::default()
    };
    let mut index = vec![NONE; model.elements.iter().map(|e| e.mesh.positions.len()).max().unwrap_or(0)];
    for labels in [false, true] {
        for (e, (element, part)) in model.elements.iter().zip(parts).enumerate() {
            let before = tables.triangles.len();
            if !labels {
                let doubled = part.pieces.iter().map(|piece| u64::from(piece.component.doubled));
                gathered.doubled_triangles += doubled.sum::<u64>();
            }
            let mut writer = Writer {
                element,
                number: e as u32,
                index: &mut index,
                places: &mut gathered.index[e],
                tables,
            };
            writer.index[..element.mesh.positions.len()].fill(NONE);
            let pieces = || part.pieces.iter().filter(|piece| (piece.role == Role::Air) == labels);
            // What is closed first. The shells that agree bound a volume together, each other one by itself.
            let (together, others): (Vec<_>, Vec<_>) =
                pieces().flat_map(Piece::bounds).partition(|bound| bound.shell.0.inside == Inside::Together);
            let volumes = [together].into_iter().chain(others.into_iter().map(|shell| vec![shell]));
            for volume in volumes.filter(|shells| !shells.is_empty()) {
                gathered.turned += writer.volume(&volume);
            }
            let mut open = Vec::new();
            for piece in pieces() {
                let count = piece.component.triangles.len() as u64;
                if piece.role == Role::Ignore {
                    gathered.ignored_triangles += count;
                } else if piece.shells.is_empty() {
                    let is_solid = matches!(element.semantic.role(), Some(Role::Solid));
                    gathered.open_solids += u64::from(is_solid && piece.role == Role::Detail);
                    let all = piece.component.triangles.iter().zip(&piece.facing);
                    open.extend(all.map(|(&t, &facing)| (t, element.mesh.triangles[t as usize], facing)));
                }
            }
            writer.triangles(open, NONE);
            if labels {
                gathered.label_triangles += (tables.triangles.len() - before) as u64;
            }
        }
        if !labels {
            gathered.detail_triangles = tables.triangles.len() as u32;
        }
    }
    for ((element, part), index) in model.elements.iter().zip(parts).zip(&mut gathered.index) {
        if part.pieces.iter().any(|piece| piece.component.doubled > 0) {
            name_doubled(&element.mesh.triangles, index);
        }
    }
    gathered
}

/// Gives doubled triangles the place of the one that was kept.
fn name_doubled(triangles: &[[u32; 3]], index: &mut [u32]) {
    let kept: HashMap<[u32; 3], u32> = triangles
        .iter()
        .zip(&*index)
        .filter(|&(_, &place)| place != NONE)
        .map(|(&corners, &place)| (rotated(corners), place))
        .collect();
    for (&corners, place) in triangles.iter().zip(index).filter(|(_, place)| **place == NONE) {
        *place = kept.get(&rotated(corners)).copied().unwrap_or(NONE);
    }
}

/// A shell of a volume.
struct Bound<'a> {
    piece: &'a Piece,
    shell: &'a (Shell, Outward),
}

/// Writes one element into the tables.
struct Writer<'a> {
    element: &'a Element,
    number: u32,
    /// The vertices written of the element's, by their index in its mesh.
    index: &'a mut [u32],
    /// The scene's triangle of each of the element's.
    places: &'a mut [u32],
    tables: &'a mut Tables,
}

impl Writer<'_> {
    /// The volume that these shells, of one role, bound together: a cavity looks inward, and takes off. Returns how many
    /// of their triangles were turned.
    fn volume(&mut self, shells: &[Bound<'_>]) -> u64 {
        let first = self.tables.triangles.len();
        let id = self.tables.volumes.len() as u32;
        let (mut turned, mut measure) = (0, 0.0);
        for Bound { piece, shell: (shell, outward) } in shells {
            let triangles = shell.triangles.iter().zip(&outward.triangles).map(|(&t, &corners)| {
                let is_turned = rotated(corners) != rotated(self.element.mesh.triangles[t as usize]);
                let facing = piece.facing_of(t);
                (t, corners, if is_turned { facing.turned() } else { facing })
            });
            self.triangles(triangles.collect(), id);
            turned += outward.turned;
            measure += outward.volume;
        }
        let triangles = &mut self.tables.triangles[first..];
        if measure < 0.0 {
            // All of it inside out: from here on triangles look out of the matter, also into cavities.
            triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
            turned += triangles.len() as u64;
            for run in self.tables.runs.iter_mut().rev().take_while(|run| run.first as usize >= first) {
                run.facing = Facing::of(run.facing).map_or(0, |facing| facing.turned() as u32);
            }
        }
        let mut corners = triangles.iter().flatten().map(|&v| self.tables.vertices[v as usize]);
        let start = corners.next().unwrap_or_default();
        let bounds = corners.fold([start; 2], |[lo, hi], p| {
            [[0, 1, 2].map(|axis| lo[axis].min(p[axis])), [0, 1, 2].map(|axis| hi[axis].max(p[axis]))]
        });
        let inside = shells.first().map_or(Inside::Together, |bound| bound.shell.0.inside);
        self.tables.volumes.push(VolumeRecord {
            bounds,
            measure: measure.abs(),
            first_triangle: first as u32,
            triangle_count: (self.tables.triangles.len() - first) as u32,
            element: self.number,
            role: shells.first().map_or(Role::Detail, |bound| bound.piece.role) as u32,
            by_winding: u32::from(inside != Inside::ByParity),
            room: NONE,
        });
        turned
    }

    /// Triangles, each with its index in the mesh, its corners there, and to which side it looks: those that look alike one after the other.
    fn triangles(&mut self, mut triangles: Vec<(u32, [u32; 3], Facing)>, volume: u32) {
        let mesh = &self.element.mesh;
        triangles.sort_by_key(|(_, _, facing)| *facing as u32);
        for (t, corners, facing) in triangles {
            let vertices = corners.map(|v| {
                let slot = &mut self.index[v as usize];
                if *slot == NONE {
                    *slot = self.tables.vertices.len() as u32;
                    self.tables.vertices.push(mesh.positions[v as usize]);
                }
                *slot
            });
            self.places[t as usize] = self.tables.triangles.len() as u32;
            let material = mesh.materials[t as usize].0;
            let (element, facing) = (self.number, facing as u32);
            self.tables.push(TriangleRecord { vertices, element, material, volume, facing });
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::generate::{HouseOptions, OfficeOptions, Style, build1, house};
    use crate::roles::roles;
    use crate::{CompileOptions, compile};

    type Bits = [[u64; 3]; 3];

    /// The corners to the last bit, in an order of their own.
    fn bits(corners: [[f64; 3]; 3]) -> Bits {
        let mut bits = corners.map(|corner| corner.map(f64::to_bits));
        bits.sort_unstable();
        bits
    }

    /// So what is exact of the compiled triangles is exact of the model's.
    #[test]
    fn triangles_are_the_models_to_the_last_bit() {
        let mut far = Style::cad(3);
        (far.far, far.turned, far.noise) = (true, true, 2e-4);
        let house = house(&HouseOptions::default());
        let office = build1(&OfficeOptions::default());
        for (building, style) in
            [(&house, Style::exact()), (&house, Style::cad(1)), (&house, far), (&office, Style::cad(2))]
        {
            let model = building.export(&style).to_model().unwrap();
            let scene = compile(&model, &CompileOptions::default()).unwrap().scene();
            let mut compiled = vec![BTreeSet::new(); model.elements.len()];
            for triangle in 0..scene.detail_triangle_count() {
                compiled[scene.triangle_element(triangle) as usize].insert(bits(scene.triangle(triangle)));
            }
            let roles = roles(&model, Untagged::default());
            let mut count = 0;
            for ((element, role), compiled) in model.elements.iter().zip(roles).zip(compiled) {
                let is_met = matches!(role, Role::Solid | Role::Detail);
                let all = 0..element.mesh.triangles.len();
                let own: BTreeSet<Bits> =
                    all.filter(|_| is_met).map(|triangle| bits(element.mesh.corners(triangle))).collect();
                assert_eq!(own, compiled, "{} in {}", element.id, building.name);
                count += own.len();
            }
            assert!(count > 1000, "{count}");
        }
    }
}
