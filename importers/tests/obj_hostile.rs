//! Damaged and hostile OBJ and MTL files, made by code: each an error that names the file, the line and the element,
//! or a documented warning; never a panic, never more memory than allowed.
#![cfg(feature = "obj")]

use enfilade_importers::obj::{read, read_text};
use enfilade_importers::{ImportErrorKind, ImportOptions, Limits};
use proptest::prelude::*;

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn options() -> ImportOptions {
    let mut options = ImportOptions::default();
    options.limits = Limits::default().with_max_memory(64 << 20);
    options
}

/// What each file ends in: the start of the message after the file's name.
fn table() -> Vec<(&'static str, Vec<u8>, &'static str)> {
    let in_a = |line: &str| format!("{SQUARE}o a\nf 1 2 3\n{line}\n").into_bytes();
    let long_name = "x".repeat(1 << 20);
    vec![
        ("empty", vec![], "no triangles: the file has 0 vertices"),
        ("vertices only", SQUARE.into(), "no triangles: the file has 4 vertices"),
        ("zero area only", format!("{SQUARE}f 1 2 2\n").into(), "no triangles: all 1 have zero area"),
        ("polygons without area only", format!("{SQUARE}f 1 2 1 2\n").into(), "no triangles"),
        (
            "web page",
            b"<!DOCTYPE html>\n<p>not found</p>\n".to_vec(),
            "line 1: this is no OBJ file: it has no",
        ),
        ("JSON", b"{\n \"asset\": 1\n}".to_vec(), "line 1: this is no OBJ file"),
        (
            "binary",
            (0..4000u32).map(|i| (i * i) as u8).collect(),
            "line 1: a zero byte: this is no text file",
        ),
        ("glb", b"glTF\x02\0\0\0\0\0".to_vec(), "line 1: a zero byte"),
        ("UTF-16", SQUARE.encode_utf16().flat_map(u16::to_le_bytes).collect(), "line 1: a zero byte"),
        ("vertex of two numbers", in_a("v 1 2"), "line 7: element 'a': a vertex is three numbers: 'v 1 2'"),
        ("vertex of no numbers", in_a("v"), "line 7: element 'a': a vertex is three numbers: 'v'"),
        (
            "vertex of five numbers",
            in_a("v 1 2 3 4 5"),
            "line 7: element 'a': a vertex is three numbers, and",
        ),
        ("vertex of words", in_a("v a b c"), "line 7: element 'a': a vertex is three numbers"),
        ("decimal commas", in_a("v 1,5 0,0 2"), "line 7: element 'a': a vertex is three numbers"),
        (
            "vertex that is no UTF-8",
            [&in_a("v 1 2 ")[..], b"\xff\n"].concat(),
            "line 7: element 'a': a vertex",
        ),
        ("weight zero", in_a("v 1 2 3 0"), "line 7: element 'a': a vertex of weight zero"),
        ("NaN", in_a("v 1 nan 0"), "line 7: element 'a': coordinate NaN of vertex 5 is not finite"),
        ("infinity", in_a("v -inf 0 0"), "line 7: element 'a': coordinate -inf of vertex 5"),
        ("overflow", in_a("v 0 0 1e999"), "line 7: element 'a': coordinate inf of vertex 5"),
        ("overflow by weight", in_a("v 0 0 1e300 1e-300"), "line 7: element 'a': coordinate inf of vertex 5"),
        (
            "overflow by digits",
            in_a(&format!("v 0 0 {}", "9".repeat(400))),
            "line 7: element 'a': coordinate inf",
        ),
        ("tabs of all kinds", in_a("v inf\u{b}0\u{b}0"), "line 7: element 'a': coordinate inf of vertex 5"),
        ("beyond all measure", in_a("v 1e200 0 0\nf 1 2 5"), "line 8: element 'a': coordinate 1000"),
        (
            "polygon beyond all measure",
            in_a("v 1e200 0 0\nf 1 2 3 5"),
            "line 8: element 'a': coordinate 1000",
        ),
        ("index 0", in_a("f 0 1 2"), "line 7: element 'a': a face refers to vertex 0"),
        (
            "index too large",
            in_a("f 1 2 5\no b"),
            "line 7: element 'a': a face refers to vertex 5, but there are 4",
        ),
        (
            "index too small",
            in_a("f 1 2 -5"),
            "line 7: element 'a': a face refers to vertex -5, but there are 4",
        ),
        (
            "largest index",
            in_a("f 1 2 9223372036854775807"),
            "line 7: element 'a': a face refers to vertex 92233",
        ),
        (
            "smallest index",
            in_a("f 1 2 -9223372036854775808"),
            "line 7: element 'a': a face refers to vertex -9",
        ),
        (
            "index beyond 64 bits",
            in_a("f 1 2 9223372036854775808"),
            "line 7: element 'a': '9223372036854775808'",
        ),
        ("index that is no number", in_a("f 1 2 x"), "line 7: element 'a': 'x' is no corner of a face"),
        ("index with a fraction", in_a("f 1 2 3.5"), "line 7: element 'a': '3.5' is no corner of a face"),
        ("no vertex index", in_a("f 1 2 /3"), "line 7: element 'a': '/3' is no corner of a face"),
        (
            "four indices a corner",
            in_a("f 1 2 3/1/1/1"),
            "line 7: element 'a': '3/1/1/1' is no corner of a face",
        ),
        ("texture index that is no number", in_a("f 1 2 3/x"), "line 7: element 'a': '3/x' is no corner"),
        ("bad index in a line of two", in_a("f 1 7\n"), "line 7: element 'a': a face refers to vertex 7"),
        ("cut off in a vertex", in_a("v 0.5 1"), "line 7: element 'a': a vertex is three numbers"),
        ("zero byte in a name", in_a("o b\0c"), "line 7: element 'a': a zero byte"),
        (
            "folder up",
            in_a("mtllib ../x.mtl"),
            "line 7: '../x.mtl' leaves the model's folder, and is refused",
        ),
        (
            "folder up, second name",
            in_a("mtllib a.mtl sub/../../x"),
            "line 7: 'a.mtl sub/../../x' leaves the model's",
        ),
        ("absolute path", in_a("mtllib /etc/passwd"), "line 7: '/etc/passwd' leaves the model's folder"),
        (
            "drive",
            in_a("mtllib C:\\Program Files\\a.mtl"),
            "line 7: 'C:\\Program Files\\a.mtl' leaves the model's",
        ),
        ("share", in_a("mtllib \\\\server\\a.mtl"), "line 7: '\\\\server\\a.mtl' leaves the model's folder"),
        (
            "a line over the memory allowed",
            in_a(&format!("f {}", "1 ".repeat(4 << 20))),
            "line 7: element 'a': a long line needs",
        ),
        (
            "names over the memory allowed",
            (0..30).flat_map(|_| in_a(&format!("o {long_name}\nf 1 2 3")).into_iter()).collect(),
            "line 8: element 'xxxxxxxx",
        ),
        (
            "one line of continuations",
            in_a(&format!("f 1{}", "\\\n".repeat(8 << 20))),
            "line 7: element 'a': a long line needs",
        ),
    ]
}

#[test]
fn hostile_files_are_errors_that_name_file_line_and_element() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("hostile.obj");
    for (name, bytes, expected) in table() {
        std::fs::write(&path, &bytes).unwrap();
        let error = match read(&path, &options()) {
            Ok(_) => panic!("{name}: no error"),
            Err(error) => error.to_string(),
        };
        let prefix = format!("{}: {expected}", path.display());
        assert!(error.starts_with(&prefix), "{name}: '{error}' does not start with '{prefix}'");
        assert!(error.len() < 1000, "{name}: {error}");
    }
}

#[test]
fn hostile_libraries_are_errors_that_name_file_and_line() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("house.obj");
    std::fs::write(&path, format!("mtllib a.mtl\n{SQUARE}usemtl m\nf 1 2 3\n")).unwrap();
    let cases: [(&str, &[u8], &str); 9] = [
        ("binary", b"newmtl m\n\0\x01", "line 2: a zero byte"),
        ("colour of no numbers", b"newmtl m\nKd", "line 2: 'Kd': no value"),
        ("colour of words", b"newmtl m\n\nKd red", "line 3: 'Kd red': no number"),
        ("colour with a comma", b"newmtl m\nKd 0,5 0 0", "line 2: 'Kd 0,5 0 0': no number"),
        ("colour cut off", b"newmtl m\nKe 1 0 -", "line 2: 'Ke 1 0 -': no number"),
        ("filter of words", b"newmtl m\nTf a", "line 2: 'Tf a': no number"),
        ("opacity of a word", b"newmtl m\nd half", "line 2: 'd half': no number"),
        ("model of a word", b"newmtl m\nillum two", "line 2: 'illum two': no number"),
        ("index of nothing", b"newmtl m\nNi # none", "line 2: 'Ni # none': no value"),
    ];
    for (name, bytes, expected) in cases {
        std::fs::write(dir.path().join("a.mtl"), bytes).unwrap();
        let error = read(&path, &options()).unwrap_err().to_string();
        assert!(error.starts_with(&format!("a.mtl: {expected}")), "{name}: {error}");
    }
    std::fs::write(dir.path().join("a.mtl"), vec![b'#'; 65 << 20]).unwrap();
    let error = read(&path, &options()).unwrap_err();
    assert!(matches!(error.kind, ImportErrorKind::OverBudget(_)), "{error}");
    std::fs::remove_file(dir.path().join("a.mtl")).unwrap();
    std::fs::create_dir(dir.path().join("a.mtl")).unwrap();
    let model = read(&path, &options()).unwrap();
    assert!(model.warnings[0].text.contains("it is no regular file"), "{:?}", model.warnings);
}

#[cfg(unix)]
#[test]
fn a_library_behind_a_link_out_of_the_folder_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let inner = dir.path().join("model");
    std::fs::create_dir(&inner).unwrap();
    std::fs::write(dir.path().join("secret.mtl"), "newmtl m\n").unwrap();
    std::os::unix::fs::symlink("../secret.mtl", inner.join("a.mtl")).unwrap();
    let path = inner.join("house.obj");
    std::fs::write(&path, format!("mtllib a.mtl\n{SQUARE}usemtl m\nf 1 2 3\n")).unwrap();
    let error = read(&path, &options()).unwrap_err();
    assert!(matches!(error.kind, ImportErrorKind::LeavesFolder(_)), "{error}");
}

#[test]
fn files_that_cannot_be_read_are_errors() {
    let dir = tempfile::tempdir().unwrap();
    for path in [dir.path().to_owned(), dir.path().join("none.obj")] {
        let error = read(&path, &options()).unwrap_err();
        assert!(matches!(error.kind, ImportErrorKind::Io(_)), "{error}");
        assert!(error.to_string().starts_with(&path.display().to_string()));
    }
}

#[test]
fn many_small_things_take_no_long_and_no_more_memory_than_allowed() {
    let mut many: Vec<(&str, String)> = vec![
        ("objects", (0..200_000).map(|i| format!("o {i}\n")).collect()),
        ("objects with faces", (0..100_000).map(|i| format!("o {}\nf 1 2 3\n", i % 7)).collect()),
        ("groups in one object", (0..100_000).map(|i| format!("g {}\nf 1 2 3\n", i % 70)).collect()),
        ("materials", (0..100_000).map(|i| format!("usemtl {i}\nf 1 2 3\n")).collect()),
        ("materials in turn", (0..200_000).map(|i| format!("usemtl {}\nf 1 2 3\n", i % 2)).collect()),
        ("libraries", "mtllib a.mtl\n".repeat(100_000)),
        ("lines", "l 1 2\np 3\nf 1 2\n".repeat(100_000)),
        ("continuations", format!("f 1{} 2 3\n", "\\\n".repeat(1_000_000))),
        ("unknown", "x\n".repeat(500_000)),
        ("a large polygon", format!("f {}\n", "1 2 3 4 ".repeat(100_000))),
    ];
    many.iter_mut().for_each(|(_, text)| text.insert_str(0, &format!("{SQUARE}o a\nf 1 2 3\n")));
    let mut options = options();
    options.limits = Limits::default().with_max_memory(1 << 30);
    for (name, text) in many {
        let start = std::time::Instant::now();
        let model = read_text(text.as_bytes(), "many.obj", None, &options);
        assert!(model.is_ok(), "{name}: {:?}", model.err().map(|e| e.to_string()));
        let took = start.elapsed();
        // Each is far under a second; anything quadratic would be far over.
        assert!(took.as_secs() < 20, "{name} took {took:?}");
    }
}

proptest! {
    // Failures are printed; there is no file to keep them in beside an integration test.
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_do_no_harm(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = read_text(&bytes, "any.obj", None, &options());
    }

    #[test]
    fn any_statements_do_no_harm(
        statements in prop::collection::vec(
            (
                prop::sample::select(vec!["v", "v", "v", "f", "f", "f", "l", "p", "o", "g", "usemtl", "mtllib", "vt",
                    "vn", "s", "fo", "#", "curv", "", "\\", "newmtl"]),
                prop::collection::vec(
                    prop::sample::select(vec!["0", "1", "2", "3", "4", "-1", "-2", "1e9", "0.5", "nan", "-7", "1/2",
                        "2//3", "3/1/2", "/", "9223372036854775807", "-9223372036854775808", "a:b#c", "Storey:x",
                        "\\", "#", "\u{b}", "\u{a0}", "ä", "..", "1e308", "-1e308"]),
                    0..7,
                ),
            ),
            0..40,
        ),
        ends in prop::sample::select(vec!["\n", "\r\n", "\r", "\\\n"]),
    ) {
        let text: String = statements.iter().map(|(k, words)| format!("{k} {}{ends}", words.join(" "))).collect();
        let text = format!("{SQUARE}{text}");
        if let Ok(model) = read_text(text.as_bytes(), "any.obj", None, &options()) {
            prop_assert!(model.triangle_count() > 0);
            for element in &model.elements {
                prop_assert!(!element.id.is_empty());
                prop_assert!(element.mesh.positions.iter().flatten().all(|c| c.is_finite()));
                let vertices = element.mesh.positions.len() as u32;
                prop_assert!(element.mesh.triangles.iter().flatten().all(|&v| v < vertices));
            }
        }
    }

    #[test]
    fn any_library_does_no_harm(
        statements in prop::collection::vec(
            (
                prop::sample::select(vec!["newmtl", "newmtl", "Ka", "Kd", "Ks", "Ke", "Ns", "Ni", "d", "Tr", "Tf",
                    "illum", "map_Kd", "map_Ka", "map_d", "bump", "Pr", "Pm", "#", "", "spectral"]),
                prop::collection::vec(
                    prop::sample::select(vec!["0", "1", "0.5", "nan", "-1", "1e999", "300", "m", "spectral", "-s",
                        "-halo", "../x", "#", "\\", "ä"]),
                    0..4,
                ),
            ),
            0..20,
        ),
    ) {
        let text: String = statements.iter().map(|(k, words)| format!("{k} {}\n", words.join(" "))).collect();
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join("a.mtl"), text).unwrap();
        let obj = format!("mtllib a.mtl\n{SQUARE}usemtl m\nf 1 2 3\n");
        if let Ok(model) = read_text(obj.as_bytes(), "any.obj", Some(dir.path()), &options()) {
            for m in &model.materials {
                let unit = |v: f32| (0.0..=1.0).contains(&v);
                prop_assert!(m.base_color.iter().all(|&c| unit(c)), "{m:?}");
                prop_assert!(unit(m.alpha) && unit(m.metallic) && unit(m.roughness) && unit(m.transmission), "{m:?}");
                prop_assert!(m.emissive.iter().all(|&e| e >= 0.0 && e.is_finite()) && m.ior > 0.0, "{m:?}");
            }
        }
    }
}
