//! What faces are called, by what they separate.

use enfilade_importers::Semantic;

use crate::format::FaceKind;
use crate::sew::Part;

impl FaceKind {
    /// What a face between air and matter is called. `matter` is the meaning of the element whose surface it is,
    /// `part` what it is of the air.
    pub fn of_surface(air: Semantic, matter: Semantic, part: Part, is_glass: bool) -> FaceKind {
        if is_glass {
            return FaceKind::Pane;
        }
        match (air, part, matter) {
            (Semantic::Door | Semantic::Window | Semantic::Opening, ..) => FaceKind::GatePost,
            (Semantic::Void, ..) => FaceKind::Lining,
            (Semantic::Exterior, Part::Floor, Semantic::Ground) => FaceKind::Terrain,
            (Semantic::Exterior, _, Semantic::Roof) => FaceKind::Roofing,
            (Semantic::Exterior, ..) => FaceKind::Facade,
            (_, Part::Floor, _) => FaceKind::Floor,
            (_, Part::Ceiling, _) => FaceKind::Ceiling,
            (_, Part::Side, _) => FaceKind::Wallpaper,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_are_called_by_what_they_separate() {
        use FaceKind::*;
        let of = |air, matter, facing| FaceKind::of_surface(air, matter, facing, false);
        let (down, up, aside) = (Part::Floor, Part::Ceiling, Part::Side);
        for (air, matter, facing, kind) in [
            (Semantic::Room, Semantic::Wall, aside, Wallpaper),
            (Semantic::Room, Semantic::Column, aside, Wallpaper),
            (Semantic::Room, Semantic::Ground, down, Floor),
            (Semantic::Room, Semantic::Wall, down, Floor),
            (Semantic::Room, Semantic::Roof, up, Ceiling),
            (Semantic::Stairwell, Semantic::Wall, aside, Wallpaper),
            (Semantic::Exterior, Semantic::Wall, aside, Facade),
            (Semantic::Exterior, Semantic::Ground, aside, Facade),
            (Semantic::Exterior, Semantic::Ground, down, Terrain),
            (Semantic::Exterior, Semantic::Roof, down, Roofing),
            (Semantic::Exterior, Semantic::Roof, aside, Roofing),
            (Semantic::Door, Semantic::Wall, aside, GatePost),
            (Semantic::Window, Semantic::Wall, down, GatePost),
            (Semantic::Opening, Semantic::Ground, aside, GatePost),
            (Semantic::Void, Semantic::Wall, aside, Lining),
        ] {
            assert_eq!(of(air, matter, facing), kind, "{air:?} {matter:?} {facing:?}");
        }
        assert_eq!(FaceKind::of_surface(Semantic::Room, Semantic::Wall, aside, true), Pane);
    }
}
