//! What parsing a JSON text will cost in memory, found without keeping any of it.
//!
//! `[{},{},{}...` makes hundreds of bytes of every three: the text is walked once, and what its arrays will become
//! is paid for, before it is parsed into structures.

use std::fmt;
use std::mem::size_of;

use gltf::json;
use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};

use super::document::Placement;

/// A nested object: a structure of the crate's, or a map with its first block of entries.
const NESTED_OBJECT: u64 = 768;

/// A number, word or string in an array or object (a string's text is counted with the file's).
const VALUE: u64 = 64;

/// How many things a JSON value holds.
#[derive(Clone, Copy, Default)]
struct Tally {
    /// Items of the array itself.
    items: u64,
    /// Objects in it, at any depth.
    objects: u64,
    /// Everything else in it, at any depth.
    values: u64,
}

impl Tally {
    fn add(&mut self, inner: Tally) {
        self.items += 1;
        self.objects += inner.objects;
        self.values += inner.values;
    }

    /// Bytes, if each item becomes `size` bytes in a vector that doubles as it grows.
    fn bytes(&self, size: usize) -> u64 {
        let nested = self.objects.saturating_sub(self.items);
        (self.items * 2)
            .saturating_mul(size as u64)
            .saturating_add(nested.saturating_mul(NESTED_OBJECT))
            .saturating_add(self.values.saturating_mul(VALUE))
    }
}

impl<'de> Deserialize<'de> for Tally {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Tally, D::Error> {
        deserializer.deserialize_any(TallyVisitor)
    }
}

struct TallyVisitor;

const ONE_VALUE: Tally = Tally { items: 0, objects: 0, values: 1 };

impl<'de> Visitor<'de> for TallyVisitor {
    type Value = Tally;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("any JSON value")
    }

    fn visit_bool<E>(self, _: bool) -> Result<Tally, E> {
        Ok(ONE_VALUE)
    }

    fn visit_i64<E>(self, _: i64) -> Result<Tally, E> {
        Ok(ONE_VALUE)
    }

    fn visit_u64<E>(self, _: u64) -> Result<Tally, E> {
        Ok(ONE_VALUE)
    }

    fn visit_f64<E>(self, _: f64) -> Result<Tally, E> {
        Ok(ONE_VALUE)
    }

    fn visit_str<E>(self, _: &str) -> Result<Tally, E> {
        Ok(ONE_VALUE)
    }

    fn visit_unit<E>(self) -> Result<Tally, E> {
        Ok(ONE_VALUE)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Tally, A::Error> {
        // An array is a value itself: `[[],[],[]]` costs too.
        let mut tally = ONE_VALUE;
        while let Some(inner) = seq.next_element()? {
            tally.add(inner);
        }
        Ok(tally)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Tally, A::Error> {
        let mut tally = Tally { items: 0, objects: 1, values: 0 };
        while let Some((_, inner)) = map.next_entry::<IgnoredAny, Tally>()? {
            tally.add(inner);
        }
        Ok(tally)
    }
}

/// The parts of a glTF file that become structures.
#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Parts {
    accessors: Tally,
    animations: Tally,
    asset: Tally,
    buffers: Tally,
    buffer_views: Tally,
    cameras: Tally,
    extensions: Tally,
    extensions_required: Tally,
    extensions_used: Tally,
    images: Tally,
    materials: Tally,
    meshes: Tally,
    nodes: Tally,
    samplers: Tally,
    scenes: Tally,
    skins: Tally,
    textures: Tally,
}

/// Bytes of memory that `text` will take once parsed, about.
///
/// # Errors
/// `text` is no JSON object.
pub(super) fn estimate(text: &[u8]) -> Result<u64, serde_json::Error> {
    let parts: Parts = serde_json::from_slice(text)?;
    let costs = [
        parts.accessors.bytes(size_of::<json::Accessor>()),
        parts.animations.bytes(size_of::<json::Animation>()),
        parts.asset.bytes(size_of::<json::Value>()),
        parts.buffers.bytes(size_of::<json::Buffer>()),
        parts.buffer_views.bytes(size_of::<json::buffer::View>()),
        parts.cameras.bytes(size_of::<json::Camera>()),
        parts.extensions.bytes(NESTED_OBJECT as usize),
        parts.extensions_required.bytes(size_of::<String>()),
        parts.extensions_used.bytes(size_of::<String>()),
        parts.images.bytes(size_of::<json::Image>()),
        parts.materials.bytes(size_of::<json::Material>()),
        parts.meshes.bytes(size_of::<json::Mesh>()),
        parts.nodes.bytes(size_of::<json::Node>() + size_of::<Placement>()),
        parts.samplers.bytes(size_of::<json::texture::Sampler>()),
        parts.scenes.bytes(size_of::<json::Scene>()),
        parts.skins.bytes(size_of::<json::Skin>()),
        parts.textures.bytes(size_of::<json::Texture>()),
    ];
    // Names, URIs and extras are copied once.
    Ok(costs.into_iter().fold(text.len() as u64, u64::saturating_add))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_empty_objects_cost_their_structures() {
        let text = format!(r#"{{"nodes":[{}{{}}]}}"#, "{},".repeat(999));
        let cost = estimate(text.as_bytes()).unwrap();
        assert!(cost >= 1000 * size_of::<json::Node>() as u64, "{cost}");
        let nested = format!(r#"{{"materials":[{{"extensions":{{"X":[{}0]}}}}]}}"#, "0,".repeat(999));
        assert!(estimate(nested.as_bytes()).unwrap() >= 1000 * size_of::<json::Value>() as u64);
    }

    #[test]
    fn deep_nesting_is_an_error_and_no_overflow() {
        let text = format!(r#"{{"nodes":{}"#, "[".repeat(1_000_000));
        assert!(estimate(text.as_bytes()).is_err());
    }
}
