//! Rays through a scene.

mod ray;

pub use ray::{Answer, Hit, NONE, Ray};
