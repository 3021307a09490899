//! Real buildings, from the reader's own folder of models: `ENFILADE_BUILDINGS`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock};

use enfilade::closing::{ClosingError, Stand};
use enfilade::components::components;
use enfilade::graph::{Graph, OpeningNode, Place, Side};
use enfilade::importers::tagging::Rules;
use enfilade::importers::{ElementId, Frame, ImportOptions, Model, Role, Semantic, Untagged, import};
use enfilade::oracle::{Truth, TruthOptions};
use enfilade::partition::cells::{Label, Partition};
use enfilade::partition::{PartitionOptions, partition};
use enfilade::roles::roles;
use enfilade::verify::{MOST_EXCUSED, standing, tell_sheets};
use enfilade::{CompileOptions, Hit, Place as Lies, Ray, Scene, Start, VerifyOptions, Want, compile, verify};

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

/// What is compiled of each model, by two threads, once for all tests.
fn compiled(path: &Path) -> &'static [u8] {
    type Files = BTreeMap<PathBuf, &'static OnceLock<Vec<u8>>>;
    static FILES: Mutex<Files> = Mutex::new(BTreeMap::new());
    let file = *FILES.lock().unwrap().entry(path.to_owned()).or_insert_with(|| Box::leak(Box::default()));
    file.get_or_init(|| compiled_by(2, path))
}

fn compiled_by(threads: usize, path: &Path) -> Vec<u8> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        let compiled = compile(&load(path), &CompileOptions::default()).unwrap();
        let report = &compiled.report;
        let out: u64 = report.triangles_out.iter().map(|row| row.count).sum();
        assert_eq!(report.triangles_in, out, "{}", path.display());
        compiled.bytes
    })
}

/// The scene of a model.
fn open(path: &Path) -> Scene {
    Scene::from_bytes(compiled(path)).unwrap()
}

#[test]
fn every_answer_is_right() {
    for path in models().unwrap_or_default() {
        let (model, scene) = (load(&path), open(&path));
        let roles = roles(&model, Untagged::default());
        let options = VerifyOptions::default().with_rays(50_000).with_grid_rays(1000);
        let report = verify(&model, |e| roles[e.0 as usize], &scene, &options).unwrap();
        println!("{}: {:?}", path.display(), report.total);
        assert_eq!(report.total.wrong, 0, "{}: {:?}", path.display(), report.wrong);
        assert!(report.excused <= MOST_EXCUSED, "{}: {}", path.display(), report.excused);
        assert_eq!(report.grid.different, 0, "{}", path.display());
        let sight = &report.sight;
        assert!(sight.different == 0 && sight.occluded > 10_000, "{}: {sight:?}", path.display());
    }
}

#[test]
fn counts_add_up_and_bytes_do_not_depend_on_threads() {
    for path in models().unwrap_or_default() {
        assert!(compiled_by(1, &path) == compiled(&path), "{}", path.display());
    }
}

#[test]
fn far_and_turned_models_answer_alike() {
    for far_path in models().unwrap_or_default() {
        let name = far_path.to_string_lossy().into_owned();
        let Some(plain_name) = name.strip_suffix(".geo.glb") else { continue };
        let root = root_transform(&far_path);
        let (plain_scene, far_scene) = (open(Path::new(&format!("{plain_name}.glb"))), open(&far_path));
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
        if !matches!(plain.locate(point), Lies::Air { room: Some(_), .. }) {
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

/// Points of a room that are looked up.
const POINTS: usize = 1000;

/// What fills a point is what the meshes say: matter where a solid is, else the smallest room, or an opening that wins over
/// it. Thin air between rooms and matter may be either.
#[test]
fn cells_hold_what_the_meshes_say() {
    for path in models().unwrap_or_default() {
        let model = load(&path);
        let (partition, report) = partition(&model, &PartitionOptions::default()).unwrap();
        let roles = roles(&model, Untagged::default());
        let with = |role: &dyn Fn(ElementId) -> bool| {
            let of = |e: ElementId| if role(e) { Role::Solid } else { Role::Ignore };
            Truth::new(&model, of, &TruthOptions::default())
        };
        let solids = with(&|e| roles[e.0 as usize] == Role::Solid);
        let rooms = with(&|e| model.elements[e.0 as usize].semantic == Semantic::Room);
        let openings = with(&|e| {
            roles[e.0 as usize] == Role::Air && model.elements[e.0 as usize].semantic != Semantic::Room
        });
        // Of these, cells may say more or less than the meshes: what is open was mended, or is detail.
        let not_carved: BTreeSet<&str> =
            report.not_carved_elements.iter().map(|(path, _)| path.as_str()).collect();
        let is_doubtful = |e: ElementId| {
            let element = &model.elements[e.0 as usize];
            not_carved.contains(element.path.as_str())
                || components(&element.mesh).iter().any(|component| !component.closed)
        };
        let volume = |e: ElementId| {
            let parts = components(&model.elements[e.0 as usize].mesh);
            parts.iter().map(|component| component.signed_volume).sum::<f64>().abs()
        };
        let finder = Finder::new(&partition);
        let mut random = enfilade_testing::Random::new(1);
        let (mut tried, mut wrong) = (0, 0);
        for (index, element) in model.elements.iter().enumerate() {
            let room = ElementId(index as u32);
            let (size, doubtful) = (volume(room), is_doubtful(room));
            if element.semantic != Semantic::Room || doubtful || size < 1e-3 {
                continue;
            }
            assert!(
                partition.cells.iter().any(|cell| cell.label == Label::Air(room)),
                "{}: no cell of {}",
                path.display(),
                element.path
            );
            let [lo, hi] = bounds(&element.mesh.positions);
            let mut off = Vec::new();
            for _ in 0..POINTS {
                let point = [0, 1, 2].map(|i| lo[i] + (hi[i] - lo[i]) * random.unit());
                // A room's box may reach out of the hull, which is turned with the building.
                let Some(label) = finder.label(point) else { continue };
                let matter = solids.solids_at(point);
                let (sure, doubts): (Vec<_>, Vec<_>) = matter.into_iter().partition(|e| !is_doubtful(*e));
                let smallest =
                    rooms.solids_at(point).into_iter().min_by(|a, b| volume(*a).total_cmp(&volume(*b)));
                let is_right = match label {
                    Label::Solid(e) => !sure.is_empty() || !doubts.is_empty() || is_doubtful(e),
                    _ if !sure.is_empty() => false,
                    Label::Air(e) if model.elements[e.0 as usize].semantic != Semantic::Room => {
                        is_doubtful(e) || openings.solids_at(point).contains(&e)
                    }
                    Label::Air(e) => smallest.is_none_or(|room| room == e),
                    _ => smallest.is_none(),
                };
                if !is_right {
                    off.push((point, label));
                }
            }
            // Points within a step of the lattice of a surface.
            assert!(off.len() <= 2, "{}: {} of {}: {off:?}", path.display(), off.len(), element.path);
            (tried, wrong) = (tried + POINTS, wrong + off.len());
        }
        println!("{}: {tried} points, {wrong} otherwise", path.display());
        assert!(wrong * 10_000 <= tried, "{}: {wrong} of {tried}", path.display());
    }
}

fn bounds(points: &[[f64; 3]]) -> [[f64; 3]; 2] {
    points.iter().fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[lo, hi], p| {
        [[0, 1, 2].map(|i| lo[i].min(p[i])), [0, 1, 2].map(|i| hi[i].max(p[i]))]
    })
}

/// Looks for cells, one by one, in whole numbers and f64.
struct Finder<'a> {
    partition: &'a Partition,
    /// Of the footprints.
    boxes: Vec<[[f64; 2]; 2]>,
}

impl<'a> Finder<'a> {
    fn new(partition: &'a Partition) -> Finder<'a> {
        let around = |cell| {
            let flat = partition.footprint(cell).map(|p| [f64::from(p.x), f64::from(p.y)]);
            flat.fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[lo, hi], p| {
                [[0, 1].map(|i| lo[i].min(p[i])), [0, 1].map(|i| hi[i].max(p[i]))]
            })
        };
        Finder { partition, boxes: partition.cells.iter().map(around).collect() }
    }

    /// `None` outside of the hull.
    fn label(&self, point: [f64; 3]) -> Option<Label> {
        let [x, y, z] = self.partition.lattice.local(point);
        let [lo, hi] = self.partition.hull.map(|corner| corner.map(f64::from));
        if (0..3).any(|i| [x, y, z][i] < lo[i] || [x, y, z][i] > hi[i]) {
            return None;
        }
        let holds = |index: usize| {
            let cell = &self.partition.cells[index];
            let height = |plane: u32| self.partition.planes[plane as usize].height_f64(x, y);
            let corners: Vec<_> = self.partition.footprint(cell).collect();
            height(cell.floor) <= z
                && z <= height(cell.ceiling)
                && corners.iter().zip(corners.iter().cycle().skip(1)).all(|(a, b)| {
                    let way = [f64::from(b.x) - f64::from(a.x), f64::from(b.y) - f64::from(a.y)];
                    way[0] * (y - f64::from(a.y)) - way[1] * (x - f64::from(a.x)) >= 0.0
                })
        };
        let near = |index: &usize| {
            let [lo, hi] = self.boxes[*index];
            lo[0] <= x && x <= hi[0] && lo[1] <= y && y <= hi[1]
        };
        let found = (0..self.boxes.len()).filter(near).find(|&index| holds(index));
        Some(self.partition.cells[found.expect("cells fill the hull")].label)
    }
}

/// What is written beside a model of what its openings join.
fn adjacency(path: &Path) -> Option<Vec<serde_json::Value>> {
    let text = std::fs::read_to_string(path.with_extension("adjacency.json")).ok()?;
    Some(serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display())))
}

/// The rooms beyond an opening, in order; an empty text where there is none.
fn sides(scene: &Scene, opening: &OpeningNode) -> [String; 2] {
    let mut sides = opening.sides.map(|side| match side {
        Side::Room(room) => scene.room(room).element().id().to_owned(),
        _ => String::new(),
    });
    sides.sort();
    sides
}

fn wanted(entry: &serde_json::Value) -> [String; 2] {
    let mut sides = [0, 1].map(|side| entry["spaces"][side].as_str().unwrap_or("").to_owned());
    sides.sort();
    sides
}

fn without(path: &Path, classes: &str) -> Model {
    let rules = format!("[[rule]]\nclass = '^({classes})$'\nsemantic = \"ANNOTATION\"\n");
    let mut options = ImportOptions::default();
    options.rules = Some(Rules::parse(&rules, "without.toml").unwrap());
    import(path, &options).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn openings_join_the_rooms_beyond_them() {
    let (mut all, mut right) = (0, 0);
    for path in models().unwrap_or_default() {
        let Some(entries) = adjacency(&path) else { continue };
        let scene = open(&path);
        let graph = scene.graph();
        let by_id: BTreeMap<&str, &OpeningNode> =
            graph.openings.iter().map(|opening| (scene.element(opening.element).id(), opening)).collect();
        let count = entries.iter().filter(|entry| {
            let opening = by_id.get(entry["opening"].as_str().unwrap());
            opening.is_some_and(|opening| sides(&scene, opening) == wanted(entry))
        });
        let count = count.count();
        println!("{}: {count} of {}", path.display(), entries.len());
        assert!(count * 10 >= entries.len() * 9, "{}", path.display());
        (all, right) = (all + entries.len(), right + count);
    }
    assert!(right * 100 >= all * 98, "{right} of {all}");
}

#[test]
fn doors_and_windows_join_the_same_rooms_without_tagged_openings() {
    let (mut all, mut right) = (0, 0);
    for path in models().unwrap_or_default() {
        if adjacency(&path).is_none() {
            continue;
        }
        let (tagged, found) = (open(&path), scene(&without(&path, "IfcOpeningElement")));
        let (graph, again) = (tagged.graph(), found.graph());
        let by_filling: BTreeMap<&str, &OpeningNode> = again
            .openings
            .iter()
            .filter_map(|opening| {
                Some((found.element(found.element(opening.element).filling()?).id(), opening))
            })
            .collect();
        let (mut count, mut same) = (0, 0);
        for opening in &graph.openings {
            let Some(filling) = tagged.element(opening.element).filling() else { continue };
            count += 1;
            let other = by_filling.get(tagged.element(filling).id());
            same += usize::from(other.is_some_and(|other| sides(&tagged, opening) == sides(&found, other)));
        }
        println!("{}: {same} of {count}", path.display());
        assert!(same * 100 >= count * 95, "{}: {same} of {count}", path.display());
        (all, right) = (all + count, right + same);
    }
    assert!(right * 100 >= all * 95, "{right} of {all}");
}

/// All rooms; and those that walls enclose, for where rooms meet in the air no wall says where the one ends.
#[test]
fn rooms_are_found_again_without_tags() {
    let (mut all, mut found) = ([0.0; 2], [0.0; 2]);
    for path in models().unwrap_or_default() {
        // Each building once, in whatever forms it is there.
        let is_other_form =
            path.extension().is_some_and(|e| e == "obj") && path.with_extension("glb").exists();
        if adjacency(&path).is_none() || is_other_form {
            continue;
        }
        let (tagged, bare) = (open(&path), scene(&without(&path, "IfcOpeningElement|IfcSpace")));
        let mut open: BTreeMap<Place, f64> = BTreeMap::new();
        for passage in tagged.graph().portals.iter().filter(|passage| passage.opening.is_none()) {
            if let [Place::Room(_), Place::Room(_)] = passage.places {
                passage.places.iter().for_each(|place| *open.entry(*place).or_default() += passage.area);
            }
        }
        let is_enclosed = |room: u32| open.get(&Place::Room(room)).is_none_or(|area| *area < 0.5);
        for (i, is_meant) in [&is_enclosed as &dyn Fn(u32) -> bool, &|_| true].into_iter().enumerate() {
            let [of, again] = rooms_again(&tagged, &bare, is_meant);
            println!("{}: {again:.1} of {of:.1} m2 {}", path.display(), ["enclosed", "in all"][i]);
            all[i] += of;
            found[i] += again;
        }
    }
    assert!(found[0] >= 0.95 * all[0] && found[1] >= 0.9 * all[1], "{found:?} of {all:?}");
}

/// The floor area of some rooms, how much of it a scene has rooms for that share 90 % with them (what both hold by what either does, in the plan
/// at 1.2 m over the floors).
fn rooms_again(tagged: &Scene, bare: &Scene, is_meant: &dyn Fn(u32) -> bool) -> [f64; 2] {
    let room = |scene: &Scene, point| match scene.locate(point) {
        Lies::Air { room, .. } => room,
        _ => None,
    };
    let mut heights: Vec<f64> = tagged.rooms().map(|room| room.bounds()[0][2] + 1.2).collect();
    heights.sort_by(f64::total_cmp);
    heights.dedup_by(|a, b| (*a - *b).abs() < 0.3);
    let [lo, hi] = tagged.hull();
    let (mut both, mut sizes) = (BTreeMap::new(), [BTreeMap::new(), BTreeMap::new()]);
    for (i, z) in (0..400_000).map(|i| (i as f64 + 0.5, heights[i % heights.len()])) {
        let [u, v] = [0.754_877_666_246_693 * i % 1.0, 0.569_840_290_998_053 * i % 1.0];
        let point = [lo[0] + (hi[0] - lo[0]) * u, lo[1] + (hi[1] - lo[1]) * v, z];
        let rooms = [room(tagged, point), room(bare, point)];
        for (size, room) in sizes.iter_mut().zip(rooms) {
            *size.entry(room).or_insert(0) += 1;
        }
        if let [Some(one), Some(other)] = rooms {
            *both.entry((one, other)).or_insert(0) += 1;
        }
    }
    let mut sums = [0.0; 2];
    for (view, number) in tagged.rooms().zip(0..) {
        let area = view.floor_area().unwrap_or(0.0);
        if is_meant(number) {
            sums[0] += area;
            let again = both.iter().any(|(&(one, other), &count)| {
                let either = sizes[0][&Some(number)] + sizes[1][&Some(other)] - count;
                one == number && count * 10 >= either * 9
            });
            sums[1] += if again { area } else { 0.0 };
        }
    }
    sums
}

/// Small numbers in turn, from 0 to 1.
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

#[test]
fn answers_are_those_of_the_model_as_its_openings_stand() {
    for path in models().unwrap_or_default() {
        let (model, mut scene) = (load(&path), open(&path));
        let ways = [Stand::CLOSED, Stand::FREE, Stand::SEALED, Stand::MODELLED];
        for (opening, stand) in scene.graph().openings.iter().zip(ways.iter().cycle()) {
            match scene.set_stands(&[(opening.element, *stand)]) {
                Ok(()) | Err(ClosingError::NoAir(_) | ClosingError::NoMatter(_)) => {}
                Err(error) => panic!("{}: {error}", path.display()),
            }
        }
        let (truth, own) = (standing(model.clone(), &scene), model.elements.len());
        let mut roles = roles(&truth, Untagged::default());
        roles[own..].fill(Role::Detail);
        let trace = |rays: &[Ray], hits: &mut [Hit]| {
            scene.trace_many(rays, hits, Want::LEAST);
            tell_sheets(&scene, own as u32, hits);
        };
        let tracer = (trace, |rays: &[Ray]| enfilade::verify::sees(&scene, rays));
        let options = VerifyOptions::default().with_rays(30_000).with_grid_rays(200).with_seed(3);
        let report = verify(&truth, |e| roles[e.0 as usize], &tracer, &options).unwrap();
        println!("{}: {} closed, {:?}", path.display(), scene.closures().len(), report.total);
        assert_eq!(report.total.wrong, 0, "{}: {:?}", path.display(), report.wrong);
        assert!(
            report.sight.different == 0 && report.sight.rays > 0,
            "{}: {:?}",
            path.display(),
            report.sight
        );
    }
}

/// What a cell is by the graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Is {
    In(Place),
    Opening(u32),
}

/// Each cell of air that the graph tells of.
fn told(scene: &Scene, graph: &Graph) -> BTreeMap<u32, Is> {
    let mut told = BTreeMap::new();
    let mut tell = |cells: &[u32], is: Is| {
        for &cell in cells {
            assert_eq!(told.insert(cell, is), None, "cell {cell} is told of twice");
        }
    };
    for (node, room) in graph.rooms.iter().zip(0..) {
        tell(&node.cells, Is::In(Place::Room(room)));
    }
    for (node, void) in graph.voids.iter().zip(0..) {
        tell(&node.cells, Is::In(Place::Void(void)));
    }
    for node in &graph.openings {
        tell(&node.cells, Is::Opening(node.element));
    }
    for (cell, record) in
        scene.cells().iter().zip(0..).filter(|(cell, _)| cell.semantic == Semantic::Exterior as u16)
    {
        tell(&[record], Is::In(Place::Exterior));
        assert_eq!(cell.room, enfilade::NONE);
    }
    told
}

/// The cells of air between two points, as they are found there, to a hundredth of a millimetre.
fn cells_between(scene: &Scene, from: [f64; 3], to: [f64; 3], cells: &mut Vec<u32>) {
    let at = |point| match scene.locate(point) {
        Lies::Air { cell, .. } => Some(cell),
        _ => None,
    };
    let (one, other) = (at(from), at(to));
    let length = (0..3).map(|i| (to[i] - from[i]).powi(2)).sum::<f64>().sqrt();
    if length < 1e-5 || (one == other && length < 0.05) {
        cells.extend(one.into_iter().chain(other));
        return;
    }
    let middle = [0, 1, 2].map(|i| (from[i] + to[i]) / 2.0);
    cells_between(scene, from, middle, cells);
    cells_between(scene, middle, to, cells);
}

#[test]
fn rays_through_openings_cross_the_cells_and_portals_of_the_graph() {
    for path in models().unwrap_or_default() {
        let mut scene = open(&path);
        let graph = scene.graph();
        let told = told(&scene, &graph);
        let free: Vec<(u32, Stand)> = graph.openings.iter().map(|o| (o.element, Stand::FREE)).collect();
        scene.set_stands(&free).unwrap();
        let mut number = numbers(5);
        let (mut rays, mut crossed, mut unlike) = (0, 0, Vec::new());
        for opening in graph.openings.iter().filter(|opening| !opening.cells.is_empty()) {
            for _ in 0..40 {
                let [from, to] = opening.ends;
                // Somewhere near the middle of the way through, on aslant.
                let point = [0, 1, 2].map(|i| {
                    let along = from[i] + (to[i] - from[i]) * (0.2 + 0.6 * number());
                    along + 0.4 * (number() - 0.5)
                });
                let ahead = [0, 1, 2].map(|i| opening.direction[i] + 1.2 * (number() - 0.5));
                let is_in = |cell| told.get(&cell) == Some(&Is::Opening(opening.element));
                if !matches!(scene.locate(point), Lies::Air { cell, .. } if is_in(cell)) {
                    continue;
                }
                rays += 1;
                let mut cells = Vec::new();
                for back in [true, false] {
                    let direction = if back { ahead.map(|c| -c) } else { ahead };
                    let length = direction.iter().map(|c| c * c).sum::<f64>().sqrt();
                    let hit = scene.trace_from(Start::Anywhere, &Ray::new(point, direction), Want::LEAST);
                    let reach = (hit.t - 1e-3).clamp(0.0, 4.0);
                    let end = [0, 1, 2].map(|i| point[i] + direction[i] / length * reach);
                    cells_between(&scene, point, end, &mut cells);
                    if back {
                        cells.reverse();
                    }
                }
                cells.dedup();
                crossed += cells.len();
                unlike.extend(
                    wrong_step(&graph, &told, &cells).map(|what| (opening.element, point, ahead, what)),
                );
            }
        }
        println!("{}: {rays} rays, {crossed} cells, {} unlike", path.display(), unlike.len());
        for (opening, point, ahead, what) in unlike.iter().take(5) {
            println!("    {}: {point:?} {ahead:?}: {what}", scene.element(*opening).path());
        }
        assert!(unlike.is_empty(), "{}", path.display());
    }
}

/// The first step from place to place along a chain of cells that no portal of the graph stands for.
fn wrong_step(graph: &Graph, told: &BTreeMap<u32, Is>, cells: &[u32]) -> Option<String> {
    let has = |one: Place, other: Place, opening: Option<u32>| {
        let places = if one < other { [one, other] } else { [other, one] };
        graph.portals.iter().any(|portal| portal.places == places && portal.opening == opening)
    };
    let mut steps: Vec<Is> = Vec::new();
    for cell in cells.iter().filter(|cell| **cell != 0) {
        match told.get(cell) {
            Some(is) => steps.push(*is),
            None => return Some(format!("cell {cell} is not told of")),
        }
    }
    steps.dedup();
    let mut before: Option<(usize, Place)> = None;
    for (i, step) in steps.iter().enumerate() {
        let Is::In(place) = *step else { continue };
        if let Some((j, last)) = before {
            match &steps[j + 1..i] {
                [] if !has(last, place, None) => return Some(format!("{last:?} touches {place:?}")),
                [Is::Opening(first), .., Is::Opening(end)] | [Is::Opening(first @ end)]
                    if last != place && !(has(last, place, Some(*first)) && has(last, place, Some(*end))) =>
                {
                    return Some(format!("{last:?} to {place:?} through {first} and {end}"));
                }
                _ => {}
            }
        }
        before = Some((i, place));
    }
    None
}
