//! A drawing as pixels.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};
use tiny_skia::{FillRule, LineCap, LineJoin, Paint, PathBuilder, Pixmap, PixmapMut, Stroke, Transform};

use super::drawing::{Anchor, Color, Drawing, Shape};

/// Most pixels on a side.
const LARGEST: u32 = 16_384;

/// A drawing cannot become a picture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// It has no extent, or the picture none, or too many pixels.
    #[error("a plan of {0} pixels: from 1 to 16384 can be drawn")]
    Size(u32),
    /// It could not be encoded.
    #[error("the picture could not be encoded: {0}")]
    Encode(String),
}

/// The sizes that letters come in, pixels.
const SIZES: [RasterHeight; 4] =
    [RasterHeight::Size16, RasterHeight::Size20, RasterHeight::Size24, RasterHeight::Size32];

/// A drawing as a picture whose longer side has `size` pixels, as the bytes of a PNG file.
///
/// # Errors
/// [`PlanError`].
pub fn plan_png(drawing: &Drawing, size: u32) -> Result<Vec<u8>, PlanError> {
    let [lo, hi] = drawing.bounds;
    let (width, height) = (hi[0] - lo[0], hi[1] - lo[1]);
    let scale = f64::from(size) / width.max(height);
    let pixels = |metres: f64| (metres * scale).ceil().max(1.0) as u32;
    let unusable = || PlanError::Size(size);
    if size == 0 || size > LARGEST || !scale.is_finite() {
        return Err(unusable());
    }
    let mut pixmap =
        Pixmap::new(pixels(width).min(LARGEST), pixels(height).min(LARGEST)).ok_or_else(unusable)?;
    pixmap.fill(tiny_skia::Color::WHITE);
    let place = |[x, y]: [f64; 2]| [((x - lo[0]) * scale) as f32, ((hi[1] - y) * scale) as f32];
    let mut canvas = Canvas { pixmap: pixmap.as_mut(), scale };
    for shape in &drawing.shapes {
        match shape {
            Shape::Area { polygons, fill, stroke, .. } => {
                let mut builder = PathBuilder::new();
                for polygon in polygons {
                    trace(&mut builder, polygon.iter().map(|p| place(*p)));
                    builder.close();
                }
                canvas.fill(builder, *fill, *stroke);
            }
            Shape::Lines { lines, color, width } => {
                let mut builder = PathBuilder::new();
                lines.iter().for_each(|line| trace(&mut builder, line.iter().map(|p| place(*p))));
                canvas.stroke(builder, *color, *width);
            }
            Shape::Text { at, size, anchor, color, text } => {
                canvas.text(place(*at), *size, *anchor, *color, text)
            }
        }
    }
    let (width, height) = (pixmap.width(), pixmap.height());
    let mut bytes = Vec::new();
    let image = image::RgbaImage::from_raw(width, height, pixmap.take()).ok_or_else(unusable)?;
    let image = image::DynamicImage::ImageRgba8(image).to_rgb8();
    image
        .write_to(&mut std::io::Cursor::new(&mut bytes), image::ImageFormat::Png)
        .map_err(|e| PlanError::Encode(e.to_string()))?;
    Ok(bytes)
}

fn trace(builder: &mut PathBuilder, points: impl Iterator<Item = [f32; 2]>) {
    for (i, [x, y]) in points.enumerate() {
        if i == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
    }
}

fn paint([r, g, b]: Color) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(r, g, b, 255);
    paint
}

struct Canvas<'a> {
    pixmap: PixmapMut<'a>,
    /// Pixels in a metre.
    scale: f64,
}

impl Canvas<'_> {
    fn fill(&mut self, builder: PathBuilder, fill: Color, stroke: Option<(Color, f64)>) {
        let Some(path) = builder.finish() else { return };
        self.pixmap.fill_path(&path, &paint(fill), FillRule::Winding, Transform::identity(), None);
        if let Some((color, width)) = stroke {
            self.along(&path, color, width);
        }
    }

    fn stroke(&mut self, builder: PathBuilder, color: Color, width: f64) {
        if let Some(path) = builder.finish() {
            self.along(&path, color, width);
        }
    }

    fn along(&mut self, path: &tiny_skia::Path, color: Color, width: f64) {
        let width = ((width * self.scale) as f32).max(0.6);
        let stroke =
            Stroke { width, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
        self.pixmap.stroke_path(path, &paint(color), &stroke, Transform::identity(), None);
    }

    /// Letters have a few sizes: the one nearest below is taken, and none if even the smallest is much too large.
    fn text(&mut self, [x, y]: [f32; 2], size: f64, anchor: Anchor, color: Color, text: &str) {
        let wanted = size * self.scale * 1.2;
        let fits = SIZES.into_iter().rev().find(|height| height.val() as f64 <= wanted);
        let Some(height) = fits.or((wanted >= 10.0).then_some(SIZES[0])) else { return };
        let advance = get_raster_width(FontWeight::Regular, height) as f32;
        let mut left = match anchor {
            Anchor::Start => x,
            Anchor::Middle => x - advance * text.chars().count() as f32 / 2.0,
        }
        .round();
        let top = (y - 0.8 * height.val() as f32).round();
        for c in text.chars() {
            let glyph =
                get_raster(c, FontWeight::Regular, height).or(get_raster('?', FontWeight::Regular, height));
            let rows = glyph.iter().flat_map(|glyph| glyph.rows());
            for (row, values) in rows.enumerate() {
                for (column, &value) in values.iter().enumerate() {
                    self.blend([left + column as f32, top + row as f32], color, value);
                }
            }
            left += advance;
        }
    }

    fn blend(&mut self, [x, y]: [f32; 2], color: Color, value: u8) {
        let (width, height) = (self.pixmap.width() as f32, self.pixmap.height() as f32);
        if value == 0 || x < 0.0 || y < 0.0 || x >= width || y >= height {
            return;
        }
        let index = (y as usize * self.pixmap.width() as usize + x as usize) * 4;
        let pixel = &mut self.pixmap.data_mut()[index..index + 3];
        for (own, new) in pixel.iter_mut().zip(color) {
            let (old, new, share) = (u32::from(*own), u32::from(new), u32::from(value));
            *own = ((old * (255 - share) + new * share) / 255) as u8;
        }
    }
}
