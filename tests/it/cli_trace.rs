//! `enfilade trace`: every way in and out gives the same answers, and bad rays are refused by place.
#![cfg(feature = "cli")]

use crate::common;

use common::{Folder, fixture_arg};
use enfilade_testing::Random;

type Row = Vec<f64>;

/// Rays about the house in its own frame (Y up), from inside and outside.
fn rays(count: usize) -> Vec<[f64; 6]> {
    let mut random = Random::new(11);
    let ray = |_| {
        let [x, y, z] = random.point([-3.0, -1.0, -13.0], [15.0, 6.0, 4.0]);
        let [u, v, w] = random.direction();
        [x, y, z, u, v, w]
    };
    (0..count).map(ray).collect()
}

fn text<const N: usize>(rays: &[[f64; N]]) -> String {
    let line = |ray: &[f64; N]| ray.map(|n| n.to_string()).join(" ") + "\n";
    rays.iter().map(line).collect()
}

fn f64s<const N: usize>(rays: &[[f64; N]]) -> Vec<u8> {
    rays.iter().flatten().flat_map(|n| n.to_le_bytes()).collect()
}

/// Rows of numbers, with the names of their columns.
fn parse(text: &str) -> (Vec<String>, Vec<Row>) {
    let (heading, rows) = text.split_once('\n').unwrap();
    let names = heading.strip_prefix("# ").unwrap().split(' ').map(str::to_owned).collect();
    let row = |line: &str| line.split(' ').map(|n| n.parse().unwrap()).collect();
    (names, rows.lines().map(row).collect())
}

fn rows_of(bytes: &[u8], columns: usize) -> Vec<Row> {
    assert_eq!(bytes.len() % (columns * 8), 0);
    let row = |row: &[u8]| row.chunks(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
    bytes.chunks(columns * 8).map(row).collect()
}

/// Equal in every bit that is a number: NaN equals NaN.
fn same(a: &[Row], b: &[Row]) -> bool {
    let equal = |(x, y): (&f64, &f64)| x == y || (x.is_nan() && y.is_nan());
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.len() == b.len() && a.iter().zip(b).all(equal))
}

/// An .npy file (format 1.0) of rows of `columns` numbers.
fn npy(descr: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let mut header = format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}");
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

const FIELDS: &str = "t,x,y,z,nx,ny,nz,element,semantic,material,cell,room";

fn house() -> Folder {
    let folder = Folder::new();
    folder.compile_house();
    folder
}

/// All fields of all rays' answers, by text.
fn answers(folder: &Folder, rays: &[[f64; 6]]) -> Vec<Row> {
    let ran = folder
        .run_with(&["trace", "house.enf", "--rays", "-", "--fields", FIELDS], text(rays).as_bytes())
        .expect(0);
    let (names, rows) = parse(ran.text());
    assert_eq!(names.join(","), FIELDS);
    assert_eq!(rows.len(), rays.len());
    rows
}

#[test]
fn every_format_in_and_out_gives_the_same() {
    let folder = house();
    let rays = rays(300);
    let expected = answers(&folder, &rays);
    let answered = |test: fn(f64) -> bool| expected.iter().filter(|row| test(row[0])).count();
    assert!(answered(f64::is_finite) > 100 && answered(f64::is_infinite) > 10 && answered(f64::is_nan) > 0);

    folder.write("rays.txt", text(&rays));
    folder.write("rays.f64", f64s(&rays));
    folder.write("rays.npy", npy("<f8", false, "(300, 6)", &f64s(&rays)));
    for input in [&["rays.txt"][..], &["rays.f64", "--in", "f64"], &["rays.npy"]] {
        let trace = [&["trace", "house.enf", "--fields", FIELDS, "--rays"], input].concat();
        let with = |more: &[&str]| folder.run(&[&trace[..], more].concat()).expect(0);
        assert!(same(&parse(with(&[]).text()).1, &expected), "{input:?} to text");
        assert!(same(&rows_of(&with(&["--out", "f64"]).out, 12), &expected), "{input:?} to f64");
        with(&["-o", "hits.npy"]);
        let file = folder.read("hits.npy");
        assert_eq!(&file[..6], b"\x93NUMPY");
        let length = usize::from(u16::from_le_bytes([file[8], file[9]]));
        let header = std::str::from_utf8(&file[10..10 + length]).unwrap();
        assert!(
            header.contains("'<f8'") && header.contains("False") && header.contains("(300, 12"),
            "{header}"
        );
        assert_eq!((10 + length) % 16, 0, "numpy aligns its data");
        assert!(same(&rows_of(&file[10 + length..], 12), &expected), "{input:?} to npy");
        assert!(with(&["--out", "npy"]).out == file);
    }

    // What came out as npy goes in as npy.
    folder.run(&["trace", "house.enf", "--rays", "rays.txt", "--fields", "x,y,z,nx,ny,nz", "-o", "back.npy"]);
    let all_hit = expected.iter().all(|row| row[0].is_finite());
    assert!(!all_hit, "so that some rows are no rays");
    folder.run(&["trace", "house.enf", "--rays", "back.npy"]).expect(3);
    let hit: Vec<[f64; 6]> =
        rays.iter().zip(&expected).filter(|(_, row)| row[0].is_finite()).map(|(ray, _)| *ray).collect();
    folder.write("hit.txt", text(&hit));
    let fields = "x,y,z,nx,ny,nz";
    folder.run(&["trace", "house.enf", "--rays", "hit.txt", "--fields", fields, "-o", "back.npy"]).expect(0);
    let ran = folder.run(&["trace", "house.enf", "--rays", "back.npy", "--fields", "t"]).expect(0);
    assert_eq!(parse(ran.text()).1.len(), hit.len());
}

#[test]
fn single_precision_rays_are_read_exactly() {
    let folder = house();
    let rounded: Vec<[f64; 6]> = rays(100).into_iter().map(|ray| ray.map(|n| f64::from(n as f32))).collect();
    let expected = answers(&folder, &rounded);
    let bytes: Vec<u8> = rounded.iter().flatten().flat_map(|&n| (n as f32).to_le_bytes()).collect();
    folder.write("rays.npy", npy("<f4", false, "(100, 6)", &bytes));
    for (arguments, stdin) in
        [(&["--rays", "-", "--in", "f32"][..], &bytes[..]), (&["--rays", "rays.npy"], &[])]
    {
        let trace = [&["trace", "house.enf", "--fields", FIELDS, "--out", "f64"], arguments].concat();
        assert!(same(&rows_of(&folder.run_with(&trace, stdin).expect(0).out, 12), &expected));
    }
}

#[test]
fn stats_tell_what_it_took_and_change_nothing() {
    let folder = house();
    folder.write("rays.txt", text(&rays(300)));
    let trace = ["trace", "house.enf", "--rays", "rays.txt"];
    let plain = folder.run(&trace).expect(0);
    let told = folder.run(&[&trace[..], &["--stats"]].concat()).expect(0);
    assert_eq!((told.text(), plain.err.is_empty()), (plain.text(), true));
    let lines: Vec<&str> = told.err.lines().collect();
    assert!(lines.len() == 5 && lines[0].starts_with("300 rays"), "{lines:?}");
    let number = |line: &str, place: usize| {
        let numbers = line.split([' ', ',']).filter_map(|word| word.parse::<f64>().ok());
        numbers.collect::<Vec<f64>>()[place]
    };
    assert!(number(lines[1], 0) > 0.5 && number(lines[2], 0) > 0.5 && number(lines[3], 1) > 0.1, "{lines:?}");
}

#[test]
fn text_may_have_comments_commas_and_blank_lines() {
    let folder = house();
    let trace = ["trace", "house.enf", "--rays", "-", "--fields", "t,element"];
    let plain = folder.run_with(&trace, b"2 1.6 -3 1 0 0\n2 1.6 -3 0 0 1\n").expect(0);
    let loose = b"# two rays\n\n 2,1.6,-3,\t1,0,0 # east\r\n2 1.6 -3 0 0 4";
    assert_eq!(folder.run_with(&trace, loose).expect(0).text(), plain.text());
    assert_eq!(folder.run_with(&trace, b"# nothing\n").expect(0).text(), "# t element\n");
}

#[test]
fn a_model_is_its_compiled_scene() {
    let folder = house();
    folder.write("rays.txt", text(&rays(200)));
    let scene = folder.run(&["trace", "house.enf", "--rays", "rays.txt"]).expect(0);
    let model = folder.run(&["trace", &fixture_arg("house.glb"), "--rays", "rays.txt"]).expect(0);
    assert!(scene.out == model.out);
    let one = folder.run(&["trace", "house.enf", "--rays", "rays.txt", "-j", "1"]).expect(0);
    assert!(scene.out == one.out);
}

#[test]
fn the_three_answers() {
    let folder = house();
    let hit = answers(&folder, &[[2.0, 1.6, -3.0, 3.0, 0.0, 0.0]]).remove(0);
    let (t, element) = (hit[0], hit[7]);
    assert!(t > 0.5 && t < 20.0 && element >= 0.0);
    assert_eq!(hit[1..4], [2.0 + t, 1.6, -3.0], "the point is origin and t times the unit direction");
    assert_eq!(hit[4..7], [-1.0, 0.0, 0.0], "the normal is on the ray's side");

    let escaped = answers(&folder, &[[2.0, 50.0, -3.0, 0.0, 1.0, 0.0]]).remove(0);
    assert_eq!((escaped[0], escaped[7], escaped[9], escaped[11]), (f64::INFINITY, -1.0, -1.0, -1.0));

    let inside = answers(&folder, &[[hit[1] + 0.05, 1.6, -3.0, 1.0, 0.0, 0.0]]).remove(0);
    assert!(inside[0].is_nan());
    assert_eq!((inside[7], inside[8]), (element, hit[8]), "in the wall that was hit");
}

#[test]
fn fields_come_in_the_order_asked_for() {
    let folder = house();
    let rays = rays(50);
    let expected = answers(&folder, &rays);
    let trace = ["trace", "house.enf", "--rays", "-", "--fields", "element,nz,t,t"];
    let (names, rows) = parse(folder.run_with(&trace, text(&rays).as_bytes()).expect(0).text());
    assert_eq!(names, ["element", "nz", "t", "t"]);
    let picked: Vec<Row> = expected.iter().map(|r| vec![r[7], r[6], r[0], r[0]]).collect();
    assert!(same(&rows, &picked));
    let ran = folder.run_with(&["trace", "house.enf", "--rays", "-"], text(&rays).as_bytes()).expect(0);
    assert_eq!(parse(ran.text()).0.join(","), "t,x,y,z,nx,ny,nz,element,semantic,cell,room");
    // Kinds of faces beside meanings of elements, which stay as they are.
    let trace = ["trace", "house.enf", "--rays", "-", "--fields", "face,semantic"];
    let (_, rows) = parse(folder.run_with(&trace, text(&rays).as_bytes()).expect(0).text());
    assert!(rows.iter().zip(&expected).all(|(row, all)| row[1] == all[8]));
    let (faces, others): (Vec<f64>, Vec<f64>) = rows.iter().map(|row| row[0]).partition(|face| *face >= 64.0);
    assert!(faces.len() > 5 && faces.iter().all(|face| *face <= 72.0), "{faces:?}");
    assert!(!others.is_empty() && others.iter().all(|face| *face == -1.0));
}

#[test]
fn segments_end_where_they_end() {
    let folder = house();
    let rays = rays(200);
    let expected = answers(&folder, &rays);
    // Each ray as a segment that ends just before its hit, just behind it, and as a whole.
    let mut segments = Vec::new();
    for (ray, answer) in rays.iter().zip(&expected).filter(|(_, answer)| answer[0].is_finite()) {
        let &[a, b, c, d, e, f] = ray;
        for end in [answer[0] - 1e-6, answer[0] + 1e-6, f64::INFINITY] {
            segments.push([a, b, c, d, e, f, 0.0, end]);
        }
        segments.push([a, b, c, d, e, f, answer[0] + 1e-6, f64::INFINITY]);
    }
    let trace = ["trace", "house.enf", "--rays", "-", "--segments", "--fields", "t,element"];
    let (_, rows) = parse(folder.run_with(&trace, text(&segments).as_bytes()).expect(0).text());
    assert_eq!(rows.len(), segments.len());
    let binary = [&trace[..], &["--in", "f64", "--out", "f64"]].concat();
    assert!(same(&rows, &rows_of(&folder.run_with(&binary, &f64s(&segments)).expect(0).out, 2)));
    let hits = expected.iter().filter(|answer| answer[0].is_finite());
    for (rows, answer) in rows.chunks(4).zip(hits) {
        assert_eq!(rows[0], [f64::INFINITY, -1.0], "too short");
        assert_eq!(rows[1], [answer[0], answer[7]]);
        assert_eq!(rows[2], [answer[0], answer[7]]);
        assert!(rows[3][0].is_nan() || rows[3][0] > answer[0], "begins behind it: {:?}", rows[3]);
    }
    folder.run_with(&trace, b"2 1.6 -3 1 0 0\n").expect(3);
}

#[test]
fn frames_differ_by_their_axes_only() {
    let folder = house();
    let rays = rays(200);
    let source = answers(&folder, &rays);
    // The house has no offset: internal is the source turned to Z up.
    let turn = |v: &[f64]| [v[0], -v[2], v[1]];
    let turned: Vec<[f64; 6]> =
        rays.iter().map(|ray| [turn(&ray[..3]), turn(&ray[3..])].concat().try_into().unwrap()).collect();
    let trace =
        ["trace", "house.enf", "--rays", "-", "--in", "f64", "--fields", FIELDS, "--frame", "internal"];
    let (_, internal) = parse(folder.run_with(&trace, &f64s(&turned)).expect(0).text());
    let expected: Vec<Row> = source
        .iter()
        .map(|row| [&row[..1], &turn(&row[1..4]), &turn(&row[4..7]), &row[7..]].concat())
        .collect();
    assert!(same(&internal, &expected));
}

#[test]
fn lengths_count_in_the_source_s_unit() {
    let folder = house();
    let rays = rays(200);
    let metres = answers(&folder, &rays);
    let house = fixture_arg("house.obj");
    folder.run(&["compile", &house, "--unit", "ft", "-o", "feet.enf"]).expect(0);
    let trace = ["trace", "feet.enf", "--rays", "-", "--fields", FIELDS];
    let (_, feet) = parse(folder.run_with(&trace, text(&rays).as_bytes()).expect(0).text());
    for (m, f) in metres.iter().zip(&feet) {
        assert_eq!(m[7], f[7]);
        for column in 0..7 {
            let (m, f) = (m[column], f[column]);
            assert!(m == f || m.is_nan() && f.is_nan() || (m - f).abs() < 1e-9, "{m} {f}");
        }
    }
}

/// Two walls of one metre, facing each other two metres apart, 5,000 km from the origin: .gltf and .bin.
fn write_far_model(folder: &Folder) {
    let mut points: Vec<f32> = Vec::new();
    for x in [0.0, 2.0] {
        points.extend([x, 0.0, 0.0, x, 1.0, 0.0, x, 1.0, 1.0, x, 0.0, 1.0]);
    }
    let indices: [u16; 12] = [0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7];
    let mut bin: Vec<u8> = points.iter().flat_map(|c| c.to_le_bytes()).collect();
    bin.extend(indices.iter().flat_map(|i| i.to_le_bytes()));
    let json = serde_json::json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [
            { "name": "site", "translation": [5e6, 0.25, -3e6], "children": [1] },
            { "name": "IfcPlate:walls", "mesh": 0 }
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3",
              "min": [0.0, 0.0, 0.0], "max": [2.0, 1.0, 1.0] },
            { "bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR" }
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 96 },
            { "buffer": 0, "byteOffset": 96, "byteLength": 24 }
        ],
        "buffers": [{ "uri": "far.bin", "byteLength": bin.len() }]
    });
    folder.write("far.bin", bin);
    folder.write("far.gltf", json.to_string());
}

#[test]
fn far_models_keep_their_millimetres() {
    let folder = Folder::new();
    write_far_model(&folder);
    let report = folder.run(&["inspect", "far.gltf", "--json"]).expect(0).json();
    let offset: Vec<f64> = report["offset"].as_array().unwrap().iter().map(|n| n.as_f64().unwrap()).collect();
    assert_eq!(offset.len(), 3);
    // Z up inside: (x, -z, y).
    assert!((offset[0] - 5e6).abs() < 3.0 && (offset[1] - 3e6).abs() < 3.0, "{offset:?}");

    let trace = ["trace", "far.gltf", "--rays", "-", "--fields", "t,x,y,z"];
    let ran = folder.run_with(&trace, b"5000000.125 0.75 -2999999.625 1 0 0\n").expect(0);
    assert_eq!(parse(ran.text()).1, [[1.875, 5_000_002.0, 0.75, -2_999_999.625]]);

    // The same ray in the internal frame, where f32 has room for it.
    let internal = [5_000_000.125 - offset[0], 2_999_999.625 - offset[1], 0.75 - offset[2], 1.0, 0.0, 0.0];
    let bytes: Vec<u8> = internal.iter().flat_map(|&n| (n as f32).to_le_bytes()).collect();
    let single = [&trace[..], &["--in", "f32"]].concat();
    folder.run_with(&single, &bytes).expect_failure(3, &["stdin", "f32", "--frame internal"]);
    let ran = folder.run_with(&[&single[..], &["--frame", "internal"]].concat(), &bytes).expect(0);
    let row = &parse(ran.text()).1[0];
    assert_eq!(row[0], 1.875);
    assert_eq!(row[1], 5_000_002.0 - offset[0]);
    folder.write("rays.npy", npy("<f4", false, "(1, 6)", &bytes));
    folder.run(&["trace", "far.gltf", "--rays", "rays.npy"]).expect_failure(3, &["rays.npy", "f32"]);
}

/// Fields of one line of CSV (RFC 4180).
fn csv(line: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let (mut quoted, mut letters) = (false, line.chars().peekable());
    while let Some(letter) = letters.next() {
        match letter {
            '"' if quoted && letters.peek() == Some(&'"') => {
                fields.last_mut().unwrap().extend(letters.next())
            }
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            letter => fields.last_mut().unwrap().push(letter),
        }
    }
    fields
}

#[test]
fn the_table_of_elements_tells_what_the_indices_mean() {
    let folder = Folder::new();
    let odd = "o IfcWall:comma, \"quotes\"#w-1\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    folder.write("odd.obj", odd);
    for model in [fixture_arg("house.glb"), "odd.obj".to_owned()] {
        let report = folder.run(&["inspect", &model, "--json"]).expect(0).json();
        let ran = folder.run(&["trace", &model, "--rays", "-", "--elements", "elements.csv"]).expect(0);
        assert_eq!(ran.text().lines().count(), 1, "no rays, a heading only");
        let table = String::from_utf8(folder.read("elements.csv")).unwrap();
        let mut lines = table.lines();
        assert_eq!(lines.next(), Some("index,id,name,class,semantic,storey"));
        let elements = report["elements"].as_array().unwrap();
        assert_eq!(lines.clone().count(), elements.len());
        for (line, element) in lines.zip(elements) {
            let fields = csv(line);
            assert_eq!(fields[0], element["index"].to_string());
            let texts =
                ["id", "name", "class", "semantic", "storey"].map(|key| element[key].as_str().unwrap());
            assert_eq!(fields[1..], texts);
        }
    }
    let table = String::from_utf8(folder.read("elements.csv")).unwrap();
    assert!(table.contains("\"comma, \"\"quotes\"\"\""), "{table}");
}

#[test]
fn bad_rays_are_refused_by_their_place() {
    let folder = house();
    let good = "2 1.6 -3 1 0 0\n";
    let lines = [
        ("2 1.6 -3 1 0\n", "5 numbers"),
        ("2 1.6 -3 1 0 0 0\n", "7 numbers"),
        ("2 1.6 -3 1 0 east\n", "'east'"),
        ("2 1.6 -3 0 0 0\n", "direction"),
        ("2 nan -3 1 0 0\n", "finite"),
        ("2 1.6 -3 1 0 inf\n", "finite"),
        ("2 1.6 -3 1 0 1e999\n", "finite"),
    ];
    let trace = |more: &[&str], stdin: &[u8]| {
        folder.run_with(&[&["trace", "house.enf", "--rays", "-", "-o", "hits.txt"], more].concat(), stdin)
    };
    for (line, what) in lines {
        trace(&[], format!("{good}# comment\n{line}{good}").as_bytes())
            .expect_failure(3, &["stdin: line 3", what]);
    }
    let long = format!("{good}{}", "1 ".repeat(1 << 20));
    trace(&[], long.as_bytes()).expect_failure(3, &["stdin: line 2", "longer"]);
    trace(&[], &[good.as_bytes(), b"\xff\xfe\n"].concat()).expect_failure(3, &["stdin: line 2"]);

    let two = [[2.0, 1.6, -3.0, 1.0, 0.0, 0.0], [2.0, 1.6, -3.0, f64::NAN, 0.0, 0.0]];
    trace(&["--in", "f64"], &f64s(&two)).expect_failure(3, &["stdin: ray 1", "finite"]);
    trace(&["--in", "f64"], &f64s(&two)[..47]).expect_failure(3, &["stdin: ray 0", "cut off after 47 of 48"]);
    let ones = 1f32.to_le_bytes().repeat(8);
    trace(&["--in", "f32"], &ones[..30]).expect_failure(3, &["stdin: ray 1", "cut off after 6 of 24"]);

    let data = f64s(&rays(2));
    let files = [
        (npy("<f8", false, "(2, 8)", &data), "shape"),
        (npy("<f8", false, "(12,)", &data), "shape"),
        (npy("<f8", true, "(2, 6)", &data), "Fortran"),
        (npy(">f8", false, "(2, 6)", &data), "little-endian"),
        (npy("<i8", false, "(2, 6)", &data), "<i8"),
        (npy("<f2", false, "(2, 6)", &data), "<f2"),
        (npy("<f8", false, "(3, 6)", &data), "3"),
        (npy("<f8", false, "(9223372036854775807, 6)", &data), "npy"),
        (npy("<f8", false, "(4294967296, 4294967296)", &data), "npy"),
        (npy("<f8", false, &"(".repeat(4000), &data), "npy"),
        (b"\x93NUMPY\x02\x00\xff\xff\xff\xff{".to_vec(), "npy"),
        (npy("<f8", false, "(2, 6)", &data[..95]), "cut off"),
        (npy("<f8", false, "(1, 6)", &data), "more"),
        (npy("<f8", false, "(2, 6)", &data)[..40].to_vec(), "npy"),
        (b"\x93NUMPY\x01\x00\xff\xff{".to_vec(), "npy"),
        (data.clone(), "npy"),
        (Vec::new(), "npy"),
    ];
    for (bytes, what) in files {
        folder.write("bad.npy", bytes);
        folder
            .run(&["trace", "house.enf", "--rays", "bad.npy", "-o", "hits.txt"])
            .expect_failure(3, &["bad.npy", what]);
    }
    assert_eq!(folder.names(), ["bad.npy", "house.enf"], "no hits of a failed run stayed");
}

#[test]
fn hits_beyond_the_memory_allowed_are_refused_in_npy_only() {
    let folder = house();
    let rays = "2 1.6 -3 1 0 0\n".repeat(70_000);
    let trace = |out: &str| {
        let arguments = ["trace", "house.enf", "--rays", "-", "--out", out, "--max-memory", "5M"];
        folder.run_with(&arguments, rays.as_bytes())
    };
    assert_eq!(trace("f64").expect(0).out.len(), 70_000 * 11 * 8);
    trace("npy").expect_failure(4, &["--max-memory", "--out f64"]);
}
