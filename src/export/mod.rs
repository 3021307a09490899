//! The building for other programs: its graph as JSON or DOT, its faces as OBJ, its rooms and cells as glTF.

mod cells;
mod dot;
mod json;
mod obj;

pub use cells::cells_glb;
pub use dot::graph_dot;
pub use json::graph_json;
pub use obj::faces_obj;

use crate::graph::{Place, Side};
use crate::scene::Scene;

/// What the open is called where rooms have ids.
const EXTERIOR: &str = "EXTERIOR";
/// What voids are called there.
const VOID: &str = "VOID";

fn place_id(scene: &Scene, place: Place) -> &str {
    match place {
        Place::Room(room) => scene.room(room).element().id(),
        Place::Exterior => EXTERIOR,
        Place::Void(_) => VOID,
    }
}

fn side_id(scene: &Scene, side: Side) -> &str {
    match side {
        Side::Room(room) => scene.room(room).element().id(),
        Side::Exterior => EXTERIOR,
        Side::Void => VOID,
    }
}
