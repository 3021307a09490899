//! What is traced: frozen scenes and models, and the views from which their frames are taken.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::Context;
use enfilade::bench::FrozenScene;
use enfilade::importers::gltf::read_slice;
use enfilade::importers::tagging::tag;
use enfilade::importers::{ImportOptions, Model, import};
use enfilade::render::{Camera, parse_cameras, room_views};
use enfilade::{CompileOptions, Scene, compile};

use crate::Arguments;

/// Frames of a model at most.
const MOST_VIEWS: usize = 20;

/// A scene to measure.
pub struct Measured {
    pub name: String,
    pub model: Model,
    pub scene: Arc<Scene>,
    /// The same left one cell, if that is asked for.
    pub uncut: Option<Arc<Scene>>,
    pub views: Vec<Camera>,
}

fn compiled(model: &Model, cells: bool) -> anyhow::Result<Arc<Scene>> {
    let mut options = CompileOptions::default();
    options.cells = cells;
    Ok(Arc::new(compile(model, &options)?.scene()))
}

fn uncut(model: &Model, arguments: &Arguments) -> anyhow::Result<Option<Arc<Scene>>> {
    arguments.uncut.then(|| compiled(model, false)).transpose()
}

fn frozen(name: &str, arguments: &Arguments) -> anyhow::Result<Measured> {
    let frozen = FrozenScene::by_name(name)?;
    let options = ImportOptions::default();
    let mut model = read_slice(&frozen.glb()?, name, &options)?;
    tag(&mut model, &options)?;
    let (scene, uncut) = (compiled(&model, true)?, uncut(&model, arguments)?);
    let views = parse_cameras(&frozen.cameras, "benches/scenes.toml", &scene.frame())?;
    Ok(Measured { name: name.to_owned(), model, scene, uncut, views })
}

/// Two level views from the middle of each room, [`MOST_VIEWS`] at most.
fn model(path: &Path, arguments: &Arguments) -> anyhow::Result<Measured> {
    let about = || path.display().to_string();
    let model = import(path, &ImportOptions::default()).with_context(about)?;
    let (scene, uncut) = (compiled(&model, true)?, uncut(&model, arguments)?);
    let views = room_views(&scene, 2);
    let step = views.len().div_ceil(MOST_VIEWS).max(1);
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(Measured { name, model, scene, uncut, views: views.into_iter().step_by(step).collect() })
}

/// All that the arguments name, one after the other; by default HOUSE and BUILD1 to BUILD3, furnished and bare.
pub fn scenes(
    arguments: &Arguments,
) -> anyhow::Result<Box<dyn Iterator<Item = anyhow::Result<Measured>> + '_>> {
    let mut names = arguments.frozen.clone();
    if names.is_empty() && arguments.models.is_empty() {
        let usual = ["house", "build1", "build2", "build3"];
        names = usual.iter().flat_map(|name| [name.to_string(), format!("{name}-bare")]).collect();
    }
    let mut paths = Vec::new();
    for path in &arguments.models {
        if path.is_dir() {
            paths.extend(models_in(path)?);
        } else {
            paths.push(path.clone());
        }
    }
    let named = names.into_iter().map(move |name| frozen(&name, arguments));
    Ok(Box::new(named.chain(paths.into_iter().map(move |path| model(&path, arguments)))))
}

/// The models of a folder: of those that differ in what follows the first dot only, one.
fn models_in(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        let is_model =
            path.extension().is_some_and(|e| ["glb", "gltf", "obj"].iter().any(|known| e == *known));
        if is_model {
            paths.push(path);
        }
    }
    let stem = |path: &Path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        name.split('.').next().unwrap_or_default().to_owned()
    };
    // Of those, that with the shortest name.
    paths.sort_by_cached_key(|path| (stem(path), path.as_os_str().len(), path.clone()));
    paths.dedup_by_key(|path| stem(path));
    Ok(paths)
}
