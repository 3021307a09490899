//! The colour of what a ray met.
//!
//! In pictures of materials the only light is a lamp at the eye, as in the paper by Maria, Horna and Aveneau: Lambert's
//! cosine and nothing else, no loss with distance and no ambient light. Lambert is perfectly diffuse, also on metals.

use enfilade_importers::Frame;
use glam::DVec3;

use super::color::{
    ColorMode, SKY, cell_color, element_color, face_color, linear, room_color, semantic_color, to_linear,
};
use crate::format::records::MaterialRecord;
use crate::scene::Scene;
use crate::trace::{Hit, NONE, Ray, Start, Want};

/// Radiance of a perfectly white surface that faces the eye: a little under 1, to leave room for lamps.
const HEADLIGHT: f64 = 0.9;

/// See-through surfaces that a ray may pass; the next one counts as opaque.
const LAYERS: usize = 8;

/// Even the clearest glass hides this share of what is behind it, so that one sees that it is there.
const LEAST_COVER: f32 = 0.1;

/// In pictures of other things than materials, the share of the colour that does not depend on the slope.
const EVEN: f64 = 0.45;

/// The cosine between the ray's direction (any length) and the normal.
fn cosine(direction: [f64; 3], normal: [f64; 3]) -> f64 {
    DVec3::from(direction).normalize_or_zero().dot(DVec3::from(normal)).abs().min(1.0)
}

/// The colour of a hit, or of an escaped ray; depth, packets and cost are coloured once the whole picture is known.
pub(super) fn shade(scene: &Scene, ray: &Ray, hit: &Hit, mode: ColorMode, frame: &Frame) -> [f32; 3] {
    if hit.element == NONE {
        return linear(SKY);
    }
    let flat = match mode {
        ColorMode::Material => return material(scene, ray, hit),
        ColorMode::Normal => {
            return frame.direction_to_source(hit.normal).map(|c| to_linear((c * 0.5 + 0.5) as f32));
        }
        ColorMode::Depth | ColorMode::Packet | ColorMode::Cost => return [0.0; 3],
        ColorMode::Semantic => semantic_color(hit.semantic),
        ColorMode::Face => face_color(hit.semantic),
        ColorMode::Element => element_color(hit.element),
        ColorMode::Room => room_color(hit.room),
        ColorMode::Cell => cell_color(hit.cell),
    };
    let light = EVEN + (1.0 - EVEN) * cosine(ray.direction, hit.normal);
    flat.map(|c| c * light as f32)
}

/// Radiance toward the eye, what is seen through glass included.
fn material(scene: &Scene, ray: &Ray, first: &Hit) -> [f32; 3] {
    let (mut layers, mut sum, mut through) = (0, [0.0f32; 3], [1.0f32; 3]);
    let mut passes = |hit: &Hit| {
        let Some(look) = scene.materials().get(hit.material as usize) else { return false };
        let light = (HEADLIGHT * cosine(ray.direction, hit.normal)) as f32;
        let (cover, clear) = if layers < LAYERS { passage(look) } else { (1.0, [0.0; 3]) };
        layers += 1;
        for i in 0..3 {
            sum[i] += through[i] * (cover * look.base_color[i] * light + look.emissive[i]);
            through[i] *= clear[i];
        }
        through != [0.0; 3]
    };
    if passes(first) {
        let last = scene.trace_beyond(Start::Anywhere, ray, Want::LEAST, first, passes);
        if last.element == NONE {
            let sky = linear(SKY);
            return [0, 1, 2].map(|i| sum[i] + through[i] * sky[i]);
        }
    }
    sum
}

/// The share of a surface that hides what is behind it, and the share of each colour that passes: what its alpha
/// leaves open passes as it is, what it transmits takes its colour.
pub(crate) fn passage(look: &MaterialRecord) -> (f32, [f32; 3]) {
    let transmitted = look.alpha * look.transmission;
    let open = 1.0 - look.alpha;
    let passing = (open + transmitted).clamp(0.0, 1.0);
    if passing <= 0.0 {
        return (1.0, [0.0; 3]);
    }
    let cover = (1.0 - passing).max(LEAST_COVER);
    let clear = look.base_color.map(|c| (1.0 - cover) * (open + transmitted * c) / passing);
    (cover, clear)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytemuck::Zeroable;

    #[test]
    fn shares_that_pass() {
        let look = |alpha: f32, transmission: f32| MaterialRecord {
            base_color: [1.0, 0.5, 0.0],
            alpha,
            transmission,
            ..MaterialRecord::zeroed()
        };
        assert_eq!(passage(&look(1.0, 0.0)), (1.0, [0.0; 3]));
        assert_eq!(passage(&look(0.25, 0.0)), (0.25, [0.75; 3]));
        // Transmission takes the colour of the glass; the clearest glass still covers a little.
        assert_eq!(passage(&look(1.0, 1.0)), (0.1, [0.9, 0.45, 0.0]));
        assert_eq!(passage(&look(0.0, 0.0)), (0.1, [0.9; 3]));
        let (cover, clear) = passage(&look(0.5, 0.5));
        assert_eq!(cover, 0.25);
        assert_eq!(clear, [0.75, 0.625, 0.5]);
    }
}
