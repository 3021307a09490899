//! The scenes: each has one thing that is hard on numbers.

use enfilade_importers::{Frame, ImportError, Material, Model, ModelBuilder, NewElement, Semantic};
use glam::{DQuat, DVec3};

use super::shape::{Shape, model};
use crate::generate::{HouseOptions, Style, house, specimens};
use crate::splitmix::SplitMix64;

/// A scene to send hard rays through.
pub struct Trial {
    /// What is hard about it.
    pub name: String,
    /// The tolerance to compile it with, metres.
    pub tolerance: f64,
    /// A box of air, and of what stands in it, that is closed all around: no ray from within may escape. In the trial's own frame, Z up, metres: the
    /// model's has an offset taken off where that is long.
    pub inside: Option<[[f64; 3]; 2]>,
    /// Of as many rays as go through each other trial, one in so many goes through this, since rays take much longer in it.
    pub one_in: u64,
    make: Box<dyn Fn() -> Result<Model, ImportError> + Send + Sync>,
}

/// The usual tolerance, metres.
const TOLERANCE: f64 = 1e-3;

/// How thick walls and slabs of closed rooms are, metres.
const WALL: f64 = 0.2;

type Shapes = Vec<(Semantic, Shape)>;

impl Trial {
    /// Its model.
    ///
    /// # Errors
    /// Those of [`ModelBuilder`](enfilade_importers::ModelBuilder): the model is over the usual limits.
    pub fn model(&self) -> Result<Model, ImportError> {
        (self.make)()
    }

    /// The box from which no ray may escape, in the frame of its model.
    pub fn inside_of(&self, model: &Model) -> Option<[[f64; 3]; 2]> {
        self.inside.map(|corners| corners.map(|corner| model.frame.point_to_internal(corner)))
    }

    fn of_model(
        name: String,
        make: impl Fn() -> Result<Model, ImportError> + Send + Sync + 'static,
    ) -> Trial {
        Trial { name, tolerance: TOLERANCE, inside: None, one_in: 1, make: Box::new(make) }
    }

    fn closed(
        name: &str,
        inside: [[f64; 3]; 2],
        shapes: impl Fn() -> Shapes + Send + Sync + 'static,
    ) -> Trial {
        let inside = Some(inside);
        Trial { inside, ..Trial::of_model(name.to_owned(), move || model(&shapes())) }
    }

    fn with_tolerance(self, tolerance: f64) -> Trial {
        Trial { tolerance, ..self }
    }
}

/// All trials; those of the long mode, too, if `long`. `seed` turns what is turned by chance.
pub fn trials(long: bool, seed: u64) -> Vec<Trial> {
    let mut all = Vec::new();
    let scales: &[i32] = if long { &[-3, -2, -1, 1, 2, 3, 4, 5, 6] } else { &[-3, 1, 3, 6] };
    for &power in scales {
        let scale = 10f64.powi(power);
        let trial = Trial::of_model(format!("scaled-1e{power}"), move || placed(move |p| p * scale));
        all.push(trial.with_tolerance((TOLERANCE * scale).min(0.1)));
    }
    for power in if long { 1..=7 } else { 7..=7 } {
        let far = 10f64.powi(power);
        // By no round number: that would leave coordinates round.
        let by = DVec3::new(0.770_123_456_789, -0.61, 0.183_333_333) * far;
        all.push(Trial::of_model(format!("moved-1e{power}"), move || rebuilt(&placed(move |p| p + by)?)));
    }
    let mut random = SplitMix64::new(seed);
    for number in 0..if long { 6 } else { 2 } {
        let angle = random.between(0.0, std::f64::consts::TAU);
        let turn = DQuat::from_rotation_z(angle);
        all.push(Trial::of_model(format!("turned-{number}"), move || placed(move |p| turn * p)));
        let axis = DVec3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), 0.3).normalize();
        let tilt = DQuat::from_axis_angle(axis, angle);
        all.push(Trial::of_model(format!("tilted-{number}"), move || placed(move |p| tilt * p)));
    }
    all.extend([
        // Hundreds of triangles come near many of these rays, each of which is to be judged.
        Trial { one_in: 4, ..Trial::closed("slivers", ROOM, slivers) },
        // Less than walls are thick: else a ray may be taken for one beside it that misses them.
        Trial::closed("thin-walls", ROOM, thin_walls).with_tolerance(1e-4),
        Trial { one_in: 4, ..Trial::closed("round-1000", [[-2.1, -2.1, 0.0], [2.1, 2.1, 2.5]], round) },
        Trial::closed("near-coplanar", ROOM, near_coplanar).with_tolerance(1e-5),
        Trial::closed("near-vertical", ROOM, near_vertical),
        Trial::closed("flat-cells", ROOM, flat_cells).with_tolerance(1e-5),
        Trial::closed("needles", ROOM, move || needles(seed)),
        Trial::closed("nested", [[0.0; 3], [9.0, 9.0, 9.0]], nested),
        // Ten kilometres, and rays that cross ten thousand cells, by each way.
        if long { Trial { one_in: 256, ..corridor(5000) } } else { corridor(100) },
    ]);
    let usual = || house(&HouseOptions::default());
    for (name, style) in [
        ("house", Style::exact()),
        ("house-cad", Style::cad(seed)),
        ("house-damaged", Style::damage(0.3, seed)),
    ] {
        all.push(Trial::of_model(name.to_owned(), move || usual().export(&style).to_model()));
    }
    all
}

/// Three rooms on a corridor, with doors and windows, with every corner elsewhere.
fn placed(place: impl Fn(DVec3) -> DVec3) -> Result<Model, ImportError> {
    let plain = specimens().into_iter().find(|specimen| specimen.name == "plain");
    let mut model = match plain {
        Some(plain) => plain.building.export(&plain.style).to_model()?,
        None => house(&HouseOptions::default()).to_model()?,
    };
    for p in model.elements.iter_mut().flat_map(|element| &mut element.mesh.positions) {
        *p = place(DVec3::from(*p)).to_array();
    }
    model.lights.clear();
    model.cameras.clear();
    Ok(model)
}

/// The model as one is that has its coordinates in the file: whatever is done with far ones is done.
fn rebuilt(model: &Model) -> Result<Model, ImportError> {
    let mut builder = ModelBuilder::new("far", Frame::default());
    let material = builder.material(Material::default());
    for old in &model.elements {
        let element = builder.element(NewElement { name: old.name.clone(), ..NewElement::default() })?;
        builder.semantic(element, old.semantic);
        for triangle in 0..old.mesh.triangles.len() {
            builder.triangle(element, old.mesh.corners(triangle), material)?;
        }
    }
    builder.finish()
}

/// The room of most trials.
const ROOM: [[f64; 3]; 2] = [[0.0; 3], [4.0, 3.0, 2.5]];

/// What encloses a box of air: floor, ceiling, four walls, and the label of the room.
fn room([lo, hi]: [[f64; 3]; 2]) -> Shapes {
    let [[x0, y0, z0], [x1, y1, z1]] = [lo.map(|c| c - WALL), hi.map(|c| c + WALL)];
    let cuboid = |semantic: Semantic, lo: [f64; 3], hi: [f64; 3]| (semantic, Shape::cuboid(lo, hi));
    vec![
        cuboid(Semantic::Ground, [x0, y0, z0], [x1, y1, lo[2]]),
        cuboid(Semantic::Ceiling, [x0, y0, hi[2]], [x1, y1, z1]),
        cuboid(Semantic::Wall, [x0, y0, lo[2]], [lo[0], y1, hi[2]]),
        cuboid(Semantic::Wall, [hi[0], y0, lo[2]], [x1, y1, hi[2]]),
        cuboid(Semantic::Wall, [lo[0], y0, lo[2]], [hi[0], lo[1], hi[2]]),
        cuboid(Semantic::Wall, [lo[0], hi[1], lo[2]], [hi[0], y1, hi[2]]),
        cuboid(Semantic::Room, lo, hi),
    ]
}

/// Its floor is cut into slivers of 0.1 mm.
fn slivers() -> Shapes {
    let mut shapes = room(ROOM);
    let cuts: Vec<f64> = std::iter::once(-WALL)
        .chain((0..=400).map(|i| 1.0 + 1e-4 * f64::from(i)))
        .chain([ROOM[1][0] + WALL])
        .collect();
    let ([front, bottom], [back, top]) = ([-WALL, -WALL], [ROOM[1][1] + WALL, 0.0]);
    let mut floor = Shape::default();
    for pair in cuts.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        floor.quad([[a, front, top], [b, front, top], [b, back, top], [a, back, top]]);
        floor.quad([[a, front, bottom], [a, back, bottom], [b, back, bottom], [b, front, bottom]]);
        floor.quad([[a, front, bottom], [b, front, bottom], [b, front, top], [a, front, top]]);
        floor.quad([[a, back, bottom], [a, back, top], [b, back, top], [b, back, bottom]]);
    }
    for (x, is_last) in [(cuts[0], false), (cuts[cuts.len() - 1], true)] {
        let mut end = [[x, front, bottom], [x, front, top], [x, back, top], [x, back, bottom]];
        if is_last {
            end.reverse();
        }
        floor.quad(end);
    }
    shapes[0].1 = floor;
    shapes
}

/// Walls of 1 mm between parts of a room.
fn thin_walls() -> Shapes {
    let (mut shapes, [_, [_, y, z]]) = (room(ROOM), ROOM);
    for x in [1.0, 2.0, 3.0] {
        shapes.push((Semantic::Wall, Shape::cuboid([x, 0.0, 0.0], [x + 1e-3, y, z])));
    }
    shapes
}

/// A room in a wall of a thousand facets.
fn round() -> Shapes {
    const SIDES: usize = 1000;
    let (inner, outer, low, high) = (3.0, 3.2, 0.0, 2.5);
    let at = |i: usize, radius: f64, z: f64| {
        let angle = std::f64::consts::TAU * (i % SIDES) as f64 / SIDES as f64;
        [radius * angle.cos(), radius * angle.sin(), z]
    };
    let mut wall = Shape::default();
    for i in 0..SIDES {
        let ring = |radius: f64, z: f64| [at(i, radius, z), at(i + 1, radius, z)];
        let ([a, b], [c, d]) = (ring(inner, low), ring(inner, high));
        let ([e, f], [g, h]) = (ring(outer, low), ring(outer, high));
        for corners in [[b, a, c, d], [e, f, h, g], [a, b, f, e], [d, c, g, h]] {
            wall.quad(corners);
        }
    }
    vec![
        (Semantic::Wall, wall),
        (Semantic::Ground, Shape::prism(SIDES, outer, low - WALL, low)),
        (Semantic::Ceiling, Shape::prism(SIDES, outer, high, high + WALL)),
        (Semantic::Room, Shape::prism(SIDES, inner, low, high)),
    ]
}

/// One wall is of parts that stand out of each other, by 1e-3 to 1e-12 m.
fn near_coplanar() -> Shapes {
    let (mut shapes, [_, [_, y, z]]) = (room(ROOM), ROOM);
    for (i, power) in (-12..=-3).enumerate() {
        let (x, out) = (0.2 + 0.35 * i as f64, 10f64.powi(power));
        shapes.push((Semantic::Wall, Shape::cuboid([x, y - out, 0.0], [x + 0.35, y, z])));
        // And boards on the floor, which enclose nothing.
        let mut board = Shape::default();
        board.quad([[x, 0.5, out], [x + 0.3, 0.5, out], [x + 0.3, 1.5, out], [x, 1.5, out]]);
        shapes.push((Semantic::Covering, board));
    }
    shapes
}

/// Posts that lean by 1e-12 to 1e-2.
fn near_vertical() -> Shapes {
    let (mut shapes, [_, [_, _, z]]) = (room(ROOM), ROOM);
    for (i, power) in (-12..=-2).enumerate() {
        let (x, tilt) = (0.2 + 0.33 * i as f64, 10f64.powi(power));
        let post = Shape::cuboid([x, 1.0, 0.0], [x + 0.1, 2.0, z]);
        let leaning = post.map(|[x, y, z]| [x + tilt * z, y - tilt * z, z]);
        shapes.push((Semantic::Column, leaning));
    }
    shapes
}

/// Slabs over each other with 4 mm to a micrometre of air between them.
fn flat_cells() -> Shapes {
    let mut shapes = room(ROOM);
    let mut z = 0.1;
    for bits in [8, 10, 12, 14, 16, 18, 20] {
        let (low, high) = (z, z + 0.125);
        shapes.push((Semantic::Ground, Shape::cuboid([0.5, 0.5, low], [3.5, 2.5, high])));
        z = high + (-f64::from(bits)).exp2();
    }
    shapes
}

/// Triangles of up to three metres, a hundredth to a hundred thousandth of a millimetre wide.
fn needles(seed: u64) -> Shapes {
    let (mut shapes, mut random) = (room(ROOM), SplitMix64::new(seed));
    let mut pile = Shape::default();
    let [lo, hi] = ROOM;
    for _ in 0..300 {
        let mut point = || [0, 1, 2].map(|i| random.between(lo[i] + 0.1, hi[i] - 0.1));
        let (a, b) = (point(), point());
        let width = 10f64.powf(random.between(-8.0, -5.0));
        let beside = [0, 1, 2].map(|i| a[i] + width * random.between(-1.0, 1.0));
        pile.0.push([a, b, beside]);
    }
    shapes.push((Semantic::Furniture, pile));
    shapes
}

/// A room in a room in a room.
fn nested() -> Shapes {
    let mut shapes = Shapes::new();
    for inset in [0.0, 1.5, 3.0] {
        shapes.extend(room([[inset; 3], [9.0 - inset; 3]]));
    }
    shapes
}

/// A corridor of so many parts, and a doorway between each two: in turn at the left and at the right.
fn corridor(parts: u32) -> Trial {
    let (wide, high, each) = (2.0, 2.5, 2.0);
    let whole = [[0.0; 3], [each * f64::from(parts), wide, high]];
    Trial::closed(&format!("corridor-{parts}"), whole, move || {
        let mut shapes = room(whole);
        for part in 1..parts {
            let x = each * f64::from(part);
            let door = if part % 2 == 0 { [0.1, 1.0] } else { [1.0, 1.9] };
            let mut wall = |y: [f64; 2], z: [f64; 2]| {
                shapes.push((Semantic::Wall, Shape::cuboid([x, y[0], z[0]], [x + 0.1, y[1], z[1]])));
            };
            wall([0.0, door[0]], [0.0, high]);
            wall([door[1], wide], [0.0, high]);
            wall(door, [2.1, high]);
        }
        shapes
    })
}
