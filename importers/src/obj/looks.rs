//! Materials by name: the libraries that `mtllib` lines name, and their textures' mean colours.

use std::collections::{HashMap, HashSet};
use std::hash::Hasher;
use std::path::PathBuf;

use twox_hash::XxHash3_64;

use crate::error::{ImportError, ImportErrorKind};
use crate::folder::{Folder, FolderError, read_whole};
use crate::import::ImportOptions;
use crate::limits::Budget;
use crate::model::{Material, Warning};
use crate::obj::guard::ObjGuard;
use crate::obj::mtl::{self, Described};
use crate::obj::parts::Named;
use crate::texture::{ColorMeans, Decoder, MeanColor};

/// The material of each of the guard's names, `None` for those that no face has. The libraries' bytes go into
/// `hash`.
///
/// # Errors
/// A library that leaves the model's folder, is damaged, or is too large.
pub(super) fn materials(
    guard: &ObjGuard,
    file: &str,
    folder: Option<&Folder>,
    hash: &mut XxHash3_64,
    budget: &mut Budget,
    options: &ImportOptions,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<Option<Material>>, ImportError> {
    let decoder = Decoder::new(&options.limits);
    let known = HashMap::new();
    let mut libraries = Libraries { file, folder, hash, budget, options, warnings, decoder, known };
    let mut lines = HashSet::new();
    let mut read = HashSet::new();
    for library in guard.libraries.iter().filter(|l| lines.insert(l.text.as_str())) {
        for (name, path) in libraries.files(library)? {
            if read.insert(path.clone()) {
                libraries.read(&name, path, library)?;
            }
        }
    }
    let mut is_used = vec![false; guard.materials.len()];
    if guard.switches.first().is_none_or(|s| s.0 > 0) {
        is_used[0] = true;
    }
    for &(_, material) in &guard.switches {
        is_used[material] = true;
    }
    let mut means = HashMap::new();
    let mut materials = Vec::with_capacity(guard.materials.len());
    for (named, used) in guard.materials.iter().zip(is_used) {
        materials.push(match used {
            true => Some(libraries.look(named, &mut means)?),
            false => None,
        });
    }
    Ok(materials)
}

struct Libraries<'a> {
    file: &'a str,
    folder: Option<&'a Folder>,
    hash: &'a mut XxHash3_64,
    budget: &'a mut Budget,
    options: &'a ImportOptions,
    warnings: &'a mut Vec<Warning>,
    decoder: Decoder,
    /// By name, with the library's name. The first one of a name counts.
    known: HashMap<String, (Described, String)>,
}

impl Libraries<'_> {
    fn warn(&mut self, place: String, text: String) {
        self.warnings.push(Warning { place, text });
    }

    /// The files that an `mtllib` line names: one whose name may have blanks, else several.
    fn files(&mut self, line: &Named) -> Result<Vec<(String, PathBuf)>, ImportError> {
        let place = format!("line {}", line.line);
        let Some(folder) = self.folder else {
            self.warn(place, format!("the material library '{}' is not at hand", line.text));
            return Ok(Vec::new());
        };
        let whole = line.text.trim_matches('"');
        let file = self.file;
        let leaves = |name: &str| {
            ImportError::new(file, ImportErrorKind::LeavesFolder(name.to_owned())).at(place.clone())
        };
        match folder.resolve(whole) {
            Ok(path) => return Ok(vec![(whole.to_owned(), path)]),
            Err(FolderError::Leaves) => return Err(leaves(whole)),
            Err(FolderError::NoFile | FolderError::Unreadable(_)) => {}
        }
        let mut files = Vec::new();
        if whole.is_empty() {
            self.warn(place.clone(), "mtllib without a file".to_owned());
        }
        for name in whole.split_whitespace() {
            match folder.resolve(name) {
                Ok(path) => files.push((name.to_owned(), path)),
                Err(FolderError::Leaves) => return Err(leaves(name)),
                Err(error) => {
                    self.warn(
                        place.clone(),
                        format!("the material library '{name}' cannot be read: {error}"),
                    );
                }
            }
        }
        Ok(files)
    }

    fn read(&mut self, name: &str, path: PathBuf, line: &Named) -> Result<(), ImportError> {
        let bytes = match read_whole(&path, self.budget, &format!("the material library '{name}'")) {
            Ok(bytes) => bytes,
            Err(ImportErrorKind::Io(error)) => {
                let text = format!("the material library '{name}' cannot be read: {error}");
                self.warn(format!("line {}", line.line), text);
                return Ok(());
            }
            Err(kind) => return Err(ImportError::new(self.file, kind).at(format!("line {}", line.line))),
        };
        self.hash.write(&bytes);
        let text = &mut bytes.as_slice();
        let materials = mtl::read(text, name, self.budget, &self.options.watch, self.warnings)?;
        self.budget.give_back(bytes.len() as u64);
        if materials.is_empty() {
            self.warn(name.to_owned(), "the material library has no materials".to_owned());
        }
        for described in materials {
            let place = format!("{name}: line {}", described.line);
            let key = described.material.name.clone();
            match self.known.get(&key) {
                Some((first, library)) => {
                    let text =
                        format!("the material '{key}' is defined before ({library}: line {})", first.line);
                    self.warn(place, text);
                }
                None => {
                    self.known.insert(key, (described, name.to_owned()));
                }
            }
        }
        Ok(())
    }

    /// The material of a name, with its texture.
    fn look(
        &mut self,
        named: &Named,
        means: &mut HashMap<PathBuf, Option<MeanColor>>,
    ) -> Result<Material, ImportError> {
        if named.text.is_empty() {
            return Ok(Material::default());
        }
        let Some((described, library)) = self.known.get(&named.text) else {
            let text = format!("no library has the material '{}': it is grey", named.text);
            self.warn(format!("line {}", named.line), text);
            return Ok(Material { name: named.text.clone(), ..Material::default() });
        };
        let mut material = described.material.clone();
        let (Some(texture), Some(folder)) = (described.texture.clone(), self.folder) else {
            return Ok(material);
        };
        let place = format!("{library}: line {}", described.line);
        // Exporters on Windows write backslashes; what they lead to is checked like any other name.
        let path = match folder.resolve(&texture.replace('\\', "/")) {
            Ok(path) => path,
            Err(error) => {
                let why = match error {
                    FolderError::Leaves => ImportErrorKind::LeavesFolder(texture.clone()).to_string(),
                    error => error.to_string(),
                };
                self.warn(place, format!("the texture '{texture}' is not read: {why}"));
                return Ok(material);
            }
        };
        let mean = match means.get(&path) {
            Some(&known) => known,
            None => {
                let mean = self.mean(&path, &texture, place)?;
                means.insert(path, mean);
                mean
            }
        };
        if let Some(mean) = mean {
            for (color, mean) in material.base_color.iter_mut().zip(mean.rgb) {
                *color *= mean as f32;
            }
            material.alpha *= mean.alpha as f32;
        }
        Ok(material)
    }

    /// A texture's mean, or a warning.
    fn mean(
        &mut self,
        path: &std::path::Path,
        name: &str,
        place: String,
    ) -> Result<Option<MeanColor>, ImportError> {
        self.options.watch.check().map_err(|e| ImportError::new(self.file, e))?;
        let mean = read_whole(path, self.budget, "a texture").and_then(|bytes| {
            // What shows little counts little.
            let mean = self
                .decoder
                .decode(&bytes, name, self.budget, |texels| ColorMeans::of(texels).weighted(|alpha| alpha));
            self.budget.give_back(bytes.len() as u64);
            mean
        });
        match mean {
            Ok(mean) => Ok(Some(mean)),
            Err(kind) => {
                self.warn(place, format!("the texture '{name}' is not read: {kind}"));
                Ok(None)
            }
        }
    }
}
