//! `enfilade trace`: rays in, hits out, as a filter.

mod hits;
mod rays;

use std::cell::RefCell;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use enfilade::importers::Frame;
use enfilade::{Costs, Hit, Ray, Scene, Want};

use super::doors::Doors;
use super::failure::{Failure, Outcome};
use super::hide::Hide;
use super::input::{FrameName, Reading, Resources};
use super::output;
use hits::Field;

/// Trace rays: read them from a file or stdin, write what they meet.
///
/// A ray is six numbers, ox oy oz dx dy dz; with --segments eight, tmin and tmax after them. Directions need not have
/// unit length; t, tmin and tmax count the frame's unit of length. A ray that escapes has t = inf and element -1; one
/// that starts inside a solid has t = NaN and that solid's element.
#[derive(Args)]
#[command(after_help = "\
Examples:
  enfilade trace house.enf --rays rays.txt --stats > hits.txt
  echo '2 1.6 -3 1 0 0' | enfilade trace house.enf --rays -
  enfilade trace house.enf --rays rays.f64 --in f64 --out f64 --fields t,element -o hits.f64
  enfilade trace house.glb --rays rays.npy --out npy -o hits.npy --elements elements.csv
  enfilade trace house.enf --rays rays.npy --closed doors --open windows

Binary records are little-endian, one row of numbers after the other; output rows hold the fields in the order given,
all as f64. Semantic numbers are listed in docs/FORMAT.md, numbers of faces in docs/TOPOLOGY.md.")]
pub struct Arguments {
    /// The scene (.enf), or a model, which is compiled on the fly.
    scene: PathBuf,
    /// Where the rays are; - for stdin.
    #[arg(long, value_name = "FILE")]
    rays: PathBuf,
    /// Format of the rays; by default npy for names in .npy, else text.
    #[arg(long = "in", value_enum, value_name = "FORMAT")]
    input: Option<rays::Form>,
    /// Format of the hits; by default npy for names in .npy, else text.
    #[arg(long = "out", value_enum, value_name = "FORMAT")]
    out: Option<OutForm>,
    /// Rays have tmin and tmax too.
    #[arg(long)]
    segments: bool,
    /// What to write for each ray.
    #[arg(
        long,
        value_enum,
        value_delimiter = ',',
        default_value = "t,x,y,z,nx,ny,nz,element,semantic,cell,room"
    )]
    fields: Vec<Field>,
    /// The frame of rays and hits.
    #[arg(long, value_enum, default_value = "source")]
    frame: FrameName,
    /// Where to write the hits; by default stdout.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write a table of the elements: index, id, name, class, semantic, storey.
    #[arg(long, value_name = "FILE.csv")]
    elements: Option<PathBuf>,
    /// Tell on stderr what it took: cells crossed, boxes opened, triangles tested, and what was skipped. Every ray is traced once more.
    #[arg(long)]
    stats: bool,
    #[command(flatten)]
    doors: Doors,
    #[command(flatten)]
    hide: Hide,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    resources: Resources,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum OutForm {
    F64,
    Text,
    Npy,
}

/// Rays that are read, traced and written at a time.
const CHUNK: usize = 1 << 16;

pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    arguments.resources.in_pool(|| stream(arguments))?
}

fn stream(arguments: &Arguments) -> Result<Outcome, Failure> {
    let mut scene = arguments.reading.scene(&arguments.scene, &arguments.resources)?;
    arguments.doors.apply(&mut scene, &arguments.resources)?;
    arguments.hide.apply(&mut scene)?;
    let frame = match arguments.frame {
        FrameName::Source => scene.frame(),
        FrameName::Internal => Frame::default(),
    };
    if let Some(path) = &arguments.elements {
        output::write(Some(path), |out| hits::write_elements(&scene, out))?;
    }
    let is_npy = |path: Option<&Path>| path.is_some_and(|p| p.extension().is_some_and(|e| e == "npy"));
    let form = arguments.input.unwrap_or(if is_npy(Some(&arguments.rays)) {
        rays::Form::Npy
    } else {
        rays::Form::Text
    });
    let out_form = arguments.out.unwrap_or(if is_npy(arguments.output.as_deref()) {
        OutForm::Npy
    } else {
        OutForm::Text
    });
    let source: Box<dyn BufRead> = if arguments.rays == Path::new("-") {
        Box::new(std::io::stdin().lock())
    } else {
        let open = std::fs::File::open(&arguments.rays);
        Box::new(BufReader::new(
            open.map_err(|e| Failure::input(format!("{}: {e}", arguments.rays.display())))?,
        ))
    };
    let name =
        if arguments.rays == Path::new("-") { "stdin".into() } else { arguments.rays.display().to_string() };
    let mut rays = rays::Reader::new(source, form, arguments.segments, &name)?;
    if rays.is_single_precision() && frame.has_offset() {
        let [x, y, z] = frame.offset;
        return Err(Failure::input(format!(
            "{name}: f32 rays are too coarse for a model this far from its origin (offset {x} {y} {z} m): give f64 \
             rays, or use --frame internal"
        )));
    }
    let costs = arguments.stats.then(|| RefCell::new(Costs::default()));
    let work = Work { scene: &scene, frame, fields: &arguments.fields, costs: costs.as_ref() };
    // The reader's errors pass through the writer's: kept aside.
    let mut failed = None;
    let result = output::write(arguments.output.as_deref(), |out| {
        let mut outcome = || match out_form {
            OutForm::Npy => work.to_npy(&mut rays, out, arguments.resources.max_memory),
            OutForm::F64 => work.each_chunk(&mut rays, |hits| hits::write_f64(hits, &work, out)),
            OutForm::Text => {
                hits::write_heading(&arguments.fields, out)?;
                work.each_chunk(&mut rays, |hits| hits::write_text(hits, &work, out))
            }
        };
        outcome().map_err(|error| match error {
            StreamError::Output(error) => error,
            StreamError::Input(failure) => {
                failed = Some(failure);
                std::io::Error::other("the rays could not be read")
            }
        })
    });
    if let Some(failure) = failed {
        return Err(failure);
    }
    result?;
    if let Some(costs) = costs {
        eprintln!("{}", costs.into_inner());
    }
    Ok(Outcome::Fine)
}

/// What stopped a stream of rays.
pub enum StreamError {
    Input(Failure),
    Output(std::io::Error),
}

impl From<std::io::Error> for StreamError {
    fn from(error: std::io::Error) -> StreamError {
        StreamError::Output(error)
    }
}

/// What is done with each chunk of rays.
pub struct Work<'a> {
    scene: &'a Scene,
    frame: Frame,
    fields: &'a [Field],
    /// What it took, if that is asked for.
    costs: Option<&'a RefCell<Costs>>,
}

impl Work<'_> {
    fn each_chunk(
        &self,
        rays: &mut rays::Reader,
        mut write: impl FnMut(&[Hit]) -> std::io::Result<()>,
    ) -> Result<(), StreamError> {
        let has = |field| self.fields.contains(&field);
        let mut want = Want::LEAST;
        (want.room, want.face) = (has(Field::Room), has(Field::Face));
        let (mut chunk, mut hits): (Vec<Ray>, Vec<Hit>) = (Vec::new(), Vec::new());
        loop {
            chunk.clear();
            rays.read(CHUNK, &mut chunk).map_err(StreamError::Input)?;
            if chunk.is_empty() {
                return Ok(());
            }
            for ray in &mut chunk {
                ray.origin = self.frame.point_to_internal(ray.origin);
                ray.direction = self.frame.direction_to_internal(ray.direction);
                ray.tmin = self.frame.length_to_internal(ray.tmin);
                ray.tmax = self.frame.length_to_internal(ray.tmax);
            }
            hits.clear();
            hits.resize(chunk.len(), Hit::ESCAPED);
            self.scene.trace_many(&chunk, &mut hits, want);
            if let Some(costs) = self.costs {
                costs.borrow_mut().merge(&self.scene.costs(&chunk, want));
            }
            write(&hits)?;
        }
    }

    /// The header of an .npy file holds the number of rows, so that they are counted before they are written.
    fn to_npy(
        &self,
        rays: &mut rays::Reader,
        out: &mut dyn Write,
        max_memory: u64,
    ) -> Result<(), StreamError> {
        let mut rows: Vec<u8> = Vec::new();
        self.each_chunk(rays, |hits| {
            if rows.len() as u64 + (hits.len() * self.fields.len() * 8) as u64 > max_memory {
                return Err(std::io::Error::other(
                    "more hits than --max-memory holds: write --out f64 instead",
                ));
            }
            hits::write_f64(hits, self, &mut rows)
        })?;
        hits::write_npy(&rows, self.fields.len(), out)?;
        Ok(())
    }
}
