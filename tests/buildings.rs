//! Real buildings, from the reader's own folder of models: `ENFILADE_BUILDINGS`.

use std::path::{Path, PathBuf};

use enfilade::importers::{Frame, ImportOptions, Model, Untagged, import};
use enfilade::roles::roles;
use enfilade::verify::MOST_EXCUSED;
use enfilade::{CompileOptions, Hit, Place, Ray, Scene, VerifyOptions, Want, compile, verify};

/// The models of the folder; `None`, and a word on it, if there is none.
fn models() -> Option<Vec<PathBuf>> {
    let Some(folder) = std::env::var_os("ENFILADE_BUILDINGS") else {
        assert!(std::env::var_os("CI").is_none(), "ENFILADE_BUILDINGS must be set in CI");
        println!("SKIPPED: ENFILADE_BUILDINGS is not set");
        return None;
    };
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("ENFILADE_BUILDINGS names a folder")
        .map(|entry| entry.expect("a readable folder").path())
        .filter(|path| path.extension().is_some_and(|e| e == "glb" || e == "obj"))
        .collect();
    paths.sort();
    Some(paths)
}

fn load(path: &Path) -> Model {
    import(path, &ImportOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn scene(model: &Model) -> Scene {
    compile(model, &CompileOptions::default()).unwrap().scene()
}

#[test]
fn every_answer_is_right() {
    for path in models().unwrap_or_default() {
        let model = load(&path);
        let scene = scene(&model);
        let roles = roles(&model, Untagged::default());
        let tracer = |rays: &[Ray], hits: &mut [Hit]| scene.trace_many(rays, hits, Want::LEAST);
        let options = VerifyOptions::default().with_rays(100_000).with_grid_rays(1000);
        let report = verify(&model, |e| roles[e.0 as usize], &tracer, &options).unwrap();
        println!("{}: {:?}", path.display(), report.total);
        assert_eq!(report.total.wrong, 0, "{}: {:?}", path.display(), report.wrong);
        assert!(report.excused <= MOST_EXCUSED, "{}: {}", path.display(), report.excused);
        assert_eq!(report.grid.different, 0, "{}", path.display());
    }
}

#[test]
fn counts_add_up_and_bytes_do_not_depend_on_threads() {
    for path in models().unwrap_or_default() {
        let bytes: Vec<Vec<u8>> = [1, 2]
            .iter()
            .map(|&threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| {
                    let model = load(&path);
                    let compiled = compile(&model, &CompileOptions::default()).unwrap();
                    let report = &compiled.report;
                    let out: u64 = report.triangles_out.iter().map(|row| row.count).sum();
                    assert_eq!(report.triangles_in, out, "{}", path.display());
                    compiled.bytes
                })
            })
            .collect();
        assert!(bytes[0] == bytes[1], "{}", path.display());
    }
}

#[test]
fn far_and_turned_models_answer_alike() {
    for far_path in models().unwrap_or_default() {
        let name = far_path.to_string_lossy().into_owned();
        let Some(plain_name) = name.strip_suffix(".geo.glb") else { continue };
        let (plain, far) = (load(Path::new(&format!("{plain_name}.glb"))), load(&far_path));
        let root = root_transform(&far_path);
        let (plain_scene, far_scene) = (scene(&plain), scene(&far));
        let (rays, moved) = rays(&plain_scene, &far_scene, &root);
        let (mut a, mut b) = (vec![Hit::ESCAPED; rays.len()], vec![Hit::ESCAPED; rays.len()]);
        plain_scene.trace_many(&rays, &mut a, Want::LEAST);
        far_scene.trace_many(&moved, &mut b, Want::LEAST);
        for ((a, b), ray) in a.iter().zip(&b).zip(&rays) {
            let near =
                (a.t - b.t).abs() <= 1e-6 * (1.0 + a.t) || a.t == b.t || (a.t.is_nan() && b.t.is_nan());
            assert!(near, "{ray:?}: {a:?} and {b:?}");
            if a.element != b.element {
                // Flush surfaces: either may be named.
                assert!(a.t.is_finite(), "{ray:?}: {a:?} and {b:?}");
            }
        }
    }
}

/// The matrix (column by column) of the root node, or that of its translation and rotation.
fn root_transform(path: &Path) -> [[f64; 4]; 3] {
    let bytes = std::fs::read(path).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let json: serde_json::Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    let root = json["scenes"][0]["nodes"][0].as_u64().unwrap() as usize;
    let node = &json["nodes"][root];
    let numbers = |key: &str| -> Option<Vec<f64>> {
        node[key].as_array().map(|a| a.iter().map(|n| n.as_f64().unwrap()).collect())
    };
    if let Some(m) = numbers("matrix") {
        return [0, 1, 2].map(|row| [m[row], m[4 + row], m[8 + row], m[12 + row]]);
    }
    let t = numbers("translation").unwrap_or(vec![0.0; 3]);
    let q = numbers("rotation").unwrap_or(vec![0.0, 0.0, 0.0, 1.0]);
    let (x, y, z, w) = (q[0], q[1], q[2], q[3]);
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w), t[0]],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w), t[1]],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y), t[2]],
    ]
}

/// Rays from the air of rooms, in the internal frames of both scenes.
fn rays(plain: &Scene, far: &Scene, root: &[[f64; 4]; 3]) -> (Vec<Ray>, Vec<Ray>) {
    let mut state = 0x1234_5678_9ABC_DEF1u64;
    let mut random = move || {
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        (state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1u64 << 53) as f64
    };
    let (frame, far_frame): (Frame, Frame) = (plain.frame(), far.frame());
    let [lo, hi] = plain.hull();
    let (mut rays, mut moved) = (Vec::new(), Vec::new());
    while rays.len() < 20_000 {
        let point = [0, 1, 2].map(|i| lo[i] + (hi[i] - lo[i]) * random());
        let direction = [random() - 0.5, random() - 0.5, random() - 0.5];
        if !matches!(plain.locate(point), Place::Air { room: Some(_), .. }) {
            continue;
        }
        let (p, d) = (frame.point_to_source(point), frame.direction_to_source(direction));
        let turned = |v: [f64; 3], one: f64| {
            [0, 1, 2].map(|i| root[i][0] * v[0] + root[i][1] * v[1] + root[i][2] * v[2] + root[i][3] * one)
        };
        rays.push(Ray::new(point, direction));
        moved.push(Ray::new(
            far_frame.point_to_internal(turned(p, 1.0)),
            far_frame.direction_to_internal(turned(d, 0.0)),
        ));
    }
    (rays, moved)
}
