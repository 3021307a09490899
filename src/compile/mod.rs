//! From a [`Model`] to a scene.
//!
//! The cells of a partition become tables as they are (`prisms`), each with a hierarchy of boxes over its detail (`detail`,
//! `bvh`). Without a partition a scene has one cell, the hull, and every triangle that rays can meet is detail in it:
//! correct, complete, and to be beaten.

mod building;
mod bvh;
mod cell_grid;
mod compact;
mod crossing;
mod detail;
mod facing;
mod geometry;
mod joined;
mod locator;
mod mapped;
pub(crate) mod outward;
mod plates;
mod prisms;
mod report;

use std::time::Instant;

use enfilade_importers::{
    Budget, Cancelled, LightKind, Limits, Model, OverBudget, Role, Semantic, Untagged, UpAxis, Watch,
};

use self::bvh::TriangleSplits;
#[cfg(feature = "render")]
pub(crate) use self::bvh::over_boxes;
use self::geometry::Gathered;
use crate::building::{Building, NamedCells};
use crate::derive::{self, DeriveOptions};
use crate::format::records::{
    CameraRecord, Leaf, LightRecord, MaterialRecord, RunRecord, SceneRecord, SourceRecord, Traits,
    VolumeRecord,
};
use crate::format::{MapTables, Tables};
use crate::parallel;
use crate::partition::cells::Partition;
use crate::partition::{Convexification, PartitionError, PartitionOptions, partition};
use crate::scene::Scene;
use crate::trace::NONE;
use crate::validate::Validated;

pub use compact::Graph;
pub use report::{Count, Repair, Report, RoleCount, Stage};

/// How to compile.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct CompileOptions {
    /// The tolerance of answers, metres. Default 1 mm.
    pub tolerance: f64,
    /// What to make of elements without a tag.
    pub untagged: Untagged,
    /// Whether to cut the space into cells (default), or to leave it one cell with all triangles. Both give right answers.
    pub cells: bool,
    /// How space that is not convex is cut into cells.
    pub convexification: Convexification,
    /// What to find in the building that the model does not say.
    pub derive: DeriveOptions,
    /// Whether the file keeps the map of the building ([`Scene::building`]), so that it can be validated without the model.
    /// Default no: rays do not need it. Without cells there is none.
    pub topology: bool,
    /// Sections that opening reads whole (vertices, triangles, leaves) are packed from so many bytes on: a file of a large building is half as long. Default
    /// 256 KiB; with `u64::MAX` every section is a plain array, for readers that map the file themselves.
    pub pack_from: u64,
    /// What the compilation may cost, beside the model itself.
    pub limits: Limits,
    /// Progress and cancellation.
    pub watch: Watch,
}

impl Default for CompileOptions {
    fn default() -> CompileOptions {
        CompileOptions {
            tolerance: 1e-3,
            untagged: Untagged::default(),
            cells: true,
            convexification: Convexification::default(),
            derive: DeriveOptions::default(),
            topology: false,
            pack_from: 1 << 18,
            limits: Limits::default(),
            watch: Watch::default(),
        }
    }
}

impl CompileOptions {
    fn partition(&self) -> PartitionOptions {
        PartitionOptions::default()
            .with_untagged(self.untagged)
            .with_convexification(self.convexification)
            .with_limits(self.limits)
            .with_watch(self.watch.clone())
    }
}

/// A compiled scene as the bytes of its file, and what was done to make it.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// The `.enf` file.
    pub bytes: Vec<u8>,
    /// Timings, counts, repairs.
    pub report: Report,
}

impl Compiled {
    /// The scene.
    ///
    /// # Panics
    /// Never: the bytes were made by this crate.
    pub fn scene(&self) -> Scene {
        Scene::from_bytes(&self.bytes)
            .unwrap_or_else(|e| unreachable!("a scene just compiled does not open: {e}"))
    }
}

/// A model could not be compiled.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CompileError {
    /// More memory would be needed than allowed.
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
    /// Cancelled through its token.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The tolerance is no positive number of metres, or larger than any wall is thick.
    #[error("the tolerance is {0} m; it must be more than 0 and at most 0.1 m")]
    Tolerance(f64),
    /// The model has more than the format can count.
    #[error("{0}")]
    TooLarge(String),
    /// The partition contradicts itself, or does not fit the model.
    #[error("the partition cannot be used: {0}")]
    Partition(String),
}

/// The hull is the box around the model, larger by this on all sides, metres.
const MARGIN: f64 = 1.0;

/// Compiles `model`, with what it lacks ([`CompileOptions::derive`]).
///
/// The same model and options give the same bytes, at any thread count and on any machine.
///
/// # Errors
/// [`CompileError`].
pub fn compile(model: &Model, options: &CompileOptions) -> Result<Compiled, CompileError> {
    let start = Instant::now();
    let (model, derived) = derive::complete(model, &options.derive, &options.partition())?;
    let stage = Stage { name: "derived elements", seconds: start.elapsed().as_secs_f64() };
    let mut compiled = compile_complete(&model, options)?;
    compiled.report.stages.insert(0, stage);
    compiled.report.derived = derived;
    Ok(compiled)
}

/// Compiles `model` as it is.
fn compile_complete(model: &Model, options: &CompileOptions) -> Result<Compiled, CompileError> {
    if !options.cells {
        return compile_tables(model, &whole(), None, options);
    }
    let failed = match partition(model, &options.partition()) {
        Ok((partition, partitioned)) => match compile_partition(model, partition, options) {
            Ok(mut compiled) => {
                compiled.report.add_partition(&partitioned, &model.frame);
                return Ok(compiled);
            }
            Err(CompileError::OverBudget(over)) => over.to_string(),
            Err(CompileError::Partition(what)) => what,
            Err(other) => return Err(other),
        },
        Err(PartitionError::Cancelled(cancelled)) => return Err(cancelled.into()),
        Err(failed) => failed.to_string(),
    };
    let mut compiled = compile_tables(model, &whole(), None, options)?;
    let map = if options.topology { ", and keeps no map" } else { "" };
    compiled.report.warnings.push(format!("the scene has no cells, and rays are slower{map}: {failed}"));
    Ok(compiled)
}

/// Compiles `model`, its space being cut into cells by `partition`: they are sewn to a building, which is validated and then
/// compiled ([`compile_building`]).
///
/// # Errors
/// [`CompileError`]; [`CompileError::Partition`] for a partition of another model, for one whose cells do not fill its hull
/// or do not agree about their neighbours, for what is not valid.
pub fn compile_partition(
    model: &Model,
    partition: Partition,
    options: &CompileOptions,
) -> Result<Compiled, CompileError> {
    let (building, map) = mapped::building(model, partition, options)?;
    let (valid, report, validation) = mapped::valid(building, options)?;
    let mut compiled = compile_building(model, valid, options)?;
    compiled.report.stages.splice(0..0, [map, validation]);
    compiled.report.add_findings(&report);
    Ok(compiled)
}

/// Compiles `model`, whose map is `building`: cells, and what lies beyond each part of their surfaces, are read off it. The
/// triangles that rays can meet are those of its sources and its detail.
///
/// # Errors
/// [`CompileError`]; [`CompileError::Partition`] for the map of another model.
pub fn compile_building(
    model: &Model,
    building: Validated<Building>,
    options: &CompileOptions,
) -> Result<Compiled, CompileError> {
    building.get().check_model(model).map_err(CompileError::Partition)?;
    let (cells, stage) = mapped::cells(&building, options)?;
    let map = options.topology.then(|| mapped::stored(&building, options)).transpose()?;
    drop(building);
    let mut compiled = compile_tables(model, &cells, map, options)?;
    compiled.report.stages.insert(0, stage);
    Ok(compiled)
}

/// No cells: everything is detail.
fn whole() -> NamedCells {
    NamedCells { partition: Partition::whole(), faces: Vec::new(), covers: Vec::new() }
}

/// Compiles cells; if there are none, everything is detail.
fn compile_tables(
    model: &Model,
    cells: &NamedCells,
    map: Option<MapTables>,
    options: &CompileOptions,
) -> Result<Compiled, CompileError> {
    if !(options.tolerance > 0.0 && options.tolerance <= 0.1) {
        return Err(CompileError::Tolerance(options.tolerance));
    }
    let partition = &cells.partition;
    partition.check_frame().map_err(CompileError::Partition)?;
    let zone = prisms::zone(partition);
    let mut run = Run { options, budget: Budget::new(&options.limits), stages: Vec::new() };
    let count = model.triangle_count();
    if count > u64::from(u32::MAX >> 1) {
        return Err(CompileError::TooLarge(format!("{count} triangles are more than the format can count")));
    }
    run.budget.take_items(
        count,
        // A volume has at least four triangles.
        3 * 24 + size_of::<[u32; 3]>() + size_of::<RunRecord>() + 4 * 16 + size_of::<VolumeRecord>() / 4,
        "the triangles of the scene",
    )?;

    let parts = run.stage("components", || geometry::split(model, options.untagged))?;
    let mut tables = Tables { map, ..Tables::default() };
    let mut gathered = run.stage("geometry", || geometry::gather(model, &parts, &mut tables))?;
    run.stage("building", || building::add(model, &parts, &mut tables))?;

    let hull = hull(&tables, partition, zone);
    let (center, diameter) = middle(hull);
    let slack = bvh::slack(diameter / 2.0 + MARGIN, diameter + 2.0 * MARGIN);
    tables.scene.push(SceneRecord {
        unit: model.frame.unit,
        offset: model.frame.offset,
        hull,
        center,
        tolerance: options.tolerance,
        detail_triangles: gathered.detail_triangles,
        slack,
        up: if model.frame.up == UpAxis::Y { 1 } else { 2 },
        lattice_bits: partition.lattice.bits,
        lattice_origin: partition.lattice.origin,
        lattice_turn: partition.lattice.turn,
        zone: zone.unwrap_or([center; 2]),
        ..bytemuck::Zeroable::zeroed()
    });
    let added = run
        .stage("cells", || prisms::add(model, cells, &gathered, hull, &mut tables))?
        .map_err(CompileError::Partition)?;
    let mut faces = tables.surfaces.clone();
    faces.sort_unstable();
    faces.dedup();
    run.stage("plates", || plates::add(&mut tables))?;
    let counted = add_detail(&mut run, partition, &gathered, zone, faces, &mut tables)?;

    let locator = run.stage("locator", || {
        let corners = |t: u32| tables.triangles[t as usize].map(|v| tables.vertices[v as usize]);
        locator::build(&tables.volumes, &corners)
    })?;

    add_looks(model, &mut tables);
    let traits = traits(model, &tables).0 | added.traits.0;
    let scene = &mut tables.scene[0];
    scene.traits = traits;
    scene.locator_origin = locator.origin;
    scene.locator_step = locator.step;
    scene.locator_dims = locator.dims;
    tables.locator = locator.starts;
    tables.located = locator.items;
    gathered.count_components(&parts);
    let mut report = report::make(model, options, &gathered, &tables, &counted);
    tables.provenance = report.provenance().into_bytes();
    let bytes = run.stage("write", || tables.to_bytes(options.pack_from))?;
    if zone.is_some() {
        // The partition is the caller's: whether its cells are prisms is what opening checks.
        run.stage("check", || Scene::from_bytes(&bytes).map(|_| ()))?
            .map_err(|error| CompileError::Partition(error.to_string()))?;
    }
    report.joined_faces = added.joined;
    report.bytes = bytes.len() as u64;
    report.stages = run.stages;
    report.peak_budget_bytes = run.budget.peak();
    Ok(Compiled { bytes, report })
}

/// One compilation under way.
struct Run<'a> {
    options: &'a CompileOptions,
    budget: Budget,
    stages: Vec<Stage>,
}

impl Run<'_> {
    fn stage<T>(&mut self, name: &'static str, work: impl FnOnce() -> T) -> Result<T, Cancelled> {
        self.options.watch.check()?;
        self.options.watch.report(name, 0.0);
        let start = Instant::now();
        let result = work();
        self.stages.push(Stage { name, seconds: start.elapsed().as_secs_f64() });
        self.options.watch.report(name, 1.0);
        Ok(result)
    }
}

/// What [`add_detail`] found.
#[derive(Clone, Copy, Debug, Default)]
struct Counted {
    /// Triangles behind faces of cells that are not detail, too.
    faces: u64,
    /// Triangles that are detail.
    detail: u64,
    /// Longest chain of nodes.
    depth: u32,
}

/// Fills the sections `cellgrid`, `gridcells`, `nodes` and `leaves`, and the roots of `cells` and `sources`. `faces` are the
/// triangles behind faces of cells.
fn add_detail(
    run: &mut Run<'_>,
    partition: &Partition,
    gathered: &Gathered,
    zone: Option<[[f64; 3]; 2]>,
    mut faces: Vec<u32>,
    tables: &mut Tables,
) -> Result<Counted, CompileError> {
    let tolerance = run.options.tolerance;
    // Points are looked up as far aside as the tolerance, and detail is sought twice as far.
    let grid = run
        .stage("grid", || cell_grid::build(tables, zone, 2.0 * tolerance))?
        .map_err(CompileError::TooLarge)?;
    let mut met = vec![false; gathered.detail_triangles as usize];
    let mut detail: Vec<u32> = match zone {
        None => (0..gathered.detail_triangles).collect(),
        Some(_) => partition
            .detail
            .iter()
            .map(|&triangle| prisms::scene_triangle(gathered, triangle))
            .collect::<Result<_, _>>()
            .map_err(CompileError::Partition)?,
    };
    detail.sort_unstable();
    detail.dedup();
    detail.iter().for_each(|&t| met[t as usize] = true);
    faces.retain(|&t| !met[t as usize]);

    let pairs = match zone {
        None => detail.iter().map(|&t| (0, t)).collect(),
        Some(zone) => {
            let size = size_of::<(u32, u32)>();
            let most = run.budget.left() / size as u64;
            let pairs =
                run.stage("detail", || detail::pairs(tables, &grid, zone, &detail, tolerance, most))?;
            let count = pairs.as_ref().map_or(most + 1, |pairs| pairs.len() as u64);
            run.budget.take_items(count, size, "the detail of all cells")?;
            pairs.unwrap_or_default()
        }
    };
    // Faces of solids that are none of a cell's go through it, or along it.
    for &(cell, triangle) in &pairs {
        let volume = tables.volumes.get(tables.record(triangle).volume as usize);
        if volume.is_some_and(|volume| volume.role == Role::Solid as u32) {
            tables.cells[cell as usize].flags = 0;
        }
    }
    let all = if zone.is_some() { u64::from(gathered.detail_triangles) } else { 0 };
    // Where memory is short they are built over whole triangles: rays take longer, answers are the same.
    let mut take = |splits: TriangleSplits| {
        run.budget.take_items(pairs.len() as u64 + all, splits.bytes_each(), "the hierarchies of boxes")
    };
    let splits = match take(TriangleSplits::Parts) {
        Ok(()) => TriangleSplits::Parts,
        Err(_) => take(TriangleSplits::None).map(|()| TriangleSplits::None)?,
    };
    let (center, slack) = (tables.scene[0].center, tables.scene[0].slack);
    let depth = run.stage("hierarchy", || {
        let owned = detail::by_cell(&pairs);
        let cells = owned.into_iter().map(|(cell, range)| {
            let ids: Vec<u32> = pairs[range].iter().map(|&(_, triangle)| triangle).collect();
            (Owner::Cell(cell), ids)
        });
        let many = tables.sources.iter().zip(0u32..).filter(|(source, _)| source.count > SourceRecord::FEW);
        let sources = many.map(|(source, index)| {
            let first = source.first as usize;
            (Owner::Source(index), tables.surfaces[first..first + source.count as usize].to_vec())
        });
        let jobs: Vec<(Owner, Vec<u32>)> = cells.chain(sources).collect();
        let built = parallel::map(jobs.len(), |job| {
            let corners = |t: u32| tables.triangles[t as usize].map(|v| tables.vertices[v as usize]);
            let corners: Vec<[[f64; 3]; 3]> = jobs[job].1.iter().map(|&t| corners(t)).collect();
            let hierarchy = bvh::build(&corners, center, slack, splits);
            let part = hierarchy.part(&corners, center, slack);
            (hierarchy, part)
        });
        let mut depth = built.iter().map(|(hierarchy, _)| hierarchy.depth).max().unwrap_or(0);
        // What cell 0 has beside detail around the prisms: all there is, for rays from outside, and those that pass edges too near for cells. It is
        // built over the hierarchies of rooms, which are apart from each other, and what is in none of them: those of the air around a building
        // reach all around it. Its nodes come before theirs.
        let is_apart = |owner: &Owner| match *owner {
            Owner::Cell(cell) => tables.cells[cell as usize].semantic != Semantic::Exterior as u16,
            Owner::Source(_) => false,
        };
        let apart: Vec<bool> = jobs.iter().map(|(owner, _)| is_apart(owner)).collect();
        let over = zone.map(|_| {
            let below = || (0..jobs.len()).filter(|&job| apart[job]);
            let mut is_below = vec![false; gathered.detail_triangles as usize];
            below().flat_map(|job| &jobs[job].1).for_each(|&triangle| is_below[triangle as usize] = true);
            let parts: Vec<bvh::Part> = below().filter_map(|job| built[job].1).collect();
            let corners = |t: u32| tables.triangles[t as usize].map(|v| tables.vertices[v as usize]);
            let rest: Vec<u32> = (0..gathered.detail_triangles).filter(|&t| !is_below[t as usize]).collect();
            let own: Vec<[[f64; 3]; 3]> = rest.iter().map(|&t| corners(t)).collect();
            bvh::build_over(&own, &parts, center, slack, splits)
                .map(|hierarchy| (hierarchy, rest))
                .unwrap_or_else(|| {
                    let all: Vec<[[f64; 3]; 3]> = (0..gathered.detail_triangles).map(corners).collect();
                    (bvh::build(&all, center, slack, splits), (0..gathered.detail_triangles).collect())
                })
        });
        let mut own = (0, 0);
        if let Some((hierarchy, rest)) = over {
            depth = depth.max(hierarchy.depth);
            own = (hierarchy.nodes.len(), tables.nodes.len() as u32);
            tables.cells[0].root = hierarchy.append(&rest, tables);
        }
        let mut roots = Vec::new();
        for (((owner, ids), (hierarchy, part)), is_apart) in jobs.into_iter().zip(built).zip(apart) {
            let root = hierarchy.append(&ids, tables);
            roots.extend(part.filter(|_| is_apart).map(|_| root));
            match owner {
                Owner::Cell(cell) => tables.cells[cell as usize].root = root,
                Owner::Source(source) => tables.sources[source as usize].root = root,
            }
        }
        bvh::Hierarchy::link(own.0, own.1, &roots, tables);
        depth
    })?;
    if tables.leaves.len() > Leaf::MOST {
        let what = format!(
            "the hierarchies of boxes have {} leaves' triangles, more than the format can count",
            tables.leaves.len()
        );
        return Err(CompileError::TooLarge(what));
    }
    let scene = &mut tables.scene[0];
    (scene.grid_step, scene.grid_dims) = (grid.step, grid.dims);
    (tables.cellgrid, tables.gridcells) = (grid.starts, grid.items);
    Ok(Counted { faces: faces.len() as u64, detail: detail.len() as u64, depth })
}

/// What a hierarchy is of.
enum Owner {
    Cell(u32),
    Source(u32),
}

/// The box around all vertices with a margin, and around the zone of the prisms.
fn hull(tables: &Tables, partition: &Partition, zone: Option<[[f64; 3]; 2]>) -> [[f64; 3]; 2] {
    let first = tables.vertices.first().copied().unwrap_or([0.0; 3]);
    let around = |[lo, hi]: [[f64; 3]; 2], p: &[f64; 3]| {
        [[0, 1, 2].map(|i| lo[i].min(p[i])), [0, 1, 2].map(|i| hi[i].max(p[i]))]
    };
    let [lo, hi] = tables.vertices.iter().fold([first, first], around);
    let corners = zone.iter().flat_map(|_| 0..8).map(|k| {
        let corner = [0, 1, 2].map(|axis| f64::from(partition.hull[k >> axis & 1][axis]));
        partition.lattice.metres(corner)
    });
    corners.fold([lo.map(|c| c - MARGIN), hi.map(|c| c + MARGIN)], |hull, p| around(hull, &p))
}

/// The middle of a box and the length of its diagonal.
fn middle([lo, hi]: [[f64; 3]; 2]) -> ([f64; 3], f64) {
    let middle = [0, 1, 2].map(|i| lo[i] + (hi[i] - lo[i]) / 2.0);
    let size = [0, 1, 2].map(|i| hi[i] - lo[i]);
    (middle, (size[0] * size[0] + size[1] * size[1] + size[2] * size[2]).sqrt())
}

fn add_looks(model: &Model, tables: &mut Tables) {
    for m in &model.materials {
        let name = tables.text(&m.name);
        tables.materials.push(MaterialRecord {
            name,
            base_color: m.base_color,
            alpha: m.alpha,
            emissive: m.emissive,
            metallic: m.metallic,
            roughness: m.roughness,
            ior: m.ior,
            transmission: m.transmission,
            reserved: 0,
        });
    }
    for l in &model.lights {
        let name = tables.text(&l.name);
        let (kind, inner, outer) = match l.kind {
            LightKind::Directional => (1, 0.0, 0.0),
            LightKind::Spot { inner, outer } => (2, inner, outer),
            _ => (0, 0.0, 0.0),
        };
        tables.lights.push(LightRecord {
            position: l.position,
            direction: l.direction,
            range: l.range,
            name,
            color: l.color,
            intensity: l.intensity,
            kind,
            inner,
            outer,
            reserved: 0,
        });
    }
    for c in &model.cameras {
        let name = tables.text(&c.name);
        tables.cameras.push(CameraRecord {
            eye: c.eye,
            direction: c.direction,
            up: c.up,
            vfov: c.vfov_degrees,
            name,
        });
    }
}

fn traits(model: &Model, tables: &Tables) -> Traits {
    /// Metals smoother than this mirror.
    const MIRROR_ROUGHNESS: f32 = 0.05;
    let used = |test: &dyn Fn(&MaterialRecord) -> bool| {
        let hits: Vec<bool> = tables.materials.iter().map(test).collect();
        tables.runs.iter().any(|run| hits[run.material as usize])
    };
    let mut storeys: Vec<&str> = model.elements.iter().filter_map(|e| e.storey.as_deref()).collect();
    storeys.sort_unstable();
    storeys.dedup();
    let mut bits = 0;
    let mut set = |bit: u32, on: bool| bits |= if on { bit } else { 0 };
    set(Traits::DETAIL, tables.cells.iter().any(|cell| cell.root != NONE));
    set(Traits::GLASS, used(&|m| m.transmission > 0.0 || m.alpha < 1.0));
    set(Traits::MIRRORS, used(&|m| m.metallic > 0.5 && m.roughness < MIRROR_ROUGHNESS));
    set(Traits::LIGHTS, !tables.lights.is_empty());
    set(Traits::SINGLE_STOREY, storeys.len() <= 1);
    Traits(bits)
}
