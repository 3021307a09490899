//! From a [`Model`] to a scene.
//!
//! Until the partition of space exists, a compiled scene has one cell, the hull, and every triangle that rays can meet
//! is detail in it: correct, complete, and to be beaten.

mod building;
mod bvh;
mod geometry;
mod locator;
pub(crate) mod outward;
mod report;

use std::time::Instant;

use enfilade_importers::{
    Budget, Cancelled, LightKind, Limits, Model, OverBudget, Semantic, Untagged, UpAxis, Watch,
};

use crate::format::Tables;
use crate::format::records::{
    BlockRecord, CameraRecord, CellRecord, LightRecord, MaterialRecord, NodeRecord, SceneRecord, Traits,
    TriangleRecord, VolumeRecord,
};
use crate::scene::Scene;
use crate::trace::NONE;

pub use report::{Count, Repair, Report, RoleCount, Stage};

/// How to compile.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct CompileOptions {
    /// The tolerance of answers, metres. Default 1 mm.
    pub tolerance: f64,
    /// What to make of elements without a tag.
    pub untagged: Untagged,
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
            limits: Limits::default(),
            watch: Watch::default(),
        }
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
}

/// The hull is the box around the model, larger by this on all sides, metres.
const MARGIN: f64 = 1.0;

/// Compiles `model`.
///
/// The same model and options give the same bytes, at any thread count and on any machine.
///
/// # Errors
/// [`CompileError`].
pub fn compile(model: &Model, options: &CompileOptions) -> Result<Compiled, CompileError> {
    if !(options.tolerance > 0.0 && options.tolerance <= 0.1) {
        return Err(CompileError::Tolerance(options.tolerance));
    }
    let mut run = Run { options, budget: Budget::new(&options.limits), stages: Vec::new() };
    let count = model.triangle_count();
    if count > u64::from(u32::MAX >> 1) {
        return Err(CompileError::TooLarge(format!("{count} triangles are more than the format can count")));
    }
    run.budget.take_items(
        count,
        // A volume has at least four triangles.
        3 * 24 + size_of::<TriangleRecord>() + 3 * 16 + size_of::<VolumeRecord>() / 4,
        "the triangles of the scene",
    )?;

    let parts = run.stage("components", || geometry::split(model, options.untagged))?;
    let mut tables = Tables::default();
    let mut gathered = run.stage("geometry", || geometry::gather(model, &parts, &mut tables))?;
    run.stage("building", || building::add(model, &parts, &mut tables))?;

    let bounds = bounds(&tables);
    let (center, diameter) = middle(bounds);
    let hull = [bounds[0].map(|c| c - MARGIN), bounds[1].map(|c| c + MARGIN)];
    let slack = bvh::slack(diameter / 2.0 + 2.0 * MARGIN, diameter + 4.0 * MARGIN);
    let detail = gathered.detail_triangles as usize;

    run.budget.take_items(
        detail as u64,
        2 * 160 + size_of::<BlockRecord>() / 2 + size_of::<NodeRecord>() / 8,
        "the hierarchy of boxes",
    )?;
    let hierarchy = run.stage("hierarchy", || {
        let corners: Vec<[[f64; 3]; 3]> = tables.triangles[..detail]
            .iter()
            .map(|t| t.vertices.map(|v| tables.vertices[v as usize]))
            .collect();
        bvh::build(&corners, center, slack)
    })?;
    let depth = hierarchy.depth;
    tables.nodes = hierarchy.nodes;
    tables.blocks = hierarchy.blocks;

    let locator = run.stage("locator", || {
        let corners = |t: u32| tables.triangles[t as usize].vertices.map(|v| tables.vertices[v as usize]);
        locator::build(&tables.volumes, &corners)
    })?;

    tables.cells.push(CellRecord {
        bounds: hull,
        semantic: Semantic::Unknown.number(),
        room: NONE,
        root: if tables.nodes.is_empty() { NONE } else { 0 },
        reserved: 0,
    });
    add_looks(model, &mut tables);
    tables.scene.push(SceneRecord {
        unit: model.frame.unit,
        offset: model.frame.offset,
        hull,
        center,
        tolerance: options.tolerance,
        locator_origin: locator.origin,
        locator_step: locator.step,
        locator_dims: locator.dims,
        up: if model.frame.up == UpAxis::Y { 1 } else { 2 },
        traits: traits(model, &tables).0,
        detail_triangles: gathered.detail_triangles,
        slack,
        reserved: 0,
    });
    tables.locator = locator.starts;
    tables.located = locator.items;
    gathered.count_components(&parts);
    let mut report = report::make(model, options, &gathered, &tables, depth);
    tables.provenance = report.provenance().into_bytes();
    let bytes = run.stage("write", || tables.to_bytes())?;
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

/// The box around all vertices.
fn bounds(tables: &Tables) -> [[f64; 3]; 2] {
    let first = tables.vertices.first().copied().unwrap_or([0.0; 3]);
    tables.vertices.iter().fold([first, first], |[lo, hi], p| {
        [[0, 1, 2].map(|i| lo[i].min(p[i])), [0, 1, 2].map(|i| hi[i].max(p[i]))]
    })
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
        let detail = tables.triangles.iter();
        detail.into_iter().any(|t| hits[t.material as usize])
    };
    let mut storeys: Vec<&str> = model.elements.iter().filter_map(|e| e.storey.as_deref()).collect();
    storeys.sort_unstable();
    storeys.dedup();
    let mut bits = 0;
    let mut set = |bit: u32, on: bool| bits |= if on { bit } else { 0 };
    set(Traits::DETAIL, !tables.nodes.is_empty());
    set(Traits::GLASS, used(&|m| m.transmission > 0.0 || m.alpha < 1.0));
    set(Traits::MIRRORS, used(&|m| m.metallic > 0.5 && m.roughness < MIRROR_ROUGHNESS));
    set(Traits::LIGHTS, !tables.lights.is_empty());
    set(Traits::SINGLE_STOREY, storeys.len() <= 1);
    Traits(bits)
}
