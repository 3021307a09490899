//! A building as Wavefront OBJ with its material library: metres, Y up, one object an element, polygons as they are.

use std::fmt::Write;

use crate::importers::Material;

use super::building::{Building, Element};
use super::lattice::{Point, point_metres};

impl Building {
    /// The texts of an OBJ file and of its material library, whose name is `mtl_name`.
    ///
    /// Objects are called `IfcClass:Name#global_id`. Faces without holes are one polygon, which may be concave;
    /// others are cut into convex polygons.
    pub fn to_obj(&self, mtl_name: &str) -> (String, String) {
        let mut obj = format!("# {}, metres, Y up\nmtllib {mtl_name}\n", self.name);
        let mut before = 0;
        for element in &self.elements {
            object(&mut obj, self, element, before);
            before += element.points.len();
        }
        (obj, library(&self.materials))
    }
}

/// Grid coordinates in glTF's and OBJ's axes, metres.
pub(super) fn y_up(p: Point) -> [f64; 3] {
    // Negated as an integer: no negative zero.
    let [x, y, z] = p;
    point_metres([x, z, -y])
}

/// An element's points and faces; `before`: how many points the objects before it have.
fn object(obj: &mut String, building: &Building, element: &Element, before: usize) {
    // Writing into a string cannot fail.
    let _ = writeln!(obj, "o {}#{}", element.tagged_name(), element.global_id);
    for &p in &element.points {
        let [x, y, z] = y_up(p);
        let _ = writeln!(obj, "v {x} {y} {z}");
    }
    for (index, material) in building.materials.iter().enumerate() {
        let mut faces = element.faces.iter().filter(|f| f.material == index as u32).peekable();
        if faces.peek().is_some() {
            let _ = writeln!(obj, "usemtl {}", word(&material.name));
        }
        for polygon in faces.flat_map(|face| element.polygons(face)) {
            obj.push('f');
            for corner in polygon {
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
