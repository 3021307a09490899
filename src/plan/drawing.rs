//! What a drawing is made of.

/// A colour: red, green, blue.
pub type Color = [u8; 3];

/// Where a text stands from its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Its start is there.
    Start,
    /// Its middle is.
    Middle,
}

/// A shape, metres: x to the right, y up.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// Polygons, each counter-clockwise, as one area.
    Area {
        /// Corners of each.
        polygons: Vec<Vec<[f64; 2]>>,
        /// What it is filled with.
        fill: Color,
        /// What it is drawn around with, to hide the seams between polygons, and how wide; metres.
        stroke: Option<(Color, f64)>,
        /// A word on it, for those who point at it.
        title: String,
    },
    /// Lines, each through some points.
    Lines {
        /// Points of each.
        lines: Vec<Vec<[f64; 2]>>,
        /// Colour.
        color: Color,
        /// Width, metres.
        width: f64,
    },
    /// A text.
    Text {
        /// Where its base line is.
        at: [f64; 2],
        /// Height of its letters with what goes below the line, metres.
        size: f64,
        /// How it stands there.
        anchor: Anchor,
        /// Colour.
        color: Color,
        /// The text.
        text: String,
    },
}

/// A drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// The sheet: lower left and upper right corner, metres.
    pub bounds: [[f64; 2]; 2],
    /// From the lowest to what lies on top.
    pub shapes: Vec<Shape>,
}
