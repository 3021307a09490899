//! The binary as its users and scripts see it: every command, its data, its exit codes.
//!
//! Exit codes are a contract: 0 fine, 1 findings, 2 wrong usage, 3 bad input, 4 output failed. Data goes to stdout,
//! everything else to stderr. `trace` has tests of its own in `cli_trace.rs`.
#![cfg(feature = "cli")]

use crate::common;

use std::process::Stdio;

use common::{Folder, Ran, fixture_arg};
use enfilade::generate::{HouseOptions, house};
use serde_json::Value;

const COMMANDS: [&str; 10] = [
    "inspect",
    "compile",
    "validate",
    "trace",
    "render",
    "verify",
    "bench",
    "generate",
    "rules",
    "completions",
];

fn list<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value[key].as_array().unwrap_or_else(|| panic!("no list {key} in {value}"))
}

fn sum(rows: &[Value], key: &str) -> u64 {
    rows.iter().map(|row| row[key].as_u64().unwrap()).sum()
}

#[test]
fn inspect_counts_what_was_generated() {
    let folder = Folder::new();
    let building = house(&HouseOptions::default());
    let mut reports = Vec::new();
    for file in ["house.glb", "house.obj"] {
        let report = folder.run(&["inspect", &fixture_arg(file), "--json"]).expect(0).json();
        let elements = list(&report, "elements");
        assert_eq!(report["source"], file);
        assert_eq!((report["unit"].as_f64(), report["up"].as_str()), (Some(1.0), Some("Y")));
        assert_eq!(elements.len(), building.elements.len());
        let triangles = report["triangles"].as_u64().unwrap();
        assert_eq!(sum(elements, "triangles"), triangles);
        assert_eq!(sum(list(&report, "groups"), "triangles"), triangles);
        assert_eq!(sum(list(&report, "groups"), "elements"), elements.len() as u64);
        assert_eq!(report["triangles_read"].as_u64(), Some(triangles), "nothing is left out");
        for (found, made) in elements.iter().zip(&building.elements) {
            assert_eq!(found["id"], made.global_id);
            assert_eq!(found["class"], *made.class);
            assert_eq!(found["closed_components"], found["components"]);
        }
        let text = folder.run(&["inspect", &fixture_arg(file)]).expect(0);
        assert!(
            text.text().starts_with(&format!("{file}: {} elements, {triangles} triangles\n", elements.len()))
        );
        let all = folder.run(&["inspect", &fixture_arg(file), "--elements"]).expect(0);
        assert_eq!(all.text().lines().count(), text.text().lines().count() + 1 + elements.len());
        reports.push(report);
    }
    // The same building, whichever file it comes from; what fills an opening stands in glTF's extras only.
    let mesh = |report: &Value| -> Vec<Value> {
        list(report, "elements").iter().map(|e| e["triangles"].clone()).collect()
    };
    assert_eq!(mesh(&reports[0]), mesh(&reports[1]));
    assert_eq!(reports[0]["extent"], reports[1]["extent"]);
}

#[test]
fn compile_accounts_for_every_triangle() {
    let folder = Folder::new();
    for file in ["house.glb", "house.obj"] {
        let path = fixture_arg(file);
        let report = folder.run(&["compile", &path, "-o", "a.enf", "-j", "1", "--json"]).expect(0).json();
        assert_eq!(report["triangles_in"].as_u64(), Some(sum(list(&report, "triangles_out"), "count")));
        assert_eq!(report["bytes"].as_u64(), Some(folder.read("a.enf").len() as u64));
        let stages = list(&report, "stages");
        assert!(!stages.is_empty() && stages.iter().all(|s| s["seconds"].as_f64().unwrap() >= 0.0));
        assert!(report["import_seconds"].as_f64().unwrap() > 0.0);

        let text = folder.run(&["compile", &path, "-o", "b.enf", "-j", "2"]).expect(0);
        assert!(text.text().starts_with("b.enf: "), "{}", text.text());
        assert!(folder.read("a.enf") == folder.read("b.enf"), "bytes depend on the number of threads");
    }
    assert_eq!(folder.names(), ["a.enf", "b.enf"], "temporary files stayed");
}

#[test]
fn scenes_do_not_tell_where_they_were_made() {
    let folders = [Folder::new(), Folder::new()];
    let scenes = folders.each_ref().map(|folder| {
        folder.write("house.obj", std::fs::read(fixture_arg("house.obj")).unwrap());
        folder.write("house.mtl", std::fs::read(fixture_arg("house.mtl")).unwrap());
        let absolute = folder.path("house.obj");
        folder.run(&["compile", absolute.to_str().unwrap(), "-o", "house.enf"]).expect(0);
        folder.read("house.enf")
    });
    assert!(scenes[0] == scenes[1]);
}

#[test]
fn generate_makes_the_fixtures() {
    let folder = Folder::new();
    for output in ["house.glb", "house.obj"] {
        let ran = folder.run(&["generate", "house", "-o", output]).expect(0);
        assert!(ran.out.is_empty());
    }
    assert_eq!(folder.names(), ["house.glb", "house.mtl", "house.obj", "house.truth.json"]);
    for name in folder.names() {
        assert!(folder.read(&name) == std::fs::read(fixture_arg(&name)).unwrap(), "{name} differs");
    }
    folder.run(&["generate", "house", "--no-furniture", "--no-site", "-o", "bare.glb"]).expect(0);
    folder.run(&["generate", "house", "--seed", "7", "-o", "other.glb"]).expect(0);
    let elements =
        |file: &str| list(&folder.run(&["inspect", file, "--json"]).expect(0).json(), "elements").to_vec();
    let (whole, bare, other) = (elements("house.glb"), elements("bare.glb"), elements("other.glb"));
    let of_class = |elements: &[Value], class: &str| elements.iter().filter(|e| e["class"] == class).count();
    for class in ["IfcFurnishingElement", "IfcSite"] {
        assert!(of_class(&whole, class) > 0 && of_class(&bare, class) == 0, "{class}");
    }
    assert_eq!(of_class(&whole, "IfcSpace"), of_class(&bare, "IfcSpace"));
    assert_eq!(whole.len(), other.len());
    assert!(whole.iter().zip(&other).all(|(a, b)| a["id"] != b["id"]), "identities follow from the seed");
}

#[test]
fn render_writes_pictures() {
    let folder = Folder::new();
    folder.compile_house();
    let size = ["--size", "48x32"];
    let shot = |arguments: &[&str]| folder.run(&[&["render", "house.enf"], arguments, &size].concat());

    shot(&["-o", "a.png"]).expect(0);
    let png = folder.read("a.png");
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
    assert_eq!((&png[16..20], &png[20..24]), (&[0, 0, 0, 48][..], &[0, 0, 0, 32][..]));
    shot(&["-o", "a.exr"]).expect(0);
    assert_eq!(folder.read("a.exr")[..4], [0x76, 0x2F, 0x31, 0x01]);

    // One view, told in many ways.
    let house = fixture_arg("house.glb");
    folder.run(&["render", &house, "-o", "model.png", "--size", "48x32"]).expect(0);
    assert!(folder.read("model.png") == png, "a model is its compiled scene");
    shot(&["-o", "comma.png", "--eye", "2,1.6,-3", "--target", "5,1.2,-4"]).expect(0);
    shot(&["-o", "blank.png", "--eye", "2", "1.6", "-3", "--target", "5", "1.2", "-4"]).expect(0);
    let inside = ["--frame", "internal", "--eye", "2,3,1.6", "--target", "5,4,1.2"];
    shot(&[&["-o", "internal.png"][..], &inside].concat()).expect(0);
    folder.write("views.txt", "# one\n2 1.6 -3 5 1.2 -4 60\n");
    shot(&["-o", "file.png", "--cams", "views.txt"]).expect(0);
    for same in ["blank.png", "internal.png", "file.png"] {
        assert!(folder.read(same) == folder.read("comma.png"), "{same}");
    }
    assert!(folder.read("comma.png") != png);

    // Cameras of the model.
    shot(&["-o", "garden.png", "--camera", "Garden"]).expect(0);
    shot(&["-o", "one.png", "--camera", "1"]).expect(0);
    shot(&["-o", "living.png", "--camera", "Living room"]).expect(0);
    assert!(folder.read("garden.png") == folder.read("one.png"));
    assert!(folder.read("garden.png") != folder.read("living.png"));
    shot(&["-o", "x.png", "--camera", "Attic"]).expect_failure(2, &["Attic", "Garden", "Living room"]);
}

#[test]
fn walks_are_timed_and_written() {
    let folder = Folder::new();
    folder.compile_house();
    folder.write("way.txt", "2 1.6 -3 5 1.6 -3 60\n3 1.6 -3 5 1.6 -3 60\n");
    let walk = |arguments: &[&str]| {
        let common =
            ["walk", "house.enf", "--cams", "way.txt", "--size", "40x24", "--speed", "1", "--rate", "4"];
        folder.run(&[&common[..], arguments].concat())
    };
    let report = walk(&["--json"]).expect(0).json();
    // A metre in quarters, and where it starts.
    assert_eq!(report["frames"], 5);
    assert_eq!(report["width"], 40);
    assert!(report["frames_per_second"].as_f64().unwrap() > 0.0);
    assert!(report["cells"].as_f64().unwrap() >= 1.0);
    assert_eq!(report["left_to_rays"], 0.0);

    walk(&["-o", "frame", "--most", "2"]).expect(2);
    walk(&["-o", "frame.png", "--most", "2"]).expect(0);
    let [first, second] = ["frame.0001.png", "frame.0002.png"].map(|name| folder.read(name));
    assert!(first.starts_with(b"\x89PNG") && first != second);
    assert!(!folder.names().contains(&"frame.0003.png".to_owned()));

    walk(&["--raw", "walk.rgba"]).expect(0);
    let raw = folder.read("walk.rgba");
    assert_eq!(raw.len(), 5 * 40 * 24 * 4);
    assert!(raw.iter().skip(3).step_by(4).all(|&alpha| alpha == 255));
    walk(&["--kernel", "portable", "--raw", "portable.rgba"]).expect(0);
    let near = |(a, b): (&u8, &u8)| a.abs_diff(*b) <= 1;
    assert!(raw.iter().zip(&folder.read("portable.rgba")).all(near), "kernels agree to one step of 255");

    walk(&["--opaque-glass", "--raw", "opaque.rgba"]).expect(0);
    assert_eq!(folder.read("opaque.rgba").len(), raw.len());

    // Without way-points it goes through the rooms.
    let all = folder.run(&["walk", "house.enf", "--size", "16x16", "--json"]).expect(0).json();
    assert!(all["frames"].as_u64().unwrap() > 100);
    folder.run(&["walk", "house.enf", "--speed", "0"]).expect(2);
    walk(&["--kernel", "neon"]).expect(2);
}

#[test]
fn several_views_are_numbered_frames() {
    let folder = Folder::new();
    folder.compile_house();
    folder.write("walk.txt", "2 1.6 -3 5 1.2 -4 60\n\n2.5 1.6 -3 5 1.2 -4 70 # wider\n");
    let walk = ["render", "house.enf", "-o", "walk.png", "--cams", "walk.txt", "--size", "96x96", "--json"];
    let shots = folder.run(&walk).expect(0).json();
    let files: Vec<&str> =
        shots.as_array().unwrap().iter().map(|shot| shot["file"].as_str().unwrap()).collect();
    assert_eq!(files, ["walk.0001.png", "walk.0002.png"]);
    assert_eq!(shots[1]["vfov_degrees"].as_f64(), Some(70.0));
    assert_eq!(shots[1]["eye"], serde_json::json!([2.5, 1.6, -3.0]));
    assert!(folder.read(files[0]) != folder.read(files[1]));

    for shot in shots.as_array().unwrap() {
        let touched = |what: &str| shot["touched"][what].as_u64().unwrap();
        assert!((1..=touched("of_cells")).contains(&touched("cells")), "{shot}");
        assert!(touched("triangles") < touched("of_triangles") && touched("parts") >= 96, "{shot}");
        assert!(touched("to_rays") < 16, "{shot}");
    }
    let cost = [&walk[..], &["--color", "cost"]].concat();
    assert!(folder.run(&cost).expect(0).json()[0]["touched"].is_null());
    let told = folder.run(&["render", "house.enf", "-o", "a.png", "--size", "96x96", "--stats"]).expect(0);
    assert!(told.err.contains("pixels left to rays"), "{}", told.err);
    // Not in every Linux does the kernel tell.
    let tells = std::fs::OpenOptions::new().write(true).open("/proc/self/clear_refs").is_ok()
        && std::fs::read_to_string("/proc/self/smaps").is_ok_and(|maps| maps.contains("Referenced:"));
    assert_eq!(told.err.contains("pages of the file read"), tells, "{}", told.err);
    let stats = [&walk[..], &["--stats"]].concat();
    let touched = &folder.run(&stats).expect(0).json()[0]["touched"];
    if tells {
        let pages = touched["pages"].as_u64().unwrap();
        assert!((1..touched["of_pages"].as_u64().unwrap()).contains(&pages), "{touched}");
    }
    // So few pixels take rays less time.
    let told = folder.run(&["render", "house.enf", "-o", "a.png", "--size", "8x8", "--stats"]).expect(0);
    assert!(told.err.contains("a ray for each pixel"), "{}", told.err);

    let rooms = ["render", "house.enf", "-o", "room.exr", "--view", "rooms", "--size", "8x8", "--json"];
    let shots = folder.run(&rooms).expect(0).json();
    let shots = shots.as_array().unwrap();
    assert!(shots.len() >= 8, "two views of each of eight rooms: {}", shots.len());
    for shot in shots {
        assert!(!folder.read(shot["file"].as_str().unwrap()).is_empty());
    }

    folder.write("bad.txt", "2 1.6 -3 5 1.2 -4 60\n2 1.6 -3 5 1.2\n");
    folder
        .run(&["render", "house.enf", "-o", "x.png", "--cams", "bad.txt"])
        .expect_failure(3, &["bad.txt:2: 5 words"]);
    folder.write("none.txt", "# nothing\n");
    folder
        .run(&["render", "house.enf", "-o", "x.png", "--cams", "none.txt"])
        .expect_failure(3, &["none.txt"]);
}

#[test]
fn every_colour_mode_makes_its_own_picture() {
    let folder = Folder::new();
    folder.compile_house();
    let modes = ["material", "semantic", "element", "room", "depth", "normal", "cost"];
    let pictures = modes.map(|mode| {
        folder.run(&["render", "house.enf", "-o", "a.png", "--color", mode, "--size", "64x64"]).expect(0);
        folder.read("a.png")
    });
    for (i, a) in pictures.iter().enumerate() {
        for (j, b) in pictures.iter().enumerate().skip(i + 1) {
            assert!(a != b, "{} and {}", modes[i], modes[j]);
        }
    }
}

/// The house as OBJ with one wall moved by `metres` along x.
fn house_with_moved_wall(metres: f64) -> String {
    let text = std::fs::read_to_string(fixture_arg("house.obj")).unwrap();
    let mut in_wall = false;
    let mut moved = 0;
    let lines = text.lines().map(|line| {
        if let Some(name) = line.strip_prefix("o ") {
            in_wall = name.contains("Outer wall west");
        }
        match line.strip_prefix("v ").filter(|_| in_wall) {
            Some(numbers) => {
                let (x, rest) = numbers.split_once(' ').unwrap();
                moved += 1;
                format!("v {} {rest}\n", x.parse::<f64>().unwrap() + metres)
            }
            None => format!("{line}\n"),
        }
    });
    let text = lines.collect();
    assert!(moved > 8, "the wall was found");
    text
}

#[test]
fn verify_passes_on_the_house_and_finds_a_wall_that_moved() {
    let folder = Folder::new();
    for file in ["house.glb", "house.obj"] {
        let path = fixture_arg(file);
        folder.run(&["compile", &path, "-o", "house.enf"]).expect(0);
        let verify = ["verify", "house.enf", "--model", &path, "--rays", "8000", "--json"];
        let report = folder.run(&verify).expect(0).json();
        assert_eq!(report["passed"], true);
        assert_eq!(report["total"]["wrong"], 0, "{report}");
        assert!(report["total"]["rays"].as_u64().unwrap() >= 8_000);
        assert_eq!(report["grid"]["different"], 0);
        let again = folder.run(&verify).expect(0).json();
        assert_eq!(report["kinds"], again["kinds"], "the same seed, the same rays");
    }
    let text = folder.run(&["verify", "house.enf", "--model", &fixture_arg("house.obj"), "--rays", "2000"]);
    assert!(text.expect(0).text().ends_with("passed\n"));

    let alone = folder.run(&["verify", &fixture_arg("house.obj"), "--rays", "2000"]);
    assert!(alone.expect(0).text().ends_with("passed\n"), "a model is its own truth");
    folder.run(&["verify", "house.enf"]).expect_failure(2, &["--model"]);

    folder.write("house.mtl", std::fs::read(fixture_arg("house.mtl")).unwrap());
    folder.write("moved.obj", house_with_moved_wall(0.01));
    let moved = ["verify", "house.enf", "--model", "moved.obj", "--rays", "8000"];
    let report = folder.run(&[&moved[..], &["--json"]].concat()).expect(1).json();
    assert_eq!(report["passed"], false);
    assert!(report["total"]["wrong"].as_u64().unwrap() > 10, "{}", report["total"]);
    assert!(!list(&report, "wrong").is_empty(), "wrong rays are shown");
    assert!(folder.run(&moved).expect(1).text().ends_with("FAILED\n"));
    // Within the tolerance of 1 mm nothing has moved.
    folder.write("moved.obj", house_with_moved_wall(0.0002));
    folder.run(&moved).expect(0);

    folder.run(&["generate", "house", "--no-furniture", "-o", "other.glb"]).expect(0);
    folder
        .run(&["verify", "house.enf", "--model", "other.glb"])
        .expect_failure(3, &["house.enf", "other.glb", "elements differ"]);
}

#[test]
fn bench_measures_what_was_asked_for() {
    let folder = Folder::new();
    folder.compile_house();
    folder.write("views.txt", "2 1.6 -3 5 1.2 -4 60\n3 1.6 -3 5 1.2 -4 60\n");
    let small = ["--cams", "views.txt", "--size", "16x8", "--repeat", "1"];
    let speed = [&["bench", "house.enf"][..], &small].concat();
    let report = folder.run(&[&speed[..], &["--json"]].concat()).expect(0).json();
    let rows = list(&report, "rows");
    for row in rows.iter().filter(|row| row["rays"] == "primary") {
        assert_eq!((row["rays_per_frame"].as_u64(), row["frames"].as_u64()), (Some(128), Some(2)));
        assert!(row["ns_per_ray"].as_f64().unwrap() > 0.0);
    }
    let named = |name: &str| rows.iter().filter(|row| row["kernel"] == name).count();
    assert!(named("enfilade-portable") >= 2 && named("obvhs-cwbvh") >= 2, "{report}");
    assert!(folder.run(&speed).expect(0).text().contains("enfilade-portable"));

    let one = folder.run(&[&speed[..], &["--kernels", "enfilade-portable", "--json"]].concat()).expect(0);
    assert!(list(&one.json(), "rows").iter().all(|row| row["kernel"] == "enfilade-portable"));
    folder.run(&[&speed[..], &["--kernels", "warp"]].concat()).expect_failure(2, &["warp"]);
    folder.run(&["bench"]).expect(2);

    let house = fixture_arg("house.glb");
    let error = [&["bench", "error", "house.enf", "--model", &house][..], &small].concat();
    let report = folder.run(&[&error[..], &["--json"]].concat()).expect(0).json();
    assert_eq!(report["pixels"].as_u64(), Some(256));
    for row in list(&report, "rows") {
        assert_eq!(row["wrong"].as_u64(), Some(0), "{row}");
        assert!(row["forward"]["largest"].as_f64().unwrap() < 1e-3);
    }
    assert!(list(&report, "rows").iter().any(|row| row["kernel"] == "enfilade-no-cells"));
    assert!(folder.run(&error).expect(0).text().contains("max fwd m"));
    // What is compiled on the fly is its own truth; drawn, and as Markdown.
    let drawn = ["--figure", "e.svg", "--figure", "e.png", "--markdown", "--kernels", "enfilade-portable"];
    let on_the_fly = [&["bench", "error", &house][..], &small, &drawn].concat();
    assert!(folder.run(&on_the_fly).expect(0).text().contains("| enfilade-portable | "));
    let (svg, png) = (folder.read("e.svg"), folder.read("e.png"));
    assert!(svg.starts_with(b"<svg") && png.starts_with(b"\x89PNG"));
    folder.run(&["bench", "error", "house.enf"]).expect_failure(2, &["--model"]);
    // Of a model with a wall elsewhere it is wrong.
    folder.write("house.mtl", std::fs::read(fixture_arg("house.mtl")).unwrap());
    folder.write("moved.obj", house_with_moved_wall(0.01));
    folder.run(&["compile", &fixture_arg("house.obj"), "-o", "obj.enf"]).expect(0);
    let moved = ["bench", "error", "obj.enf", "--model", "moved.obj", "--size", "16x16", "--repeat", "1"];
    let moved = [&moved[..], &["--kernels", "enfilade-portable"]].concat();
    assert!(folder.run(&moved).expect(1).text().contains("enfilade-portable"));
    assert_eq!(folder.run(&[&moved[..], &["--json"]].concat()).expect(1).json()["frames"], 16);
}

#[test]
fn sources_skips_and_damage_are_measured() {
    let folder = Folder::new();
    let house = fixture_arg("house.glb");
    for what in ["sources", "skip"] {
        let of = |scene: &[&str], how: &[&str]| {
            folder.run(&[&["bench", what, "--rays", "300"][..], scene, how].concat()).expect(0)
        };
        let report = of(&[&house], &["--json"]).json();
        assert!(report["rays"].as_u64() == Some(300) && list(&report, "rows").len() > 7, "{report}");
        assert!(of(&["--frozen", "house"], &["--markdown"]).text().contains("|---|"));
        folder.run(&["bench", what]).expect(2);
        folder.run(&["bench", what, "no.glb"]).expect_failure(3, &["no.glb"]);
    }
    let robust = ["bench", "robust", "--damage", "room-gaps", "--sizes", "1e-3,1e-4", "--repeat", "1"];
    let few = ["--rays", "300", "--verified", "500"];
    let drawn = ["--figure", "r.svg", "--json"];
    let report = folder.run(&[&robust[..], &few, &drawn].concat()).expect(0).json();
    let sizes: Vec<f64> = list(&report, "rows").iter().map(|row| row["size"].as_f64().unwrap()).collect();
    assert!(sizes == [1e-4, 1e-3] && folder.read("r.svg").starts_with(b"<svg"), "{report}");
    for bad in [["--sizes", "0"], ["--sizes", "1e9"], ["--damage", "fire"], ["--frozen", "castle"]] {
        folder.run(&[&["bench", "robust"][..], &bad].concat()).expect(2);
    }
}

#[test]
fn rules_are_printed_and_can_be_read_again() {
    let folder = Folder::new();
    let rules = folder.run(&["rules"]).expect(0);
    folder.write("rules.toml", &rules.out);
    let house = fixture_arg("house.glb");
    let semantics = |extra: &[&str]| -> Vec<Value> {
        let report = folder.run(&[&["inspect", &house, "--json"], extra].concat()).expect(0).json();
        list(&report, "elements").iter().map(|e| e["semantic"].clone()).collect()
    };
    let plain = semantics(&[]);
    assert_eq!(plain, semantics(&["--rules", "rules.toml"]));
    folder.write("mine.toml", "[[rule]]\nname = \"Chimney\"\nsemantic = \"FURNITURE\"\n");
    let mine = semantics(&["--rules", "mine.toml"]);
    assert_eq!(plain.iter().zip(&mine).filter(|(a, b)| a != b).count(), 1);
    folder.write("bad.toml", "[[rule]]\nname = \"(\"\nsemantic = \"WALL\"\n");
    folder.run(&["inspect", &house, "--rules", "bad.toml"]).expect(3).err.contains("bad.toml");
}

#[test]
fn help_versions_and_completions() {
    let folder = Folder::new();
    let help = folder.run(&["--help"]).expect(0);
    for command in COMMANDS {
        assert!(help.text().contains(command), "{command}");
        let own = folder.run(&[command, "--help"]).expect(0);
        assert!(own.text().contains("Usage: enfilade") && own.err.is_empty(), "{command}");
        if command != "rules" {
            assert!(own.text().contains("Example"), "{command}");
        }
    }
    folder.run(&["bench", "error", "--help"]).expect(0);
    folder.run(&["generate", "house", "--help"]).expect(0);
    let version = folder.run(&["--version"]).expect(0);
    assert_eq!(version.text(), concat!("enfilade ", env!("CARGO_PKG_VERSION"), "\n"));
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = folder.run(&["completions", shell]).expect(0);
        assert!(COMMANDS.iter().all(|command| script.text().contains(command)), "{shell}");
    }
}

/// That it ended as usage errors do: exit code 2, nothing on stdout.
#[track_caller]
fn assert_usage(ran: Ran) {
    let ran = ran.expect(2);
    assert!(ran.out.is_empty() && !ran.err.is_empty());
}

#[test]
fn wrong_usage_is_2() {
    let folder = Folder::new();
    folder.compile_house();
    let house = fixture_arg("house.glb");
    assert_usage(folder.run(&[]));
    assert_usage(folder.run(&["fly"]));
    for command in COMMANDS {
        assert_usage(folder.run(&[command, "--no-such-flag"]));
    }
    assert_usage(folder.run(&["compile", &house]));
    assert_usage(folder.run(&["trace", "house.enf"]));
    assert_usage(folder.run(&["trace", "house.enf", "--rays", "-", "--fields", "t,colour"]));
    assert_usage(folder.run(&["inspect", &house, "--max-memory", "lots"]));
    assert_usage(folder.run(&["inspect", &house, "--unit", "0"]));
    assert_usage(folder.run(&["verify", "house.enf"]));
    assert_usage(folder.run(&["completions", "abacus"]));
    let render = |arguments: &[&str]| folder.run(&[&["render", "house.enf"], arguments].concat());
    assert_usage(render(&["-o", "a.jpg"]));
    assert_usage(render(&["-o", "a.png", "--eye", "1,2,3"]));
    assert_usage(render(&["-o", "a.png", "--eye", "1,2,3", "--target", "1,2,3"]));
    assert_usage(render(&["-o", "a.png", "--eye", "1,2", "--target", "1,2,3"]));
    assert_usage(render(&["-o", "a.png", "--size", "0x10"]));
    assert_usage(render(&["-o", "a.png", "--color", "mood"]));
    assert_usage(render(&["-o", "a.png", "--view", "auto", "--camera", "Garden"]));
    assert_eq!(folder.names(), ["house.enf"]);
}

#[test]
fn bad_input_is_3_and_names_the_file() {
    let folder = Folder::new();
    folder.compile_house();
    let house = fixture_arg("house.glb");
    for model in ["no.glb", "no.obj", "no.gltf"] {
        folder.run(&["inspect", model]).expect_failure(3, &[model]);
        folder.run(&["compile", model, "-o", "a.enf"]).expect_failure(3, &[model]);
        folder.run(&["verify", "house.enf", "--model", model]).expect_failure(3, &[model]);
    }
    folder.run(&["trace", "no.enf", "--rays", "-"]).expect_failure(3, &["no.enf"]);
    folder.run(&["trace", "house.enf", "--rays", "no.txt"]).expect_failure(3, &["no.txt"]);
    folder.run(&["render", "no.enf", "-o", "a.png"]).expect_failure(3, &["no.enf"]);
    folder.run(&["render", "house.enf", "-o", "a.png", "--cams", "no.txt"]).expect_failure(3, &["no.txt"]);
    folder.run(&["bench", "no.enf"]).expect_failure(3, &["no.enf"]);
    folder.run(&["inspect", &house, "--rules", "no.toml"]).expect_failure(3, &["no.toml"]);
    folder.run(&["inspect", "house.enf"]).expect_failure(3, &["house.enf"]);
    folder.run(&["inspect", "."]).expect_failure(3, &["."]);
    folder
        .run(&["inspect", &house, "--max-memory", "100K"])
        .expect_failure(3, &["house.glb", "--max-memory"]);
    folder.run(&["inspect", &house, "--max-elements", "10"]).expect_failure(3, &["--max-elements"]);
    folder.run(&["inspect", &house, "--unit", "mm"]).expect_failure(3, &["house.glb"]);
    assert_eq!(folder.names(), ["house.enf"]);
}

#[test]
fn output_that_cannot_be_written_is_4() {
    let folder = Folder::new();
    folder.compile_house();
    std::fs::create_dir(folder.path("taken.enf")).unwrap();
    let house = fixture_arg("house.glb");
    folder.run(&["compile", &house, "-o", "no/a.enf"]).expect_failure(4, &["no/a.enf"]);
    folder.run(&["compile", &house, "-o", "taken.enf"]).expect_failure(4, &["taken.enf"]);
    folder.run(&["generate", "house", "-o", "no/a.glb"]).expect_failure(4, &["no"]);
    folder.run(&["trace", "house.enf", "--rays", "-", "-o", "no/a.txt"]).expect_failure(4, &["no/a.txt"]);
    let table = ["trace", "house.enf", "--rays", "-", "--elements", "no/a.csv"];
    folder.run(&table).expect_failure(4, &["no/a.csv"]);
    for picture in ["no/a.png", "no/a.exr"] {
        let ran = folder.run(&["render", "house.enf", "--size", "4x4", "-o", picture]);
        ran.expect_failure(4, &[picture]);
    }
    assert_eq!(folder.names(), ["house.enf", "taken.enf"], "nothing half-written stayed");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_4() {
    let folder = Folder::new();
    let mut command = folder.command(&["rules"]);
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output = command.stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(4), "{output:?}");
}

#[test]
fn a_reader_that_leaves_is_no_failure() {
    let folder = Folder::new();
    folder.compile_house();
    // The pipe's reader is gone before the first ray arrives.
    let mut child =
        folder.command(&["trace", "house.enf", "--rays", "-"]).stdout(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let mut rays = child.stdin.take().unwrap();
    // The child may end before it has read everything.
    std::io::Write::write_all(&mut rays, "2 1.6 -3 1 0 0\n".repeat(20_000).as_bytes()).ok();
    drop(rays);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
}

#[test]
fn validate_tells_findings_by_code() {
    let folder = Folder::new();
    folder.run(&["generate", "house", "-o", "house.glb", "--no-truth"]).expect(0);
    let ran = folder.run(&["validate", "house.glb"]).expect(0);
    let text = ran.text();
    assert!(text.contains("8 rooms") && text.contains("nothing found"), "{text}");
    let told = folder.run(&["validate", "house.glb", "--json"]).expect(0).json();
    assert_eq!(told["findings"].as_array().map(Vec::len), Some(0));
    assert!(told["darts"].as_u64().is_some_and(|darts| darts > 1000));
    // Without openings in the model their holes are leaks, if nobody looks for them.
    folder.run(&["generate", "house", "-o", "leaks.glb", "--no-truth", "--openings-missing"]).expect(0);
    folder.run(&["validate", "leaks.glb"]).expect(0);
    let bare = ["leaks.glb", "--derive", "nothing"];
    let told = folder.run(&["validate", bare[0], bare[1], bare[2], "--json"]).expect(1).json();
    let findings = told["findings"].as_array().unwrap();
    let leaks: Vec<_> = findings.iter().filter(|finding| finding["code"] == "S02").collect();
    assert!(!leaks.is_empty());
    for leak in leaks {
        let chain = leak["chain"].as_array().unwrap();
        assert!(
            chain.len() >= 2 && leak["id"].is_string() && leak["size"].as_f64().unwrap() > 1e-4,
            "{leak}"
        );
    }
    folder.run(&["validate", bare[0], bare[1], bare[2], "--ignore", "s02"]).expect(0);
    folder.run(&["validate", "leaks.glb", "--ignore", "S99"]).expect(2);
}
