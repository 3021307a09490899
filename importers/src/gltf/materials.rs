//! Materials: factors times the mean values of their textures.

use gltf::json;
use gltf::json::material::AlphaMode;
use gltf::json::validation::Checked;
use serde_json::Value;

use super::buffers::Buffers;
use super::fault;
use super::images::{self, ImageMeans};
use super::uri::{Uris, is_refusal};
use crate::builder::ModelBuilder;
use crate::error::ImportError;
use crate::limits::{Budget, Limits};
use crate::model::{Material, MaterialId};
use crate::texture::Decoder;
use crate::watch::Watch;

/// A file's materials in the builder.
#[derive(Debug)]
pub(super) struct Materials {
    of_file: Vec<MaterialId>,
    /// For primitives without a material. By the letter of the format that is a rough white *metal*, which no exporter
    /// means that leaves materials out; a neutral grey shows shapes and reflects about as much as a building does.
    default: Option<MaterialId>,
}

impl Materials {
    /// The builder's material for that of a primitive.
    pub fn get(&mut self, index: Option<usize>, builder: &mut ModelBuilder) -> MaterialId {
        match index.and_then(|index| self.of_file.get(index)) {
            Some(material) => *material,
            None => *self.default.get_or_insert_with(|| builder.material(Material::default())),
        }
    }
}

/// Gives the builder all materials of the file. Textures that cannot be read are left out with a warning.
///
/// # Errors
/// A refused `uri`, or cancelled.
pub(super) fn load(
    root: &json::Root,
    buffers: &Buffers<'_>,
    uris: &Uris,
    limits: &Limits,
    watch: &Watch,
    builder: &mut ModelBuilder,
) -> Result<Materials, ImportError> {
    for (index, image) in root.images.iter().enumerate() {
        if let Some(uri) = &image.uri {
            uris.check(uri, &format!("images[{index}].uri"))?;
        }
    }
    let mut textures = Textures {
        root,
        buffers,
        uris,
        watch,
        means: vec![None; root.images.len()],
        decoder: Decoder::new(limits),
    };
    let mut of_file = Vec::with_capacity(root.materials.len());
    for material in &root.materials {
        let material = convert(material, &mut textures, builder)?;
        of_file.push(builder.material(material));
    }
    Ok(Materials { of_file, default: None })
}

fn convert(
    material: &json::Material,
    textures: &mut Textures<'_>,
    builder: &mut ModelBuilder,
) -> Result<Material, ImportError> {
    let pbr = &material.pbr_metallic_roughness;
    let mut factor = pbr.base_color_factor.0;
    let mut color_texture = pbr.base_color_texture.as_ref().map(|info| info.index.value());
    let mut metallic = pbr.metallic_factor.0;
    let mut roughness = pbr.roughness_factor.0;
    if let Some(info) = &pbr.metallic_roughness_texture
        && let Some(means) = textures.means(info.index.value(), builder)?
    {
        roughness *= means.plain[1] as f32;
        metallic *= means.plain[2] as f32;
    }
    let extensions = material.extensions.as_ref();
    if let Some(old) = extensions.and_then(|e| e.others.get("KHR_materials_pbrSpecularGlossiness")) {
        // Where a file has both, this is the exporter's own model and the other a stand-in.
        factor = numbers(old.get("diffuseFactor")).unwrap_or([1.0; 4]);
        color_texture = old.pointer("/diffuseTexture/index").and_then(Value::as_u64).map(|i| i as usize);
        metallic = 0.0;
        roughness = 1.0 - old.get("glossinessFactor").and_then(Value::as_f64).unwrap_or(1.0) as f32;
    }

    let means = match color_texture {
        Some(texture) => textures.means(texture, builder)?,
        None => None,
    };
    let cutoff = f64::from(material.alpha_cutoff.unwrap_or_default().0);
    let (texture_color, alpha) = match (alpha_mode(material), means) {
        (AlphaMode::Opaque, means) => (means.map_or([1.0; 3], |means| means.colors.color()), 1.0),
        (AlphaMode::Blend, None) => ([1.0; 3], f64::from(factor[3])),
        (AlphaMode::Blend, Some(means)) => {
            let mean = means.colors.weighted(|alpha| alpha);
            (mean.rgb, mean.alpha * f64::from(factor[3]))
        }
        // A cut-out surface is there, or not, point by point: its opacity is the share that is there.
        (AlphaMode::Mask, means) => {
            let is_there = |alpha: f64| if alpha * f64::from(factor[3]) >= cutoff { 1.0 } else { 0.0 };
            match means {
                None => ([1.0; 3], is_there(1.0)),
                Some(means) => {
                    let mean = means.colors.weighted(is_there);
                    (mean.rgb, mean.alpha)
                }
            }
        }
    };
    let base_color = [0, 1, 2].map(|c| share(factor[c] * texture_color[c] as f32));

    let strength =
        extensions.and_then(|e| e.emissive_strength.as_ref()).map_or(1.0, |e| e.emissive_strength.0);
    let mut emissive = material.emissive_factor.0.map(|c| c * strength);
    if let (Some(info), true) = (&material.emissive_texture, emissive.iter().any(|c| *c > 0.0))
        && let Some(means) = textures.means(info.index.value(), builder)?
    {
        let color = means.colors.color();
        emissive = [0, 1, 2].map(|c| emissive[c] * color[c] as f32);
    }
    let mut transmission = 0.0;
    if let Some(extension) = extensions.and_then(|e| e.transmission.as_ref()) {
        transmission = extension.transmission_factor.0;
        if let Some(info) = &extension.transmission_texture
            && let Some(means) = textures.means(info.index.value(), builder)?
        {
            transmission *= means.plain[0] as f32;
        }
    }
    let ior = extensions.and_then(|e| e.ior.as_ref()).map_or(1.5, |e| e.ior.0);
    Ok(Material {
        name: material.name.clone().unwrap_or_default(),
        base_color,
        alpha: share(alpha as f32),
        metallic: share(metallic),
        roughness: share(roughness),
        // Products may be infinite in f32.
        emissive: emissive.map(|c| if c.is_nan() { 0.0 } else { c.clamp(0.0, f32::MAX) }),
        ior: if ior.is_finite() && ior >= 0.0 { ior } else { 1.5 },
        transmission: share(transmission),
    })
}

fn alpha_mode(material: &json::Material) -> AlphaMode {
    match material.alpha_mode {
        Checked::Valid(mode) => mode,
        Checked::Invalid => AlphaMode::Opaque,
    }
}

/// Clamped to 0..=1.
fn share(value: f32) -> f32 {
    if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) }
}

fn numbers(value: Option<&Value>) -> Option<[f32; 4]> {
    let values: Vec<f32> = value?.as_array()?.iter().filter_map(Value::as_f64).map(|v| v as f32).collect();
    values.try_into().ok()
}

/// Textures, each image decoded once.
struct Textures<'a> {
    root: &'a json::Root,
    buffers: &'a Buffers<'a>,
    uris: &'a Uris,
    watch: &'a Watch,
    /// By image: not looked at yet, unreadable, or read.
    means: Vec<Option<Option<ImageMeans>>>,
    decoder: Decoder,
}

impl Textures<'_> {
    /// The means of a texture's image; `None`, with a warning at the first time, if it cannot be read.
    fn means(
        &mut self,
        texture: usize,
        builder: &mut ModelBuilder,
    ) -> Result<Option<&ImageMeans>, ImportError> {
        let Some(image) = self.image_of(texture) else {
            builder.warn(format!("textures[{texture}]"), "the texture has no image that enfilade reads");
            return Ok(None);
        };
        if self.means[image].is_none() {
            self.watch.check().map_err(|e| fault("", e.into()))?;
            let means = match self.decode(image, builder.budget())? {
                Ok(means) => Some(means),
                Err(text) => {
                    let text = format!("the image cannot be read, and is left out: {text}");
                    builder.warn(format!("images[{image}]"), text);
                    None
                }
            };
            self.means[image] = Some(means);
        }
        Ok(self.means[image].as_ref().and_then(Option::as_ref))
    }

    fn image_of(&self, texture: usize) -> Option<usize> {
        let texture = self.root.textures.get(texture)?;
        let extension = texture.extensions.as_ref().and_then(|e| e.others.get("EXT_texture_webp"));
        let webp = extension.and_then(|e| e.get("source")).and_then(Value::as_u64).map(|i| i as usize);
        [Some(texture.source.value()), webp]
            .into_iter()
            .flatten()
            .find(|image| *image < self.root.images.len())
    }

    /// The outer error ends the import, the inner one just this image.
    fn decode(
        &mut self,
        image: usize,
        budget: &mut Budget,
    ) -> Result<Result<ImageMeans, String>, ImportError> {
        let json = &self.root.images[image];
        let place = format!("images[{image}].uri");
        let before = budget.used();
        let own;
        let bytes = match (&json.uri, json.buffer_view) {
            (Some(uri), _) => match self.uris.read(uri, &place, "an image", budget) {
                Ok(bytes) => {
                    own = bytes;
                    &own[..]
                }
                Err(error) if is_refusal(&error) => return Err(error),
                Err(error) => return Ok(Err(error.kind.to_string())),
            },
            (None, Some(view)) => match self.buffers.view(self.root, view.value()) {
                Ok(bytes) => bytes,
                Err(error) => return Ok(Err(format!("{}: {}", error.place, error.kind))),
            },
            (None, None) => return Ok(Err("it has neither a uri nor a buffer view".to_owned())),
        };
        let means = images::decode(&mut self.decoder, bytes, budget).map_err(|e| e.to_string());
        budget.give_back(budget.used() - before);
        let means = means.and_then(|means| {
            budget.take(ImageMeans::BYTES, "means of images").map(|()| means).map_err(|e| e.to_string())
        });
        Ok(means)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{self, GltfText};
    use super::*;
    use crate::model::Model;
    use base64::Engine;
    use base64::prelude::BASE64_STANDARD;
    use image::{ImageFormat, Rgba, RgbaImage};
    use serde_json::json;

    fn png(pixels: &[[u8; 4]]) -> String {
        let image = RgbaImage::from_fn(pixels.len() as u32, 1, |x, _| Rgba(pixels[x as usize]));
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write_to(&mut bytes, ImageFormat::Png).unwrap();
        format!("data:image/png;base64,{}", BASE64_STANDARD.encode(bytes.into_inner()))
    }

    fn model_of(material: serde_json::Value, image: Option<&str>) -> Model {
        let mut text = GltfText::triangle();
        text.json["meshes"][0]["primitives"][0]["material"] = json!(0);
        text.json["materials"] = json!([material]);
        if let Some(image) = image {
            text.json["images"] = json!([{ "uri": image }]);
            text.json["textures"] = json!([{ "source": 0 }]);
        }
        testing::read(&text).unwrap()
    }

    fn close(a: f32, b: f64) -> bool {
        (f64::from(a) - b).abs() < 1e-6
    }

    #[test]
    fn factors_and_extensions_are_read() {
        let model = model_of(
            json!({
                "name": "Glas", "alphaMode": "BLEND", "emissiveFactor": [0.5, 0.25, 0.0],
                "pbrMetallicRoughness": {
                    "baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5, "roughnessFactor": 0.25
                },
                "extensions": {
                    "KHR_materials_ior": { "ior": 1.33 },
                    "KHR_materials_transmission": { "transmissionFactor": 0.75 },
                    "KHR_materials_emissive_strength": { "emissiveStrength": 8.0 },
                    "KHR_materials_unlit": {}
                }
            }),
            None,
        );
        let expected = Material {
            name: "Glas".into(),
            base_color: [0.1, 0.2, 0.3],
            alpha: 0.4,
            metallic: 0.5,
            roughness: 0.25,
            emissive: [4.0, 2.0, 0.0],
            ior: 1.33,
            transmission: 0.75,
        };
        assert_eq!(model.materials, [expected]);
        assert!(model.warnings.is_empty());
    }

    #[test]
    fn alpha_counts_by_its_mode() {
        let alpha = |mode: &str, factor: f64, cutoff: f64| {
            let material = json!({
                "alphaMode": mode, "alphaCutoff": cutoff,
                "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 1, factor] }
            });
            model_of(material, None).materials[0].alpha
        };
        assert_eq!(alpha("OPAQUE", 0.2, 0.5), 1.0);
        assert_eq!(alpha("BLEND", 0.25, 0.5), 0.25);
        assert_eq!((alpha("MASK", 0.2, 0.5), alpha("MASK", 0.5, 0.5)), (0.0, 1.0));
    }

    #[test]
    fn the_mean_linear_colour_of_a_texture_is_multiplied_in() {
        let image = png(&[[255, 0, 0, 255], [0, 0, 0, 255], [0, 255, 0, 51], [0, 0, 0, 51]]);
        let pbr = json!({ "baseColorFactor": [0.8, 1, 1, 1], "baseColorTexture": { "index": 0 } });
        let opaque = &model_of(json!({ "pbrMetallicRoughness": pbr }), Some(&image)).materials[0];
        assert!(close(opaque.base_color[0], 0.2) && close(opaque.base_color[1], 0.25));
        assert_eq!((opaque.base_color[2], opaque.alpha), (0.0, 1.0));

        let blend = json!({ "pbrMetallicRoughness": pbr, "alphaMode": "BLEND" });
        let blend = &model_of(blend, Some(&image)).materials[0];
        assert!(close(blend.alpha, 0.6));
        assert!(close(blend.base_color[0], 0.8 / 2.4) && close(blend.base_color[1], 0.2 / 2.4));

        let mask = json!({ "pbrMetallicRoughness": pbr, "alphaMode": "MASK" });
        let mask = &model_of(mask, Some(&image)).materials[0];
        assert!(close(mask.alpha, 0.5));
        assert!(close(mask.base_color[0], 0.4) && mask.base_color[1] == 0.0);
    }

    #[test]
    fn other_textures_count_with_their_means() {
        let image = png(&[[255, 255, 0, 255], [255, 0, 51, 255]]);
        let texture = json!({ "index": 0 });
        let material = json!({
            "pbrMetallicRoughness": { "metallicRoughnessTexture": texture },
            "emissiveFactor": [1, 1, 1], "emissiveTexture": texture,
            "extensions": {
                "KHR_materials_transmission": { "transmissionFactor": 0.5, "transmissionTexture": texture }
            }
        });
        let material = &model_of(material, Some(&image)).materials[0];
        assert!(close(material.roughness, 0.5) && close(material.metallic, 0.1));
        assert!(close(material.emissive[0], 1.0) && close(material.emissive[1], 0.5));
        assert!(close(material.transmission, 0.5));
    }

    #[test]
    fn specular_glossiness_becomes_a_dielectric() {
        let material = json!({ "extensions": { "KHR_materials_pbrSpecularGlossiness": {
            "diffuseFactor": [0.1, 0.2, 0.3, 0.5], "glossinessFactor": 0.75, "diffuseTexture": { "index": 0 }
        } } });
        let material = &model_of(material, Some(&png(&[[255, 255, 0, 255]]))).materials[0];
        assert_eq!(
            (material.base_color, material.metallic, material.roughness),
            ([0.1, 0.2, 0.0], 0.0, 0.25)
        );
    }

    #[test]
    fn unreadable_images_leave_the_factor_and_one_warning() {
        let images = ["missing.png", "data:image/ktx2;base64,q0tUWCAyMLs=", "data:,x"];
        for image in images {
            let material = json!({
                "pbrMetallicRoughness": {
                    "baseColorFactor": [0.5, 0.5, 0.5, 1], "baseColorTexture": { "index": 0 },
                    "metallicRoughnessTexture": { "index": 0 }
                }
            });
            let folder = tempfile::tempdir().unwrap();
            let mut text = GltfText::triangle();
            text.json["materials"] = json!([material]);
            text.json["images"] = json!([{ "uri": image }]);
            text.json["textures"] = json!([{ "source": 0 }]);
            let path = folder.path().join("m.gltf");
            std::fs::write(&path, text.embedded()).unwrap();
            let model = crate::gltf::read(&path, &crate::ImportOptions::default()).unwrap();
            assert_eq!(model.materials[0].base_color, [0.5; 3]);
            let places: Vec<&str> = model.warnings.iter().map(|w| w.place.as_str()).collect();
            assert_eq!(places, ["images[0]"], "{image}");
        }
    }

    #[test]
    fn images_outside_the_folder_are_refused() {
        for uri in ["../x.png", "http://example.org/x.png"] {
            let mut text = GltfText::triangle();
            text.json["images"] = json!([{ "uri": uri }]);
            assert_eq!(testing::read(&text).unwrap_err().place, "images[0].uri");
        }
    }

    #[test]
    fn primitives_without_material_are_grey_and_not_metal() {
        let model = testing::read(&GltfText::triangle()).unwrap();
        assert_eq!(model.materials, [Material::default()]);
        assert_eq!((model.materials[0].metallic, model.materials[0].name.as_str()), (0.0, ""));
    }
}
