//! Writing hits: text, raw f64, npy; and the table of elements.

use std::io::{self, Write};

use clap::ValueEnum;
use enfilade::{Hit, NONE, Scene};
use npyz::WriterBuilder;

use super::Work;

/// What can be written for a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Field {
    /// Distance along the normalised direction; inf if it escapes, NaN if it starts in a solid.
    T,
    /// The point.
    X,
    /// The point.
    Y,
    /// The point.
    Z,
    /// The unit normal on the ray's side.
    Nx,
    /// The unit normal on the ray's side.
    Ny,
    /// The unit normal on the ray's side.
    Nz,
    /// Index of the element, or -1.
    Element,
    /// Number of the element's semantic.
    Semantic,
    /// Number of the kind of the face of the room or other air in which the ray ended: wallpaper, floor...; of detail, -1.
    Face,
    /// Index of the material, or -1.
    Material,
    /// Index of the cell, or -1.
    Cell,
    /// Index of the room, or -1.
    Room,
}

/// Numbers from this on are kinds of faces.
const FIRST_FACE: u32 = 64;

fn index(i: u32) -> f64 {
    if i == NONE { -1.0 } else { f64::from(i) }
}

impl Work<'_> {
    /// The fields of a hit as numbers, in the frame asked for.
    fn numbers<'a>(&'a self, hit: &'a Hit) -> impl Iterator<Item = f64> + 'a {
        let point = self.frame.point_to_source(hit.point);
        let normal = self.frame.direction_to_source(hit.normal);
        self.fields.iter().map(move |field| match field {
            Field::T => self.frame.length_to_source(hit.t),
            Field::X => point[0],
            Field::Y => point[1],
            Field::Z => point[2],
            Field::Nx => normal[0],
            Field::Ny => normal[1],
            Field::Nz => normal[2],
            Field::Element => index(hit.element),
            // With kinds of faces asked for, hits tell these.
            Field::Semantic if hit.element != NONE => {
                f64::from(self.scene.element(hit.element).semantic().number())
            }
            Field::Semantic => f64::from(hit.semantic),
            Field::Face => index(Some(hit.semantic).filter(|&number| number >= FIRST_FACE).unwrap_or(NONE)),
            Field::Material => index(hit.material),
            Field::Cell => index(hit.cell),
            Field::Room => index(hit.room),
        })
    }
}

pub fn write_f64(hits: &[Hit], work: &Work<'_>, out: &mut dyn Write) -> io::Result<()> {
    let mut bytes = Vec::with_capacity(hits.len() * work.fields.len() * 8);
    for hit in hits {
        bytes.extend(work.numbers(hit).flat_map(f64::to_le_bytes));
    }
    out.write_all(&bytes)
}

/// The names of the columns, as a comment.
pub fn write_heading(fields: &[Field], out: &mut dyn Write) -> io::Result<()> {
    let names: Vec<String> =
        fields.iter().filter_map(|f| f.to_possible_value()).map(|v| v.get_name().to_owned()).collect();
    writeln!(out, "# {}", names.join(" "))
}

/// A row a ray; numbers as short as they can be read back exactly.
pub fn write_text(hits: &[Hit], work: &Work<'_>, out: &mut dyn Write) -> io::Result<()> {
    for hit in hits {
        for (i, number) in work.numbers(hit).enumerate() {
            let blank = if i > 0 { " " } else { "" };
            // Not "-0".
            write!(out, "{blank}{}", number + 0.0)?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// Rows of `columns` little-endian f64 as an .npy file.
pub fn write_npy(rows: &[u8], columns: usize, out: &mut dyn Write) -> io::Result<()> {
    let numbers = rows.as_chunks::<8>().0;
    let mut writer = npyz::WriteOptions::new()
        .default_dtype()
        .shape(&[(numbers.len() / columns.max(1)) as u64, columns as u64])
        .writer(out)
        .begin_nd()?;
    writer.extend(numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)))?;
    writer.finish()
}

/// The table of elements, as CSV.
pub fn write_elements(scene: &Scene, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "index,id,name,class,semantic,storey")?;
    for e in scene.elements() {
        let texts = [e.id(), e.name(), e.class(), e.semantic().name(), e.storey()].map(quoted);
        writeln!(out, "{},{}", e.index(), texts.join(","))?;
    }
    Ok(())
}

/// A CSV field, in quotes where it needs them (RFC 4180).
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
