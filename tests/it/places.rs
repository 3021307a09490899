//! Where points lie and where rays begin: rooms, solids, cavities, surfaces, solids that touch.

use enfilade::importers::{ElementId, Frame, Material, Model, ModelBuilder, NewElement, Semantic};
use enfilade::{Answer, CompileOptions, Place, Ray, Scene, Start, Want, compile};

struct Builder(ModelBuilder, enfilade::importers::MaterialId);

impl Builder {
    fn new() -> Builder {
        let mut builder = ModelBuilder::new("places", Frame::default());
        let material = builder.material(Material::default());
        Builder(builder, material)
    }

    fn element(&mut self, name: &str, semantic: Semantic) -> ElementId {
        let element = self.0.element(NewElement { name: name.into(), ..NewElement::default() }).unwrap();
        self.0.semantic(element, semantic);
        element
    }

    /// A box of an element; `inward` turns all its triangles.
    fn add_box(&mut self, element: ElementId, lo: [f64; 3], hi: [f64; 3], inward: bool) {
        let p: Vec<[f64; 3]> = (0..8)
            .map(|i| [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { hi[axis] } else { lo[axis] }))
            .collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        for [a, b, c, d] in quads {
            for [i, j, k] in [[a, b, c], [a, c, d]] {
                let [j, k] = if inward { [k, j] } else { [j, k] };
                self.0.triangle(element, [p[i], p[j], p[k]], self.1).unwrap();
            }
        }
    }

    fn scene(self) -> Scene {
        let model: Model = self.0.finish().unwrap();
        compile(&model, &CompileOptions::default()).unwrap().scene()
    }
}

fn hit(answer: Answer) -> (f64, u32) {
    match answer {
        Answer::Hit(hit) => (hit.t, hit.element),
        other => panic!("no hit: {other:?}"),
    }
}

#[test]
fn a_cavity_of_a_solid_is_air() {
    for inside_out in [false, true] {
        let mut builder = Builder::new();
        let shell = builder.element("shell", Semantic::Wall);
        builder.add_box(shell, [0.0; 3], [10.0, 10.0, 5.0], inside_out);
        builder.add_box(shell, [1.0; 3], [9.0, 9.0, 4.0], !inside_out);
        let room = builder.element("room", Semantic::Room);
        builder.add_box(room, [1.0; 3], [9.0, 9.0, 4.0], false);
        let scene = builder.scene();
        assert!(matches!(
            scene.locate([5.0, 5.0, 2.0]),
            Place::Air { room: Some(0), label: Semantic::Room, .. }
        ));
        assert_eq!(scene.locate([0.5, 5.0, 2.0]), Place::InSolid(0));
        assert!(matches!(scene.locate([-0.5, 5.0, 2.0]), Place::Air { room: None, .. }));
        assert_eq!(scene.locate([50.0, 0.0, 0.0]), Place::Outside);
        assert_eq!(hit(scene.trace(&Ray::new([5.0, 5.0, 2.0], [2.0, 0.0, 0.0]))), (4.0, 0));
        assert_eq!(scene.trace(&Ray::new([0.5, 5.0, 2.0], [1.0, 0.0, 0.0])), Answer::InSolid(0));
        let room = scene.room(0);
        assert!(
            (room.volume().unwrap() - 192.0).abs() < 1e-9 && (room.floor_area().unwrap() - 64.0).abs() < 1e-9
        );
    }
}

#[test]
fn rays_begin_on_the_air_side_that_they_enter() {
    let mut builder = Builder::new();
    let slab = builder.element("slab", Semantic::Ground);
    builder.add_box(slab, [0.0, 0.0, -0.25], [8.0, 8.0, 0.0], false);
    let wall = builder.element("wall", Semantic::Wall);
    builder.add_box(wall, [4.0, 0.0, 0.0], [4.25, 8.0, 3.0], false);
    let table = builder.element("table", Semantic::Furniture);
    builder.add_box(table, [1.0, 1.0, 0.0], [2.0, 2.0, 0.75], false);
    let scene = builder.scene();
    let trace = |o: [f64; 3], d: [f64; 3]| scene.trace(&Ray::new(o, d));

    // From the floor up, also from a little inside it, and down into it.
    assert_eq!(trace([3.0, 3.0, 0.0], [0.0, 0.0, 1.0]), Answer::Escaped);
    assert_eq!(trace([3.0, 3.0, -0.0005], [0.0, 0.0, 1.0]), Answer::Escaped);
    assert_eq!(trace([3.0, 3.0, -0.002], [0.0, 0.0, 1.0]), Answer::InSolid(0));
    let (t, element) = hit(trace([3.0, 3.0, 0.0], [0.0, 0.0, -1.0]));
    assert!(t.abs() < 1e-6 && element == 0);
    // Along the floor, exactly in it, to the wall; and along the wall.
    let (t, element) = hit(trace([3.0, 3.0, 0.0], [1.0, 0.0, 0.0]));
    assert!((t - 1.0).abs() < 1e-6 && element == 1, "{t} {element}");
    assert_eq!(trace([4.0, 3.0, 1.0], [0.0, 1.0, 0.0]), Answer::Escaped);
    // Where floor and wall touch there is no air.
    assert!(matches!(trace([4.125, 3.0, 0.0], [0.0, 1.0, 0.0]), Answer::InSolid(_)));
    assert!(matches!(trace([4.125, 3.0, -0.0001], [0.0, 0.0, 1.0]), Answer::InSolid(_)));
    // Below the table's foot the ray leaves floor and foot together, and meets the table's top from below.
    let (t, element) = hit(trace([1.5, 1.5, 0.0], [0.0, 0.0, 1.0]));
    assert!((t - 0.75).abs() < 1e-6 && element == 2, "{t} {element}");
    // A segment that ends before the wall escapes, and is not occluded.
    let short = Ray::segment([3.0, 3.0, 1.0], [1.0, 0.0, 0.0], 0.0, 0.999);
    let long = Ray::segment([3.0, 3.0, 1.0], [1.0, 0.0, 0.0], 0.0, 1.001);
    assert_eq!(scene.trace(&short), Answer::Escaped);
    assert!(!scene.occluded(&short) && scene.occluded(&long));
    assert!(scene.occluded(&Ray::segment([4.1, 3.0, 1.0], [1.0, 0.0, 0.0], 0.0, 0.01)), "starts in the wall");
    // Past the wall by tmin.
    let past = Ray::segment([3.0, 3.0, 1.0], [1.0, 0.0, 0.0], 1.25, f64::INFINITY);
    assert_eq!(scene.trace(&past), Answer::Escaped);
}

#[test]
fn directions_of_any_length_and_origins_anywhere() {
    let mut builder = Builder::new();
    let wall = builder.element("wall", Semantic::Wall);
    builder.add_box(wall, [0.0; 3], [1.0; 3], false);
    let scene = builder.scene();
    for scale in [1e-300, 1e-30, 1.0, 1e30, 1e300] {
        let (t, _) = hit(scene.trace(&Ray::new([-3.0, 0.5, 0.5], [scale, 0.0, 0.0])));
        assert_eq!(t, 3.0, "{scale}");
    }
    for distance in [10.0, 1e3, 1e6, 1e9] {
        let (t, _) = hit(scene.trace(&Ray::new([-distance, 0.5, 0.5], [1.0, 1e-300, 0.0])));
        assert!((t - distance).abs() <= 1e-15 * distance, "{distance}");
        assert_eq!(scene.trace(&Ray::new([-distance, 0.5, 0.5], [-1.0, 0.0, 0.0])), Answer::Escaped);
    }
    let bad = [
        Ray::new([f64::NAN, 0.0, 0.0], [1.0, 0.0, 0.0]),
        Ray::new([0.5; 3], [0.0; 3]),
        Ray::new([0.5; 3], [f64::INFINITY, 0.0, 0.0]),
        Ray::segment([-1.0, 0.5, 0.5], [1.0, 0.0, 0.0], 0.0, f64::NAN),
        Ray::segment([-1.0, 0.5, 0.5], [1.0, 0.0, 0.0], 5.0, 1.0),
    ];
    for ray in bad {
        assert_eq!(scene.trace(&ray), Answer::Escaped, "{ray:?}");
        assert!(!scene.occluded(&ray));
    }
}

#[test]
fn restarts_do_not_meet_their_own_surface() {
    let mut builder = Builder::new();
    let shell = builder.element("shell", Semantic::Wall);
    builder.add_box(shell, [-1.0; 3], [4.3, 3.7, 2.9], false);
    builder.add_box(shell, [0.0; 3], [3.3, 2.7, 1.9], true);
    let scene = builder.scene();
    // A billiard in the cavity, which runs into its corners too: every bounce stays inside.
    let mut direction = [0.61, 0.53, 0.4];
    let mut hit = scene.trace_from(Start::Cell(0), &Ray::new([1.0, 1.1, 0.7], direction), Want::default());
    for bounce in 0..20_000 {
        assert!(hit.t.is_finite(), "bounce {bounce}: {hit:?}");
        let along: f64 = (0..3).map(|i| direction[i] * hit.normal[i]).sum();
        direction = [0, 1, 2].map(|i| direction[i] - 2.0 * along * hit.normal[i]);
        let ray = Ray::new(hit.point, direction);
        hit = scene.trace_from(Start::Hit(&hit), &ray, Want::default());
    }
}
