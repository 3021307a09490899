//! MTL: a guard before `tobj`, and what its materials become.
//!
//! `tobj` panics on a colour of fewer than three numbers and errs on some statements that exporters write, so the
//! guard hands on only what enfilade uses, in the form that `tobj` expects.

use std::io::BufRead;

use crate::error::{ImportError, ImportErrorKind};
use crate::limits::Budget;
use crate::model::{Material, Warning};
use crate::obj::feed::{Feed, Guard, excerpt};
use crate::watch::Watch;

/// A material of a library, before its texture is looked at.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Described {
    pub(super) material: Material,
    /// The file of `map_Kd`, as the library has it.
    pub(super) texture: Option<String>,
    /// The line of its `newmtl`.
    pub(super) line: u64,
}

/// The materials of a library, in its order.
///
/// # Errors
/// Values that are no numbers, a file that is no text, too much memory.
pub(super) fn read(
    text: &mut dyn BufRead,
    file: &str,
    budget: &mut Budget,
    watch: &Watch,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<Described>, ImportError> {
    let guard = MtlGuard { file: file.to_owned(), lines: Vec::new(), warnings: Vec::new() };
    let mut feed = Feed::new(text, guard, budget, watch, &|_| {});
    let (materials, _) = match tobj::load_mtl_buf(&mut feed) {
        Ok(materials) => materials,
        Err(error) => return Err(feed.failure(error)),
    };
    let (_, guard) = feed.into_parts();
    warnings.extend(guard.warnings);
    let describe = |(material, &line): (tobj::Material, &u64)| {
        let texture = material.diffuse_texture.as_deref().map(texture_file).map(str::to_owned);
        Described { material: material_of(&material), texture, line }
    };
    // The guard notes a line for each `newmtl` that it hands on, and `tobj` makes a material of each.
    Ok(materials.into_iter().zip(&guard.lines).map(describe).collect())
}

#[derive(Debug)]
struct MtlGuard {
    file: String,
    /// The lines of the materials.
    lines: Vec<u64>,
    warnings: Vec<Warning>,
}

impl MtlGuard {
    fn warn(&mut self, line: u64, text: String) {
        self.warnings.push(Warning { place: format!("{}: line {line}", self.file), text });
    }

    /// The numbers at the start of `rest`; `None` with a warning if one is not finite.
    fn numbers(&mut self, line: u64, statement: &str, rest: &str) -> Result<Option<Vec<f64>>, ImportError> {
        let mut numbers = Vec::new();
        for word in rest.split_whitespace().take_while(|w| !w.starts_with('#')).take(3) {
            let Ok(number) = word.parse::<f64>() else {
                let kind = ImportErrorKind::Malformed(format!("'{}': no number", excerpt(statement)));
                return Err(self.error(line, kind));
            };
            numbers.push(number);
        }
        if numbers.is_empty() {
            let kind = ImportErrorKind::Malformed(format!("'{}': no value", excerpt(statement)));
            return Err(self.error(line, kind));
        }
        if numbers.iter().any(|n| !n.is_finite()) {
            self.warn(line, format!("'{}' is not finite, and left out", excerpt(statement)));
            return Ok(None);
        }
        Ok(Some(numbers))
    }
}

impl Guard for MtlGuard {
    fn statement(
        &mut self,
        line: u64,
        statement: &[u8],
        budget: &mut Budget,
        out: &mut Vec<u8>,
    ) -> Result<(), ImportError> {
        let statement = String::from_utf8_lossy(statement);
        let statement = statement.trim();
        let end = statement.find(char::is_whitespace).unwrap_or(statement.len());
        let (keyword, rest) = (&statement[..end], statement[end..].trim());
        let mut hand_on = |keyword: &str, rest: &str| {
            out.extend_from_slice(format!("{keyword} {rest}\n").as_bytes());
        };
        match keyword {
            "newmtl" => {
                budget
                    .take(1024 + 4 * rest.len() as u64, "materials")
                    .map_err(|e| self.error(line, e.into()))?;
                self.lines.push(line);
                if rest.is_empty() {
                    self.warn(line, "a material without a name".to_owned());
                }
                // A name that no `usemtl` can have, as that has its blanks taken off.
                hand_on(keyword, if rest.is_empty() { "\u{1}" } else { rest });
            }
            "Kd" | "Ke" | "Tf" if rest.starts_with("spectral") || rest.starts_with("xyz") => {
                self.warn(line, format!("'{}' is no RGB colour, and left out", excerpt(statement)));
            }
            "Kd" | "Ke" | "Tf" => {
                if let Some(n) = self.numbers(line, statement, rest)? {
                    // One number stands for three.
                    let (g, b) = (n.get(1).unwrap_or(&n[0]), n.get(2).unwrap_or(&n[0]));
                    hand_on(keyword, &format!("{:?} {g:?} {b:?}", n[0]));
                }
            }
            "d" | "Tr" | "Ns" | "Ni" | "Pr" | "Pm" => {
                let rest = rest.strip_prefix("-halo").unwrap_or(rest);
                if let Some(n) = self.numbers(line, statement, rest)? {
                    hand_on(keyword, &format!("{:?}", n[0]));
                }
            }
            "illum" => {
                if let Some(n) = self.numbers(line, statement, rest)? {
                    // Beyond the models that there are is as good as none.
                    hand_on(keyword, &format!("{}", n[0].clamp(0.0, 255.0) as u8));
                }
            }
            "map_Kd" | "map_kd" if rest.is_empty() => {
                self.warn(line, "map_Kd without a file".to_owned());
            }
            "map_Kd" | "map_kd" => {
                budget.take(4 * rest.len() as u64, "materials").map_err(|e| self.error(line, e.into()))?;
                hand_on("map_Kd", rest);
            }
            _ => {}
        }
        Ok(())
    }

    fn end(&mut self, _: &mut Budget) -> Result<(), ImportError> {
        Ok(())
    }

    fn error(&self, number: u64, kind: ImportErrorKind) -> ImportError {
        ImportError::new(self.file.clone(), kind).at(format!("line {number}"))
    }
}

fn material_of(mtl: &tobj::Material) -> Material {
    let unit = |value: f64| value.clamp(0.0, 1.0) as f32;
    let parameter = |name: &str| -> Option<f64> { mtl.unknown_param.get(name)?.parse().ok() };
    let default = Material::default();
    let base_color = match (mtl.diffuse, &mtl.diffuse_texture) {
        (Some(color), _) => color.map(unit),
        (None, Some(_)) => [1.0; 3],
        (None, None) => default.base_color,
    };
    let alpha = mtl.dissolve.or_else(|| parameter("Tr").map(|t| 1.0 - t)).map_or(1.0, unit);
    let roughness = match (parameter("Pr"), mtl.shininess) {
        (Some(roughness), _) => unit(roughness),
        // The roughness whose microfacets have about the highlight of a Phong lobe of this exponent.
        (None, Some(exponent)) => unit((2.0 / (exponent.max(0.0) + 2.0)).sqrt()),
        (None, None) => default.roughness,
    };
    Material {
        name: if mtl.name == "\u{1}" { String::new() } else { mtl.name.clone() },
        base_color,
        alpha,
        metallic: parameter("Pm").map_or(0.0, unit),
        roughness,
        emissive: mtl.emissive.map_or([0.0; 3], |e| e.map(|v| v.clamp(0.0, f64::from(f32::MAX)) as f32)),
        ior: mtl.optical_density.filter(|&n| n > 0.0).map_or(default.ior, |n| n.clamp(0.001, 10.0) as f32),
        transmission: transmission(mtl),
    }
}

/// How much light goes through, by `illum` (4, 6, 7, 9 are glass) and `Tf`.
///
/// Some exporters write `Tf 1 1 1` for every material, some with `illum 4` even, which by the letter would make all
/// walls of clear glass. So a `Tf` of ones counts only with an illumination model that refracts.
fn transmission(mtl: &tobj::Material) -> f32 {
    let filter = mtl.unknown_param.get("Tf").map(|text| {
        let channels: Vec<f64> = text.split_whitespace().filter_map(|w| w.parse().ok()).collect();
        channels.iter().sum::<f64>() / channels.len().max(1) as f64
    });
    let share = match (filter, mtl.illumination_model) {
        (Some(filter), model) if filter >= 1.0 => f64::from(matches!(model, Some(6 | 7 | 9))),
        (Some(filter), _) => filter,
        (None, model) => f64::from(matches!(model, Some(4 | 6 | 7 | 9))),
    };
    share.clamp(0.0, 1.0) as f32
}

/// The file of a `map_` statement, after its options.
fn texture_file(statement: &str) -> &str {
    let mut rest = statement.trim();
    while rest.starts_with('-') {
        let (option, after) = next_word(rest);
        let (fewest, most) = match option {
            "-o" | "-s" | "-t" => (1, 3),
            "-mm" => (2, 2),
            "-blendu" | "-blendv" | "-bm" | "-boost" | "-cc" | "-clamp" | "-imfchan" | "-texres"
            | "-type" => (1, 1),
            // A file's name may begin with a dash.
            _ => break,
        };
        rest = after;
        for count in 0..most {
            let (word, after) = next_word(rest);
            if count < fewest || word.parse::<f64>().is_ok() {
                rest = after;
            }
        }
    }
    rest
}

fn next_word(text: &str) -> (&str, &str) {
    let end = text.find(char::is_whitespace).unwrap_or(text.len());
    (&text[..end], text[end..].trim_start())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;

    fn library(text: &str) -> Result<(Vec<Described>, Vec<Warning>), ImportError> {
        let mut warnings = Vec::new();
        let mut budget = Budget::new(&Limits::default());
        let watch = Watch::default();
        let materials = read(&mut text.as_bytes(), "a.mtl", &mut budget, &watch, &mut warnings)?;
        Ok((materials, warnings))
    }

    fn one(statements: &str) -> Material {
        library(&format!("newmtl m\n{statements}\n")).unwrap().0[0].material.clone()
    }

    #[test]
    fn every_value_is_read() {
        let m = one("Ka 1 1 1\nKd 0.1 0.2 0.3\nKe 4 0 0\nNs 98\nNi 1.33\nd 0.5\nPm 0.25\nillum 2");
        assert_eq!(m.name, "m");
        assert_eq!(m.base_color, [0.1, 0.2, 0.3]);
        assert_eq!(m.emissive, [4.0, 0.0, 0.0]);
        assert!((m.roughness - 0.141_421).abs() < 1e-5);
        assert_eq!((m.ior, m.alpha, m.metallic, m.transmission), (1.33, 0.5, 0.25, 0.0));
        assert_eq!(one("Pr 0.3\nNs 98").roughness, 0.3);
        assert_eq!(one("Tr 0.25").alpha, 0.75);
        assert_eq!(one("Tr 0.25\nd 1").alpha, 1.0);
        assert_eq!(one("d -halo 0.5").alpha, 0.5);
        assert_eq!(one("Kd 0.5 # grey").base_color, [0.5; 3]);
        assert_eq!(one("Kd 9 -1 0.5").base_color, [1.0, 0.0, 0.5]);
        assert_eq!(one(""), Material { name: "m".into(), ..Material::default() });
    }

    #[test]
    fn glass_is_told_from_exporters_habits() {
        assert_eq!(one("illum 4").transmission, 1.0);
        assert_eq!(one("illum 2\nd 0.2").transmission, 0.0);
        assert_eq!(one("illum 7\nTf 1 1 1").transmission, 1.0);
        assert_eq!(one("illum 4\nTf 1.00 1.00 1.00").transmission, 0.0);
        assert_eq!(one("illum 2\nTf 1 1 1").transmission, 0.0);
        assert_eq!(one("Tf 0.25 0.5 0.75").transmission, 0.5);
        assert_eq!(one("illum 6\nTf 0").transmission, 0.0);
    }

    #[test]
    fn names_keep_blanks_and_letters() {
        let (materials, _) = library("newmtl  Glas, grün \r\nKd 1 0 0\r\n\tnewmtl b\n\tKd 0 1 0").unwrap();
        let names: Vec<&str> = materials.iter().map(|m| m.material.name.as_str()).collect();
        assert_eq!(names, ["Glas, grün", "b"]);
        assert_eq!((materials[0].line, materials[1].line), (1, 3));
        assert_eq!(materials[1].material.base_color, [0.0, 1.0, 0.0]);
    }

    #[test]
    fn texture_options_are_skipped() {
        assert_eq!(texture_file("a b.png"), "a b.png");
        assert_eq!(texture_file("-s 2 2 -o 0 0 0 -clamp on my tex.png"), "my tex.png");
        assert_eq!(texture_file("-bm 0.5 -mm 0 1 t.jpg"), "t.jpg");
        assert_eq!(texture_file("-x.png"), "-x.png");
        assert_eq!(texture_file("-s"), "");
        let (materials, _) = library("newmtl a\nmap_Kd -o 1 t.png\nnewmtl b\nKd 0 0 0").unwrap();
        assert_eq!(materials[0].texture.as_deref(), Some("t.png"));
        assert_eq!(materials[0].material.base_color, [1.0; 3]);
    }

    #[test]
    fn odd_values_are_left_out_with_a_warning() {
        let odd = [
            "Kd spectral file.rfl",
            "Kd nan 0 0",
            "Ke inf",
            "Ns 1e999",
            "Kd xyz 1 1 1",
            "map_Kd",
            "newmtl",
            "illum nan",
        ];
        for statement in odd {
            let (materials, warnings) = library(&format!("newmtl m\n{statement}\n")).unwrap();
            let expected = Material { name: "m".into(), ..Material::default() };
            assert_eq!(materials[0].material, expected, "{statement}");
            assert_eq!(warnings.len(), 1, "{statement}");
            assert_eq!(warnings[0].place, "a.mtl: line 2");
        }
        assert!(library("Kd 1 1 1\nmap_Kd x\nunknown\n").unwrap().0.is_empty(), "nothing before newmtl");
        assert_eq!(library("newmtl a\nillum 999\nKs 1\nmap_Ka\nbump\nrefl -type").unwrap().1, []);
    }

    #[test]
    fn damaged_libraries_are_errors_with_their_line() {
        for statement in ["Kd", "Kd a b c", "Kd 1,0 0,5 0,5", "Ns x", "d", "Ni # 1", "illum", "Tf x", "\0"] {
            let error = library(&format!("newmtl m\n\n{statement}\n")).unwrap_err();
            assert_eq!((error.file.as_str(), error.place.as_str()), ("a.mtl", "line 3"), "{statement}");
        }
    }
}
