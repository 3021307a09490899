//! Pictures: from where they are taken, what colours they show, and the files that they are written to.
//!
//! ```no_run
//! use enfilade::Scene;
//! use enfilade::render::{RenderOptions, auto_view, render, write_png};
//!
//! let scene = Scene::open("house.enf".as_ref())?;
//! let picture = render(&scene, &auto_view(&scene), &RenderOptions::default())?;
//! write_png(&picture, "house.png".as_ref())?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod camera;
mod camera_file;
mod choose;
mod color;
mod draw;
mod exr;
mod numbered;
mod picture;
mod png;
mod shade;
mod stand;
mod views;
mod way;
mod write;

pub use camera::{Camera, CameraError, Pinhole};
pub use camera_file::{CameraFileError, CameraLineError, parse_cameras, write_cameras};
pub use choose::PictureWay;
pub(crate) use color::to_srgb;
pub use color::{
    ColorMode, UnknownColorMode, cell_color, element_color, face_color, face_legend, ramp, room_color,
    semantic_color, semantic_legend,
};
pub use draw::{RenderError, RenderOptions, render};
pub use exr::write_exr;
pub use numbered::numbered;
pub use picture::{Picture, Pixel};
pub use png::{rgba_bytes, srgb_bytes, write_png, write_png_rgba};
pub(crate) use shade::passage;
pub use views::{auto_view, outside_view, room_views};
pub use way::walk;
pub use write::WriteError;
