//! The OBJ reader, behaviour by behaviour.
#![cfg(feature = "obj")]

use std::path::Path;

use enfilade_importers::obj::{read, read_text};
use enfilade_importers::{
    CancelToken, Element, ImportErrorKind, ImportOptions, LeftOutReason, Limits, Material, Model, UpAxis,
    Watch,
};

/// Four corners of a unit square.
const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn z_up() -> ImportOptions {
    let mut options = ImportOptions::default();
    options.up = Some(UpAxis::Z);
    options
}

fn model(text: &str) -> Model {
    model_of(text.as_bytes())
}

fn model_of(text: &[u8]) -> Model {
    let model = read_text(text, "test.obj", None, &z_up()).unwrap();
    let kept: u64 = model.triangle_count();
    let left_out: u64 = model.left_out.iter().filter(|l| l.reason.is_triangles()).map(|l| l.count).sum();
    assert_eq!(model.triangles_read, kept + left_out, "triangles add up");
    model
}

fn names(model: &Model) -> Vec<&str> {
    model.elements.iter().map(|e| e.source_name.as_str()).collect()
}

fn ids(model: &Model) -> Vec<&str> {
    model.elements.iter().map(|e| e.id.as_str()).collect()
}

fn triangles(element: &Element) -> Vec<[[f64; 3]; 3]> {
    (0..element.mesh.triangles.len()).map(|t| element.mesh.corners(t)).collect()
}

fn area(element: &Element) -> f64 {
    let area = |[a, b, c]: [[f64; 3]; 3]| {
        let u = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
        let v = [c[0] - a[0], c[1] - a[1], c[2] - a[2]];
        let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        n.iter().map(|x| x * x).sum::<f64>().sqrt() / 2.0
    };
    triangles(element).into_iter().map(area).sum()
}

fn warned(model: &Model, place: &str, words: &str) -> bool {
    model.warnings.iter().any(|w| w.place == place && w.text.contains(words))
}

// ---- Elements -----------------------------------------------------------------------------------------------

#[test]
fn objects_only_are_elements() {
    let m = model(&format!("{SQUARE}o IfcWall:Wall A#id1\nf 1 2 3\no Slab\nf 1 3 4\nf 1 2 3\n"));
    assert_eq!(names(&m), ["IfcWall:Wall A#id1", "Slab"]);
    assert_eq!(ids(&m), ["id1", "Slab"]);
    let wall = &m.elements[0];
    assert_eq!(
        (wall.name.as_str(), wall.class.as_deref(), wall.path.as_str(), wall.place.as_str()),
        ("Wall A", Some("IfcWall"), "IfcWall:Wall A", "line 5")
    );
    assert_eq!(m.elements[1].class, None);
    assert_eq!(m.elements[1].mesh.triangles.len(), 2);
    assert!(m.warnings.is_empty() && m.left_out.is_empty(), "{:?}", m.warnings);
}

#[test]
fn groups_only_are_elements() {
    let m = model(&format!("{SQUARE}g IfcDoor:d#7\nf 1 2 3\ng Mesh1 Group1 Model\nf 1 3 4\n"));
    assert_eq!(names(&m), ["IfcDoor:d#7", "Mesh1 Group1 Model"]);
    assert_eq!(ids(&m), ["7", "Mesh1 Group1 Model"]);
    assert_eq!(m.elements[0].class.as_deref(), Some("IfcDoor"));
    assert!(m.elements[0].other_names.is_empty());
    assert_eq!(m.elements[1].other_names, ["Mesh1", "Group1", "Model"]);
}

#[test]
fn groups_of_an_object_are_its_other_names() {
    let m = model(&format!(
        "{SQUARE}o table\ng legs\nf 1 2 3\ng top wood\nf 1 3 4\ng legs\nf 2 3 4\no chair\nf 1 2 4\n"
    ));
    assert_eq!(names(&m), ["table", "chair"]);
    assert_eq!(m.elements[0].other_names, ["legs", "top", "wood"]);
    assert_eq!(m.elements[0].mesh.triangles.len(), 3);
    // Faces stay in the file's order, and a group ends with its object.
    assert_eq!(triangles(&m.elements[0])[2], [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    assert!(m.elements[1].other_names.is_empty());
}

#[test]
fn a_class_and_a_storey_may_come_from_groups() {
    let m = model(&format!(
        "{SQUARE}g Storey:Level 1\no kitchen\ng IfcSpace:rooms IfcBuildingStorey:Level 2#x\nf 1 2 3\n\
         o bath\nf 1 2 3\no hall\ng walls\nf 1 2 3\n"
    ));
    assert_eq!(names(&m), ["kitchen", "bath", "hall"]);
    assert_eq!(m.elements[0].class.as_deref(), Some("IfcSpace"));
    assert_eq!(m.elements[0].name, "kitchen");
    let storeys: Vec<_> = m.elements.iter().map(|e| e.storey.as_deref()).collect();
    assert_eq!(storeys, [Some("Level 2"), Some("Level 2"), None]);
}

#[test]
fn the_only_object_of_a_file_is_split_by_its_groups() {
    let m = model(&format!("o house\n{SQUARE}g wall\nf 1 2 3\ng roof\nf 1 3 4\nf 1 2 3\n"));
    assert_eq!(names(&m), ["wall", "roof"]);
    assert_eq!(ids(&m), ["house/wall", "house/roof"]);
    assert_eq!(m.elements[1].other_names, ["house"]);
    assert_eq!(m.elements[1].mesh.triangles.len(), 2);
}

#[test]
fn an_untagged_object_is_split_by_tagged_groups() {
    let groups = "g IfcWall:w#1\nf 1 2 3\ng IfcSlab:s#2\nf 1 3 4\n";
    let m = model(&format!("{SQUARE}o storey 1\n{groups}f 1 2 3\no IfcWindow:x#3\n{groups}"));
    assert_eq!(ids(&m), ["1", "2", "3"]);
    assert_eq!(m.elements[0].path, "storey 1/IfcWall:w");
    assert_eq!(m.elements[1].class.as_deref(), Some("IfcSlab"));
    assert_eq!(m.elements[2].class.as_deref(), Some("IfcWindow"));
    assert_eq!(m.elements[2].other_names, ["IfcWall:w#1", "IfcSlab:s#2"]);
}

#[test]
fn faces_before_any_name_are_an_unnamed_element() {
    let m = model(&format!("{SQUARE}f 1 2 3\no\nf 1 3 4\no a\nf 1 2 4\n"));
    assert_eq!(names(&m), ["", "", "a"]);
    assert_eq!(ids(&m), ["unnamed", "unnamed[2]", "a"]);
    assert_eq!(m.elements[0].place, "line 5");
    assert!(m.warnings.is_empty());
}

#[test]
fn a_name_that_comes_back_is_another_element() {
    let m =
        model(&format!("{SQUARE}o a\nf 1 2 3\no b\nf 1 2 3\no a\nf 1 3 4\no c#7\nf 1 2 3\no b\nf 1 2 3\n"));
    assert_eq!(ids(&m), ["a", "b", "a[2]", "7", "b[2]"]);
    // The same id twice, apart: unique ids, with a warning.
    let m = model(&format!("{SQUARE}o x#1\nf 1 2 3\no b\nf 1 2 3\no x#1\nf 1 3 4\n"));
    assert_eq!(ids(&m), ["1", "b", "1~2"]);
    assert!(warned(&m, "", "'1'"));
}

#[test]
fn a_line_that_repeats_the_name_goes_on_with_the_element() {
    // As exporters do at each material.
    let m = model(&format!("{SQUARE}g a\nusemtl x\nf 1 2 3\ng a\nusemtl y\nf 1 3 4\n"));
    assert_eq!(ids(&m), ["a"]);
    assert_eq!(m.elements[0].mesh.triangles.len(), 2);
    // Two things of one name, each with its own vertices.
    let m = model(&format!("g a\n{SQUARE}f 1 2 3\ng a\n{SQUARE}f 5 6 7\n"));
    assert_eq!(ids(&m), ["a", "a[2]"]);
    // An id says that it is the same.
    let m = model(&format!("o a#1\n{SQUARE}f 1 2 3\no a#1\n{SQUARE}f 5 6 7\n"));
    assert_eq!(ids(&m), ["1"]);
    assert_eq!(m.elements[0].mesh.triangles.len(), 2);
}

#[test]
fn objects_without_faces_are_told() {
    let m = model(&format!("{SQUARE}o nothing\no a\nf 1 2 3\no line\nl 1 2 3\no none\n"));
    assert_eq!(names(&m), ["a"]);
    assert!(warned(&m, "line 5", "2 objects have nothing in them (first 'nothing')"));
    assert!(warned(&m, "line 8", "'line' has no triangles"));
    assert_eq!((m.left_out[0].reason, m.left_out[0].count), (LeftOutReason::Lines, 2));
    assert_eq!((m.left_out[0].element, m.left_out[0].place.as_str()), (None, "line 9"));
}

#[test]
fn names_that_are_not_ascii_and_not_utf_8_are_kept() {
    let m = model(&format!("{SQUARE}o IfcWall:Außenwand 日本#é1\nf 1 2 3\n"));
    assert_eq!((m.elements[0].name.as_str(), m.elements[0].id.as_str()), ("Außenwand 日本", "é1"));
    let mut latin = SQUARE.as_bytes().to_vec();
    latin.extend_from_slice(b"o K\xfcche\nusemtl gr\xfcn\nf 1 2 3\n");
    let m = model_of(&latin);
    assert_eq!(m.elements[0].name, "K\u{fffd}che");
    assert_eq!(m.materials[0].name, "gr\u{fffd}n");
}

// ---- Text ---------------------------------------------------------------------------------------------------

#[test]
fn line_ends_blanks_comments_and_continuations_do_not_matter() {
    let plain = format!("# a\n{SQUARE}o a b\nusemtl m\nf 1 2 3 4\nf 1/1/1 2 3\n");
    let expected = model(&plain);
    let variants = [
        plain.replace('\n', "\r\n"),
        plain.replace('\n', "\r"),
        format!("\u{feff}{plain}"),
        plain.trim_end().to_owned(),
        plain.replace("v ", "  v\t").replace("f ", "\tf   ").replace("o a b", "\to  a b \t"),
        plain.replace("f 1 2 3 4", "f 1 2 \\\n 3 \\\n4").replace("v 1 1 0", "v \\\n1 1 0"),
        plain.replace("v 1 1 0", "v 1 1 0 # corner").replace("f 1 2 3 4", "f 1 2 3 4 #face"),
        plain.replace("v 1 1 0", "v 1.0e0 +1. .0"),
        plain.replace("f 1 2 3 4", "fo 1 2 3 4"),
    ];
    for variant in variants {
        let mut actual = model(&variant);
        actual.source_hash = expected.source_hash;
        for (e, a) in expected.elements.iter().zip(&mut actual.elements) {
            a.place.clone_from(&e.place);
        }
        actual.warnings.clone_from(&expected.warnings);
        assert_eq!(actual, expected, "{variant:?}");
    }
}

#[test]
fn negative_indices_count_from_the_last_vertex() {
    let m = model(&format!("{SQUARE}f -4 -3 -2\n{SQUARE}f -4//-1 -2/-1 -1/-1/-1\nf 1 -1 4\n"));
    let corners = triangles(&m.elements[0]);
    assert_eq!(corners[0], [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    assert_eq!(corners[1], [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    // Vertices 1, 8 and 4: 8 is equal to 4, so that the triangle has no area.
    assert_eq!((m.left_out[0].reason, m.left_out[0].count), (LeftOutReason::Degenerate, 1));
}

#[test]
fn texture_coordinates_and_normals_are_read_over() {
    let attributes = "vt 0 0\nvt 1 1 1\nvn 0 0 1\nvn nan\ns 1\ns off\nlod 1\n";
    let m = model(&format!("{SQUARE}{attributes}f 1/1/1 2/2/2 3//2\nf 1/1 3/2 4/1\nf 1// 2/ 4/2/\n"));
    assert_eq!(m.triangle_count(), 3);
    assert!(m.warnings.is_empty(), "{:?}", m.warnings);
    let m = model(&format!("{SQUARE}f 1/1/1 2/2/-9223372036854775808 3/9223372036854775807/0\n"));
    assert!(warned(&m, "line 5", "6 corners of faces refer to texture coordinates or normals"));
}

#[test]
fn vertex_colours_are_read_over_and_weights_divide() {
    let text = "v 0 0 0 1 0 0\nv 2 0 0 2\nv 1 1 0 0.5 0.5 0.5 1\nv 3 3 0 nan nan nan\nf 1 2 3 4\n";
    let m = model(text);
    let points = &m.elements[0].mesh.positions;
    assert!(points.contains(&[1.0, 0.0, 0.0]), "{points:?}");
    assert!(points.contains(&[3.0, 3.0, 0.0]), "{points:?}");
    assert_eq!(m.triangle_count(), 2);
}

#[test]
fn vertices_may_follow_their_faces_within_an_element() {
    let m = model(&format!("o a\nf 1 2 3 4\n{SQUARE}"));
    assert_eq!(m.triangle_count(), 2);
    let error = read_text(format!("o a\nf 1 2 9\no b\n{SQUARE}f 1 2 3\n").as_bytes(), "t", None, &z_up())
        .unwrap_err();
    assert_eq!((error.place.as_str(), error.element.as_deref()), ("line 2", Some("a")));
}

#[test]
fn lines_points_and_free_form_are_counted() {
    let m = model(&format!(
        "{SQUARE}o a\nf 1 2 3\nl 1 2 3 4\np 1 2\nl 2/1 3/1\np 3\ncstype bezier\ncurv 0 1 1 2\nend\nxyzzy 1\nxyzzy\n"
    ));
    assert_eq!(m.triangle_count(), 1);
    let left_out: Vec<_> = m.left_out.iter().map(|l| (l.reason, l.count, l.place.as_str())).collect();
    assert_eq!(left_out, [(LeftOutReason::Lines, 4, "line 7"), (LeftOutReason::Points, 3, "line 8")]);
    assert!(warned(&m, "line 11", "3 statements of free-form geometry were left out (first 'cstype')"));
    assert!(warned(&m, "line 14", "2 statements that OBJ does not have were skipped (first 'xyzzy')"));
    assert_eq!(m.warnings.len(), 2);
}

// ---- Faces --------------------------------------------------------------------------------------------------

#[test]
fn concave_polygons_have_their_exact_area() {
    let m = model("v 0 0 0\nv 4 0 0\nv 4 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\nf 1 2 3 4 5 6\nf 6 5 4 3 2 1\n");
    assert_eq!(m.triangle_count(), 8);
    assert_eq!(area(&m.elements[0]), 12.0);
    let up = triangles(&m.elements[0])
        .into_iter()
        .filter(|[a, b, c]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0);
    assert_eq!(up.count(), 4, "each side winds as its polygon");
}

#[test]
fn polygons_without_area_are_counted_at_their_line() {
    let m = model(&format!("{SQUARE}o a\nf 1 2\nf 1\nf\nf 1 2 1 2\nf 3 3 3 3\nf 1 2 3\nf 1 1 2\n"));
    assert_eq!(m.triangle_count(), 1);
    let left_out: Vec<_> = m.left_out.iter().map(|l| (l.reason, l.count, l.place.as_str())).collect();
    let expected = [
        (LeftOutReason::BadPolygon, 3, "line 6"),
        (LeftOutReason::BadPolygon, 2, "line 9"),
        (LeftOutReason::Degenerate, 1, "line 5"),
    ];
    assert_eq!(left_out, expected);
}

#[test]
fn polygons_that_cross_themselves_give_a_warning() {
    let m = model("v 0 3 0\nv 2 -3 0\nv -3 1 0\nv 3 1 0\nv -2 -3 0\nf 1 2 3 4 5\n");
    assert!(warned(&m, "line 6", "1 polygons cross themselves"));
    assert_eq!(m.triangle_count(), 3);
}

// ---- Frame --------------------------------------------------------------------------------------------------

#[test]
fn units_and_axes_lead_to_one_model() {
    let in_metres = "v 0 0 0\nv 4 0 1\nv 4 2 1\nv 0 2 1\nv 1 1 3\nf 1 2 3 4\nf 1 2 5 4 3\n";
    let in_y_up = "v 0 0 0\nv 4 1 0\nv 4 1 -2\nv 0 1 -2\nv 1 3 -1\nf 1 2 3 4\nf 1 2 5 4 3\n";
    let in_quarters = "v 0 0 0\nv 16 4 0\nv 16 4 -8\nv 0 4 -8\nv 4 12 -4\nf 1 2 3 4\nf 1 2 5 4 3\n";
    let expected = model(in_metres);
    for (text, unit) in [(in_y_up, None), (in_quarters, Some(0.25))] {
        let mut options = ImportOptions::default();
        options.unit = unit;
        let actual = read_text(text.as_bytes(), "test.obj", None, &options).unwrap();
        assert_eq!(actual.elements, expected.elements);
        assert_eq!((actual.frame.unit, actual.frame.up), (unit.unwrap_or(1.0), UpAxis::Y));
        let source = actual.frame.point_to_source(actual.elements[0].mesh.positions[1]);
        assert_eq!(source, [16.0, 4.0, 0.0].map(|c| c * if unit.is_some() { 1.0 } else { 0.25 }));
    }
}

#[test]
fn a_unit_that_is_not_positive_is_refused() {
    for unit in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let mut options = ImportOptions::default();
        options.unit = Some(unit);
        let error = read_text(SQUARE.as_bytes(), "test.obj", None, &options).unwrap_err();
        assert!(matches!(error.kind, ImportErrorKind::Unsupported(_)), "{error}");
    }
}

// ---- Materials ----------------------------------------------------------------------------------------------

fn write(folder: &Path, name: &str, text: impl AsRef<[u8]>) {
    std::fs::create_dir_all(folder.join(name).parent().unwrap()).unwrap();
    std::fs::write(folder.join(name), text).unwrap();
}

fn look<'a>(m: &'a Model, name: &str) -> &'a Material {
    m.materials.iter().find(|m| m.name == name).unwrap()
}

#[test]
fn usemtl_inside_an_object_gives_each_triangle_its_material() {
    let m = model(&format!(
        "{SQUARE}o a\nf 1 2 3\nusemtl red\nf 1 3 4\nf 1 2 4\nusemtl blue\nusemtl red\nf 2 3 4\nusemtl\nf 1 2 3\n\
         o b\nf 1 2 3\nusemtl blue\nf 1 2 3 4\n"
    ));
    assert_eq!(ids(&m), ["a", "b"]);
    let looks = |e: usize| -> Vec<&str> {
        m.elements[e].mesh.materials.iter().map(|&id| m.materials[id.0 as usize].name.as_str()).collect()
    };
    assert_eq!(looks(0), ["", "red", "red", "red", ""]);
    assert_eq!(looks(1), ["", "blue", "blue"]);
    let expected = Material { name: "red".into(), ..Material::default() };
    assert_eq!(*look(&m, "red"), expected);
    assert!(warned(&m, "line 7", "no library has the material 'red'"));
    assert!(warned(&m, "line 10", "no library has the material 'blue'"));
}

#[test]
fn materials_come_from_the_libraries_beside_the_file() {
    let dir = tempfile::tempdir().unwrap();
    let text = format!(
        "mtllib my colours.mtl\nmtllib sub/b.mtl c.mtl missing.mtl\n{SQUARE}usemtl red\nf 1 2 3\nusemtl glass\n\
         f 1 3 4\nusemtl red wine\nf 1 2 4\nusemtl unused\nusemtl nowhere\nf 1 2 3\nmtllib late.mtl\n"
    );
    write(dir.path(), "house.obj", &text);
    write(dir.path(), "my colours.mtl", "newmtl red\nKd 1 0 0\nnewmtl unused\nKd 0 0 0\n");
    write(dir.path(), "sub/b.mtl", "newmtl glass\nd 0.1\nillum 4\nnewmtl red\nKd 0 0 1\n");
    write(dir.path(), "c.mtl", "");
    write(dir.path(), "late.mtl", "newmtl red wine\r\nKd .5 0 0\r\n");
    let m = read(&dir.path().join("house.obj"), &z_up()).unwrap();
    assert_eq!(m.source, "house.obj");
    let names: Vec<&str> = m.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["red", "glass", "red wine", "nowhere"]);
    assert_eq!(look(&m, "red").base_color, [1.0, 0.0, 0.0]);
    assert_eq!(look(&m, "red wine").base_color, [0.5, 0.0, 0.0]);
    assert!(look(&m, "glass").is_see_through());
    assert!(warned(&m, "line 2", "'missing.mtl' cannot be read"));
    assert!(warned(&m, "c.mtl", "no materials"));
    assert!(warned(&m, "sub/b.mtl: line 4", "'red' is defined before (my colours.mtl: line 1)"));
    assert!(warned(&m, "line 14", "no library has the material 'nowhere'"));
    assert_eq!(m.warnings.len(), 4, "{:?}", m.warnings);
}

#[test]
fn the_hash_is_of_the_model_and_then_its_libraries() {
    let dir = tempfile::tempdir().unwrap();
    let text = format!("mtllib a.mtl\n{SQUARE}f 1 2 3\n");
    write(dir.path(), "house.obj", &text);
    write(dir.path(), "a.mtl", "newmtl a\n");
    let hash = |_: &str| read(&dir.path().join("house.obj"), &z_up()).unwrap().source_hash;
    let both = twox_hash::XxHash3_64::oneshot(format!("{text}newmtl a\n").as_bytes());
    assert_eq!(hash("both"), both);
    write(dir.path(), "a.mtl", "newmtl b\n");
    assert_ne!(hash("changed"), both);
    assert_eq!(model(&text).source_hash, twox_hash::XxHash3_64::oneshot(text.as_bytes()));
}

#[test]
fn textures_give_their_mean_colour() {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), "house.obj", format!("mtllib a.mtl\n{SQUARE}usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\n"));
    let library = "newmtl a\nKd 0.5 1 1\nmap_Kd -s 1 1 1 tex\\half.bmp\nnewmtl b\nmap_Kd ../half.bmp\n";
    write(dir.path(), "a.mtl", library);
    // A 24-bit bitmap of 2 x 1 texels, red and black, rows padded to 8 bytes.
    let mut bmp = b"BM".to_vec();
    for word in [62u32, 0, 54, 40, 2, 1, 24 << 16 | 1, 0, 8, 2835, 2835, 0, 0] {
        bmp.extend_from_slice(&word.to_le_bytes());
    }
    bmp.extend_from_slice(&[0, 0, 255, 0, 0, 0, 0, 0]);
    write(dir.path(), "tex/half.bmp", &bmp);
    let m = read(&dir.path().join("house.obj"), &z_up()).unwrap();
    assert_eq!(look(&m, "a").base_color, [0.25, 0.0, 0.0]);
    assert_eq!(look(&m, "b").base_color, [1.0; 3]);
    assert!(warned(&m, "a.mtl: line 4", "'../half.bmp' leaves the model's folder"));
    assert_eq!(m.warnings.len(), 1, "{:?}", m.warnings);
    write(dir.path(), "tex/half.bmp", &bmp[..50]);
    let m = read(&dir.path().join("house.obj"), &z_up()).unwrap();
    assert_eq!(look(&m, "a").base_color, [0.5, 1.0, 1.0]);
    assert!(warned(&m, "a.mtl: line 1", "is not read: no image"));
}

// ---- Limits, progress, cancellation -------------------------------------------------------------------------

#[test]
fn cancelling_stops_and_progress_is_told() {
    let mut text = SQUARE.to_owned();
    text.push_str(&"f 1 2 3\n".repeat(50_000));
    let token = CancelToken::new();
    token.cancel();
    let mut options = z_up();
    options.watch = Watch::default().with_cancel(token);
    let error = read_text(text.as_bytes(), "test.obj", None, &options).unwrap_err();
    assert!(matches!(error.kind, ImportErrorKind::Cancelled(_)), "{error}");

    let seen = std::sync::Arc::new(std::sync::Mutex::new(Vec::new()));
    let sink = seen.clone();
    options.watch = Watch::default()
        .with_progress(move |stage, done| sink.lock().unwrap().push((stage.to_owned(), done)));
    read_text(text.as_bytes(), "test.obj", None, &options).unwrap();
    let seen = seen.lock().unwrap();
    assert!(seen.len() > 5 && seen.iter().all(|(_, done)| (0.0..=1.0).contains(done)));
    assert!(seen.windows(2).all(|w| w[0].0 != w[1].0 || w[0].1 <= w[1].1), "it only grows");
}

#[test]
fn memory_and_elements_are_limited() {
    let mut text = SQUARE.to_owned();
    for k in 0..2000 {
        text.push_str(&format!("o a{k}\nv {k} 0 0\nf 1 2 3\n"));
    }
    let with = |limits: Limits| {
        let mut options = z_up();
        options.limits = limits;
        read_text(text.as_bytes(), "test.obj", None, &options)
    };
    assert!(with(Limits::default().with_max_memory(10_000_000)).is_ok());
    for bytes in [0, 100, 10_000, 300_000, 1_000_000] {
        let error = with(Limits::default().with_max_memory(bytes)).unwrap_err();
        assert!(matches!(error.kind, ImportErrorKind::OverBudget(_)), "{bytes}: {error}");
        assert!(error.place.starts_with("line ") || error.element.is_some(), "{error}");
    }
    let error = with(Limits::default().with_max_elements(1000)).unwrap_err();
    assert!(matches!(error.kind, ImportErrorKind::TooManyElements(1000)), "{error}");
    assert_eq!(error.place, "line 3005");
}
