//! A drawing as SVG.

use std::fmt::Write;

use super::drawing::{Anchor, Color, Drawing, Shape};

/// A drawing as an SVG file, at a scale of 1:100.
pub fn plan_svg(drawing: &Drawing) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_svg(&mut out, drawing);
    out
}

fn write_svg(out: &mut String, drawing: &Drawing) -> std::fmt::Result {
    let [lo, hi] = drawing.bounds;
    let (width, height) = (hi[0] - lo[0], hi[1] - lo[1]);
    writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.3} {height:.3}\" width=\"{:.1}mm\" height=\"{:.1}mm\" \
         font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\">",
        width * 10.0,
        height * 10.0
    )?;
    writeln!(out, "<rect width=\"{width:.3}\" height=\"{height:.3}\" fill=\"#ffffff\"/>")?;
    let place = |[x, y]: [f64; 2]| [x - lo[0], hi[1] - y];
    for shape in &drawing.shapes {
        match shape {
            Shape::Area { polygons, fill, stroke, title } => {
                write!(out, "<path fill=\"{}\"", hex(*fill))?;
                if let Some((color, width)) = stroke {
                    write!(
                        out,
                        " stroke=\"{}\" stroke-width=\"{width}\" stroke-linejoin=\"round\"",
                        hex(*color)
                    )?;
                }
                write!(out, " d=\"")?;
                for polygon in polygons {
                    path(out, polygon.iter().map(|p| place(*p)))?;
                    write!(out, "Z")?;
                }
                match title.as_str() {
                    "" => writeln!(out, "\"/>")?,
                    title => writeln!(out, "\"><title>{}</title></path>", escaped(title))?,
                }
            }
            Shape::Lines { lines, color, width } => {
                write!(
                    out,
                    "<path fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\" stroke-linecap=\"round\" d=\"",
                    hex(*color)
                )?;
                for line in lines {
                    path(out, line.iter().map(|p| place(*p)))?;
                }
                writeln!(out, "\"/>")?;
            }
            Shape::Text { at, size, anchor, color, text } => {
                let [x, y] = place(*at);
                let anchor = if *anchor == Anchor::Middle { " text-anchor=\"middle\"" } else { "" };
                writeln!(
                    out,
                    "<text x=\"{x:.3}\" y=\"{y:.3}\" font-size=\"{size:.3}\"{anchor} fill=\"{}\">{}</text>",
                    hex(*color),
                    escaped(text)
                )?;
            }
        }
    }
    writeln!(out, "</svg>")
}

/// Points to the millimetre.
fn path(out: &mut String, points: impl Iterator<Item = [f64; 2]>) -> std::fmt::Result {
    for (i, [x, y]) in points.enumerate() {
        write!(out, "{}{} {}", if i == 0 { "M" } else { "L" }, millimetres(x), millimetres(y))?;
    }
    Ok(())
}

fn millimetres(metres: f64) -> f64 {
    (metres * 1000.0).round() / 1000.0
}

fn hex([r, g, b]: Color) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn escaped(text: &str) -> String {
    // What XML does not allow at all is left out.
    let text: String =
        text.chars().filter(|c| !c.is_control() && !matches!(c, '\u{fffe}' | '\u{ffff}')).collect();
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
