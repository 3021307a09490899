//! Floor plans: what a level plane through a storey cuts, drawn as architects read it.
//!
//! Walls are solid, rooms tinted and named with their floor area, doors and windows marked. A plan is drawn once, as a list of shapes in metres
//! ([`Drawing`]), and written as SVG, at a scale of 1:100, or as PNG. Up in it is the internal frame's y, which for glTF is the north of the
//! usual exporters (the source's -z).

mod cut;
mod drawing;
mod png;
mod sheet;
mod storeys;
mod svg;

pub use drawing::{Anchor, Color, Drawing, Shape};
pub use png::{PlanError, plan_png};
pub use sheet::{Mark, PlanOptions, floor_plan};
pub use storeys::{PlanStorey, plan_storeys};
pub use svg::plan_svg;
