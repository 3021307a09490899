//! What a name says by itself: a semantic word (`ROOM_kitchen`, `kitchen-room`) or an IFC class (`IfcWall/Wall 1`).

use crate::semantic::Semantic;
pub(super) use crate::semantic::class_in;

/// Longest text that can be a semantic word, bytes; longer ones need no look.
const LONGEST_WORD: usize = 32;

/// Names of things that begin or end with the word for something else: a door's knob is no air. Modellers join
/// these words with `_` or `-` like tags, so they are looked up before the single words.
const COMPOUNDS: &[(&str, Semantic)] = &[
    ("DOOR_FRAME", Semantic::DoorLeaf),
    ("DOOR_GLASS", Semantic::DoorLeaf),
    ("DOOR_HANDLE", Semantic::DoorLeaf),
    ("DOOR_KNOB", Semantic::DoorLeaf),
    ("DOOR_PANEL", Semantic::DoorLeaf),
    ("WINDOW_GLASS", Semantic::WindowFrame),
    ("WINDOW_PANE", Semantic::WindowFrame),
    ("WINDOW_SASH", Semantic::WindowFrame),
    ("WINDOW_SILL", Semantic::WindowFrame),
    ("ROOM_DIVIDER", Semantic::Furniture),
    ("WINDOW_SEAT", Semantic::Furniture),
    ("CEILING_FAN", Semantic::Equipment),
    ("CEILING_LAMP", Semantic::Equipment),
    ("FLOOR_LAMP", Semantic::Equipment),
    ("WALL_LAMP", Semantic::Equipment),
    ("FLOOR_COVERING", Semantic::Covering),
    ("WALL_COVERING", Semantic::Covering),
    ("CURTAIN_WALL", Semantic::Glass),
];

/// The meaning that `name` gives by a semantic word: the whole name (a number may follow: `room12`, `WALL.001`), its
/// beginning up to one of `_ - . :`, or its end from one of these. A beginning goes before an end, and a word of two
/// parts (`DOOR_LEAF`) before a shorter one. Blanks separate nothing: `Chair living room` says nothing.
///
/// `DOOR`, `WINDOW`, `OPENING` and `EXTERIOR` at the beginning count in capitals only, unless a number is all that
/// follows: `door_bell` and `exterior-brick` are things, no air. And `EXTERIOR` gives way to a word at the end, since
/// an `EXTERIOR_WALL` is a wall.
pub(super) fn semantic_in(name: &str) -> Option<Semantic> {
    let name = without_number(name);
    if let Some(whole) = semantic_word(name) {
        return Some(whole);
    }
    let suffix = || {
        // Two separators from the end are enough: no word has more than two parts.
        let mut cuts = name.rmatch_indices(is_separator).map(|(at, _)| at + 1);
        let (short, long) = (cuts.next(), cuts.next());
        [long, short].into_iter().flatten().find_map(|at| semantic_word(&name[at..]))
    };
    let mut cuts = name.match_indices(is_separator).map(|(at, _)| at);
    let (short, long) = (cuts.next(), cuts.next());
    for at in [long, short].into_iter().flatten() {
        let word = &name[..at];
        match semantic_word(word) {
            None => {}
            Some(Semantic::Exterior) => {
                return suffix().or_else(|| is_in_capitals(word).then_some(Semantic::Exterior));
            }
            Some(Semantic::Door | Semantic::Window | Semantic::Opening) if !is_in_capitals(word) => {}
            found => return found,
        }
    }
    suffix()
}

fn is_separator(c: char) -> bool {
    matches!(c, '_' | '-' | '.' | ':')
}

/// `word` as a meaning, without a number behind it.
fn semantic_word(word: &str) -> Option<Semantic> {
    let word = without_number(word);
    if word.is_empty() || word.len() > LONGEST_WORD {
        return None;
    }
    let upper: String =
        word.chars().map(|c| if c == '-' || c == ' ' { '_' } else { c.to_ascii_uppercase() }).collect();
    match upper.as_str() {
        // Modelling programs give this name to a plain mesh.
        "GRID" => None,
        upper => match COMPOUNDS.iter().find(|row| row.0 == upper) {
            Some(row) => Some(row.1),
            None => upper.parse().ok(),
        },
    }
}

/// `text` without blanks around it and without the numbers at its end, as programs append them: `WALL.001`,
/// `room12`, `Room 2`, `ROOM_1_2`.
fn without_number(text: &str) -> &str {
    let mut text = text.trim();
    loop {
        let shorter = text.trim_end_matches(|c: char| c.is_ascii_digit());
        if shorter.len() == text.len() {
            return text;
        }
        text = shorter.trim_end_matches(|c: char| is_separator(c) || c == ' ' || c == '#');
    }
}

fn is_in_capitals(word: &str) -> bool {
    !word.chars().any(char::is_lowercase)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn says(name: &str, expected: &str) {
        let found = semantic_in(name).map_or("nothing", Semantic::name);
        assert_eq!(found, expected, "{name}");
    }

    #[test]
    fn whole_names_and_numbers() {
        says("ROOM", "ROOM");
        says("Room", "ROOM");
        says("room12", "ROOM");
        says("Room 12", "ROOM");
        says("ROOM_1_2", "ROOM");
        says("WALL.001", "WALL");
        says("door", "DOOR");
        says("Door.001", "DOOR");
        says("door leaf", "DOOR_LEAF");
        says("DOOR-LEAF.012", "DOOR_LEAF");
        says("window_frame3", "WINDOW_FRAME");
        says("floor", "GROUND");
        says("", "nothing");
        says("12", "nothing");
        says("...", "nothing");
        says("_", "nothing");
        says("Cube.001", "nothing");
        says("Grid.001", "nothing");
        says("UNKNOWN", "nothing");
        says("VOID_1", "nothing");
    }

    #[test]
    fn prefixes() {
        says("ROOM_kitchen", "ROOM");
        says("room_kitchen", "ROOM");
        says("ROOM:living room", "ROOM");
        says("ROOM12_kitchen.001", "ROOM");
        says("DOOR_room12_room13", "DOOR");
        says("DOOR_LEAF_12_oak", "DOOR_LEAF");
        says("wall-brick.003", "WALL");
        says("Furniture_Chair.002", "FURNITURE");
        says("ROOM_stair", "ROOM");
        says("WALL_Küche", "WALL");
    }

    #[test]
    fn suffixes() {
        says("kitchen-room", "ROOM");
        says("kitchen-room.001", "ROOM");
        says("kitchen_room12", "ROOM");
        says("north.door_leaf", "DOOR_LEAF");
        says("front-door", "DOOR");
        says("Küche_ROOM", "ROOM");
    }

    #[test]
    fn things_are_no_air() {
        says("door_bell", "nothing");
        says("door_knob.001", "DOOR_LEAF");
        says("window-sill-north", "WINDOW_FRAME");
        says("exterior-brick", "nothing");
        says("exterior_wall", "WALL");
        says("EXTERIOR_WALL_01", "WALL");
        says("EXTERIOR_court", "EXTERIOR");
        says("room-divider", "FURNITURE");
        says("floor-lamp", "EQUIPMENT");
    }

    #[test]
    fn free_text_says_nothing() {
        says("Chair living room", "nothing");
        says("wall mounted lamp", "nothing");
        says("Bedroom", "nothing");
        says("wallpaper", "nothing");
        says("Basic Wall:Exterior - Brick:130892", "nothing");
        says("DoorFrame", "nothing");
    }

    #[test]
    fn classes_at_the_beginning() {
        assert_eq!(class_in("IfcWall/Wall 1"), Some("IfcWall"));
        assert_eq!(class_in("IfcWall"), Some("IfcWall"));
        assert_eq!(class_in(" ifcdoor.003"), Some("ifcdoor"));
        assert_eq!(class_in("Ifc"), None);
        assert_eq!(class_in("Wall IfcWall"), None);
        assert_eq!(class_in("IfçWall"), None);
        assert_eq!(class_in(""), None);
    }
}
