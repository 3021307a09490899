//! Random buildings of which something was not right once, made as small as they would go.

use enfilade::arbitrary::{Assembly, Defect, Finding, Piece, Relation, Shape};
use enfilade::importers::Semantic::{self, Door, Room, Stairwell, Wall};
use enfilade::partition::{NotCarved, PartitionOptions, partition};
use enfilade::sew::sew;

use super::{findings, made};

/// Half a lattice unit.
const HALF_UNIT: f64 = 0.5 / 65536.0;

/// Nothing is found whatever points and rays are tried, of some that showed it.
fn is_right(pieces: Vec<Piece>) {
    is_right_from(pieces, 0);
}

/// The first of those points and rays is told.
fn is_right_from(pieces: Vec<Piece>, first: u64) {
    let assembly = Assembly { pieces, scale: 1.0, at: [0.0; 3] };
    for seed in first..first + 40 {
        let found = findings(&assembly, seed);
        assert!(found.is_empty(), "{seed}: {}", found.iter().map(Finding::to_string).collect::<String>());
    }
}

/// Stands at the origin.
fn piece(semantic: Semantic, shape: Shape, size: [f64; 3]) -> Piece {
    let (at, turn, relation, defect) = ([0.0; 3], [0.0; 2], Relation::Free, Defect::None);
    Piece { semantic, shape, size, at, turn, relation, other: 0, axis: 0, defect }
}

/// Stands to the `other`-th before it, counted from 0.
fn beside(piece: Piece, relation: Relation, other: usize, axis: usize) -> Piece {
    Piece { relation, other, axis, ..piece }
}

/// A cube of a quarter of a metre.
fn cube() -> Piece {
    piece(Wall, Shape::Box, [0.25; 3])
}

/// Slivers of four units beside a turned wall, of points each moved by nearly as much: wider than a fixed limit.
#[test]
fn slivers_are_as_wide_as_rounding_makes_them() {
    let wedge = piece(Room, Shape::Wedge, [0.75, 0.1, 4.0]);
    is_right(vec![
        Piece {
            at: [0.6000000000000001, 0.0, 2.8000000000000003],
            turn: [82.09403757230912, 0.0],
            relation: Relation::Coplanar(HALF_UNIT, 0.0),
            ..wedge
        },
        beside(cube(), Relation::Nested, 0, 0),
        beside(cube(), Relation::Gap(HALF_UNIT), 0, 0),
        beside(piece(Wall, Shape::LyingU, [0.25; 3]), Relation::Face, 1, 1),
        Piece {
            at: [0.0, 0.0, 0.5],
            ..piece(Wall, Shape::Box, [0.25, 3.4167350060508572, 4.353520581902193])
        },
    ]);
}

/// A long sliver beside a room that leans by 45 degrees was told near it by the middle of its height: its end, a metre
/// above the room, became the room's.
#[test]
fn slivers_join_rooms_only_where_they_are_near() {
    let turn = [1e-6f64.to_degrees(), 0.0];
    let wedge = piece(Wall, Shape::Wedge, [0.25, 0.25, 2.9000000000000004]);
    let gable = piece(Door, Shape::SteepGable(0.0001), [0.25, 1.0, 3.966944116473175]);
    is_right(vec![
        Piece { turn, ..piece(Wall, Shape::Box, [0.25, 0.25, 0.1]) },
        Piece {
            at: [5.1000000000000005, 4.6000000000000005, 5.894744063157812],
            turn,
            relation: Relation::Coplanar(HALF_UNIT, 0.0),
            ..wedge
        },
        Piece { at: [0.0, 3.5, 0.25], turn: [0.0, 45.0], ..gable },
        cube(),
        beside(piece(Room, Shape::Steep(0.0001), [0.1, 0.25, 0.25]), Relation::Face, 1, 0),
        cube(),
        cube(),
    ]);
}

/// Where planes cross over a side, what lies below its next face is not bounded by the straight line between the higher of
/// their ends: faces were left out.
#[test]
fn sides_have_all_faces_where_planes_cross() {
    let wedge = piece(Room, Shape::Wedge, [2.75, 1.75, 3.5]);
    let slab = piece(Wall, Shape::Box, [4.753499618874762, 3.1, 0.25]);
    is_right(vec![
        Piece { at: [3.0, 4.25, 4.57475795773778], relation: Relation::Coplanar(0.0005, 0.0), ..wedge },
        beside(piece(Room, Shape::Tilted(0.0001), [0.25; 3]), Relation::Nested, 0, 0),
        beside(piece(Wall, Shape::Gable, [0.25; 3]), Relation::NestedFace, 7, 0),
        Piece { at: [0.8, 0.5, 0.0], ..piece(Room, Shape::Box, [0.25; 3]) },
        Piece { at: [2.2, 1.75, 3.75], turn: [131.68053475853242, 90.0 + 1e-6f64.to_degrees()], ..slab },
    ]);
}

/// The foot of a face that leans by two millimetres over two and a half metres hangs four millimetres below the solid, where
/// its crossing with the level below is rounded by a fifth of a unit.
#[test]
fn steep_faces_hang_by_what_their_foot_is_rounded() {
    let wedge = piece(Door, Shape::Wedge, [0.1, 3.7, 2.5]);
    let wall = |size| piece(Wall, Shape::Box, size);
    is_right_from(
        vec![
            Piece {
                at: [0.0, 0.75, 1.8962907945798717],
                relation: Relation::Coplanar(HALF_UNIT, 0.0),
                ..wedge
            },
            beside(wall([0.25, 4.45877204538056, 0.25]), Relation::Gap(7.0 * HALF_UNIT), 0, 1),
            Piece { at: [0.0, 2.681513572433975, 4.842817157932267], ..wall([0.25, 0.1, 2.2]) },
            beside(piece(Stairwell, Shape::Box, [0.25; 3]), Relation::Twin, 9, 0),
            Piece { at: [0.0, 2.260311728503938, 0.5], ..cube() },
            Piece { at: [0.0, 0.7000000000000001, 0.5], ..piece(Door, Shape::Box, [0.25; 3]) },
            beside(
                piece(Wall, Shape::SteepGable(0.002), [0.25, 0.7928853882029839, 2.5]),
                Relation::Vertex,
                10,
                0,
            ),
            beside(piece(Door, Shape::Box, [3.0, 0.5, 3.75]), Relation::Vertex, 10, 0),
        ],
        4796201764628529387,
    );
}

/// A cell without height from a corner on that lies on both of its planes: the corner was not taken for an end of that part, and its
/// floor and its ceiling were left apart at a place between.
#[test]
fn parts_without_height_may_start_at_corners() {
    let wedge = piece(Wall, Shape::Wedge, [4.845013442432301, 1.8, 2.9578124347510304]);
    let assembly = Assembly {
        pieces: vec![
            Piece {
                at: [1.4813775744962714, 0.25, 0.0],
                turn: [0.0, 27.3591248052402],
                ..piece(Wall, Shape::Box, [4.674000610809422, 2.5, 0.25])
            },
            Piece { at: [0.0, 0.0, 4.75], ..piece(Wall, Shape::Box, [0.25, 0.1, 0.25]) },
            Piece {
                at: [0.0, 2.5, 2.9000000000000004],
                turn: [0.0, 45.0],
                relation: Relation::Coplanar(7.0 * HALF_UNIT, 0.0),
                ..wedge
            },
        ],
        scale: 1.0,
        at: [0.0; 3],
    };
    assert!(sew(&made(&assembly.model())).is_ok());
}

/// The ends of a beam that leans by 45 degrees rise by nearly a millimetre and are level: by their corners its sides are cut at a slab's
/// level 0.76 mm from where their planes are.
#[test]
fn sides_are_cut_by_corners_that_have_moved() {
    let wall = |size| piece(Wall, Shape::Box, size);
    let beam = piece(Wall, Shape::L, [0.25, 0.23374990556477582, 4.0]);
    let pieces = vec![
        Piece { at: [0.0, 0.0, 2.8026924730040683], turn: [0.0, 45.0], ..beam },
        Piece { at: [0.0, 0.0, 4.25], ..piece(Wall, Shape::Steep(0.0001), [1.5, 1.75, 0.7000000000000001]) },
        cube(),
        beside(wall([0.25, 0.5, 0.25]), Relation::Gap(HALF_UNIT), 1, 1),
        Piece { at: [0.0, 0.0, 3.5376479993978225], ..wall([0.1, 0.25, 4.20264045075232]) },
        beside(piece(Wall, Shape::L, [0.25; 3]), Relation::Overlap, 0, 0),
    ];
    let assembly = Assembly { pieces, scale: 0.02, at: [0.0; 3] };
    let found = findings(&assembly, 0);
    assert!(found.is_empty(), "{}", found.iter().map(Finding::to_string).collect::<String>());
}

/// A room two kilometres from most of the building has no cells, and the report says so.
#[test]
fn rooms_far_off_are_told() {
    let wall = |x: f64| piece(Wall, Shape::Box, [x, 0.25, 0.25]);
    let room = piece(Room, Shape::Box, [3.0, 0.25, 0.25]);
    let pieces = vec![
        cube(),
        Piece { at: [1.5, 0.0, 0.0], ..wall(3.7) },
        beside(wall(4.317121992519579), Relation::Vertex, 2, 0),
        beside(wall(3.5), Relation::Face, 9, 0),
        cube(),
        cube(),
        cube(),
        Piece { defect: Defect::TwoComponents, ..beside(room, Relation::Edge, 3, 0) },
        wall(0.1),
    ];
    let assembly = Assembly { pieces, scale: 100.0, at: [0.0; 3] };
    let (_, report) = partition(&assembly.model(), &PartitionOptions::default()).unwrap();
    assert_eq!(report.not_carved_elements, [("Room_7".to_owned(), NotCarved::Far)]);
    for seed in 0..40 {
        let found = findings(&assembly, seed);
        assert!(found.is_empty(), "{seed}: {}", found.iter().map(Finding::to_string).collect::<String>());
    }
}

/// Strips of matter that rounding made shut a gap from the open; it is exterior when they are air again.
#[test]
fn what_matter_given_back_opens_is_exterior() {
    let turned = piece(Wall, Shape::Box, [0.30000000000000004, 3.4000000000000004, 3.0]);
    is_right(vec![
        Piece { at: [0.0, 1.75, 2.5], ..piece(Wall, Shape::Box, [0.8807457780066534, 2.5, 2.25]) },
        Piece {
            at: [2.9000000000000004, 3.77625753076991, 3.1344475600783634],
            turn: [88.94291330168257, 0.0],
            ..turned
        },
        beside(piece(Wall, Shape::Sheared, [1.4323815052653341, 0.25, 0.25]), Relation::Gap(-0.0005), 5, 0),
        Piece {
            at: [0.0, 0.0, 1.5],
            ..piece(Wall, Shape::Box, [0.75, 1.9000000000000001, 2.61415213713929])
        },
    ]);
}
