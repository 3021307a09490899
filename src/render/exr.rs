//! Pictures as OpenEXR files, with all that the rays met.

use std::path::Path;

use enfilade_importers::Frame;
use exr::prelude::{
    AnyChannel, AnyChannels, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes, LineOrder,
    WritableImage,
};

use super::picture::{Picture, Pixel};
use super::write::{WriteError, write};

/// Writes a picture to the OpenEXR file `path`: one layer, compressed without loss, with these channels.
///
/// | channel | type | meaning |
/// |---|---|---|
/// | `R`, `G`, `B` | f32 | radiance, linear, not cut |
/// | `Z` | f32 | distance along the ray, in the unit of `frame`; infinite: escaped, NaN: in a solid |
/// | `N.X`, `N.Y`, `N.Z` | f32 | normal toward the eye, in the axes of `frame`; zeros: none |
/// | `element`, `room`, `cell`, `material` | u32 | index; 4294967295: none |
/// | `semantic` | u32 | number of the element's semantic, in pictures of faces of the face's kind; 4294967295: no element |
///
/// `frame` is the source's own, [`Scene::frame`](crate::Scene::frame), or `Frame::default()` for the internal one. The
/// file is there whole or not at all; one that was there is replaced. The same picture gives the same bytes.
///
/// # Errors
/// [`WriteError`], which names the file.
pub fn write_exr(picture: &Picture, path: &Path, frame: &Frame) -> Result<(), WriteError> {
    let floats = |name: &str, of: &dyn Fn(&Pixel) -> f32| {
        AnyChannel::new(name, FlatSamples::F32(picture.pixels().iter().map(of).collect()))
    };
    let numbers = |name: &str, of: &dyn Fn(&Pixel) -> u32| {
        AnyChannel::new(name, FlatSamples::U32(picture.pixels().iter().map(of).collect()))
    };
    let normal =
        |axis: usize| move |p: &Pixel| frame.direction_to_source(p.normal.map(f64::from))[axis] as f32;
    let channels = [
        floats("R", &|p| p.color[0]),
        floats("G", &|p| p.color[1]),
        floats("B", &|p| p.color[2]),
        floats("Z", &|p| frame.length_to_source(f64::from(p.depth)) as f32),
        floats("N.X", &normal(0)),
        floats("N.Y", &normal(1)),
        floats("N.Z", &normal(2)),
        numbers("element", &|p| p.element),
        numbers("room", &|p| p.room),
        numbers("cell", &|p| p.cell),
        numbers("material", &|p| p.material),
        numbers("semantic", &|p| p.semantic),
    ];
    let encoding = Encoding {
        compression: Compression::ZIP16,
        line_order: LineOrder::Increasing,
        ..Encoding::default()
    };
    let attributes = LayerAttributes {
        software_name: Some(concat!("enfilade ", env!("CARGO_PKG_VERSION")).into()),
        ..LayerAttributes::default()
    };
    let size = (picture.width() as usize, picture.height() as usize);
    let layer = Layer::new(size, attributes, encoding, AnyChannels::sort(channels.into_iter().collect()));
    let image = Image::from_layer(layer);
    // Not in parallel: that would start a pool of its own beside the caller's.
    write(path, |writer| image.write().non_parallel().to_buffered(writer).map_err(std::io::Error::other))
}
