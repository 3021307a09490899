//! Hostile files, through the binary: each ends with exit code 3 and a few words that name the file and the place; none
//! with a panic, in long time, or with more memory than a limit of the operating system leaves.
#![cfg(feature = "cli")]

use crate::common;

use std::fs::File;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use common::{Folder, enf};
use enfilade_testing::glb;
use enfilade_testing::wall::{self, bin, json as good};
use serde_json::{Value, json};

/// What the binary is told that it may use.
const MAX_MEMORY: &str = "256M";

/// What the operating system lets it use, KiB of address space: that, the program itself, and its threads' stacks.
const ADDRESS_SPACE: &str = "786432";

/// Each command ends within this.
const LONGEST: Duration = Duration::from_secs(20);

/// Runs the binary within the limits. Returns its exit code and what it wrote to stderr.
fn run(folder: &Folder, arguments: &[&str]) -> (i32, String) {
    let binary = env!("CARGO_BIN_EXE_enfilade");
    let mut command = if cfg!(target_os = "linux") {
        let mut command = Command::new("sh");
        command.args(["-c", "ulimit -v \"$1\" && shift && exec \"$@\"", "sh", ADDRESS_SPACE, binary]);
        command
    } else {
        Command::new(binary)
    };
    command.args(arguments).args(["--max-memory", MAX_MEMORY, "-j", "2"]);
    // To files, so that nothing waits for a full pipe.
    let [out, err] = ["stdout", "stderr"].map(|name| folder.path(name));
    command.stdin(Stdio::null()).stdout(File::create(&out).unwrap()).stderr(File::create(&err).unwrap());
    let start = Instant::now();
    let mut child = command.current_dir(folder.path("")).spawn().unwrap();
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if start.elapsed() > LONGEST {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!("{arguments:?} takes longer than {LONGEST:?}");
        }
        std::thread::sleep(Duration::from_millis(2));
    };
    let stderr = String::from_utf8(std::fs::read(err).unwrap()).unwrap();
    let code = status.code().unwrap_or_else(|| panic!("{arguments:?}: {status}: {stderr}"));
    assert!(!stderr.contains("panicked"), "{arguments:?}: {stderr}");
    (code, stderr)
}

/// That a command fails on its input: by exit code 3, and a few words that hold all `words`.
fn refused(what: &str, folder: &Folder, arguments: &[&str], words: &[&str]) {
    let (code, stderr) = run(folder, &[arguments, &["--quiet"]].concat());
    println!("{what}: {code}: {}", stderr.trim_end());
    assert_eq!(code, 3, "{what}: {arguments:?}: {stderr}");
    assert_eq!(std::fs::read(folder.path("stdout")).unwrap(), b"", "{what}: data beside a failure");
    assert!((1..=5).contains(&stderr.trim_end().lines().count()), "{what}: {stderr}");
    assert!(stderr.starts_with("enfilade: "), "{what}: {stderr}");
    assert!(stderr.len() < 1000, "{what}: {} bytes on stderr", stderr.len());
    for word in words {
        assert!(stderr.contains(word), "{what}: no '{word}' in: {stderr}");
    }
}

/// The good file with another value at a JSON pointer.
fn changed(pointer: &str, value: Value) -> Vec<u8> {
    glb::of_json(&wall::changed(good(), pointer, value), &bin())
}

/// The good file with other bytes in its binary chunk.
fn patched(offset: usize, bytes: &[u8]) -> Vec<u8> {
    glb::of_json(&good(), &wall::patched(offset, bytes))
}

/// `count` nodes of one mesh of 100,000 triangles.
fn instances_by_nodes(count: usize) -> Vec<u8> {
    let indices: Vec<u8> = (0..100_000u32)
        .flat_map(|i| [[0u32, 1, 2], [0, 3, 1], [1, 3, 2], [0, 2, 3]][i as usize % 4])
        .flat_map(u32::to_le_bytes)
        .collect();
    let points: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let mut bin: Vec<u8> = points.iter().flat_map(|c| c.to_le_bytes()).collect();
    bin.extend(&indices);
    let mut json = good();
    let all: Vec<usize> = (0..count).collect();
    json["scenes"][0]["nodes"] = json!(all);
    json["nodes"] = Value::Array(vec![json!({ "mesh": 0 }); count]);
    json["accessors"][0].as_object_mut().unwrap().remove("sparse");
    json["accessors"][1] =
        json!({ "bufferView": 1, "componentType": 5125, "count": 300_000, "type": "SCALAR" });
    json["bufferViews"] = json!([
        { "buffer": 0, "byteLength": 48 },
        { "buffer": 0, "byteOffset": 48, "byteLength": indices.len() }
    ]);
    json["buffers"] = json!([{ "byteLength": bin.len() }]);
    glb::of_json(&json, &bin)
}

/// The good file, with `count` instances of its wall.
fn instanced(count: u64) -> Vec<u8> {
    let mut json = good();
    let extension = json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 2 } } });
    json["nodes"][1]["extensions"] = extension;
    json["accessors"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "componentType": 5126, "type": "VEC3", "count": count }));
    glb::of_json(&json, &bin())
}

/// A chain of nodes each of which has the next one twice: node 20 would stand in 2^20 places.
fn doubled() -> Vec<u8> {
    let mut json = good();
    let mut nodes: Vec<Value> = (0..20).map(|i| json!({ "children": [i + 1, i + 1] })).collect();
    nodes.push(json!({ "name": "IfcWall:W", "mesh": 0 }));
    json["nodes"] = Value::Array(nodes);
    glb::of_json(&json, &bin())
}

/// The same without an equal pair of children: each level has two nodes, with both of the next as children.
fn diamonds() -> Vec<u8> {
    let mut json = good();
    let mut nodes: Vec<Value> =
        (0..40).map(|i| json!({ "children": [i / 2 * 2 + 2, i / 2 * 2 + 3] })).collect();
    nodes.extend([json!({ "mesh": 0 }), json!({ "mesh": 0 })]);
    json["nodes"] = Value::Array(nodes);
    json["scenes"][0]["nodes"] = json!([0, 1]);
    glb::of_json(&json, &bin())
}

type Case = (&'static str, &'static str, Vec<u8>, &'static [&'static str]);

/// What it is, the file's name, its bytes, what the message holds beside the name.
fn gltf_table() -> Vec<Case> {
    let whole = glb::of_json(&good(), &bin());
    let text = good().to_string().into_bytes();
    let zeros =
        |component: u32, kind: &str| json!({ "componentType": component, "type": kind, "count": 1u64 << 31 });
    let nested = |depth: usize| {
        let (open, close) = ("[".repeat(depth), "]".repeat(depth));
        format!(r#"{{"asset":{{"version":"2.0"}},"extras":{open}{close}}}"#).into_bytes()
    };
    let matrix = |n: &str| {
        let text = good().to_string().replace(
            r#""name":"IfcWall:W""#,
            &format!(r#""name":"IfcWall:W","matrix":[{n},0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]"#),
        );
        assert!(text.contains("matrix"));
        glb::of_text(text.as_bytes(), &bin())
    };
    vec![
        ("empty", "a.glb", vec![], &[]),
        ("wrong magic", "a.glb", [b"glTG", &whole[4..]].concat(), &[]),
        ("version 1", "a.glb", [&whole[..4], &[1], &whole[5..]].concat(), &["GLB header"]),
        ("length too long", "a.glb", [&whole[..8], &[0xFF; 4], &whole[12..]].concat(), &["GLB header"]),
        ("chunk too long", "a.glb", [&whole[..12], &[0xFF; 4], &whole[16..]].concat(), &[]),
        ("text", "a.gltf", b"no JSON at all".to_vec(), &["JSON line 1"]),
        ("a picture", "a.gltf", b"\x89PNG\r\n\x1a\n".to_vec(), &["JSON line 1"]),
        ("not UTF-8", "a.gltf", b"{\"asset\":{\"version\":\"\xff\"}}".to_vec(), &["JSON"]),
        ("JSON cut", "a.gltf", text[..text.len() / 2].to_vec(), &["JSON line"]),
        ("deep JSON", "a.gltf", nested(100_000), &[]),
        ("deeper JSON", "a.gltf", nested(20_000_000), &[]),
        ("a list", "a.gltf", b"[]".to_vec(), &["JSON line 1"]),
        ("no asset", "a.gltf", b"{}".to_vec(), &["JSON line 1"]),
        ("nothing in it", "a.gltf", br#"{"asset":{"version":"2.0"}}"#.to_vec(), &["no triangles"]),
        ("glTF 1", "a.glb", changed("/asset/version", json!("1.0")), &["asset.version"]),
        (
            "unknown required extension",
            "a.glb",
            changed("/extensionsRequired", json!(["ACME_walls"])),
            &["ACME_walls"],
        ),
        ("scene out of range", "a.glb", changed("/scene", json!(7)), &["scene"]),
        ("node out of range", "a.glb", changed("/scenes/0/nodes", json!([9])), &["scenes[0].nodes[0]"]),
        ("node its own child", "a.glb", changed("/nodes/1/children", json!([1])), &["nodes[1]"]),
        ("cyclic nodes", "a.glb", changed("/nodes/1/children", json!([0])), &["nodes[0]"]),
        ("a node reached 2^20 times", "a.glb", doubled(), &["nodes[20]"]),
        ("nodes reached by diamonds", "a.glb", diamonds(), &["nodes["]),
        ("mesh out of range", "a.glb", changed("/nodes/1/mesh", json!(3)), &["nodes[1].mesh"]),
        ("NaN in a matrix", "a.glb", matrix("NaN"), &["JSON"]),
        ("infinity in a matrix", "a.glb", matrix("1e999"), &["JSON"]),
        ("scaled to nothing", "a.glb", changed("/nodes/1/scale", json!([0, 0, 0])), &["no triangles"]),
        ("zero rotation", "a.glb", changed("/nodes/1/rotation", json!([0, 0, 0, 0])), &["nodes[1]"]),
        (
            "beyond all measure",
            "a.glb",
            changed("/nodes/1/translation", json!([1e30, 0, 0])),
            &["nodes[1]", "farther"],
        ),
        ("scaled beyond all measure", "a.glb", changed("/nodes/1/scale", json!([1e30, 1, 1])), &["nodes[1]"]),
        ("accessor out of range", "a.glb", changed("/meshes/0/primitives/0/indices", json!(9)), &["indices"]),
        ("unknown mode", "a.glb", changed("/meshes/0/primitives/0/mode", json!(9)), &["mode"]),
        ("index out of range", "a.glb", patched(48, &[4, 0]), &["meshes[0].primitives[0].indices"]),
        ("largest index", "a.glb", patched(48, &[0xFF, 0xFF]), &["meshes[0].primitives[0].indices"]),
        ("NaN position", "a.glb", patched(0, &f32::NAN.to_le_bytes()), &["POSITION", "NaN"]),
        ("infinite position", "a.glb", patched(8, &f32::NEG_INFINITY.to_le_bytes()), &["POSITION", "inf"]),
        ("zero triangles", "a.glb", patched(48, &[0; 24]), &["no triangles"]),
        (
            "2^31 points of a buffer",
            "a.glb",
            changed("/accessors/0/count", json!(1u64 << 31)),
            &["accessors[0]"],
        ),
        ("2^31 points of no buffer", "a.glb", changed("/accessors/0", zeros(5126, "VEC3")), &[]),
        (
            "2^31 indices of a buffer",
            "a.glb",
            changed("/accessors/1/count", json!(1u64 << 31)),
            &["meshes[0].primitives[0].indices"],
        ),
        (
            "2^31 indices of no buffer",
            "a.glb",
            changed("/accessors/1", zeros(5125, "SCALAR")),
            &["IfcWall:W"],
        ),
        ("2^64 points", "a.glb", changed("/accessors/0/count", json!(u64::MAX)), &["accessors[0]"]),
        ("points as matrices", "a.glb", changed("/accessors/0/type", json!("MAT4")), &["POSITION"]),
        ("points of doubles", "a.glb", changed("/accessors/0/componentType", json!(5130)), &["accessors[0]"]),
        ("signed indices", "a.glb", changed("/accessors/1/componentType", json!(5120)), &["indices"]),
        (
            "view beyond its buffer",
            "a.glb",
            changed("/bufferViews/0/byteLength", json!(1000)),
            &["bufferViews[0]"],
        ),
        (
            "view that overflows",
            "a.glb",
            changed("/bufferViews/0/byteOffset", json!(u64::MAX)),
            &["bufferViews[0]"],
        ),
        (
            "stride that overflows",
            "a.glb",
            changed("/bufferViews/0/byteStride", json!(u64::MAX)),
            &["accessors[0]"],
        ),
        (
            "a buffer of 2^40 bytes",
            "a.glb",
            changed("/buffers/0/byteLength", json!(1u64 << 40)),
            &["buffers[0]"],
        ),
        ("sparse beyond its accessor", "a.glb", patched(74, &[4, 0]), &["accessors[0].sparse"]),
        (
            "2^31 sparse points",
            "a.glb",
            changed("/accessors/0/sparse/count", json!(1u64 << 31)),
            &["accessors[0].sparse"],
        ),
        ("buffer above", "a.glb", changed("/buffers/0/uri", json!("../../x")), &["'../../x'", "folder"]),
        ("buffer above, encoded", "a.glb", changed("/buffers/0/uri", json!("%2e%2e/x")), &["folder"]),
        ("buffer elsewhere", "a.glb", changed("/buffers/0/uri", json!("/etc/passwd")), &["/etc/passwd"]),
        (
            "buffer on the net",
            "a.glb",
            changed("/buffers/0/uri", json!("https://a.b/c")),
            &["buffers[0].uri"],
        ),
        (
            "buffer as a file URI",
            "a.glb",
            changed("/buffers/0/uri", json!("file:///etc/passwd")),
            &["buffers[0].uri"],
        ),
        ("buffer missing", "a.glb", changed("/buffers/0/uri", json!("none.bin")), &["none.bin"]),
        (
            "no base64",
            "a.glb",
            changed("/buffers/0/uri", json!("data:application/octet-stream;base64,@@@@")),
            &["buffers[0].uri"],
        ),
        ("image above", "a.glb", changed("/images", json!([{ "uri": "../x.png" }])), &["../x.png"]),
        ("2^31 instances", "a.glb", instanced(1 << 31), &["IfcWall:W", "--max-elements"]),
        ("3 million instances", "a.glb", instanced(3_000_000), &["IfcWall:W", "--max-memory"]),
        ("10^6 nodes of 10^5 triangles", "a.glb", instances_by_nodes(1_000_000), &["--max-memory"]),
        ("10^4 nodes of 10^5 triangles", "a.glb", instances_by_nodes(10_000), &["--max-memory"]),
        ("camera out of range", "a.glb", changed("/nodes/2/camera", json!(1)), &["nodes[2].camera"]),
    ]
}

const SQUARE: &str = "# a square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

/// A square, and then these lines of an element `a`; the first is line 7.
fn obj(lines: &str) -> Vec<u8> {
    format!("{SQUARE}o a\n{lines}\n").into_bytes()
}

fn obj_table() -> Vec<Case> {
    let noise: Vec<u8> = (0..10_000u32).map(|i| (i.wrapping_mul(i) >> 3) as u8).collect();
    vec![
        ("empty", "a.obj", vec![], &["no triangles"]),
        ("garbage", "a.obj", noise, &["line 1"]),
        ("a web page", "a.obj", b"<!DOCTYPE html>\n<p>sign in</p>\n".to_vec(), &["line 1", "no OBJ"]),
        ("a glb", "a.obj", glb::of_json(&good(), &bin())[4..].to_vec(), &["line 1"]),
        ("no faces", "a.obj", SQUARE.into(), &["no triangles"]),
        ("zero area only", "a.obj", obj("f 1 2 2\nf 1 2 1 2"), &["no triangles"]),
        ("index 0", "a.obj", obj("f 0 1 2"), &["line 7", "'a'", "vertex 0"]),
        ("index too large", "a.obj", obj("f 1 2 5"), &["line 7", "'a'", "vertex 5"]),
        ("index too small", "a.obj", obj("f -1 -2 -5"), &["line 7", "'a'", "vertex -5"]),
        ("index beyond 64 bits", "a.obj", obj("f 1 2 99999999999999999999"), &["line 7"]),
        ("NaN", "a.obj", obj("v nan 0 0\nf 1 2 5"), &["line 7", "NaN"]),
        ("infinity", "a.obj", obj("v 0 -inf 0\nf 1 2 5"), &["line 7", "inf"]),
        ("overflow", "a.obj", obj("v 0 0 1e999\nf 1 2 5"), &["line 7", "inf"]),
        ("beyond all measure", "a.obj", obj("v 1e200 0 0\nf 1 2 5"), &["line 8"]),
        ("words", "a.obj", obj("v one two three"), &["line 7", "'a'"]),
        ("cut", "a.obj", obj("f 1 2 3\nv 0.5 1"), &["line 8"]),
        ("zero bytes", "a.obj", obj("f 1 2 3\no b\0c"), &["line 8"]),
        ("library above", "a.obj", obj("f 1 2 3\nmtllib ../x.mtl"), &["line 8", "../x.mtl"]),
        ("library elsewhere", "a.obj", obj("f 1 2 3\nmtllib /etc/passwd"), &["line 8", "/etc/passwd"]),
        ("library of a drive", "a.obj", obj("f 1 2 3\nmtllib C:\\x.mtl"), &["line 8", "C:\\x.mtl"]),
        (
            "a polygon of 20 MB",
            "a.obj",
            obj(&format!("f {}", "1 2 3 ".repeat(20 << 20 >> 2))),
            &["line 7", "--max-memory"],
        ),
        ("a line of continuations", "a.obj", obj(&format!("f 1{}", "\\\n".repeat(10 << 20))), &["line 7"]),
        ("an unknown format", "a.ifc", b"ISO-10303-21;".to_vec(), &[".obj"]),
        ("no ending", "a", SQUARE.into(), &[".obj"]),
    ]
}

#[test]
fn hostile_models_are_refused() {
    let (gltf, obj) = (gltf_table(), obj_table());
    assert!(gltf.len() >= 60 && obj.len() >= 20, "{} and {}", gltf.len(), obj.len());
    let folder = Folder::new();
    for (what, name, bytes, words) in gltf.into_iter().chain(obj) {
        folder.write(name, bytes);
        let words = [&[name], words].concat();
        refused(what, &folder, &["inspect", name], &words);
        refused(what, &folder, &["compile", name, "-o", "a.enf"], &words);
        std::fs::remove_file(folder.path(name)).unwrap();
    }
    assert_eq!(folder.names(), ["stderr", "stdout"], "no scene, not even half of one");
}

#[test]
fn the_good_files_are_good() {
    let folder = Folder::new();
    folder.write("a.glb", glb::of_json(&good(), &bin()));
    folder.write("a.obj", obj("f 1 2 3"));
    for name in ["a.glb", "a.obj"] {
        for arguments in
            [&["inspect", name][..], &["compile", name, "-o", "a.enf"], &["trace", name, "--rays", "-"]]
        {
            // The OBJ has no tag, which gives a warning.
            let (code, stderr) = run(&folder, arguments);
            assert!(code == 0 && stderr.lines().all(|line| line.contains("warning: line 6")), "{stderr}");
        }
    }
}

#[test]
fn models_cut_at_any_length_are_refused() {
    let folder = Folder::new();
    let whole = glb::of_json(&good(), &bin());
    for length in (0..whole.len()).step_by(67).chain([1, 4, 11, 12, 19, 20, whole.len() - 1]) {
        folder.write("cut.glb", &whole[..length]);
        refused(&format!("{length} bytes"), &folder, &["inspect", "cut.glb"], &["cut.glb"]);
    }
    let text = obj("usemtl m\nf 1 2 3\nf 1 3 4");
    let first_face = text.len() - "f 1 2 3\nf 1 3 4\n".len();
    for length in (0..first_face).step_by(9) {
        folder.write("cut.obj", &text[..length]);
        refused(&format!("{length} bytes"), &folder, &["inspect", "cut.obj"], &["cut.obj"]);
    }
}

/// A PNG file's first chunk, that says it is `side` pixels wide and high, and nothing behind it.
fn png_of(side: u32) -> Vec<u8> {
    let mut crc_of = b"IHDR".to_vec();
    crc_of.extend(side.to_be_bytes());
    crc_of.extend(side.to_be_bytes());
    crc_of.extend([8, 6, 0, 0, 0]);
    let mut crc = u32::MAX;
    for &byte in &crc_of {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 };
        }
    }
    [b"\x89PNG\r\n\x1a\n\0\0\0\r", &crc_of[..], &(!crc).to_be_bytes()].concat()
}

/// What only spoils a colour is left out with a warning, and takes no more memory than anything else.
#[test]
fn pictures_that_cannot_be_read_cost_a_colour_only() {
    let folder = Folder::new();
    for (what, picture) in [
        ("65535 pixels square", png_of(65535)),
        ("2^31 pixels square", png_of(i32::MAX as u32)),
        ("16000 pixels square, cut", png_of(16000)),
        ("garbage", b"\x89PNG\r\n\x1a\n and no more".to_vec()),
        ("empty", vec![]),
    ] {
        folder.write("bomb.png", &picture);
        let mut json = good();
        json["materials"] = json!([{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }]);
        json["textures"] = json!([{ "source": 0 }]);
        json["images"] = json!([{ "uri": "bomb.png" }]);
        folder.write("a.glb", glb::of_json(&json, &bin()));
        folder.write("a.mtl", "newmtl m\nmap_Kd bomb.png\n");
        folder.write("a.obj", format!("mtllib a.mtl\n{SQUARE}usemtl m\nf 1 2 3\n"));
        for (name, place) in [("a.glb", "images[0]: "), ("a.obj", "a.mtl: line 1: the texture 'bomb.png'")] {
            let (code, stderr) = run(&folder, &["compile", name, "-o", "a.enf"]);
            println!("{what}: {stderr}");
            assert_eq!(code, 0, "{what}: {name}: {stderr}");
            assert!(stderr.contains(&format!("warning: {place}")), "{what}: {name}: {stderr}");
        }
    }
}

#[test]
fn hostile_libraries_and_rules_are_refused() {
    let folder = Folder::new();
    folder.write("a.obj", format!("mtllib a.mtl\n{SQUARE}usemtl m\nf 1 2 3\n"));
    let libraries: [(&str, &[u8], &[&str]); 5] = [
        ("binary", b"newmtl m\n\0\x01", &["line 2"]),
        ("colour without numbers", b"newmtl m\nKd", &["line 2", "'Kd'"]),
        ("colour of words", b"newmtl m\n\nKd red", &["line 3", "red"]),
        ("opacity of a word", b"newmtl m\nd half", &["line 2"]),
        ("a glb", b"glTF\x02\0\0\0", &["line 1"]),
    ];
    for (what, bytes, words) in libraries {
        folder.write("a.mtl", bytes);
        refused(what, &folder, &["inspect", "a.obj"], &[&["a.mtl"], words].concat());
    }
    folder.write("a.mtl", "newmtl m\n");
    let rules: [(&str, &[u8], &[&str]); 7] = [
        ("no TOML", b"rule: [", &[]),
        ("not UTF-8", b"# \xff\xfe", &[]),
        ("unknown key", b"[[rule]]\nnam = \"a\"\nsemantic = \"WALL\"\n", &["nam"]),
        ("unknown word", b"[[rule]]\nname = \"a\"\nsemantic = \"FLOOR?\"\n", &["FLOOR?"]),
        ("no expression", b"[[rule]]\nname = \"(\"\nsemantic = \"WALL\"\n", &[]),
        (
            "an expression that swells",
            b"[[rule]]\nname = \"((a{1000}){1000}){1000}\"\nsemantic = \"WALL\"\n",
            &[],
        ),
        ("deep lists", &[&b"a = "[..], &[b'['; 200_000]].concat(), &[]),
    ];
    for (what, bytes, words) in rules {
        folder.write("a.toml", bytes);
        refused(what, &folder, &["inspect", "a.obj", "--rules", "a.toml"], &[&["a.toml"], words].concat());
    }
}

/// Files far longer than the memory allowed, most of them holes of zeros.
#[test]
fn huge_files_are_refused_before_they_are_read() {
    let folder = Folder::new();
    folder.write("good.obj", format!("mtllib huge.mtl\n{SQUARE}usemtl m\nf 1 2 3\n"));
    folder.write("empty.obj", format!("{SQUARE}f 1 2 3\n"));
    let mut external = good();
    external["buffers"][0]["uri"] = json!("huge.bin");
    external["buffers"][0]["byteLength"] = json!(1u64 << 31);
    folder.write("external.gltf", external.to_string());
    for (name, start) in [
        ("huge.glb", &b"glTF\x02\0\0\0\0\0\0\x80"[..]),
        ("huge.gltf", b"{"),
        ("huge.obj", b"v 0 0 0\n"),
        ("huge.mtl", b"newmtl m\n"),
        ("huge.toml", b"# rules\n"),
        ("huge.enf", b"\x89ENF\r\n\x1a\n"),
        ("huge.txt", b"# rays or views\n"),
        ("huge.bin", b""),
    ] {
        folder.write(name, start);
        File::options().write(true).open(folder.path(name)).unwrap().set_len(1 << 31).unwrap();
    }
    let cases: [(&[&str], &str); 9] = [
        (&["inspect", "huge.glb"], "huge.glb"),
        (&["inspect", "huge.gltf"], "huge.gltf"),
        (&["inspect", "huge.obj"], "huge.obj"),
        (&["inspect", "good.obj"], "huge.mtl"),
        (&["inspect", "external.gltf"], "external.gltf: buffers[0].uri"),
        (&["inspect", "empty.obj", "--rules", "huge.toml"], "huge.toml"),
        (&["trace", "huge.enf", "--rays", "-"], "huge.enf"),
        (&["trace", "empty.obj", "--rays", "huge.txt", "-o", "hits"], "huge.txt: line 2"),
        (&["render", "empty.obj", "-o", "a.png", "--cams", "huge.txt"], "huge.txt"),
    ];
    for (arguments, name) in cases {
        refused("huge", &folder, arguments, &[name]);
    }
}

/// Files that never end.
#[cfg(unix)]
#[test]
fn endless_files_are_refused() {
    let folder = Folder::new();
    folder.write("good.obj", format!("{SQUARE}f 1 2 3\n"));
    for name in ["zero.glb", "zero.obj", "zero.toml", "zero.txt", "zero.enf"] {
        std::os::unix::fs::symlink("/dev/zero", folder.path(name)).unwrap();
    }
    refused("endless", &folder, &["inspect", "zero.glb"], &["zero.glb"]);
    refused("endless", &folder, &["inspect", "zero.obj"], &["zero.obj"]);
    refused("endless", &folder, &["inspect", "good.obj", "--rules", "zero.toml"], &["zero.toml"]);
    refused("endless", &folder, &["trace", "zero.enf", "--rays", "-"], &["zero.enf"]);
    refused("endless", &folder, &["trace", "good.obj", "--rays", "zero.txt", "-o", "hits"], &["zero.txt"]);
    refused("endless", &folder, &["render", "good.obj", "-o", "a.png", "--cams", "zero.txt"], &["zero.txt"]);
}

/// The wall as a compiled scene.
fn scene(folder: &Folder) -> Vec<u8> {
    folder.write("a.glb", glb::of_json(&good(), &bin()));
    assert_eq!(run(folder, &["compile", "a.glb", "-o", "a.enf"]).0, 0);
    folder.read("a.enf")
}

#[test]
fn hostile_scenes_are_refused() {
    let folder = Folder::new();
    let whole = scene(&folder);
    let check = |what: &str, bytes: &[u8], words: &[&str]| {
        folder.write("bad.enf", bytes);
        let words = [&["bad.enf"], words].concat();
        refused(what, &folder, &["trace", "bad.enf", "--rays", "-"], &words);
    };
    // Each field of the header, with a right checksum.
    let header: [(&str, usize, Vec<u8>, &str); 7] = [
        ("magic", 0, b"\x89ENG".to_vec(), "not an enfilade scene"),
        ("version", 8, vec![9], "version 9"),
        ("byte order", 12, vec![0x0A, 0x0B, 0x0C, 0x0D], "byte order"),
        ("features", 16, vec![0xFF; 8], "features"),
        ("length", 24, u64::MAX.to_le_bytes().to_vec(), "bytes long"),
        ("number of sections", 32, vec![0xFF; 4], "sections"),
        ("one section more", 32, vec![whole[32] + 1], "section"),
    ];
    for (what, at, bytes, word) in header {
        let mut file = whole.clone();
        enf::put(&mut file, at, &bytes);
        enf::seal_header(&mut file);
        check(what, &file, &[word]);
    }
    // And with a wrong one.
    for at in (24..64).step_by(5) {
        let mut file = whole.clone();
        file[at] ^= 0x40;
        check(&format!("byte {at}"), &file, &[]);
    }
    let sections = enf::sections(&whole);
    for (index, section) in sections.iter().enumerate() {
        let name = section.name.as_str();
        if section.length > 0 {
            let mut file = whole.clone();
            file[section.start + section.length / 2] ^= 1;
            check(&format!("damaged {name}"), &file, &["checksum", name]);
        }
        let mut file = whole.clone();
        enf::put(&mut file, enf::row(index), b"?");
        enf::seal_header(&mut file);
        check(&format!("required, unknown, instead of {name}"), &file, &["required"]);
        for (what, at, number) in [
            ("offset", 16, u64::MAX - 63),
            ("crooked offset", 16, section.start as u64 + 1),
            ("offset on the table", 16, 0),
            ("length", 24, u64::MAX),
            ("no item size", 32, 0),
            ("item size", 32, 3 * section.item as u64),
        ] {
            let mut file = whole.clone();
            enf::put(&mut file, enf::row(index) + at, &number.to_le_bytes());
            enf::seal(&mut file);
            if what != "item size" || section.length > 0 {
                check(&format!("{what} of {name}"), &file, &[]);
            }
        }
    }
    for length in (0..whole.len()).step_by(whole.len() / 23) {
        check(&format!("{length} bytes"), &whole[..length], &[]);
    }
    check("one byte more", &[&whole[..], &[0]].concat(), &[]);
}

#[test]
fn scenes_that_refer_to_nothing_are_refused() {
    let folder = Folder::new();
    let whole = scene(&folder);
    let far = u32::MAX - 1;
    // A section, the byte in its first item, by docs/FORMAT.md, and a number that cannot be there.
    let integers = [
        ("scene", 156, 3, "up axis"),
        ("scene", 160, 1 << 30, "traits"),
        ("scene", 164, far, "detail triangles"),
        ("scene", 144, far, "locator dims"),
        ("elements", 0, far, "id"),
        ("elements", 4, far, "length of the id"),
        ("elements", 40, 9, "semantic"),
        ("elements", 44, 9, "role"),
        ("elements", 48, far, "first triangle"),
        ("elements", 52, far, "triangle count"),
        ("elements", 56, far, "host"),
        ("elements", 60, far, "filling"),
        ("elements", 64, far, "opening"),
        ("cells", 48, 9, "kind"),
        ("cells", 60, far, "room"),
        ("cells", 64, far, "root node"),
        ("materials", 0, far, "name"),
        ("cameras", 80, far, "name"),
        ("triangles", 0, far, "vertex"),
        ("runs", 0, 1, "first triangle"),
        ("runs", 4, far, "element"),
        ("runs", 8, far, "material"),
        ("runs", 12, far, "volume"),
        ("nodes", 192, far, "child"),
        ("nodes", 192, 0, "child that is the root"),
        ("nodes", 192, 1 << 31 | 77_000, "leaf"),
        ("nodes", 192, 1 << 31 | 2 << 28 | 6, "leaf in two groups"),
        ("leaves", 0, far, "triangle"),
        ("volumes", 56, far, "first triangle"),
        ("volumes", 64, far, "element"),
        ("volumes", 68, 9, "role"),
        ("volumes", 76, far, "room"),
        ("locator", 0, far, "first item"),
        ("located", 0, far, "volume"),
    ];
    let floats = [
        ("scene", 0, 0.0, "unit 0"),
        ("scene", 0, -1.0, "unit"),
        ("scene", 8, f64::NAN, "offset"),
        ("scene", 32, f64::INFINITY, "hull"),
        ("scene", 104, -1.0, "tolerance"),
        ("scene", 136, 0.0, "locator step"),
        ("cells", 0, 1e300, "bounds"),
        ("cameras", 72, 180.0, "field of view"),
        ("vertices", 0, f64::NAN, "coordinate"),
        ("volumes", 48, f64::NAN, "volume"),
    ];
    let integers =
        integers.map(|(name, at, n, what): (_, _, u32, _)| (name, at, n.to_le_bytes().to_vec(), what));
    let floats = floats.map(|(name, at, n, what): (_, _, f64, _)| (name, at, n.to_le_bytes().to_vec(), what));
    for (name, at, bytes, what) in integers.into_iter().chain(floats) {
        let section = enf::section(&whole, name);
        if name == "nodes" && section.length == 0 {
            // A scene of so few triangles has but one leaf.
            continue;
        }
        assert!(at + bytes.len() <= section.item && section.length > 0, "{name}: {what}");
        let mut file = whole.clone();
        enf::put(&mut file, section.start + at, &bytes);
        enf::seal(&mut file);
        folder.write("bad.enf", &file);
        let what = format!("{what} of {name}");
        refused(&what, &folder, &["trace", "bad.enf", "--rays", "-"], &["bad.enf", "section"]);
        refused(&what, &folder, &["render", "bad.enf", "-o", "a.png"], &["bad.enf"]);
        refused(&what, &folder, &["verify", "bad.enf", "--model", "a.glb"], &["bad.enf"]);
    }
    assert!(!Path::new(&folder.path("a.png")).exists());
}
