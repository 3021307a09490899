//! The surfaces of a building's air as OBJ: faces by what they are.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::place_id;
use crate::format::FaceKind;
use crate::graph::{Place, fills, parts, place_of};
use crate::scene::Scene;
use crate::trace::Prisms;

/// By kind of face, and what it is a face of (openings together): polygons, source frame.
type Objects = BTreeMap<(FaceKind, Option<Place>), Vec<Vec<[f64; 3]>>>;

/// The surfaces of rooms, of the open and of voids, and the portals between volumes of air, as OBJ: an object for each kind of face of each place
/// (`WALLPAPER:Kitchen#id`), its faces looking into the air, with its kind as material; portals once, from the first of both sides. In the source's own
/// frame and unit. `library` is the file of materials that it names, if any.
pub fn faces_obj(scene: &Scene, library: Option<&str>) -> String {
    let prisms = Prisms::new(&scene.tables);
    let fills = fills(&prisms);
    let mut objects: Objects = BTreeMap::new();
    let frame = scene.frame();
    for (cell, number) in prisms.cells.iter().zip(0u32..) {
        let fill = fills[number as usize];
        if !fill.is_air() {
            continue;
        }
        for part in parts(&prisms, cell) {
            let Some(kind) = FaceKind::from_number(part.kind) else { continue };
            let other = fills[part.beyond as usize];
            // A portal is one face of two cells; within one room it is none at all.
            if other.is_air() && (part.beyond < number || other == fill) {
                continue;
            }
            let corners = part.corners.iter().rev().map(|p| frame.point_to_source(p.to_array())).collect();
            objects.entry((kind, place_of(fill))).or_default().push(corners);
        }
    }
    let mut out = String::from("# Surfaces of air, by what they are: enfilade export --obj\n");
    if let Some(library) = library {
        out.push_str(&format!("mtllib {library}\n"));
    }
    // Writing to a String cannot fail.
    let _ = write_objects(&mut out, scene, &objects);
    out
}

fn write_objects(out: &mut String, scene: &Scene, objects: &Objects) -> std::fmt::Result {
    let mut next = 1;
    for ((kind, place), polygons) in objects {
        let name = match place {
            Some(Place::Room(room)) => {
                let element = scene.room(*room).element();
                let name = if element.name().is_empty() { element.id() } else { element.name() };
                format!(
                    "{}#{}",
                    name.replace(char::is_whitespace, "_"),
                    element.id().replace(char::is_whitespace, "_")
                )
            }
            Some(place) => place_id(scene, *place).to_owned(),
            None => "OPENING".to_owned(),
        };
        writeln!(out, "o {}:{name}\nusemtl {}", kind.name(), kind.name())?;
        for polygon in polygons {
            for [x, y, z] in polygon {
                writeln!(out, "v {x} {y} {z}")?;
            }
            write!(out, "f")?;
            for _ in polygon {
                write!(out, " {next}")?;
                next += 1;
            }
            writeln!(out)?;
        }
    }
    Ok(())
}
