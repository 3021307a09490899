//! Elements that a converter took apart by material.
//!
//! OBJ has no tree, and such parts no identity: what shows them is their names (`Wall_1`, `Wall_2`, or `Wall_Brick`,
//! `Wall_Plaster`), their one material each, and that some are open sheets while together they are closed. All of
//! it is asked for, so that walls that are merely numbered stay walls. Parts that are all closed by themselves (a
//! door's leaf, its handle) stay apart: nothing shows that they are one.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use crate::builder::ModelBuilder;
use crate::error::ImportError;
use crate::model::{Element, Material};
use crate::watch::Watch;

/// What may stand between a name and the part's number or material.
const SEPARATORS: [char; 4] = ['_', '.', '-', ' '];

/// Bytes that comparing the edges of a triangle takes.
const TRIANGLE: usize = 512;

/// Makes one element of those that are parts of one.
///
/// # Errors
/// Over the budget, or cancelled.
pub(super) fn join_parts(builder: &mut ModelBuilder, watch: &Watch) -> Result<(), ImportError> {
    for (run, ending) in runs(builder.elements(), builder.materials()) {
        watch.check().map_err(|e| builder.error(e))?;
        let parts = &builder.elements()[run.clone()];
        let bytes = parts.iter().map(|part| part.mesh.triangles.len() * TRIANGLE).sum::<usize>() as u64;
        let place = parts[0].place.clone();
        builder.budget().take(bytes, "elements by material").map_err(|e| builder.error(e).at(place))?;
        if close_together(&builder.elements()[run.clone()]) {
            builder.join(run, ending);
        }
        builder.budget().give_back(bytes);
    }
    Ok(())
}

/// The neighbours in the file that by name and material may be one element, and the length of what the first one's
/// name has more than the element's.
fn runs(elements: &[Element], materials: &[Material]) -> Vec<(Range<usize>, usize)> {
    // Of elements that stay, and of those that are made.
    let mut taken: HashSet<&str> = elements.iter().flat_map(|e| [e.path.as_str(), e.id.as_str()]).collect();
    let mut runs = Vec::new();
    let mut start = 0;
    while start < elements.len() {
        let first = &elements[start];
        let mut end = start + 1;
        if let Some((ending, stem)) = Ending::of(first, materials) {
            let length = first.source_name.len() - stem.len();
            let path = cut(&first.path, length);
            if !taken.contains(path) {
                end = end.max(start + run_length(&elements[start..], materials, ending, stem));
                if end > start + 1 {
                    taken.insert(path);
                    runs.push((start..end, length));
                }
            }
        }
        start = end;
    }
    runs
}

/// How the parts of an element are told apart: behind a separator.
#[derive(Clone, Copy)]
enum Ending {
    Number(char),
    Material(char),
}

impl Ending {
    /// How the name of the first part of an element ends, and the name of that; `None` if it cannot be one.
    fn of<'e>(element: &'e Element, materials: &[Material]) -> Option<(Ending, &'e str)> {
        SEPARATORS.into_iter().flat_map(|s| [Ending::Number(s), Ending::Material(s)]).find_map(|ending| {
            let stem = ending.strip(&element.source_name, element, materials, 1)?;
            Some((ending, stem))
        })
    }

    /// A name of the part with this number, without its ending.
    fn strip<'n>(
        self,
        name: &'n str,
        element: &Element,
        materials: &[Material],
        number: usize,
    ) -> Option<&'n str> {
        let material = *element.mesh.materials.first()?;
        let (rest, separator) = match self {
            Ending::Number(separator) => (name.strip_suffix(number.to_string().as_str())?, separator),
            Ending::Material(separator) => {
                let material = materials[material.0 as usize].name.as_str();
                (name.strip_suffix(material).filter(|_| !material.is_empty())?, separator)
            }
        };
        rest.strip_suffix(separator)
    }
}

/// How many elements from the first on are named like parts of `stem`, each with another material.
fn run_length(elements: &[Element], materials: &[Material], ending: Ending, stem: &str) -> usize {
    let first = &elements[0];
    let path = cut(&first.path, first.source_name.len() - stem.len());
    let mut seen = HashSet::new();
    let mut is_part = |element: &Element, number: usize| {
        let strip = |name: &'_ str| ending.strip(name, element, materials, number).map(str::len);
        let is_named = ending.strip(&element.source_name, element, materials, number) == Some(stem)
            && ending.strip(&element.path, element, materials, number) == Some(path)
            && strip(&element.name).is_some();
        // With an id of its own it is an element of its own.
        is_named
            && !stem.is_empty()
            && element.id == element.path
            && (&element.class, &element.storey) == (&first.class, &first.storey)
            && element.mesh.materials.iter().all(|m| *m == element.mesh.materials[0])
            && seen.insert(element.mesh.materials[0].0)
    };
    elements.iter().zip(1..).take_while(|(element, number)| is_part(element, *number)).count()
}

/// `text` without its last `length` bytes.
fn cut(text: &str, length: usize) -> &str {
    text.len().checked_sub(length).and_then(|end| text.get(..end)).unwrap_or_default()
}

/// Whether some mesh alone has an edge that it uses an odd number of times, and all together have none.
fn close_together(parts: &[Element]) -> bool {
    let mut is_open = false;
    let mut odd_in_all = HashSet::new();
    let mut flip = |edge| {
        if !odd_in_all.insert(edge) {
            odd_in_all.remove(&edge);
        }
    };
    for part in parts {
        let mesh = &part.mesh;
        let mut uses: HashMap<[u32; 2], u32> = HashMap::new();
        let mut seen = HashSet::new();
        for &[a, b, c] in &mesh.triangles {
            let mut corners = [a, b, c];
            corners.sort_unstable();
            // A face that is there twice is one.
            if seen.insert(corners) {
                for [p, q] in [[a, b], [b, c], [c, a]] {
                    *uses.entry([p.min(q), p.max(q)]).or_default() += 1;
                }
            }
        }
        for (edge, _) in uses.into_iter().filter(|(_, uses)| uses % 2 == 1) {
            is_open = true;
            let mut ends = edge.map(|vertex| mesh.positions[vertex as usize].map(f64::to_bits));
            ends.sort_unstable();
            flip(ends);
        }
    }
    is_open && odd_in_all.is_empty()
}

#[cfg(test)]
mod tests {
    use crate::import::ImportOptions;
    use crate::model::Model;

    /// A box of 2 x 3 x 4 whose faces are named by pairs of objects and materials.
    fn a_box(names: [(&str, &str); 6]) -> String {
        let mut text = String::new();
        for i in 0..8 {
            text += &format!("v {} {} {}\n", 2 * (i & 1), 3 * (i >> 1 & 1), 4 * (i >> 2));
        }
        let faces = ["1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"];
        let mut object = "";
        for ((name, material), face) in names.into_iter().zip(faces) {
            if name != object {
                text += &format!("o {name}\n");
                object = name;
            }
            text += &format!("usemtl {material}\nf {face}\n");
        }
        text
    }

    fn read(text: &str) -> Model {
        crate::obj::read_text(text.as_bytes(), "box.obj", None, &ImportOptions::default()).unwrap()
    }

    fn names(model: &Model) -> Vec<(&str, usize)> {
        model.elements.iter().map(|e| (e.source_name.as_str(), e.mesh.triangles.len())).collect()
    }

    #[test]
    fn numbered_parts_of_several_materials_are_one_element() {
        let (a, b) = (("IfcWall:south_1", "plaster"), ("IfcWall:south_2", "brick"));
        let model = read(&a_box([a, a, a, b, b, b]));
        assert_eq!(names(&model), [("IfcWall:south", 12)]);
        let wall = &model.elements[0];
        assert_eq!((wall.name.as_str(), wall.class.as_deref()), ("south", Some("IfcWall")));
        assert_eq!((wall.id.as_str(), wall.path.as_str()), ("IfcWall:south", "IfcWall:south"));
        assert_eq!(wall.mesh.positions.len(), 8);
        let materials: Vec<&str> =
            wall.mesh.materials.iter().map(|m| model.materials[m.0 as usize].name.as_str()).collect();
        assert_eq!(materials, [["plaster"; 6], ["brick"; 6]].concat());
        assert!(model.warnings.iter().all(|w| !w.text.contains("no triangles")));
    }

    #[test]
    fn parts_named_after_their_materials_are_one_element() {
        let (a, b) = (("wall.plaster", "plaster"), ("wall.brick", "brick"));
        assert_eq!(names(&read(&a_box([a, a, b, b, b, b]))), [("wall", 12)]);
    }

    #[test]
    fn what_may_be_elements_of_their_own_stays_so() {
        let all = |a, b| names(&read(&a_box([a, a, a, b, b, b]))).len();
        // One material; numbers that begin elsewhere; other names; other classes; ids.
        assert_eq!(all(("wall_1", "brick"), ("wall_2", "brick")), 2);
        assert_eq!(all(("wall_2", "plaster"), ("wall_3", "brick")), 2);
        assert_eq!(all(("wall_1", "plaster"), ("roof_2", "brick")), 2);
        assert_eq!(all(("IfcWall:a_1", "plaster"), ("IfcDoor:a_2", "brick")), 2);
        // Each closed alone, or not closed together.
        let (a, b) = (("wall_1", "plaster"), ("wall_2", "brick"));
        let text = a_box([a, a, a, a, a, a]);
        let other = a_box([b, b, b, b, b, b]).replace("f ", "f -8 -7 -6\nf ");
        assert_eq!(names(&read(&format!("{text}{other}"))).len(), 2);
        let open = a_box([a, a, a, b, b, b]);
        let (open, _) = open.rsplit_once('f').unwrap();
        assert_eq!(names(&read(open)).len(), 2);
        // The name of the whole is another's identity.
        let (a, b) = (("wall_1", "plaster"), ("wall_2", "brick"));
        let text = format!("{}o other#wall\nf -8 -7 -6\n", a_box([a, a, a, b, b, b]));
        assert_eq!(names(&read(&text)).len(), 3);
        // A second whole of one name.
        let (c, d) = (("wall-1", "plaster"), ("wall-2", "brick"));
        let twice = format!("{}{}", a_box([a, a, a, b, b, b]), a_box([c, c, c, d, d, d]));
        assert_eq!(names(&read(&twice)), [("wall", 12), ("wall-1", 6), ("wall-2", 6)]);
        // Where the whole is there too, they are something else.
        let whole = open.replace("_1", "").replace("_2", "");
        assert_eq!(names(&read(&format!("{}{whole}", a_box([a, a, a, b, b, b])))).len(), 3);
    }
}
