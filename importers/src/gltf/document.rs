//! Parses the JSON and checks what the rest of the reader relies on.
//!
//! The crate's own validation entry point refuses legal files (a required KHR_mesh_quantization, accessors that are
//! all zeros) and indexes out of bounds on illegal ones. Its checks are run here one by one, after what it trips
//! over was checked, and without its verdict on parts that enfilade does not read.

use gltf::Document;
use gltf::json;
use gltf::json::validation::{Checked, Error as Finding, Validate};
use serde::Deserialize;
use serde::de::Deserializer;

use super::{fault, json_cost, malformed};
use crate::error::{ImportError, ImportErrorKind};
use crate::limits::Budget;

/// Extensions that a file may require: read, or without a say in where triangles are.
const SUPPORTED: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_xmp_json_ld",
];

/// Where a node is put, in f64 as the text has it.
#[derive(Clone, Debug, Default, Deserialize)]
pub(super) struct Placement {
    /// Column-major 4x4 matrix; goes before the other three.
    #[serde(default)]
    pub matrix: Option<[f64; 16]>,
    #[serde(default)]
    pub translation: Option<[f64; 3]>,
    /// Quaternion x, y, z, w.
    #[serde(default)]
    pub rotation: Option<[f64; 4]>,
    #[serde(default)]
    pub scale: Option<[f64; 3]>,
    #[serde(default, rename = "mesh")]
    _mesh: Option<Fits>,
    #[serde(default, rename = "children")]
    _children: Option<Vec<Fits>>,
}

/// An integer that fits 32 bits. The crate cuts larger indices down to 32 bits, which would let index 4294967296
/// pass for 0.
#[derive(Clone, Copy, Debug)]
struct Fits;

impl<'de> Deserialize<'de> for Fits {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Fits, D::Error> {
        u32::deserialize(deserializer).map(|_| Fits)
    }
}

/// What is read from the text a second time.
#[derive(Deserialize)]
struct Again {
    #[serde(default)]
    nodes: Vec<Placement>,
    #[serde(default, rename = "scene")]
    _scene: Option<Fits>,
    #[serde(default, rename = "scenes")]
    _scenes: Vec<SceneAgain>,
    #[serde(default, rename = "meshes")]
    _meshes: Vec<MeshAgain>,
    #[serde(default, rename = "accessors")]
    _accessors: Vec<AccessorAgain>,
    #[serde(default, rename = "bufferViews")]
    _views: Vec<ViewAgain>,
}

#[derive(Deserialize)]
struct SceneAgain {
    #[serde(default, rename = "nodes")]
    _nodes: Vec<Fits>,
}

#[derive(Deserialize)]
struct MeshAgain {
    #[serde(default, rename = "primitives")]
    _primitives: Vec<PrimitiveAgain>,
}

#[derive(Deserialize)]
struct PrimitiveAgain {
    #[serde(rename = "attributes")]
    _attributes: AttributesAgain,
    #[serde(default, rename = "indices")]
    _indices: Option<Fits>,
    #[serde(default, rename = "material")]
    _material: Option<Fits>,
    #[serde(default, rename = "mode")]
    _mode: Option<Fits>,
}

#[derive(Deserialize)]
struct AttributesAgain {
    #[serde(default, rename = "POSITION")]
    _position: Option<Fits>,
}

#[derive(Deserialize)]
struct AccessorAgain {
    #[serde(default, rename = "bufferView")]
    _view: Option<Fits>,
    #[serde(rename = "componentType")]
    _component_type: Fits,
    #[serde(default, rename = "sparse")]
    _sparse: Option<SparseAgain>,
}

#[derive(Deserialize)]
struct SparseAgain {
    #[serde(rename = "indices")]
    _indices: SparseViewAgain,
    #[serde(rename = "values")]
    _values: SparseViewAgain,
}

#[derive(Deserialize)]
struct SparseViewAgain {
    #[serde(rename = "bufferView")]
    _view: Fits,
}

#[derive(Deserialize)]
struct ViewAgain {
    #[serde(rename = "buffer")]
    _buffer: Fits,
}

/// Parses `text`. On success every index that the reader follows is in range: of scenes, nodes, meshes, accessors,
/// buffer views, buffers, materials, textures, images, cameras and lights. What accessors hold is not checked yet.
///
/// # Errors
/// No JSON, no glTF 2, a required extension that is not supported, or an invalid value or index, with its place.
pub(super) fn parse(text: &[u8], budget: &mut Budget) -> Result<(Document, Vec<Placement>), ImportError> {
    // Derived parsers take an array for a structure, field by field; each of the three below in another order.
    if text.trim_ascii_start().first().is_some_and(|first| *first != b'{') {
        return Err(malformed("JSON line 1 column 1", "not a JSON object"));
    }
    let cost = json_cost::estimate(text).map_err(json_error)?;
    budget.take(cost, "the parsed JSON").map_err(|e| fault("", e.into()))?;
    let again: Again = serde_json::from_slice(text).map_err(json_error)?;
    let mut root = json::Root::from_slice(text).map_err(json_error)?;
    // Not needed, may be of any size, and the crate's validation copies them once for each use of the accessor.
    for accessor in &mut root.accessors {
        accessor.min = None;
        accessor.max = None;
    }
    check_version(&root.asset)?;
    check_extensions(&root)?;
    check_positions(&root)?;
    validate(&root)?;
    Ok((Document::from_json_without_validation(root), again.nodes))
}

fn json_error(error: serde_json::Error) -> ImportError {
    let place = match error.line() {
        0 => "JSON".to_owned(),
        line => format!("JSON line {line} column {}", error.column()),
    };
    // The message ends with the place again.
    let text = error.to_string();
    malformed(place, text.rsplit_once(" at line ").map_or(text.as_str(), |(text, _)| text))
}

fn check_version(asset: &json::Asset) -> Result<(), ImportError> {
    let wanted = asset.min_version.as_deref().unwrap_or(&asset.version);
    let known =
        if asset.min_version.is_some() { wanted == "2.0" } else { wanted.split('.').next() == Some("2") };
    if known {
        return Ok(());
    }
    let field = if asset.min_version.is_some() { "asset.minVersion" } else { "asset.version" };
    Err(fault(field, ImportErrorKind::Unsupported(format!("glTF {wanted}; enfilade reads glTF 2.0"))))
}

fn check_extensions(root: &json::Root) -> Result<(), ImportError> {
    for (index, name) in root.extensions_required.iter().enumerate() {
        if !SUPPORTED.contains(&name.as_str()) {
            let kind = ImportErrorKind::RequiredExtension(name.clone());
            return Err(fault(format!("extensionsRequired[{index}]"), kind));
        }
    }
    Ok(())
}

/// The crate's validation of primitives indexes `accessors` with these before it checks them.
fn check_positions(root: &json::Root) -> Result<(), ImportError> {
    for (m, mesh) in root.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let index = primitive.attributes.get(&Checked::Valid(json::mesh::Semantic::Positions));
            if let Some(index) = index.filter(|index| index.value() >= root.accessors.len()) {
                let place = format!("meshes[{m}].primitives[{p}].attributes.POSITION");
                let text = format!("accessor {index} does not exist: there are {}", root.accessors.len());
                return Err(malformed(place, text));
            }
        }
    }
    Ok(())
}

fn validate(root: &json::Root) -> Result<(), ImportError> {
    let mut first = None;
    root.validate(root, json::Path::new, &mut |path, finding| {
        if first.is_none() {
            let path = path();
            if matters(path.as_str(), finding) {
                first = Some((path, finding));
            }
        }
    });
    match first {
        None => Ok(()),
        Some((path, finding)) => Err(malformed(path.0, finding.to_string().to_lowercase())),
    }
}

/// Whether a finding of the crate's is about something that enfilade reads, and is right.
fn matters(path: &str, finding: Finding) -> bool {
    // Required extensions have been checked against the right list. Animations, skins, morph targets, samplers,
    // attributes other than positions, and hints to graphics cards are not read.
    let unread = path.starts_with("extensionsRequired")
        || path.starts_with("animations")
        || path.starts_with("skins")
        || path.starts_with("samplers")
        || path.starts_with("nodes") && path.ends_with(".skin")
        || path.starts_with("textures") && path.ends_with(".sampler")
        || path.starts_with("meshes") && (path.contains(".attributes[") || path.contains(".targets["))
        || path.starts_with("bufferViews") && path.ends_with(".target");
    // The stride has a check of its own, before it is used: files with a stride of 0 or 2 are readable.
    let checked_later = path.starts_with("bufferViews") && path.ends_with(".byteStride");
    // An accessor without a view is all zeros, and a texture may have its image in an extension.
    let legal = finding == Finding::Missing
        && (path.starts_with("accessors") && path.ends_with(".bufferView")
            || path.starts_with("textures") && path.ends_with(".source"));
    !(unread || checked_later || legal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;

    fn parse_text(text: &str) -> Result<(Document, Vec<Placement>), ImportError> {
        parse(text.as_bytes(), &mut Budget::new(&Limits::default()))
    }

    fn with(fields: &str) -> String {
        format!(r#"{{"asset":{{"version":"2.0"}},{fields}}}"#)
    }

    #[test]
    fn required_extensions_are_named_unless_supported() {
        for name in SUPPORTED {
            parse_text(&with(&format!(r#""extensionsRequired":["{name}"]"#))).unwrap();
        }
        for name in ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_texture_basisu"] {
            let text = with(&format!(r#""extensionsRequired":["KHR_mesh_quantization","{name}"]"#));
            let error = parse_text(&text).unwrap_err();
            assert_eq!(error.place, "extensionsRequired[1]");
            assert!(matches!(&error.kind, ImportErrorKind::RequiredExtension(n) if n == name));
        }
    }

    #[test]
    fn indices_of_more_than_32_bits_do_not_wrap() {
        let hosts = [
            r#""nodes":[{"mesh":4294967296}],"meshes":[{"primitives":[]}]"#,
            r#""nodes":[{"children":[4294967297]},{}]"#,
            r#""scenes":[{"nodes":[4294967296]}],"nodes":[{}]"#,
            r#""scene":4294967296,"scenes":[{"nodes":[]}]"#,
            r#""meshes":[{"primitives":[{"attributes":{"POSITION":4294967296}}]}]"#,
        ];
        for fields in hosts {
            let error = parse_text(&with(fields)).unwrap_err();
            assert!(error.place.starts_with("JSON line 1"), "{error}");
        }
    }

    #[test]
    fn indices_out_of_range_name_their_place() {
        let cases = [
            (r#""scene":3,"scenes":[{"nodes":[]}]"#, "scene"),
            (r#""scenes":[{"nodes":[7]}]"#, "scenes[0].nodes[0]"),
            (r#""nodes":[{},{"mesh":0}]"#, "nodes[1].mesh"),
            (r#""nodes":[{"children":[1]}]"#, "nodes[0].children[0]"),
            (r#""nodes":[{"camera":1}]"#, "nodes[0].camera"),
            (r#""bufferViews":[{"buffer":0,"byteLength":4}]"#, "bufferViews[0].buffer"),
            (
                r#""meshes":[{"primitives":[{"attributes":{"POSITION":5}}]}]"#,
                "meshes[0].primitives[0].attributes.POSITION",
            ),
            (
                r#""meshes":[{"primitives":[{"attributes":{},"indices":5}]}]"#,
                "meshes[0].primitives[0].indices",
            ),
            (r#""meshes":[{"primitives":[{"attributes":{},"mode":9}]}]"#, "meshes[0].primitives[0].mode"),
            (
                r#""accessors":[{"bufferView":2,"componentType":5126,"count":1,"type":"VEC3"}]"#,
                "accessors[0].bufferView",
            ),
        ];
        for (fields, place) in cases {
            let error = parse_text(&with(fields)).unwrap_err();
            assert_eq!(error.place, place, "{error}");
        }
    }

    #[test]
    fn what_is_not_read_may_be_wrong() {
        let fields = [
            r#""samplers":[{"magFilter":1}],"textures":[{"sampler":5}]"#,
            r#""meshes":[{"primitives":[{"attributes":{"BATCHID":4,"NORMAL":9}}]}]"#,
            r#""skins":[{"joints":[4]}],"nodes":[{"skin":3}]"#,
            r#""buffers":[{"byteLength":4}],"bufferViews":[{"buffer":0,"byteLength":4,"byteStride":2,"target":1}]"#,
            r#""accessors":[{"componentType":5126,"count":1,"type":"VEC3"}]"#,
        ];
        for field in fields {
            parse_text(&with(field)).unwrap();
        }
    }

    #[test]
    fn other_versions_are_refused() {
        for asset in [r#"{"version":"1.0"}"#, r#"{"version":"2.0","minVersion":"2.1"}"#, r#"{"version":""}"#]
        {
            let error = parse_text(&format!(r#"{{"asset":{asset}}}"#)).unwrap_err();
            assert!(error.place.starts_with("asset."), "{error}");
        }
        parse_text(r#"{"asset":{"version":"2.1","minVersion":"2.0"}}"#).unwrap();
    }

    #[test]
    fn transforms_keep_every_bit() {
        let (_, placements) =
            parse_text(&with(r#""nodes":[{"translation":[-5427891.3751234567,0.1,123456.78901234567]}]"#))
                .unwrap();
        assert_eq!(placements[0].translation, Some([-5427891.375123457, 0.1, 123456.78901234567]));
    }
}
