//! Vertices, triangles and closed volumes: which triangles rays can meet, which only label air.

use std::collections::HashMap;

use enfilade_importers::{Element, Model, Role, Untagged};

use super::outward::{Outward, turn_outward};
use crate::components::{Component, components, rotated};
use crate::format::Tables;
use crate::format::records::{TriangleRecord, VolumeRecord};
use crate::roles::{asked_role, component_role};
use crate::trace::NONE;

/// The components of one element, each with its role and, if it is closed and carves or labels, turned outward.
pub(super) struct Part {
    pub(super) components: Vec<(Component, Role, Option<Outward>)>,
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
        for (_, role, _) in parts.iter().flat_map(|p| &p.components) {
            self.solids += u64::from(*role == Role::Solid);
        }
    }
}

/// The components and roles of every element.
pub(super) fn split(model: &Model, untagged: Untagged) -> Vec<Part> {
    #[cfg(feature = "rayon")]
    {
        use rayon::prelude::*;
        model.elements.par_iter().map(|element| part(element, untagged)).collect()
    }
    #[cfg(not(feature = "rayon"))]
    model.elements.iter().map(|element| part(element, untagged)).collect()
}

fn part(element: &Element, untagged: Untagged) -> Part {
    let asked = asked_role(element, untagged);
    let components = components(&element.mesh).into_iter().map(|component| {
        let role = component_role(asked, &component);
        let volume = component.closed && matches!(role, Role::Solid | Role::Air);
        let outward = volume.then(|| turn_outward(&element.mesh, &component));
        (component, role, outward)
    });
    Part { components: components.collect() }
}

/// Fills the sections `vertices`, `triangles` and `volumes`. Rooms are not known yet.
pub(super) fn gather(model: &Model, parts: &[Part], tables: &mut Tables) -> Gathered {
    let mut gathered = Gathered::default();
    gathered.index = model.elements.iter().map(|e| vec![NONE; e.mesh.triangles.len()]).collect();
    let mut index = vec![NONE; model.elements.iter().map(|e| e.mesh.positions.len()).max().unwrap_or(0)];
    for labels in [false, true] {
        for (e, (element, part)) in model.elements.iter().zip(parts).enumerate() {
            let before = tables.triangles.len();
            index[..element.mesh.positions.len()].fill(NONE);
            let mut volume = NewVolume::default();
            // Closed components first: together they bound the element's volume.
            for closed in [true, false] {
                for (component, role, outward) in &part.components {
                    if !labels && !closed {
                        gathered.doubled_triangles += u64::from(component.doubled);
                    }
                    if *role == Role::Ignore {
                        gathered.ignored_triangles +=
                            if labels || closed { 0 } else { component.triangles.len() as u64 };
                        continue;
                    }
                    if (*role == Role::Air) != labels || outward.is_some() != closed {
                        continue;
                    }
                    if *role == Role::Detail {
                        let solid = matches!(element.semantic.role(), Some(Role::Solid));
                        gathered.open_solids += u64::from(solid);
                    }
                    let index = &mut index;
                    let id = if closed { tables.volumes.len() as u32 } else { NONE };
                    for (&t, place) in component.triangles.iter().zip(tables.triangles.len() as u32..) {
                        gathered.index[e][t as usize] = place;
                    }
                    add(element, e as u32, component, outward.as_ref(), id, index, tables);
                    if let Some(outward) = outward {
                        gathered.turned += outward.turned;
                        volume.add(component, *role, outward);
                    }
                }
                if closed && volume.parts > 0 {
                    if volume.measure < 0.0 {
                        // All of it inside out: from here on triangles look out of the matter, also into cavities.
                        tables.triangles[before..].iter_mut().for_each(|t| t.vertices.swap(1, 2));
                        gathered.turned += (tables.triangles.len() - before) as u64;
                    }
                    tables.volumes.push(volume.record(
                        e as u32,
                        before as u32,
                        tables.triangles.len() as u32,
                    ));
                }
            }
            if labels {
                gathered.label_triangles += (tables.triangles.len() - before) as u64;
            }
        }
        if !labels {
            gathered.detail_triangles = tables.triangles.len() as u32;
        }
    }
    for ((element, part), index) in model.elements.iter().zip(parts).zip(&mut gathered.index) {
        if part.components.iter().any(|(component, ..)| component.doubled > 0) {
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

/// The volume that the closed components of an element bound together: a cavity looks inward, and takes off.
#[derive(Default)]
struct NewVolume {
    parts: u32,
    bounds: [[f64; 3]; 2],
    measure: f64,
    role: u32,
    by_parity: bool,
}

impl NewVolume {
    fn add(&mut self, component: &Component, role: Role, outward: &Outward) {
        if self.parts == 0 {
            self.bounds = component.bounds;
        }
        self.parts += 1;
        for axis in 0..3 {
            self.bounds[0][axis] = self.bounds[0][axis].min(component.bounds[0][axis]);
            self.bounds[1][axis] = self.bounds[1][axis].max(component.bounds[1][axis]);
        }
        self.measure += outward.volume;
        self.role = role as u32;
        self.by_parity |= !outward.by_winding;
    }

    fn record(&self, element: u32, first_triangle: u32, end: u32) -> VolumeRecord {
        VolumeRecord {
            bounds: self.bounds,
            measure: self.measure.abs(),
            first_triangle,
            triangle_count: end - first_triangle,
            element,
            role: self.role,
            by_winding: u32::from(!self.by_parity),
            room: NONE,
        }
    }
}

fn add(
    element: &Element,
    e: u32,
    component: &Component,
    outward: Option<&Outward>,
    volume: u32,
    index: &mut [u32],
    tables: &mut Tables,
) {
    for (i, &t) in component.triangles.iter().enumerate() {
        let corners = outward.map_or(element.mesh.triangles[t as usize], |o| o.triangles[i]);
        let vertices = corners.map(|v| {
            let slot = &mut index[v as usize];
            if *slot == NONE {
                *slot = tables.vertices.len() as u32;
                tables.vertices.push(element.mesh.positions[v as usize]);
            }
            *slot
        });
        let material = element.mesh.materials[t as usize].0;
        tables.triangles.push(TriangleRecord { vertices, element: e, material, volume });
    }
}
