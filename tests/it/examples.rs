//! The examples, run as a reader would run them, on the shipped house.
#![cfg(all(feature = "gltf", feature = "obj", feature = "compile", feature = "render"))]

use std::error::Error;
use std::path::Path;

use enfilade::importers::{ImportOptions, Model, import};
use enfilade::{CompileOptions, compile};

// Each example's `main` is its own; its `run` is what is tested.
#[allow(dead_code)]
#[path = "../../examples/beams.rs"]
mod beams;
#[allow(dead_code)]
#[path = "../../examples/lidar.rs"]
mod lidar;
#[cfg(feature = "proptest")]
#[allow(dead_code)]
#[path = "../../examples/properties.rs"]
mod properties;
#[allow(dead_code)]
#[path = "../../examples/render.rs"]
mod render;
#[allow(dead_code)]
#[path = "../../examples/rules.rs"]
mod rules;
#[allow(dead_code)]
#[path = "../../examples/ways.rs"]
mod ways;

const HOUSE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/house.glb");

fn words<'a>(words: impl IntoIterator<Item = &'a str>) -> Vec<String> {
    words.into_iter().map(str::to_owned).collect()
}

/// What a run writes.
fn said(run: impl FnOnce(&mut dyn std::io::Write) -> Result<(), Box<dyn Error>>) -> String {
    let mut out = Vec::new();
    run(&mut out).unwrap();
    String::from_utf8(out).unwrap()
}

/// The distance of `point` (source frame) from the nearest of the planes of an element's triangles, metres.
fn off_element(model: &Model, point: [f64; 3], element: u32) -> f64 {
    let point = model.frame.point_to_internal(point);
    let mesh = &model.elements[element as usize].mesh;
    let minus = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let distance = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        let (u, v) = (minus(b, a), minus(c, a));
        let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        dot(n, minus(point, a)).abs() / dot(n, n).sqrt()
    };
    (0..mesh.triangles.len()).map(distance).fold(f64::INFINITY, f64::min)
}

#[test]
fn lidar_writes_points_on_the_elements_it_names() {
    let folder = tempfile::tempdir().unwrap();
    let model = import(HOUSE.as_ref(), &ImportOptions::default()).unwrap();
    let compiled = compile(&model, &CompileOptions::default()).unwrap();
    let enf = folder.path().join("house.enf");
    std::fs::write(&enf, &compiled.bytes).unwrap();
    let options = ["--rings", "8", "--azimuths", "90"];
    let text = |path: &str| said(|out| lidar::run(words([path].into_iter().chain(options)), out));
    let sweep = text(enf.to_str().unwrap());
    // The scene file and the model give the same sweep.
    assert_eq!(sweep, text(HOUSE));

    let mut lines = sweep.lines();
    assert_eq!(lines.next(), Some("# x y z element"));
    let points: Vec<([f64; 3], u32)> = lines
        .map(|line| {
            let numbers: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
            ([numbers[0], numbers[1], numbers[2]], numbers[3] as u32)
        })
        .collect();
    // From inside a room nearly all beams meet something.
    assert!(points.len() > 700 && points.len() <= 720, "{}", points.len());
    for &(point, element) in points.iter().step_by(7) {
        let off = off_element(&model, point, element);
        // As far as six decimals tell.
        assert!(off < 1e-6, "{point:?} is {off} m off {}", model.elements[element as usize].name);
    }

    let ply = folder.path().join("sweep.PLY");
    let to_ply = words([HOUSE, ply.to_str().unwrap()].into_iter().chain(options));
    let message = said(|out| lidar::run(to_ply, out));
    assert!(message.ends_with(&format!("{} points of 720 beams\n", points.len())), "{message}");
    let ply = std::fs::read_to_string(ply).unwrap();
    let (header, body) = ply.split_once("end_header\n").unwrap();
    assert!(header.starts_with("ply\nformat ascii 1.0\n"));
    assert!(header.contains(&format!("element vertex {}\n", points.len())));
    assert_eq!(body, sweep.split_once('\n').unwrap().1);
}

#[test]
fn lidar_refuses_bad_places_and_words() {
    let fails = |arguments: &[&str]| {
        let arguments = words([HOUSE].into_iter().chain(arguments.iter().copied()));
        lidar::run(arguments, &mut Vec::new()).unwrap_err().to_string()
    };
    assert_eq!(fails(&["--from", "1e6,0,0"]), "the scanner is outside of the scene's hull");
    // In the floor slab, under the living room.
    assert!(fails(&["--from", "0.69,-0.1,-0.729"]).starts_with("the scanner is inside "));
    assert!(fails(&["--from", "1,2"]).starts_with("usage: "));
    assert!(fails(&["--rays", "7"]).starts_with("usage: "));
}

#[test]
fn rules_change_what_they_name_and_nothing_else() {
    let table = said(|out| rules::run(words([HOUSE]), out));
    let row = |semantic: &str| -> Option<(u32, u32)> {
        let line = table.lines().find(|line| line.split_whitespace().next() == Some(semantic))?;
        let mut numbers = line.split_whitespace().skip(1).map(|word| word.parse().unwrap());
        Some((numbers.next()?, numbers.next()?))
    };
    // Two slabs in the garden, five sanitary things, eight lamps.
    assert_eq!(row("GROUND"), Some((4, 2)));
    assert_eq!(row("SITE"), Some((1, 3)));
    assert_eq!(row("EQUIPMENT"), Some((13, 0)));
    assert_eq!(row("FURNITURE"), Some((28, 33)));
    assert_eq!(row("ANNOTATION"), Some((0, 8)));
    assert_eq!(row("WALL"), Some((15, 15)));
    assert!(table.lines().any(|line| line.starts_with("Terrace: GROUND -> SITE (")), "{table}");
    assert_eq!(table.lines().filter(|line| line.contains(" -> ")).count(), 15);

    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mine.toml");
    std::fs::write(&file, "[[rule]]\nname = '^Column'\nsemantic = 'BEAM'\n").unwrap();
    let table = said(|out| rules::run(words([HOUSE, file.to_str().unwrap()]), out));
    assert_eq!(table.lines().filter(|line| line.contains("COLUMN -> BEAM")).count(), 3);
    assert!(rules::run(words([]), &mut Vec::new()).unwrap_err().to_string().starts_with("usage: "));
}

#[test]
fn render_writes_pictures_of_either_kind() {
    let folder = tempfile::tempdir().unwrap();
    for (name, magic) in [("a.png", &b"\x89PNG"[..]), ("a.exr", &b"\x76\x2f\x31\x01"[..])] {
        let path = folder.path().join(name);
        let arguments =
            [HOUSE, path.to_str().unwrap(), "--outside", "--color", "semantic", "--size", "40x30"];
        let message = said(|out| render::run(words(arguments), out));
        assert!(message.starts_with(path.to_str().unwrap()), "{message}");
        assert!(std::fs::read(Path::new(&path)).unwrap().starts_with(magic), "{name}");
    }
    let fails = |arguments: &[&str]| {
        render::run(words(arguments.iter().copied()), &mut Vec::new()).unwrap_err().to_string()
    };
    assert!(fails(&[HOUSE]).starts_with("usage: "));
    assert!(fails(&[HOUSE, "a.png", "--colour", "depth"]).starts_with("usage: "));
}

#[test]
fn ways_go_through_doors_and_daylight_through_windows() {
    let said_of = |arguments: &[&str]| said(|out| ways::run(words(arguments.iter().copied()), out));
    let text = said_of(&[HOUSE, "Bedroom", "Kitchen"]);
    let way = text.lines().next().unwrap();
    assert!(
        way.starts_with("Bedroom > ") && way.contains(" > Hall > ") && way.contains(" > Kitchen ("),
        "{way}"
    );
    let lit: Vec<String> =
        said_of(&[HOUSE]).lines().filter_map(|line| line.split(':').next()).map(str::to_owned).collect();
    assert_eq!(lit, ["Living room", "Kitchen", "Hall", "WC", "Bath", "Children's room", "Study", "Bedroom"]);
    let fails = |arguments: &[&str]| {
        ways::run(words(arguments.iter().copied()), &mut Vec::new()).unwrap_err().to_string()
    };
    assert!(fails(&[HOUSE, "Kitchen"]).starts_with("usage: "));
    assert!(fails(&[HOUSE, "Bedroom", "Cellar"]).contains("Cellar"));
}

#[test]
fn beams_make_a_picture_of_each_room() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rooms.png");
    let text = said(|out| beams::run(words([HOUSE, path.to_str().unwrap()]), out));
    assert_eq!(text.lines().count(), 8);
    for line in text.lines() {
        let file = line.split(": ").next().unwrap();
        assert!(std::fs::read(file).unwrap().starts_with(b"\x89PNG"), "{line}");
    }
    assert!(beams::run(words([HOUSE]), &mut Vec::new()).unwrap_err().to_string().starts_with("usage: "));
}

#[cfg(feature = "proptest")]
#[test]
fn properties_hold() {
    let text = said(|out| properties::run(words(["20"]).into_iter(), out));
    assert_eq!(text, "20 degenerate models: it holds\n2 damaged exports: it holds\n");
}
