//! The same mesh in any form that glTF has for it is the same model.

use proptest::prelude::*;
use serde_json::json;

use super::testing::{GltfText, read};
use crate::model::{Mesh, Model};

/// A mesh with integer coordinates, which all number types hold: points, and corners of triangles.
#[derive(Clone, Debug)]
struct Soup {
    points: Vec<[i8; 3]>,
    triangles: Vec<[u8; 3]>,
}

fn soups() -> impl Strategy<Value = Soup> {
    prop::collection::vec(any::<[i8; 3]>(), 3..20).prop_flat_map(|points| {
        let corner = 0..points.len() as u8;
        let triangles = prop::collection::vec([corner.clone(), corner.clone(), corner], 1..20);
        triangles.prop_map(move |triangles| Soup { points: points.clone(), triangles })
    })
}

/// How indices are written.
#[derive(Clone, Copy, Debug)]
enum Indexing {
    None,
    U8,
    U16,
    U32,
}

/// How points are written.
#[derive(Clone, Copy, Debug)]
enum Points {
    Float,
    /// With so many bytes of something else around each.
    Interleaved(u8),
    /// Half of them as replacements of others.
    Sparse,
    Byte,
    Short,
}

/// How the node is placed; all three move alike.
#[derive(Clone, Copy, Debug)]
enum Placing {
    Parts,
    Matrix,
    Parents,
}

fn build(soup: &Soup, indexing: Indexing, points: Points, placing: Placing) -> GltfText {
    let corners: Vec<u8> = soup.triangles.as_flattened().to_vec();
    let used: Vec<[i8; 3]> = match indexing {
        Indexing::None => corners.iter().map(|c| soup.points[usize::from(*c)]).collect(),
        _ => soup.points.clone(),
    };
    let mut text = GltfText::empty();
    let positions = add_points(&mut text, &used, points);
    let mut primitive = json!({ "attributes": { "POSITION": positions } });
    let (component, bytes): (u32, Vec<u8>) = match indexing {
        Indexing::None => (0, Vec::new()),
        Indexing::U8 => (5121, corners.clone()),
        Indexing::U16 => (5123, corners.iter().flat_map(|c| u16::from(*c).to_le_bytes()).collect()),
        Indexing::U32 => (5125, corners.iter().flat_map(|c| u32::from(*c).to_le_bytes()).collect()),
    };
    if component != 0 {
        primitive["indices"] = json!(text.accessor(&bytes, component, "SCALAR", corners.len()));
    }
    text.mesh(json!([primitive]));
    text.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    text.json["nodes"] = match placing {
        Placing::Parts => json!([{
            "name": "a", "mesh": 0, "translation": [100.5, -3, 7], "rotation": [0, 0, 1, 0], "scale": [2, 4, -0.5]
        }]),
        Placing::Matrix => json!([{
            "name": "a", "mesh": 0, "matrix": [-2, 0, 0, 0, 0, -4, 0, 0, 0, 0, -0.5, 0, 100.5, -3, 7, 1]
        }]),
        // The outer nodes come later in the file, and are unnamed: only the mesh is compared.
        Placing::Parents => json!([
            { "children": [1], "translation": [100.5, -3, 7] },
            { "children": [2], "rotation": [0, 0, 2, 0] },
            { "name": "a", "mesh": 0, "scale": [2, 4, -0.5] }
        ]),
    };
    text
}

fn add_points(text: &mut GltfText, points: &[[i8; 3]], form: Points) -> usize {
    let floats: Vec<[f32; 3]> = points.iter().map(|p| p.map(f32::from)).collect();
    match form {
        Points::Float => text.floats(&floats),
        Points::Interleaved(pad) => {
            let pad = usize::from(pad) * 4;
            let item = |p: &[f32; 3]| [p.map(f32::to_le_bytes).as_flattened(), &vec![0xFF; pad][..]].concat();
            let bytes: Vec<u8> = floats.iter().flat_map(item).collect();
            let accessor = text.accessor(&bytes, 5126, "VEC3", points.len());
            let view = text.json["accessors"][accessor]["bufferView"].as_u64().unwrap() as usize;
            text.json["bufferViews"][view]["byteStride"] = json!(12 + pad);
            accessor
        }
        Points::Sparse => {
            let mut base = floats.clone();
            let odd: Vec<usize> = (0..points.len()).filter(|index| index % 2 == 1).collect();
            odd.iter().for_each(|index| base[*index] = [f32::NAN; 3]);
            let accessor = text.floats(&base);
            let indices = text.view(&odd.iter().map(|index| *index as u8).collect::<Vec<u8>>());
            let values: Vec<u8> = odd.iter().flat_map(|i| floats[*i]).flat_map(f32::to_le_bytes).collect();
            let values = text.view(&values);
            text.json["accessors"][accessor]["sparse"] = json!({
                "count": odd.len(),
                "indices": { "bufferView": indices, "componentType": 5121 },
                "values": { "bufferView": values }
            });
            accessor
        }
        Points::Byte => {
            let bytes: Vec<u8> = points.iter().flatten().map(|c| *c as u8).collect();
            text.accessor(&bytes, 5120, "VEC3", points.len())
        }
        Points::Short => {
            let bytes: Vec<u8> = points.iter().flatten().flat_map(|c| i16::from(*c).to_le_bytes()).collect();
            text.accessor(&bytes, 5122, "VEC3", points.len())
        }
    }
}

/// The mesh, or `None` if the soup has no triangle with an area; and how many triangles were read.
fn mesh_of(text: &GltfText) -> Option<(Mesh, u64)> {
    let model: Model = read(text).ok()?;
    Some((model.elements[0].mesh.clone(), model.triangles_read))
}

proptest! {
    #[test]
    fn every_form_of_a_mesh_is_the_same_mesh(
        soup in soups(),
        indexing in prop::sample::select(vec![Indexing::None, Indexing::U8, Indexing::U16, Indexing::U32]),
        points in prop_oneof![
            Just(Points::Float), (1u8..8).prop_map(Points::Interleaved), Just(Points::Sparse),
            Just(Points::Byte), Just(Points::Short)
        ],
        placing in prop::sample::select(vec![Placing::Parts, Placing::Matrix, Placing::Parents]),
    ) {
        let plain = mesh_of(&build(&soup, Indexing::U32, Points::Float, Placing::Parts));
        let other = mesh_of(&build(&soup, indexing, points, placing));
        prop_assert_eq!(&plain, &other);
        // The plain form against the numbers themselves: mirrored, so that corners 1 and 2 change places.
        if let Some((mesh, read)) = plain {
            prop_assert_eq!(read, soup.triangles.len() as u64);
            let mut found = (0..mesh.triangles.len()).map(|triangle| mesh.corners(triangle));
            for [a, b, c] in &soup.triangles {
                let corners = [a, c, b].map(|corner| {
                    let [x, y, z] = soup.points[usize::from(*corner)].map(f64::from);
                    // The node's transform, then from Y up to Z up.
                    let [x, y, z] = [100.5 - 2.0 * x, -3.0 - 4.0 * y, 7.0 - 0.5 * z];
                    [x, -z, y]
                });
                if area_squared(corners) > 0.0 {
                    prop_assert_eq!(found.next(), Some(corners));
                }
            }
            prop_assert_eq!(found.next(), None);
        }
    }
}

/// Four times the squared area of a triangle; exact for the small numbers here.
fn area_squared([a, b, c]: [[f64; 3]; 3]) -> f64 {
    let u = [0, 1, 2].map(|i| b[i] - a[i]);
    let v = [0, 1, 2].map(|i| c[i] - a[i]);
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    dot(u, u) * dot(v, v) - dot(u, v) * dot(u, v)
}
