//! What the colours of a picture mean. Palettes are chosen in sRGB, as seen, and given in linear RGB.

use std::fmt;
use std::str::FromStr;

use enfilade_importers::Semantic;

use crate::trace::NONE;

/// What the colours of a picture show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ColorMode {
    /// The material under a lamp at the eye; see-through materials are blended with what lies behind them.
    #[default]
    Material,
    /// The meaning of the element: [`semantic_color`].
    Semantic,
    /// The kind of the face: [`face_color`]; of detail, the meaning of the element.
    Face,
    /// The element: [`element_color`].
    Element,
    /// The room in which the ray ends: [`room_color`].
    Room,
    /// The cell in which the ray ends: [`cell_color`].
    Cell,
    /// The distance along the ray, near light and far dark: [`ramp`].
    Depth,
    /// The normal, in the axes of [`RenderOptions::frame`](super::RenderOptions::frame): x, y, z from -1..1 to 0..1 of
    /// red, green, blue as PNG writes them.
    Normal,
    /// How large the packet of rays was that told the pixel, as in the paper's Fig. 11b, single pixels dark and large packets light: [`ramp`] of the
    /// logarithm of its edge ([`Packets::sizes`](crate::packets::Packets::sizes)).
    Packet,
    /// How many steps the tracer took, few dark and many light: [`ramp`] of [`Cost::total`](crate::Cost::total).
    Cost,
}

/// The word names no colour mode.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is none of material, semantic, face, element, room, cell, depth, normal, packet, cost")]
pub struct UnknownColorMode(pub String);

impl ColorMode {
    /// All modes.
    pub const ALL: [ColorMode; 10] = [
        ColorMode::Material,
        ColorMode::Semantic,
        ColorMode::Face,
        ColorMode::Element,
        ColorMode::Room,
        ColorMode::Cell,
        ColorMode::Depth,
        ColorMode::Normal,
        ColorMode::Packet,
        ColorMode::Cost,
    ];

    /// Its word: `material`, `semantic`...
    pub const fn name(self) -> &'static str {
        match self {
            ColorMode::Material => "material",
            ColorMode::Semantic => "semantic",
            ColorMode::Face => "face",
            ColorMode::Element => "element",
            ColorMode::Room => "room",
            ColorMode::Cell => "cell",
            ColorMode::Depth => "depth",
            ColorMode::Normal => "normal",
            ColorMode::Packet => "packet",
            ColorMode::Cost => "cost",
        }
    }
}

impl fmt::Display for ColorMode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for ColorMode {
    type Err = UnknownColorMode;

    fn from_str(word: &str) -> Result<ColorMode, UnknownColorMode> {
        let found = ColorMode::ALL.into_iter().find(|mode| mode.name().eq_ignore_ascii_case(word.trim()));
        found.ok_or_else(|| UnknownColorMode(word.to_owned()))
    }
}

/// What is seen where rays escape: a light grey with a touch of blue.
pub(super) const SKY: [u8; 3] = [222, 229, 236];

/// The squares of what is seen from inside a solid.
pub(super) const IN_SOLID: [[u8; 3]; 2] = [[255, 0, 255], [64, 0, 64]];

/// No room, no element.
const NOTHING: [u8; 3] = [128, 128, 128];

/// sRGB bytes as linear RGB.
pub(super) fn linear(srgb: [u8; 3]) -> [f32; 3] {
    srgb.map(|byte| to_linear(f32::from(byte) / 255.0))
}

/// One channel of sRGB, 0 to 1, as linear light.
pub(super) fn to_linear(c: f32) -> f32 {
    if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

/// Linear light as one channel of sRGB; what is under 0 or over 1 is cut.
pub(crate) fn to_srgb(c: f32) -> f32 {
    // Not `clamp`: NaN becomes 0.
    let c = if c > 0.0 { c.min(1.0) } else { 0.0 };
    if c <= 0.003_130_8 { c * 12.92 } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
}

/// The colour of each meaning, sRGB. Paints for what is built, greens for what grows, strong hues for small things.
const SEMANTICS: [(Semantic, [u8; 3]); 25] = [
    (Semantic::Unknown, [150, 150, 150]),
    (Semantic::Room, [142, 202, 230]),
    (Semantic::Door, [205, 133, 63]),
    (Semantic::Window, [100, 149, 237]),
    (Semantic::Opening, [255, 215, 130]),
    (Semantic::Stairwell, [190, 160, 210]),
    (Semantic::Exterior, [205, 225, 245]),
    (Semantic::Void, [70, 70, 80]),
    (Semantic::Wall, [232, 224, 205]),
    (Semantic::Ground, [176, 137, 104]),
    (Semantic::Ceiling, [176, 214, 205]),
    (Semantic::Roof, [178, 66, 40]),
    (Semantic::Column, [92, 107, 192]),
    (Semantic::Beam, [48, 56, 130]),
    (Semantic::Furniture, [244, 150, 60]),
    (Semantic::Stair, [240, 205, 70]),
    (Semantic::Railing, [125, 75, 140]),
    (Semantic::DoorLeaf, [120, 72, 30]),
    (Semantic::WindowFrame, [30, 140, 130]),
    (Semantic::Glass, [70, 200, 235]),
    (Semantic::Site, [120, 170, 60]),
    (Semantic::Equipment, [225, 55, 75]),
    (Semantic::Covering, [240, 180, 195]),
    (Semantic::Other, [110, 125, 155]),
    (Semantic::Annotation, [30, 30, 30]),
];

/// The colour of the meaning with this number, linear RGB. Numbers that stand for no element's meaning have colours
/// as [`element_color`] gives.
pub fn semantic_color(number: u32) -> [f32; 3] {
    let row = SEMANTICS.iter().find(|row| row.0.number() == number);
    row.map_or_else(|| element_color(number), |row| linear(row.1))
}

/// The colour of each kind of face that rays meet, by its number, sRGB.
const FACES: [(u32, &str, [u8; 3]); 9] = [
    (65, "WALLPAPER", [240, 228, 190]),
    (66, "FACADE", [214, 160, 122]),
    (67, "GATE_POST", [150, 90, 160]),
    (68, "FLOOR", [150, 110, 75]),
    (69, "CEILING", [190, 222, 214]),
    (70, "TERRAIN", [120, 170, 60]),
    (71, "ROOFING", [178, 66, 40]),
    (72, "PANE", [70, 200, 235]),
    (74, "LINING", [105, 105, 118]),
];

/// The colour of the kind of face with this number, linear RGB; of numbers that are none, as [`semantic_color`] gives.
pub fn face_color(number: u32) -> [f32; 3] {
    let row = FACES.iter().find(|row| row.0 == number);
    row.map_or_else(|| semantic_color(number), |row| linear(row.2))
}

/// All kinds of faces that rays meet, by number and name, with their colours as sRGB bytes, for a legend.
pub fn face_legend() -> impl Iterator<Item = (u32, &'static str, [u8; 3])> {
    FACES.iter().copied()
}

/// All meanings with their colours as sRGB bytes, for a legend.
pub fn semantic_legend() -> impl Iterator<Item = (Semantic, [u8; 3])> {
    SEMANTICS.iter().copied()
}

/// The colour of the element with this index, linear RGB: neighbours in the list differ most. Grey for
/// [`NONE`].
pub fn element_color(index: u32) -> [f32; 3] {
    if index == NONE { linear(NOTHING) } else { spread(index, [0.66, 0.80, 0.52], 0.13) }
}

/// The colour of the room with this index, linear RGB; grey for [`NONE`].
pub fn room_color(index: u32) -> [f32; 3] {
    if index == NONE { linear(NOTHING) } else { spread(index, [0.80, 0.68, 0.88], 0.10) }
}

/// The colour of the cell with this index, linear RGB; grey for [`NONE`].
pub fn cell_color(index: u32) -> [f32; 3] {
    if index == NONE { linear(NOTHING) } else { spread(index, [0.74, 0.86, 0.60], 0.12) }
}

/// Hues a golden angle apart, so that any number of them stay as different as can be; the lightness changes too.
fn spread(index: u32, lightness: [f64; 3], chroma: f64) -> [f32; 3] {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let hue = (f64::from(index) * GOLDEN + 0.08).fract() * std::f64::consts::TAU;
    // Every hue of the first few comes back with another lightness.
    let level = lightness[(index / 5 % 3) as usize];
    from_oklab(level, chroma * hue.cos(), chroma * hue.sin()).map(|c| c.clamp(0.0, 1.0) as f32)
}

/// From Oklab to linear RGB, after Bjoern Ottosson (A perceptual color space for image processing, 2020).
fn from_oklab(l: f64, a: f64, b: f64) -> [f64; 3] {
    let x = (l + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let y = (l - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let z = (l - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    [
        4.076_741_662_1 * x - 3.307_711_591_3 * y + 0.230_969_929_2 * z,
        -1.268_438_004_6 * x + 2.609_757_401_1 * y - 0.341_319_396_5 * z,
        -0.004_196_086_3 * x - 0.703_418_614_7 * y + 1.707_614_701_0 * z,
    ]
}

/// Viridis of matplotlib, by Stefan van der Walt and Nathaniel Smith (CC0), at nine points.
const VIRIDIS: [[u8; 3]; 9] = [
    [0x44, 0x01, 0x54],
    [0x47, 0x2d, 0x7b],
    [0x3b, 0x52, 0x8b],
    [0x2c, 0x72, 0x8e],
    [0x21, 0x91, 0x8c],
    [0x28, 0xae, 0x80],
    [0x5e, 0xc9, 0x62],
    [0xad, 0xdc, 0x30],
    [0xfd, 0xe7, 0x25],
];

/// The ramp of depth and cost, linear RGB: dark violet at 0, by green, to light yellow at 1. What lies outside is cut.
pub fn ramp(at: f64) -> [f32; 3] {
    let last = VIRIDIS.len() - 1;
    // Not `clamp`: NaN becomes 0.
    let place = if at > 0.0 { at.min(1.0) * last as f64 } else { 0.0 };
    let step = (place as usize).min(last - 1);
    let share = (place - step as f64) as f32;
    let (from, to) = (VIRIDIS[step], VIRIDIS[step + 1]);
    [0, 1, 2].map(|i| {
        let mixed = f32::from(from[i]) * (1.0 - share) + f32::from(to[i]) * share;
        to_linear(mixed / 255.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distance in Oklab; about 0.02 can just be told apart.
    fn distance(a: [f32; 3], b: [f32; 3]) -> f64 {
        let (p, q) = (to_oklab(a), to_oklab(b));
        (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>().sqrt()
    }

    fn to_oklab(c: [f32; 3]) -> [f64; 3] {
        let [r, g, b] = c.map(f64::from);
        let l = (0.412_221_470_8 * r + 0.536_332_536_3 * g + 0.051_445_992_9 * b).cbrt();
        let m = (0.211_903_498_2 * r + 0.680_699_545_1 * g + 0.107_396_956_6 * b).cbrt();
        let s = (0.088_302_461_9 * r + 0.281_718_837_6 * g + 0.629_978_700_5 * b).cbrt();
        [
            0.210_454_255_3 * l + 0.793_617_785_0 * m - 0.004_072_046_8 * s,
            1.977_998_495_1 * l - 2.428_592_205_0 * m + 0.450_593_709_9 * s,
            0.025_904_037_1 * l + 0.782_771_766_2 * m - 0.808_675_766_0 * s,
        ]
    }

    #[test]
    fn meanings_can_be_told_apart() {
        let legend: Vec<_> = semantic_legend().collect();
        assert_eq!(legend.len(), Semantic::all().count());
        for semantic in Semantic::all() {
            assert!(legend.iter().any(|row| row.0 == semantic), "{semantic} has no colour");
        }
        for (i, a) in legend.iter().enumerate() {
            for b in &legend[..i] {
                let d = distance(linear(a.1), linear(b.1));
                assert!(d > 0.05, "{} and {}: {d}", a.0, b.0);
            }
        }
    }

    #[cfg(feature = "compile")]
    #[test]
    fn faces_can_be_told_apart() {
        use crate::building::FaceKind;
        let legend: Vec<_> = face_legend().collect();
        for kind in FaceKind::ALL {
            let is_met = !matches!(kind, FaceKind::Portal | FaceKind::Horizon | FaceKind::Joint);
            let row = legend.iter().find(|row| row.0 == kind.number());
            assert_eq!(row.map(|row| row.1), is_met.then(|| kind.name()));
        }
        for (i, a) in legend.iter().enumerate() {
            for b in &legend[..i] {
                let d = distance(linear(a.2), linear(b.2));
                assert!(d > 0.05, "{} and {}: {d}", a.1, b.1);
            }
        }
    }

    #[test]
    fn neighbouring_elements_and_rooms_can_be_told_apart() {
        for color in [element_color, room_color] {
            for i in 0..1000u32 {
                for j in i + 1..i + 8 {
                    let d = distance(color(i), color(j));
                    assert!(d > 0.03, "{i} and {j}: {d}");
                }
                assert!(distance(color(i), color(NONE)) > 0.03, "{i} is grey");
            }
        }
    }

    #[test]
    fn srgb_there_and_back() {
        for byte in 0..=255u8 {
            let back = to_srgb(linear([byte; 3])[0]) * 255.0;
            assert_eq!(back.round() as u8, byte);
        }
        assert_eq!(to_srgb(f32::NAN), 0.0);
        assert_eq!(to_srgb(f32::INFINITY), to_srgb(1.0));
    }

    #[test]
    fn the_ramp_grows_lighter() {
        let light: Vec<f64> = (0..=100).map(|i| to_oklab(ramp(f64::from(i) / 100.0))[0]).collect();
        assert!(light.windows(2).all(|w| w[0] < w[1]));
        assert_eq!(ramp(-1.0), ramp(0.0));
        assert_eq!(ramp(f64::NAN), ramp(0.0));
        assert_eq!(ramp(7.0), ramp(1.0));
    }

    #[test]
    fn words() {
        for mode in ColorMode::ALL {
            assert_eq!(mode.name().parse(), Ok(mode));
        }
        assert!("colour".parse::<ColorMode>().unwrap_err().to_string().contains("semantic"));
    }
}
