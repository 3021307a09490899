//! The generated house as files: what they hold, and that the fixtures are what the generator makes.
//!
//! `ENFILADE_BLESS=1 cargo test --test generate` writes the fixtures anew.
#![cfg(feature = "compile")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use enfilade::generate::{
    Building, Element, HouseOptions, Kind, OfficeOptions, Style, TowerOptions, build1, build2, build3, house,
    metres, random, specimens, tower,
};
use enfilade::importers::{ImportOptions, Model, Semantic, import};
use serde_json::Value;

/// A point as the file has it, by the bits of its coordinates.
type Bits = [u64; 3];

fn bits(p: [f64; 3]) -> Bits {
    p.map(f64::to_bits)
}

/// Panics unless each directed edge occurs once, and its reverse too.
fn assert_closed(rings: impl IntoIterator<Item = Vec<Bits>>, name: &str) {
    let mut edges = BTreeMap::new();
    for ring in rings {
        for (i, &p) in ring.iter().enumerate() {
            *edges.entry((p, ring[(i + 1) % ring.len()])).or_insert(0) += 1;
        }
    }
    assert!(!edges.is_empty(), "{name} has no faces");
    for (&(p, q), &count) in &edges {
        assert!(count == 1 && edges.contains_key(&(q, p)), "{name} is open at {:?}", p.map(f64::from_bits));
    }
}

/// Six times the volume inside rings that fan out from their first corner.
fn sixfold_volume(rings: &[Vec<[f64; 3]>]) -> f64 {
    let fans = rings.iter().flat_map(|ring| ring.windows(2).skip(1).map(|w| [ring[0], w[0], w[1]]));
    fans.map(|[a, b, c]| {
        a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    })
    .sum()
}

/// That a file's mesh, Y up, is the element: closed, of the same volume, its corners on the grid.
fn assert_is_element(element: &Element, rings: &[Vec<[f64; 3]>]) {
    let name = element.tagged_name();
    assert_closed(rings.iter().map(|ring| ring.iter().map(|&p| bits(p)).collect()), &name);
    assert!((sixfold_volume(rings) / 6.0 - element.volume()).abs() < 1e-7, "{name}");
    let drawn: BTreeSet<Bits> =
        element.points.iter().map(|&[x, y, z]| bits([x, z, -y].map(metres))).collect();
    let written: BTreeSet<Bits> = rings.iter().flatten().map(|&p| bits(p)).collect();
    assert!(written == drawn, "{name} has other corners");
}

/// A binary glTF, taken apart.
struct Glb {
    json: Value,
    binary: Vec<u8>,
}

impl Glb {
    fn parse(bytes: &[u8]) -> Glb {
        let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!((&bytes[..4], number(4), number(8)), (&b"glTF"[..], 2, bytes.len()));
        let json = number(12);
        assert_eq!((json % 4, &bytes[16..20]), (0, &b"JSON"[..]));
        let binary = number(20 + json);
        assert_eq!((binary % 4, &bytes[24 + json..28 + json]), (0, &b"BIN\0"[..]));
        assert_eq!(28 + json + binary, bytes.len());
        Glb {
            json: serde_json::from_slice(&bytes[20..20 + json]).unwrap(),
            binary: bytes[28 + json..].to_vec(),
        }
    }

    fn list(&self, name: &str) -> &[Value] {
        self.json[name].as_array().unwrap()
    }

    /// An accessor's bytes, within its view and aligned, with its component type.
    fn bytes(&self, accessor: usize, kind: &str, components: usize) -> (&[u8], u64) {
        let accessor = &self.list("accessors")[accessor];
        assert_eq!(accessor["type"], kind);
        let component = accessor["componentType"].as_u64().unwrap();
        let size = match component {
            5123 => 2,
            5125 | 5126 => 4,
            other => panic!("component type {other}"),
        };
        let view = &self.list("bufferViews")[accessor["bufferView"].as_u64().unwrap() as usize];
        let at = |value: &Value| value.as_u64().unwrap() as usize;
        let (start, inside, length) =
            (at(&view["byteOffset"]), at(&accessor["byteOffset"]), at(&view["byteLength"]));
        let bytes = at(&accessor["count"]) * components * size;
        assert!(inside + bytes <= length && start + length <= self.binary.len());
        assert_eq!((start + inside) % size, 0);
        if let Some(stride) = view["byteStride"].as_u64() {
            assert_eq!((stride as usize, inside % 4), (components * size, 0));
        }
        (&self.binary[start + inside..start + inside + bytes], component)
    }

    fn positions(&self, accessor: usize) -> Vec<[f64; 3]> {
        let (bytes, component) = self.bytes(accessor, "VEC3", 3);
        assert_eq!(component, 5126);
        let float = |b: &[u8]| f64::from(f32::from_le_bytes(b.try_into().unwrap()));
        let points: Vec<[f64; 3]> =
            bytes.chunks(12).map(|p| [float(&p[..4]), float(&p[4..8]), float(&p[8..])]).collect();
        for axis in 0..3 {
            let bound = |name: &str| self.list("accessors")[accessor][name][axis].as_f64();
            let all = || points.iter().map(|p| p[axis]);
            assert_eq!(bound("min"), all().reduce(f64::min));
            assert_eq!(bound("max"), all().reduce(f64::max));
        }
        points
    }

    fn indices(&self, accessor: usize) -> Vec<usize> {
        let (bytes, component) = self.bytes(accessor, "SCALAR", 1);
        match component {
            5123 => bytes.chunks(2).map(|b| usize::from(u16::from_le_bytes(b.try_into().unwrap()))).collect(),
            5125 => bytes.chunks(4).map(|b| u32::from_le_bytes(b.try_into().unwrap()) as usize).collect(),
            other => panic!("indices of type {other}"),
        }
    }
}

#[test]
fn glb_holds_the_house() {
    let building = house(&HouseOptions::default());
    let glb = Glb::parse(&building.to_glb());
    assert_eq!(glb.json["asset"]["version"], "2.0");
    assert_eq!(glb.json["buffers"][0]["byteLength"], glb.binary.len());
    let nodes = glb.list("nodes");
    let shown: Vec<u64> =
        glb.json["scenes"][0]["nodes"].as_array().unwrap().iter().map(|n| n.as_u64().unwrap()).collect();
    assert!(shown.into_iter().eq(0..nodes.len() as u64), "the scene shows every node");

    for (node, element) in nodes.iter().zip(&building.elements) {
        assert_eq!(node["name"], element.tagged_name());
        let extras = &node["extras"];
        assert_eq!(extras["ifc_class"], *element.class);
        assert_eq!(extras["global_id"], *element.global_id);
        assert_eq!(extras["name"], *element.name);
        assert_eq!(extras["storey"].as_str(), element.storey.as_deref());
        let links =
            [("host_id", element.host), ("filling_id", element.filling), ("opening_id", element.opening)];
        for (key, link) in links {
            let id = link.map(|other| building.elements[other as usize].global_id.as_str());
            assert_eq!(extras[key].as_str(), id, "{key} of {}", element.name);
        }
        let mesh = &glb.list("meshes")[node["mesh"].as_u64().unwrap() as usize];
        let mut triangles = Vec::new();
        for primitive in mesh["primitives"].as_array().unwrap() {
            assert_eq!(primitive["mode"], 4);
            assert!((primitive["material"].as_u64().unwrap() as usize) < glb.list("materials").len());
            let points = glb.positions(primitive["attributes"]["POSITION"].as_u64().unwrap() as usize);
            let corners = glb.indices(primitive["indices"].as_u64().unwrap() as usize);
            assert!(corners.len().is_multiple_of(3) && !corners.is_empty());
            triangles.extend(corners.chunks(3).map(|t| t.iter().map(|&i| points[i]).collect::<Vec<_>>()));
        }
        assert_is_element(element, &triangles);
    }
    let materials = |class: &str| {
        let node = nodes.iter().find(|n| n["extras"]["ifc_class"] == class).unwrap();
        let mesh = &glb.list("meshes")[node["mesh"].as_u64().unwrap() as usize];
        let of = |p: &Value| glb.list("materials")[p["material"].as_u64().unwrap() as usize]["name"].clone();
        mesh["primitives"].as_array().unwrap().iter().map(of).collect::<Vec<_>>()
    };
    assert_eq!(materials("IfcWindow"), ["White paint", "Glass"]);
}

#[test]
fn glb_holds_lights_and_cameras() {
    let building = house(&HouseOptions::default());
    let glb = Glb::parse(&building.to_glb());
    assert_eq!(glb.json["extensionsUsed"], serde_json::json!(["KHR_lights_punctual"]));
    let lights = glb.json["extensions"]["KHR_lights_punctual"]["lights"].as_array().unwrap();
    assert!(lights.len() == 8 && lights.iter().all(|l| l["type"] == "point"));
    let nodes = &glb.list("nodes")[building.elements.len()..];
    for (node, light) in nodes.iter().zip(&building.lights) {
        let index = node["extensions"]["KHR_lights_punctual"]["light"].as_u64().unwrap() as usize;
        assert_eq!(lights[index]["name"], *light.name);
        assert_eq!(lights[index]["intensity"].as_f64().unwrap() as f32, light.intensity);
        let [x, y, z] = light.position;
        assert_eq!(node["translation"], serde_json::json!([x, z, -y]));
    }
    for (node, camera) in nodes[8..].iter().zip(&building.cameras) {
        let index = node["camera"].as_u64().unwrap() as usize;
        let yfov = glb.list("cameras")[index]["perspective"]["yfov"].as_f64().unwrap();
        assert!((yfov.to_degrees() - camera.vfov_degrees).abs() < 1e-9);
        let matrix: Vec<f64> =
            node["matrix"].as_array().unwrap().iter().map(|c| c.as_f64().unwrap()).collect();
        // Columns: right, up, back, eye. An orthonormal frame, looking where the camera does.
        let columns: Vec<&[f64]> = matrix.chunks(4).collect();
        let dot = |a: &[f64], b: &[f64]| (0..3).map(|i| a[i] * b[i]).sum::<f64>();
        for i in 0..3 {
            for j in 0..3 {
                assert!((dot(columns[i], columns[j]) - f64::from(u8::from(i == j))).abs() < 1e-12);
            }
        }
        let [x, y, z] = camera.direction;
        assert!((dot(columns[2], &[-x, -z, y]) - 1.0).abs() < 1e-12);
        assert!(columns[1][1] > 0.0, "up is up");
        let [x, y, z] = camera.eye;
        assert_eq!(columns[3], [x, z, -y, 1.0]);
    }
    assert_eq!(nodes.len(), building.lights.len() + building.cameras.len());
}

#[test]
fn obj_holds_the_house() {
    let building = house(&HouseOptions::default());
    let (obj, mtl) = building.to_obj("house.mtl");
    let named = |text: &str, word: &str| -> BTreeSet<String> {
        text.lines().filter_map(|l| l.strip_prefix(word)).map(|l| l.trim().to_owned()).collect()
    };
    assert!(named(&obj, "usemtl ").is_subset(&named(&mtl, "newmtl ")));
    assert_eq!(named(&obj, "mtllib "), ["house.mtl".to_owned()].into());
    assert_eq!(named(&mtl, "newmtl ").len(), building.materials.len());

    let mut points: Vec<[f64; 3]> = Vec::new();
    let mut objects: Vec<(&str, Vec<Vec<[f64; 3]>>)> = Vec::new();
    let mut quads = 0;
    for line in obj.lines() {
        let (word, rest) = line.split_once(' ').unwrap();
        match word {
            "o" => objects.push((rest, Vec::new())),
            "v" => {
                let p: Vec<f64> = rest.split(' ').map(|c| c.parse().unwrap()).collect();
                points.push(p.try_into().unwrap());
            }
            "f" => {
                let ring: Vec<[f64; 3]> =
                    rest.split(' ').map(|i| points[i.parse::<usize>().unwrap() - 1]).collect();
                quads += usize::from(ring.len() == 4);
                objects.last_mut().unwrap().1.push(ring);
            }
            "#" | "mtllib" | "usemtl" => {}
            other => panic!("unexpected word {other}"),
        }
    }
    assert_eq!(objects.len(), building.elements.len());
    let mut faces = 0;
    for ((name, rings), element) in objects.iter().zip(&building.elements) {
        assert_eq!(*name, format!("{}#{}", element.tagged_name(), element.global_id));
        assert_is_element(element, rings);
        faces += rings.len();
    }
    assert!(quads * 4 > faces * 3, "{quads} of {faces} polygons have four corners");
}

#[test]
fn the_seed_changes_identities_and_the_options_are_kept() {
    let one = house(&HouseOptions::default());
    assert_eq!(one, house(&HouseOptions::default()));
    let mut options = HouseOptions::default();
    options.seed = 1;
    let other = house(&options);
    assert_eq!(one.elements.len(), other.elements.len());
    assert!(one.elements.iter().zip(&other.elements).all(|(a, b)| a.global_id != b.global_id));
    let ids = |b: &Building| b.elements.iter().map(|e| e.global_id.clone()).collect::<Vec<_>>();
    options.furniture = false;
    let bare = house(&options);
    assert!(bare.elements.iter().filter(|e| e.kind != Kind::Detail).count() < bare.elements.len());
    assert!(ids(&bare).iter().all(|id| ids(&other).contains(id)), "what stays keeps its identity");
}

/// Everything in `fixtures/`: name and bytes.
fn all_fixtures() -> Vec<(String, Vec<u8>)> {
    let house = house(&HouseOptions::default());
    let (obj, mtl) = house.to_obj("house.mtl");
    let mut all = vec![
        ("house.glb".to_owned(), house.to_glb()),
        ("house.obj".to_owned(), obj.into_bytes()),
        ("house.mtl".to_owned(), mtl.into_bytes()),
        ("house.truth.json".to_owned(), house.truth().to_json().into_bytes()),
    ];
    for specimen in specimens() {
        let glb = specimen.building.export(&specimen.style).to_glb();
        all.push((format!("{}.glb", specimen.name), glb));
        // Those in a style are all one building.
        if specimen.style == Style::exact() {
            let truth = specimen.building.truth().to_json();
            all.push((format!("{}.truth.json", specimen.name), truth.into_bytes()));
        }
    }
    all
}

#[test]
fn fixtures_are_what_the_generator_makes() {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures");
    let bless = std::env::var_os("ENFILADE_BLESS").is_some_and(|value| value == "1");
    let all = all_fixtures();
    let whole: usize = all.iter().map(|(_, bytes)| bytes.len()).sum();
    assert!(whole < 4_000_000, "{whole} bytes in all");
    for (name, bytes) in &all {
        if bless {
            std::fs::write(fixtures.join(name), bytes).unwrap();
        }
        assert!(bytes.len() < 300_000, "{name} has {} bytes", bytes.len());
        let fixture = std::fs::read(fixtures.join(name)).unwrap();
        let same = fixture.iter().zip(bytes).take_while(|(a, b)| a == b).count();
        assert!(
            fixture == *bytes,
            "fixtures/{name} ({} bytes) and what the generator makes ({} bytes) part at byte {same}; if that is \
             meant, run this test with ENFILADE_BLESS=1",
            fixture.len(),
            bytes.len()
        );
    }
    let mut there: Vec<String> = std::fs::read_dir(&fixtures)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    there.sort();
    let mut made: Vec<&String> = all.iter().map(|(name, _)| name).collect();
    made.sort();
    assert!(there.iter().eq(made), "nothing else lies there: {there:?}");
}

/// What the model says of each element, a file of it says too, by its classes, types and names. Only what fills an
/// opening, and which type a covering is of, cannot be said in OBJ; nor the former by identities that two elements have.
#[test]
fn files_and_models_have_the_same_tags() {
    let office = |seed, furniture| {
        let mut options = OfficeOptions::default();
        (options.seed, options.furniture) = (seed, furniture);
        options
    };
    let mut two_storeys = TowerOptions::default();
    two_storeys.storeys = 2;
    let mut buildings = vec![
        house(&HouseOptions::default()),
        build1(&office(1, true)),
        build2(&office(1, false)),
        build3(&office(1, false)),
        tower(&two_storeys),
    ];
    buildings.extend((0..4).map(|seed| random(&office(seed, true))));
    let both = &["a.glb", "a.obj"][..];
    let mut all: Vec<_> = buildings.into_iter().map(|b| (b, Style::exact(), both)).collect();
    all.extend(specimens().into_iter().map(|specimen| (specimen.building, specimen.style, &["a.glb"][..])));
    let folder = tempfile::tempdir().unwrap();
    for (building, style, files) in &all {
        let export = building.export(style);
        let made = export.to_model().unwrap();
        for &file in *files {
            let path = folder.path().join(file);
            export.write(&path).unwrap();
            let read = import(&path, &ImportOptions::default()).unwrap();
            let tags = |model: &Model| {
                // In OBJ, the identity is part of the name.
                let name = |e: &enfilade::importers::Element| match e.source_name.split_once('#') {
                    Some((name, _)) => name.to_owned(),
                    None => e.source_name.clone(),
                };
                let semantic = |e: &enfilade::importers::Element| match e.class.as_deref() {
                    Some("IfcOpeningElement" | "IfcCovering") if file == "a.obj" => None,
                    Some("IfcOpeningElement") if style.doubled_ids > 0.0 => None,
                    _ => Some(e.semantic),
                };
                let mut all: Vec<(String, Option<Semantic>)> =
                    model.elements.iter().map(|e| (name(e), semantic(e))).collect();
                all.sort();
                all
            };
            for (a, b) in tags(&made).iter().zip(&tags(&read)) {
                assert_eq!(a, b, "{}: {file}", building.name);
            }
            assert_eq!(read.elements.len(), made.elements.len(), "{}: {file}", building.name);
        }
    }
}
