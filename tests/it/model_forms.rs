//! A model in any axis, unit, matrix, number and indexing form imports to the same `Model`, from glTF and from OBJ.
//!
//! One small building is written by code in forms that proptest draws, imported like any file, and compared with the
//! building and with its other forms: elements, names, classes, tags, storeys, materials; triangles with their
//! orientation; closed bodies; and every coordinate, exactly where the form is exact, else to what its numbers can say.
#![cfg(all(feature = "gltf", feature = "obj", feature = "compile", feature = "render"))]

use crate::common::forms;

use enfilade::importers::{Material, Model, UpAxis, import};
use enfilade_testing::{glb, wall};
use proptest::prelude::*;
use proptest::sample::select;

use forms::building::{Building, PARTS, building};
use forms::compare::{Seen, check_views, see};
use forms::container::Container;
use forms::gltf::{self, ClassIn, GltfForm, PartForm, Placing, Root, Storeys};
use forms::mesh::{Indices, Layout, MeshForm, Mode};
use forms::numbers::Numbers;
use forms::obj::{self, Corners, Digits, Names, ObjForm, Polygons, Text, UseMaterial, Vertices};
use forms::{ROUNDING, Written};

/// Where the building stands, in its own axes, metres.
const NEAR: [f64; 3] = [0.0; 3];
const FAR: [f64; 3] = [458_123.625, -5_427_891.375, 112.5];

/// A file of either format.
#[derive(Clone, Debug)]
enum Form {
    Gltf(GltfForm),
    Obj(ObjForm),
}

impl Form {
    fn write(&self, building: &Building, folder: &std::path::Path) -> Written {
        match self {
            Form::Gltf(form) => gltf::write(building, form, folder),
            Form::Obj(form) => obj::write(building, form, folder),
        }
    }
}

/// Units in metres: three powers of two, millimetres, inches, feet, kilometres. The plainest first.
fn units() -> impl Strategy<Value = f64> {
    select(vec![1.0, 0.25, 16.0, 0.001, 0.0254, 0.3048, 1000.0])
}

fn buildings() -> impl Strategy<Value = Building> {
    let far = select(vec![NEAR, FAR]);
    (prop_oneof![Just(0.0), -180.0..180.0], far).prop_map(|(degrees, far)| building(degrees, far))
}

fn mesh_forms() -> impl Strategy<Value = MeshForm> {
    let numbers = prop_oneof![
        Just(Numbers::Float),
        (any::<bool>(), any::<bool>(), any::<bool>()).prop_map(|(few_bits, is_signed, is_normalized)| {
            Numbers::Integer { few_bits, is_signed, is_normalized }
        }),
    ];
    let layout = prop_oneof![
        Just(Layout::Own),
        Just(Layout::Common),
        (0usize..3, 0usize..4).prop_map(|(before, behind)| Layout::Interleaved { before, behind }),
        any::<bool>().prop_map(|has_base| Layout::Sparse { has_base }),
    ];
    let mode = select(vec![Mode::List, Mode::Strip, Mode::Fan]);
    let indices = select(vec![Indices::U32, Indices::U16, Indices::U8, Indices::None]);
    (numbers, layout, mode, indices, any::<bool>(), 0usize..8).prop_map(
        |(numbers, layout, mode, indices, by_face, rolled)| MeshForm {
            numbers,
            layout,
            mode,
            indices,
            by_face,
            rolled,
        },
    )
}

fn part_forms() -> impl Strategy<Value = PartForm> {
    let nested = (select(vec![1.0, -1.0, 4.0, -0.125, 3.0]), 0..4, any::<[i8; 3]>());
    let placing = prop_oneof![
        Just(Placing::Baked),
        Just(Placing::Parts),
        Just(Placing::Matrix),
        nested.prop_map(|(scale, quarters, at)| Placing::Nested { scale, quarters, at }),
    ];
    let class = select(vec![ClassIn::Extras, ClassIn::NodeName, ClassIn::MeshName]);
    (placing, class, any::<bool>(), mesh_forms()).prop_map(|(placing, class, is_named_in_extras, mesh)| {
        PartForm { placing, class, is_named_in_extras, mesh }
    })
}

fn gltf_forms() -> impl Strategy<Value = GltfForm> {
    let containers = vec![Container::Base64, Container::Glb, Container::External, Container::PercentCoded];
    let storeys = vec![Storeys::Extras, Storeys::NamedNode, Storeys::ClassedNode, Storeys::Inherited];
    let whole =
        (select(containers), units(), any::<bool>(), select(vec![Root::Parts, Root::Matrix, Root::Nested]));
    let flags = any::<[bool; 4]>();
    let parts = prop::collection::vec(part_forms(), PARTS);
    (whole, select(storeys), flags, parts).prop_map(
        |((container, unit, y_up, root), storeys, flags, parts)| {
            let [is_shared, is_reversed, nodes_backwards, has_scenes] = flags;
            GltfForm {
                container,
                unit,
                y_up,
                root,
                storeys,
                is_shared,
                is_reversed,
                nodes_backwards,
                has_scenes,
                parts,
            }
        },
    )
}

fn polygons() -> impl Strategy<Value = Polygons> {
    prop_oneof![Just(Polygons::None), (0u8..8).prop_map(Polygons::All), any::<u64>().prop_map(Polygons::Some)]
}

fn obj_forms() -> impl Strategy<Value = ObjForm> {
    let digits = select(vec![Digits::Shortest, Digits::Exponent, Digits::Six]);
    let names = vec![Names::Objects, Names::ObjectsWithGroups, Names::Groups, Names::GroupsOfOne];
    let vertices = select(vec![Vertices::First, Vertices::ByElement, Vertices::ByFace]);
    let tails = select(vec!["", " 1", " 1.0 0.5 0"]);
    let corners = vec![Corners::V, Corners::Vt, Corners::Vn, Corners::Vtn, Corners::Mixed];
    let materials = vec![UseMaterial::Sorted, UseMaterial::Changes, UseMaterial::Always];
    let ends = select(vec!["\n", "\r\n", "\r"]);
    let text = (ends, any::<[bool; 3]>()).prop_map(|(end, [has_comments, is_continued, is_spaced])| Text {
        end,
        has_comments,
        is_continued,
        is_spaced,
    });
    let numbers = (units(), any::<bool>(), digits, vertices, tails);
    let faces = (polygons(), select(corners), select(materials), any::<u64>());
    (numbers, select(names), faces, any::<[bool; 4]>(), text).prop_map(
        |(numbers, names, faces, flags, text)| {
            let (unit, y_up, digits, vertices, tail) = numbers;
            let (polygons, corners, materials, seed) = faces;
            let [is_relative, repeats_storey, is_shuffled, is_reversed] = flags;
            // Six digits of a kilometre are a millimetre.
            let digits = if digits == Digits::Six && unit > 16.0 { Digits::Shortest } else { digits };
            ObjForm {
                unit,
                y_up,
                digits,
                names,
                vertices,
                tail,
                polygons,
                is_relative,
                corners,
                materials,
                repeats_storey,
                is_shuffled,
                is_reversed,
                text,
                seed,
            }
        },
    )
}

fn any_forms() -> impl Strategy<Value = Form> {
    prop_oneof![gltf_forms().prop_map(Form::Gltf), obj_forms().prop_map(Form::Obj)]
}

/// Writes and imports the building, and checks that it is the building.
fn round(building: &Building, form: &Form) -> Result<(Model, Vec<Seen>, Written), TestCaseError> {
    let folder = tempfile::tempdir().unwrap();
    let written = form.write(building, folder.path());
    let model = import(&written.path, &written.options).map_err(|e| TestCaseError::fail(e.to_string()))?;
    let (unit, y_up) = written.frame;
    prop_assert_eq!(model.frame.unit, unit);
    prop_assert_eq!(model.frame.up, if y_up { UpAxis::Y } else { UpAxis::Z });
    let seen = see(building, &model, &written.order, &written.bounds).map_err(TestCaseError::fail)?;
    Ok((model, seen, written))
}

/// The same of the building as the builder has it, without a file.
fn truth(building: &Building) -> (Model, Vec<Seen>) {
    let model = building.model();
    let order: Vec<usize> = (0..PARTS).collect();
    let bound = if model.frame.has_offset() { ROUNDING * building.reach() } else { 0.0 };
    let seen = see(building, &model, &order, &[bound; PARTS]).unwrap();
    (model, seen)
}

/// The plainest form of each format, in units of 1/4 m.
fn plain() -> [Form; 2] {
    let mesh = MeshForm {
        numbers: Numbers::Integer { few_bits: true, is_signed: true, is_normalized: false },
        layout: Layout::Own,
        mode: Mode::List,
        indices: Indices::U16,
        by_face: false,
        rolled: 0,
    };
    let placing = Placing::Nested { scale: -4.0, quarters: 2, at: [1, 2, 3] };
    let part = PartForm { placing, class: ClassIn::Extras, is_named_in_extras: false, mesh };
    let gltf = GltfForm {
        container: Container::Glb,
        unit: 0.25,
        y_up: false,
        root: Root::Matrix,
        storeys: Storeys::Extras,
        is_shared: true,
        is_reversed: false,
        nodes_backwards: false,
        has_scenes: true,
        parts: vec![part; PARTS],
    };
    let text = Text { end: "\n", has_comments: false, is_continued: false, is_spaced: false };
    let obj = ObjForm {
        unit: 0.25,
        y_up: true,
        digits: Digits::Shortest,
        names: Names::Objects,
        vertices: Vertices::First,
        tail: "",
        polygons: Polygons::None,
        is_relative: false,
        corners: Corners::V,
        materials: UseMaterial::Changes,
        repeats_storey: true,
        is_shuffled: false,
        is_reversed: false,
        text,
        seed: 0,
    };
    [Form::Gltf(gltf), Form::Obj(obj)]
}

#[test]
fn short_coordinates_are_exact_to_the_last_bit() {
    for far in [NEAR, FAR] {
        let building = building(0.0, far);
        for form in plain() {
            // `round` holds each element to its bound.
            let (_, _, written) = round(&building, &form).unwrap();
            let exact: Vec<&str> = (0..PARTS)
                .filter(|part| written.bounds[*part] == 0.0)
                .map(|part| building.parts[part].id)
                .collect();
            let expected = ["0gP1$ground", "1wN_north", "2wE", "4sL", "5room", "6roomL", "7c", "Cr", "Dx"];
            assert_eq!(exact, expected, "{form:?}");
        }
    }
}

#[test]
fn surfaces_without_a_material_are_alike() {
    let mut json = wall::json();
    json["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("material");
    json.as_object_mut().unwrap().remove("materials");
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\no IfcWall:W\nf 1 2 3\n".to_owned();
    for (name, bytes) in [("a.glb", glb::of_json(&json, &wall::bin())), ("a.obj", obj.into_bytes())] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let model = import(&path, &Default::default()).unwrap();
        assert_eq!(model.materials, [Material::default()], "{name}");
        assert_eq!(model.materials[0].name, "", "{name}");
    }
}

proptest! {
    #[test]
    fn all_forms_are_one_model(building in buildings(), forms in [any_forms(), any_forms()]) {
        let (model, expected) = truth(&building);
        for form in &forms {
            let (found, mut seen, written) = round(&building, form)?;
            prop_assert_eq!(found.frame.offset, model.frame.offset);
            if matches!(form, Form::Gltf(_)) {
                check_views(&found, &model, ROUNDING * building.reach()).map_err(TestCaseError::fail)?;
            }
            if written.cut.is_some() {
                // `see` has checked that the triangles are the polygons.
                seen.iter_mut().zip(&expected).for_each(|(s, e)| s.triangles.clone_from(&e.triangles));
            }
            for (seen, expected) in seen.iter().zip(&expected) {
                prop_assert_eq!(seen, expected);
            }
        }
    }

    #[test]
    fn polygons_are_cut_alike_in_any_frame(
        building in buildings(), polygons in polygons(), mut forms in [obj_forms(), obj_forms()]
    ) {
        for form in &mut forms {
            form.polygons = polygons;
            // Rounded, the corners are others.
            form.digits = Digits::Shortest;
            form.is_reversed = false;
        }
        let [a, b] = forms.map(|form| round(&building, &Form::Obj(form)).map(|(_, seen, _)| seen));
        for (a, b) in a?.into_iter().zip(b?) {
            prop_assert_eq!(a, b);
        }
    }
}
