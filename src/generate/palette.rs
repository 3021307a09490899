//! What generated buildings are made of. Colours are linear RGB.

use crate::importers::Material;

/// What the faces of a volume are made of. For a solid: what each side of it shows. For air: what the solids around
/// it show to it.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Where a solid meets another one or the edge of the world.
    pub core: u32,
    /// A solid's sides and undersides outdoors.
    pub outside: u32,
    /// A solid's tops outdoors.
    pub top: u32,
    /// A solid's sides indoors; `None`: as the room's walls are.
    pub inside: Option<u32>,
    /// What is under this air.
    pub floor: u32,
    /// What is above this air.
    pub ceiling: u32,
    /// What is around this air.
    pub walls: u32,
}

impl Default for Look {
    fn default() -> Look {
        Look {
            core: MASONRY,
            outside: RENDER,
            top: RENDER,
            inside: None,
            floor: OAK_FLOOR,
            ceiling: CEILING_PAINT,
            walls: PLASTER,
        }
    }
}

/// The colour of the lamps: warm white.
pub const LAMP_LIGHT: [f32; 3] = [1.0, 0.87, 0.7];

macro_rules! palette {
    ($($(#[doc = $doc:literal])* $name:ident = $number:literal, $text:literal, $color:expr, $roughness:expr, $metallic:expr, $alpha:expr;)*) => {
        $($(#[doc = $doc])* pub const $name: u32 = $number;)*

        /// All materials; the constants of this module are indices of it.
        pub fn materials() -> Vec<Material> {
            vec![$(Material {
                name: $text.to_owned(),
                base_color: $color,
                alpha: $alpha,
                metallic: $metallic,
                roughness: $roughness,
                ..Material::default()
            }),*]
        }

        #[cfg(test)]
        const NUMBERS: &[u32] = &[$($number),*];
    };
}

palette! {
    /// Air volumes: there for viewers only.
    AIR = 0, "Air", [0.55, 0.75, 0.95], 1.0, 0.0, 0.05;
    /// Interior walls.
    PLASTER = 1, "White plaster", [0.82, 0.81, 0.78], 0.9, 0.0, 1.0;
    /// Facades.
    RENDER = 2, "Cream render", [0.78, 0.70, 0.56], 0.95, 0.0, 1.0;
    /// Ceilings.
    CEILING_PAINT = 3, "Ceiling paint", [0.88, 0.88, 0.87], 0.95, 0.0, 1.0;
    /// Cut walls.
    MASONRY = 4, "Masonry", [0.48, 0.22, 0.14], 0.95, 0.0, 1.0;
    /// Slabs.
    CONCRETE = 5, "Concrete", [0.40, 0.40, 0.39], 0.9, 0.0, 1.0;
    /// Living rooms and bedrooms.
    OAK_FLOOR = 6, "Oak floor", [0.42, 0.26, 0.13], 0.6, 0.0, 1.0;
    /// Hall and kitchen.
    FLOOR_TILES = 7, "Floor tiles", [0.33, 0.31, 0.29], 0.4, 0.0, 1.0;
    /// Bath and WC.
    BATH_TILES = 8, "Bath tiles", [0.62, 0.74, 0.78], 0.25, 0.0, 1.0;
    /// Window sills and steps.
    STONE = 9, "Stone", [0.30, 0.29, 0.28], 0.6, 0.0, 1.0;
    /// Flat roofs.
    GRAVEL = 10, "Gravel", [0.25, 0.24, 0.22], 1.0, 0.0, 1.0;
    /// Roof edges.
    ZINC = 11, "Zinc sheet", [0.28, 0.30, 0.32], 0.45, 1.0, 1.0;
    /// The garden.
    GRASS = 12, "Grass", [0.10, 0.20, 0.05], 1.0, 0.0, 1.0;
    /// Doors and window frames.
    WHITE_PAINT = 13, "White paint", [0.84, 0.84, 0.82], 0.5, 0.0, 1.0;
    /// Window panes.
    GLASS = 14, "Glass", [0.85, 0.93, 0.90], 0.02, 0.0, 0.2;
    /// Handles, taps, hinges.
    STEEL = 15, "Brushed steel", [0.56, 0.55, 0.53], 0.35, 1.0, 1.0;
    /// Furniture.
    BEECH = 16, "Beech", [0.58, 0.40, 0.22], 0.6, 0.0, 1.0;
    /// Furniture.
    WALNUT = 17, "Walnut", [0.14, 0.07, 0.04], 0.5, 0.0, 1.0;
    /// Furniture.
    LACQUER = 18, "White lacquer", [0.80, 0.80, 0.80], 0.3, 0.0, 1.0;
    /// Sofas and armchairs.
    BLUE_FABRIC = 19, "Blue fabric", [0.08, 0.14, 0.27], 1.0, 0.0, 1.0;
    /// Mattresses and pillows.
    LINEN = 20, "Linen", [0.76, 0.72, 0.66], 1.0, 0.0, 1.0;
    /// Blankets.
    RED_WOOL = 21, "Red wool", [0.38, 0.06, 0.05], 1.0, 0.0, 1.0;
    /// Sanitary ware.
    CERAMIC = 22, "White ceramic", [0.86, 0.86, 0.85], 0.1, 0.0, 1.0;
    /// Screens, hobs.
    BLACK_GLASS = 23, "Black glass", [0.01, 0.01, 0.012], 0.05, 0.0, 1.0;
    /// Books.
    PAPER = 24, "Book spines", [0.45, 0.18, 0.10], 0.9, 0.0, 1.0;
    /// The entrance door.
    GREEN_PAINT = 25, "Green paint", [0.03, 0.12, 0.07], 0.5, 0.0, 1.0;
    /// Lamps.
    LAMP_SHADE = 26, "Lamp shade", [0.90, 0.88, 0.82], 0.8, 0.0, 1.0;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_indices() {
        assert!(NUMBERS.iter().copied().eq(0..materials().len() as u32));
        assert_eq!(materials()[GLASS as usize].name, "Glass");
        assert!(materials()[GLASS as usize].is_see_through());
    }
}
