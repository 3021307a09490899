//! A building as Wavefront OBJ with its material library: metres, Y up, one object an element, polygons as they are.

use std::fmt::Write;

use crate::importers::Material;

use super::building::Building;
use super::style::{Cut, Export, Object, Part, Placement, Style};

impl Building {
    /// The texts of an OBJ file and of its material library, whose name is `mtl_name`: [`Export::to_obj`] in the style
    /// [`Style::exact`].
    pub fn to_obj(&self, mtl_name: &str) -> (String, String) {
        self.export(&Style::exact()).to_obj(mtl_name)
    }
}

impl Export<'_> {
    /// The texts of an OBJ file and of its material library, whose name is `mtl_name`.
    ///
    /// Objects are called `IfcClass:Name#global_id`. Faces without holes are one polygon, which may be concave;
    /// others are cut into convex polygons.
    pub fn to_obj(&self, mtl_name: &str) -> (String, String) {
        let unit = self.placement.unit().plural();
        let mut obj = format!("# {}, {unit}, Y up\nmtllib {mtl_name}\n", self.name);
        let mut before = 0;
        for object in &self.objects {
            let parts = object.parts(Cut::Polygons);
            let is_split = parts.len() > 1;
            for (number, part) in (1..).zip(&parts) {
                let name = name(object, is_split.then_some(number));
                write_part(&mut obj, &name, part, &self.placement, self.materials, before);
                before += part.points.len();
            }
        }
        (obj, library(self.materials))
    }
}

/// What an object is called. A part of one has a number, and no identity.
fn name(object: &Object<'_>, number: Option<usize>) -> String {
    let name = object.label.object_name();
    match number {
        Some(number) => format!("{name}_{number}"),
        None => format!("{name}#{}", object.label.id),
    }
}

/// A mesh's points and faces; `before`: how many points the objects before it have.
fn write_part(
    obj: &mut String,
    name: &str,
    part: &Part<'_>,
    placement: &Placement,
    materials: &[Material],
    before: usize,
) {
    // Writing into a string cannot fail.
    let _ = writeln!(obj, "o {name}");
    for &p in part.points.iter() {
        let [x, y, z] = placement.global(p);
        let _ = writeln!(obj, "v {x} {y} {z}");
    }
    for (material, rings) in &part.faces {
        let _ = writeln!(obj, "usemtl {}", word(&materials[*material as usize].name));
        for ring in rings.iter() {
            obj.push('f');
            for &corner in ring {
                let _ = write!(obj, " {}", before + corner as usize + 1);
            }
            obj.push('\n');
        }
    }
}

fn library(materials: &[Material]) -> String {
    let mut mtl = String::new();
    for material in materials {
        let [r, g, b] = material.base_color;
        let _ = writeln!(mtl, "newmtl {}\nKd {r} {g} {b}", word(&material.name));
        let _ = writeln!(mtl, "Pr {}\nPm {}", material.roughness, material.metallic);
        let _ = writeln!(mtl, "d {}\nillum {}\n", material.alpha, if material.alpha < 1.0 { 4 } else { 2 });
    }
    mtl
}

/// A material's name as one word, which all readers take.
fn word(name: &str) -> String {
    name.replace(char::is_whitespace, "_")
}
