//! What glTF files have around their nodes and meshes: looks, and the containers.

use std::path::{Path, PathBuf};

use enfilade_testing::glb;
use serde_json::{Value, json};

use super::building::{Building, Look, VFOV_DEGREES};
use super::{base64, texture};

/// Where the buffer and the image are.
#[derive(Clone, Copy, Debug)]
pub enum Container {
    Glb,
    Base64,
    PercentCoded,
    External,
}

/// Writes a file into `folder`, and beside it what it refers to.
pub fn write(mut json: Value, mut bin: Vec<u8>, container: Container, folder: &Path) -> PathBuf {
    json["asset"] = json!({ "version": "2.0" });
    let image = texture();
    let mut buffer = json!({ "byteLength": bin.len() });
    match container {
        Container::Glb => {
            let view = json!({ "buffer": 0, "byteOffset": bin.len(), "byteLength": image.len() });
            bin.extend_from_slice(&image);
            let views = json["bufferViews"].as_array_mut().unwrap();
            views.push(view);
            json["images"] = json!([{ "bufferView": views.len() - 1, "mimeType": "image/png" }]);
            json["buffers"] = json!([{ "byteLength": bin.len() }]);
            let path = folder.join("a.glb");
            std::fs::write(&path, glb::of_json(&json, &bin)).unwrap();
            return path;
        }
        Container::Base64 => {
            json["images"] = json!([{ "uri": format!("data:image/png;base64,{}", base64(&image)) }]);
            buffer["uri"] = json!(format!("data:application/octet-stream;base64,{}", base64(&bin)));
        }
        Container::PercentCoded => {
            let coded = |bytes: &[u8]| bytes.iter().map(|b| format!("%{b:02X}")).collect::<String>();
            json["images"] = json!([{ "uri": format!("data:image/png,{}", coded(&image)) }]);
            buffer["uri"] = json!(format!("data:,{}", coded(&bin)));
        }
        Container::External => {
            std::fs::create_dir_all(folder.join("data")).unwrap();
            std::fs::write(folder.join("data/tür 1.png"), image).unwrap();
            std::fs::write(folder.join("all.bin"), &bin).unwrap();
            json["images"] = json!([{ "uri": "data/t%C3%BCr%201.png" }]);
            buffer["uri"] = json!("./data/../all.bin");
        }
    }
    json["buffers"] = json!([buffer]);
    let path = folder.join("a.gltf");
    std::fs::write(&path, serde_json::to_vec(&json).unwrap()).unwrap();
    path
}

/// Adds materials, the texture, the camera and the light.
pub fn put_looks(json: &mut Value, building: &Building) {
    let material = |look: &Look| {
        let m = &look.material;
        let [r, g, b] = m.base_color;
        let mut pbr = json!({
            "baseColorFactor": [r, g, b, m.alpha], "metallicFactor": m.metallic, "roughnessFactor": m.roughness
        });
        if look.is_textured {
            pbr["baseColorTexture"] = json!({ "index": 0 });
        }
        let is_blended = m.alpha < 1.0 || look.is_textured;
        // Emission over 1 needs a strength.
        let strength = m.emissive.iter().fold(1.0f32, |most, c| most.max(*c));
        json!({
            "name": m.name, "pbrMetallicRoughness": pbr, "emissiveFactor": m.emissive.map(|c| c / strength),
            "alphaMode": if is_blended { "BLEND" } else { "OPAQUE" },
            "extensions": {
                "KHR_materials_ior": { "ior": m.ior },
                "KHR_materials_transmission": { "transmissionFactor": m.transmission },
                "KHR_materials_emissive_strength": { "emissiveStrength": strength }
            }
        })
    };
    json["materials"] = building.looks.iter().map(material).collect();
    json["textures"] = json!([{ "source": 0 }]);
    let yfov = VFOV_DEGREES.to_radians();
    json["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": yfov, "znear": 0.1 } }]);
    json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{
        "type": "spot", "color": [1, 0.5, 0.25], "intensity": 640, "range": 12.5,
        "spot": { "innerConeAngle": 0.25, "outerConeAngle": 0.5 }
    }] } });
    json["extensionsUsed"] = json!([
        "KHR_mesh_quantization",
        "KHR_materials_ior",
        "KHR_materials_transmission",
        "KHR_materials_emissive_strength",
        "KHR_lights_punctual"
    ]);
    json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
}
