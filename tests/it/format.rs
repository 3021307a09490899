//! Scene files: opening is the inverse of writing, and no damage to their bytes does harm.
//!
//! The files are taken apart here by `docs/FORMAT.md` alone.
#![cfg(feature = "compile")]

use crate::common;

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use common::{enf, fixture};
use enfilade::building::Building;
use enfilade::format::FormatError;
use enfilade::importers::{ImportOptions, Model, import};
use enfilade::partition::{PartitionOptions, partition};
use enfilade::validate::{Code, validate};
use enfilade::{Answer, CompileOptions, Hit, Ray, Scene, Want, compile};
use enfilade_testing::Random;

fn house_model() -> Model {
    import(&fixture("house.glb"), &ImportOptions::default()).unwrap()
}

/// The compiled house, with its map.
fn house() -> &'static [u8] {
    static HOUSE: OnceLock<Vec<u8>> = OnceLock::new();
    HOUSE.get_or_init(|| compile(&house_model(), &with_map()).unwrap().bytes)
}

fn with_map() -> CompileOptions {
    let mut options = CompileOptions::default();
    options.topology = true;
    options
}

fn rays(count: usize) -> Vec<Ray> {
    let mut random = Random::new(5);
    let ray = |_| Ray::new(random.point([-7.0, -8.0, -1.0], [19.0, 17.0, 7.0]), random.direction());
    (0..count).map(ray).collect()
}

/// Hits as bytes, so that NaN equals NaN.
fn traced(scene: &Scene, rays: &[Ray]) -> Vec<u8> {
    let mut hits = vec![Hit::ESCAPED; rays.len()];
    scene.trace_many(rays, &mut hits, Want::default());
    bytemuck_bytes(&hits)
}

fn bytemuck_bytes(hits: &[Hit]) -> Vec<u8> {
    let number = |hit: &Hit| {
        let floats = [[hit.t].as_slice(), &hit.point, &hit.normal].concat();
        let indices = [hit.element, hit.semantic, hit.material, hit.cell, hit.room, hit.triangle];
        let floats = floats.into_iter().flat_map(f64::to_le_bytes);
        floats.chain(indices.into_iter().flat_map(u32::to_le_bytes)).collect::<Vec<u8>>()
    };
    hits.iter().flat_map(number).collect()
}

/// All that a scene says of itself, triangle by triangle.
fn told(scene: &Scene) -> String {
    let mut text = format!(
        "{:?} {:?} {:?} {} {:?}\n",
        scene.frame(),
        scene.hull(),
        scene.traits(),
        scene.tolerance(),
        scene.provenance()
    );
    for e in scene.elements() {
        let texts = [e.id(), e.name(), e.path(), e.class(), e.storey()];
        let links = [e.host(), e.filling(), e.opening()];
        text += &format!("{texts:?} {:?} {:?} {} {links:?}\n", e.semantic(), e.role(), e.triangle_count());
    }
    for r in scene.rooms() {
        let closed = r.is_closed();
        text += &format!(
            "{} {:?} {:?} {:?} {closed}\n",
            r.element().index(),
            r.bounds(),
            r.volume(),
            r.floor_area()
        );
    }
    text += &format!("{:?}\n{:?}\n", scene.cells(), scene.materials());
    text += &format!("{:?}\n{:?}\n", scene.lights(), scene.cameras());
    for triangle in 0..scene.detail_triangle_count() {
        text += &format!("{:?}\n", scene.triangle(triangle));
    }
    text
}

#[test]
fn opening_is_the_inverse_of_writing() {
    let model = house_model();
    let compiled = compile(&model, &with_map()).unwrap();
    let bytes = compiled.bytes.clone();
    assert!(bytes == house(), "the same model, the same bytes");
    let kept = compiled.scene();
    let copied = Scene::from_bytes(&bytes).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("house.enf");
    enfilade::format::write_atomically(&path, |file| std::io::Write::write_all(file, &bytes)).unwrap();
    let opened = Scene::open(&path).unwrap();

    let (rays, expected) = (rays(2000), told(&kept));
    let hits = traced(&kept, &rays);
    for scene in [&copied, &opened] {
        assert!(told(scene) == expected);
        assert!(traced(scene, &rays) == hits);
    }
    // A view of bytes that do not lie at a multiple of 64 is the same.
    let mut shifted = vec![0; 3];
    shifted.extend(&bytes);
    assert!(told(&Scene::from_bytes(&shifted[3..]).unwrap()) == expected);

    // And what it tells is what the model said.
    assert_eq!(copied.element_count() as usize, model.elements.len());
    for (e, element) in copied.elements().zip(&model.elements) {
        assert_eq!((e.id(), e.name(), e.path()), (&*element.id, &*element.name, &*element.path));
        assert_eq!(e.class(), element.class.as_deref().unwrap_or(""));
        assert_eq!(e.storey(), element.storey.as_deref().unwrap_or(""));
        assert_eq!(e.semantic(), element.semantic);
        assert_eq!(e.triangle_count() as usize, element.mesh.triangles.len());
        let id = |index: Option<u32>| index.map(|i| copied.element(i).id());
        assert_eq!(id(e.host()), element.host.as_deref());
        assert_eq!(id(e.filling()), element.filling.as_deref());
        assert_eq!(id(e.opening()), element.opening.as_deref());
    }
    assert_eq!(copied.materials().len(), model.materials.len());
    assert_eq!((copied.lights().len(), copied.cameras().len()), (model.lights.len(), model.cameras.len()));
    assert_eq!(copied.frame(), model.frame);
    let (cells, _) = partition(&model, &PartitionOptions::default()).unwrap();
    assert!(copied.building().unwrap() == Some(Building::new(&model, &cells).unwrap()));
    let without = compile(&model, &CompileOptions::default()).unwrap();
    assert!(!without.scene().has_building() && without.scene().building().unwrap().is_none());
    let sections = |file: &[u8]| enf::sections(file).into_iter().map(|s| s.name).collect::<Vec<_>>();
    let all = sections(house());
    assert_eq!(all[..all.len() - 10], sections(&without.bytes));
}

#[test]
fn the_file_is_laid_out_as_documented() {
    let file = house();
    assert_eq!(&file[..8], b"\x89ENF\r\n\x1a\n");
    assert_eq!((enf::u32_at(file, 8), enf::u32_at(file, 12)), (7, 0x0A0B_0C0D));
    assert_eq!((enf::u64_at(file, 16), enf::u64_at(file, 24)), (0, file.len() as u64));
    assert_eq!(file[36..56], [0; 20]);
    let mut sealed = file.to_vec();
    enf::seal(&mut sealed);
    assert!(sealed == file, "the checksums are XXH3-64 of what the page says");
    let (mut end, page) = (enf::row(enf::sections(file).len()), include_str!("../../docs/FORMAT.md"));
    for section in enf::sections(file) {
        assert_eq!(section.start % 64, 0);
        assert!(section.start >= end && section.start - end < 64, "{section:?}");
        assert!(file[end..section.start].iter().all(|&b| b == 0), "gaps are zeros");
        end = section.start + section.length;
        assert_eq!(section.length % section.item, 0);
        let row = page.lines().find(|l| l.starts_with(&format!("| `{}` |", section.name)));
        let size = row.unwrap_or_else(|| panic!("{} is not documented", section.name));
        assert_eq!(size.split('|').nth(3).unwrap().trim(), section.item.to_string(), "{}", section.name);
    }
    assert!(end <= file.len() && file.len() - end < 64);
}

/// The house, its large sections packed however small they are.
fn packed_house() -> Vec<u8> {
    let mut options = with_map();
    options.pack_from = 0;
    compile(&house_model(), &options).unwrap().bytes
}

#[test]
fn packed_sections_hold_the_same() {
    let (plain, packed) = (house(), packed_house());
    assert!(packed.len() < plain.len());
    assert_eq!(enf::u64_at(&packed, 16), 1);
    let mut shorter = Vec::new();
    for (index, (one, other)) in enf::sections(plain).into_iter().zip(enf::sections(&packed)).enumerate() {
        assert_eq!((&one.name, one.item), (&other.name, other.item));
        let items = &plain[one.start..one.start + one.length];
        let stored = &packed[other.start..other.start + other.length];
        let (flags, unpacked) =
            (packed[enf::row(index) + 12], enf::u64_at(&packed, enf::row(index) + 48) as usize);
        if flags & 2 == 0 {
            assert!(stored == items && unpacked == 0, "{}", one.name);
            continue;
        }
        // By docs/FORMAT.md.
        assert_eq!(unpacked, items.len());
        shorter.push(one.name);
        let size = 65_520 / one.item * one.item;
        let mut block = 4 * items.len().div_ceil(size);
        for (number, items) in items.chunks(size).enumerate() {
            let length = enf::u32_at(stored, 4 * number) as usize;
            let bytes = &stored[block..block + length];
            let bytes = match length == items.len() {
                true => bytes.to_vec(),
                false => lz4_flex::block::decompress(bytes, items.len()).unwrap(),
            };
            let count = items.len() / one.item;
            for (i, byte) in items.iter().enumerate() {
                assert_eq!(*byte, bytes[i % one.item * count + i / one.item]);
            }
            block += length;
        }
        assert_eq!(block, stored.len());
    }
    assert_eq!(shorter, ["vertices", "triangles", "leaves"]);
    let [plain, packed] = [plain, &packed[..]].map(|file| Scene::from_bytes(file).unwrap());
    assert!(told(&plain) == told(&packed));
    let rays = rays(2000);
    assert!(traced(&plain, &rays) == traced(&packed, &rays));
    assert!(packed.building().unwrap() == plain.building().unwrap());
}

#[test]
fn damaged_packed_sections_do_no_harm() {
    let whole = packed_house();
    let mut random = Random::new(9);
    let (mut opened, mut refused) = (0, 0);
    for section in enf::sections(&whole) {
        let index = enf::sections(&whole).iter().position(|s| s.name == section.name).unwrap();
        if whole[enf::row(index) + 12] & 2 == 0 {
            // What is no packed section says that it is one.
            let mut file = whole.clone();
            enf::put(&mut file, enf::row(index) + 12, &[3]);
            enf::put(&mut file, enf::row(index) + 48, &(section.length as u64).to_le_bytes());
            enf::seal(&mut file);
            let is_optional = whole[enf::row(index) + 12] == 0;
            assert!(
                Scene::from_bytes(&file).is_err() || is_optional || section.length == 0,
                "{}",
                section.name
            );
            continue;
        }
        for _ in 0..40 {
            let mut file = whole.clone();
            for _ in 0..1 + random.below(3) {
                file[section.start + random.below(section.length)] = random.below(256) as u8;
            }
            assert!(matches!(Scene::from_bytes(&file), Err(FormatError::Checksum(_))) || file == whole);
            enf::seal(&mut file);
            match Scene::from_bytes(&file) {
                Ok(scene) => {
                    traced(&scene, &rays(20));
                    opened += 1;
                }
                Err(error) => {
                    assert!(!error.to_string().is_empty());
                    refused += 1;
                }
            }
        }
        for unpacked in [0, section.item as u64, u64::MAX / 12 * 12, 1 << 40] {
            let mut file = whole.clone();
            enf::put(&mut file, enf::row(index) + 48, &unpacked.to_le_bytes());
            enf::seal(&mut file);
            assert!(Scene::from_bytes(&file).is_err(), "{} of {unpacked} bytes", section.name);
        }
    }
    assert!(opened > 3 && refused > 40, "{opened} {refused}");
}

#[test]
fn unknown_sections_are_skipped_unless_required() {
    let extended = enf::with_section(house(), "acoustics", 0, b"absorption of everything");
    let scene = Scene::from_bytes(&extended).unwrap();
    assert!(told(&scene) == told(&Scene::from_bytes(house()).unwrap()));
    // Not even its checksum matters to who does not know it.
    let mut damaged = extended.clone();
    let section = enf::section(&extended, "acoustics");
    damaged[section.start] ^= 1;
    assert!(Scene::from_bytes(&damaged).is_ok());

    let required = enf::with_section(house(), "acoustics", 1, b"absorption of everything");
    assert_eq!(
        Scene::from_bytes(&required).map(|_| ()).unwrap_err(),
        FormatError::Unknown("acoustics".to_owned())
    );
}

#[test]
fn missing_sections_and_new_versions_are_refused() {
    let count = enf::sections(house()).len();
    for index in 0..count {
        let mut file = house().to_vec();
        // Renamed, and no longer required: a file without that section. Of the map's all are there or none.
        enf::put(&mut file, enf::row(index), b"x");
        enf::put(&mut file, enf::row(index) + 12, &[0]);
        enf::seal(&mut file);
        let error = Scene::from_bytes(&file).map(|_| ()).unwrap_err();
        assert!(matches!(error, FormatError::Missing(_)), "{error}");
    }
    let changed = |at: usize, bytes: &[u8]| {
        let mut file = house().to_vec();
        enf::put(&mut file, at, bytes);
        enf::seal_header(&mut file);
        Scene::from_bytes(&file).map(|_| ()).unwrap_err()
    };
    assert!(matches!(changed(8, &[1]), FormatError::Version { found: 1, known: 7 }));
    assert!(matches!(changed(16, &[4]), FormatError::Features(4)));
    assert!(matches!(changed(12, &[0x0A, 0x0B, 0x0C, 0x0D]), FormatError::Endianness));
    assert!(matches!(changed(0, b"x"), FormatError::Magic));
}

/// A file whose parts lie over each other could make opening it, or each look-up of a point, take time by the square of
/// its size.
#[test]
fn parts_that_lie_over_each_other_are_refused() {
    let changed = |section: &str, item: usize, at: usize, bytes: &[u8]| {
        let mut file = house().to_vec();
        let section = enf::section(&file, section);
        enf::put(&mut file, section.start + item * section.item + at, bytes);
        enf::seal(&mut file);
        Scene::from_bytes(&file).map(|_| ()).unwrap_err().to_string()
    };
    // The second volume gets all triangles from the first one's first on.
    let error = changed("volumes", 1, 56, &[0; 4]);
    assert_eq!(error, "section 'volumes', item 1: it shares triangles with one before");

    // A run of triangles faces somewhere that is not known.
    let error = changed("runs", 0, 16, &[3]);
    assert!(error.starts_with("section 'runs', item 0: ") && error.contains("facing: 3"), "{error}");

    // The first cube with two volumes gets the first of them twice.
    let start =
        |cube: usize| enf::u32_at(house(), enf::section(house(), "locator").start + 4 * cube) as usize;
    let item = start((0..).find(|&cube| start(cube + 1) - start(cube) >= 2).unwrap());
    let first = enf::section(house(), "located").start + 4 * item;
    let error = changed("located", item + 1, 0, &house()[first..first + 4]);
    assert_eq!(error, format!("section 'located', item {item}: the volumes of a cube do not ascend"));

    // Texts may share bytes, but all of the section is text.
    let text = enf::section(house(), "strings");
    assert_eq!(
        changed("strings", text.length - 1, 0, &[0xFF]),
        format!("section 'strings', item {}: no UTF-8", text.length - 1)
    );
}

/// Ways to look for a point that turn it, and ways that see that nothing is turned, must agree.
#[test]
fn lattices_that_are_turned_half_around_are_refused() {
    let at = std::mem::offset_of!(enfilade::format::records::SceneRecord, lattice_turn);
    for (cos, sin, is_fine) in [(1.0, 0.0, true), (-1.0, 0.0, false), (-1.0, -0.0, false), (0.5, 0.5, false)]
    {
        let mut file = house().to_vec();
        let section = enf::section(&file, "scene");
        let turn = [f64::to_le_bytes(cos), f64::to_le_bytes(sin)].concat();
        enf::put(&mut file, section.start + at, &turn);
        enf::seal(&mut file);
        let opened = Scene::from_bytes(&file).map(|_| ()).map_err(|error| error.to_string());
        let said = "section 'scene', item 0: the lattice is turned by no angle".to_owned();
        assert_eq!(opened, if is_fine { Ok(()) } else { Err(said) });
    }
}

/// Damages some bytes in one of many ways.
fn damage(random: &mut Random, bytes: &mut [u8]) {
    let at = random.below(bytes.len());
    let tail = bytes.len() - at;
    match random.below(6) {
        0 => bytes[at] ^= 1 << random.below(8),
        1 => bytes[at] = random.bits() as u8,
        // Numbers that are at the edge of something, where numbers are.
        2 | 3 if bytes.len() >= 4 => {
            let at = at.min(bytes.len() - 4) / 4 * 4;
            let wild =
                [0, 1, u32::MAX, 1 << 31, (1 << 31) - 1, u32::MAX - 1, f32::NAN.to_bits(), 0x7F80_0000];
            let old = enf::u32_at(bytes, at);
            let near = [old.wrapping_add(1), old.wrapping_sub(1), old ^ (1 << 31), old.wrapping_mul(2)];
            let new = if random.below(2) == 0 { wild[random.below(8)] } else { near[random.below(4)] };
            enf::put(bytes, at, &new.to_le_bytes());
        }
        4 if bytes.len() >= 8 => {
            let at = at.min(bytes.len() - 8) / 8 * 8;
            let wild = [f64::NAN, f64::INFINITY, -0.0, 1e308, -1e308, 5e-324, 1e13, -1.0];
            enf::put(bytes, at, &wild[random.below(8)].to_le_bytes());
        }
        _ => {
            // A stretch of noise, or of another stretch.
            let length = tail.min(1 + random.below(64));
            let from = random.below(bytes.len() - length + 1);
            if random.below(2) == 0 {
                bytes.copy_within(from..from + length, at);
            } else {
                bytes[at..at + length].iter_mut().for_each(|b| *b = random.bits() as u8);
            }
        }
    }
}

#[test]
fn damage_without_checksums_is_always_noticed() {
    let mut random = Random::new(1);
    let used: Vec<std::ops::Range<usize>> = std::iter::once(0..enf::row(enf::sections(house()).len()))
        .chain(enf::sections(house()).into_iter().map(|s| s.start..s.start + s.length))
        .filter(|range| !range.is_empty())
        .collect();
    let (mut refused, mut unchanged) = (0, 0);
    for round in 0..3000 {
        let mut file = house().to_vec();
        if round % 3 == 0 {
            file.truncate(random.below(file.len()));
        } else {
            for _ in 0..1 + random.below(3) {
                let range = used[random.below(used.len())].clone();
                damage(&mut random, &mut file[range]);
            }
        }
        if file == house() {
            unchanged += 1;
            continue;
        }
        // Damage to the map is noticed when it is asked for.
        let whole = Scene::from_bytes(&file).and_then(|scene| scene.building());
        assert!(whole.is_err(), "round {round}");
        refused += 1;
    }
    assert!(refused > 2500, "{refused} refused, {unchanged} unchanged");
}

#[test]
fn damage_with_right_checksums_is_refused_or_harmless() {
    let rays = rays(200);
    let sections: Vec<enf::Section> = enf::sections(house()).into_iter().filter(|s| s.length > 0).collect();
    let mut random = Random::new(2);
    let (mut refused, mut opened) = (0, 0);
    let mut slowest = Duration::ZERO;
    for round in 0..700 {
        let mut file = house().to_vec();
        for _ in 0..1 + random.below(3) {
            let section = &sections[random.below(sections.len())];
            // Not only somewhere in long sections: their ends are where counts go wrong.
            let mut range = section.start..section.start + section.length;
            match random.below(4) {
                0 => range.end = range.end.min(range.start + section.item),
                1 => range.start = range.start.max(range.end - section.item),
                _ => {}
            }
            damage(&mut random, &mut file[range]);
        }
        // Sometimes the table tells another length or place.
        if random.below(8) == 0 {
            let row = enf::row(random.below(sections.len()));
            damage(&mut random, &mut file[row + 12..row + 40]);
        }
        enf::seal(&mut file);
        match Scene::from_bytes(&file) {
            Err(error) => {
                assert!(!error.to_string().is_empty());
                refused += 1;
            }
            Ok(scene) => {
                opened += 1;
                let start = Instant::now();
                told(&scene);
                harmless(&scene, &rays);
                let took = start.elapsed();
                slowest = slowest.max(took);
                assert!(took < Duration::from_secs(10), "round {round}: {took:?}");
            }
        }
    }
    println!("{refused} refused, {opened} opened, slowest {slowest:?}");
    assert!(refused > 150 && opened > 150, "{refused} refused, {opened} opened");
}

/// Asks a scene everything that may walk through its tables.
fn harmless(scene: &Scene, rays: &[Ray]) {
    for ray in rays {
        scene.locate(ray.origin);
        scene.occluded(ray);
        if let Answer::Hit(hit) = scene.trace(ray) {
            assert!(hit.element < scene.element_count());
        }
    }
    let mut hits = vec![Hit::ESCAPED; rays.len()];
    scene.trace_many(rays, &mut hits, Want::default());
    if let Ok(Some(building)) = scene.building() {
        validate(building);
    }
}

/// Of the map's own sections, too: whatever it is, it is refused or validated.
#[test]
fn damaged_maps_are_refused_or_validated() {
    let sections: Vec<enf::Section> = enf::sections(house()).into_iter().rev().take(10).collect();
    let mut random = Random::new(3);
    let (mut refused, mut codes) = (0, BTreeSet::new());
    for round in 0..700 {
        let mut file = house().to_vec();
        for _ in 0..1 + random.below(2) {
            let section = &sections[random.below(sections.len())];
            let mut range = section.start..section.start + section.length;
            if random.below(3) == 0 {
                range.end = range.end.min(range.start + section.item);
            }
            if range.is_empty() {
                continue;
            }
            damage(&mut random, &mut file[range]);
        }
        enf::seal(&mut file);
        let start = Instant::now();
        // What rays need of the file is whole.
        let scene = Scene::from_bytes(&file).unwrap();
        assert_eq!(scene.check_map().is_err(), scene.building().is_err());
        match scene.building() {
            Err(_) => refused += 1,
            Ok(building) => {
                let (valid, report) = validate(building.unwrap());
                assert_eq!(valid.is_some(), !report.is_fatal());
                codes.extend(report.findings.iter().map(|finding| finding.code));
            }
        }
        assert!(start.elapsed() < Duration::from_secs(10), "round {round}");
    }
    println!("{refused} refused, {codes:?}");
    assert!(refused > 200, "{refused}");
    for code in [Code::T07, Code::G01, Code::G02, Code::G04] {
        assert!(codes.contains(&code), "{code:?}: {codes:?}");
    }
}

/// Alphas that are no involutions are refused: a walk along them might not end. Other maps that are none are validated.
#[test]
fn maps_that_are_none_are_told() {
    let section = enf::section(house(), "darts");
    let alpha = |file: &[u8], dart: usize, i: usize| {
        enf::u32_at(file, section.start + dart * section.item + 4 * i) as usize
    };
    let link = |file: &mut [u8], i: usize, a: usize, b: usize| {
        for (from, to) in [(a, b), (b, a)] {
            enf::put(file, section.start + from * section.item + 4 * i, &(to as u32).to_le_bytes());
        }
    };
    let findings = |change: &dyn Fn(&mut [u8])| {
        let mut file = house().to_vec();
        change(&mut file);
        enf::seal(&mut file);
        let report = validate(Scene::from_bytes(&file).unwrap().building()?.unwrap()).1;
        Ok::<_, FormatError>(report.findings.iter().map(|finding| finding.code).collect::<BTreeSet<_>>())
    };
    assert_eq!(findings(&|_| ()), Ok(BTreeSet::new()));
    let error = findings(&|file| enf::put(file, section.start, &7u32.to_le_bytes())).unwrap_err();
    assert!(error.to_string().contains("T01"), "{error}");
    // Two edges that change their ends.
    let [a, b] = [0, alpha(house(), 4, 0)];
    let [c, d] = [a, b].map(|dart| alpha(house(), dart, 0));
    let crossed = findings(&|file| {
        link(file, 0, a, b);
        link(file, 0, c, d);
    });
    assert_eq!(crossed, Ok(BTreeSet::from([Code::T02])));
    let open = findings(&|file| {
        link(file, 1, a, a);
        link(file, 1, alpha(house(), a, 1), alpha(house(), a, 1));
    });
    assert_eq!(open, Ok(BTreeSet::from([Code::T02, Code::T03])));
}

#[test]
fn an_open_error_names_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.enf");
    std::fs::write(&path, &house()[..1000]).unwrap();
    for path in [path.as_path(), Path::new("no/such.enf"), folder.path()] {
        let error = Scene::open(path).map(|_| ()).unwrap_err();
        assert!(error.to_string().starts_with(&path.display().to_string()), "{error}");
    }
}
