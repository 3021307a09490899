//! What cutting the space into cells came to, as text: for `inspect` and `compile`.

use std::fmt::Write;

use enfilade::partition::PartitionReport;

/// Voids that are listed.
const VOIDS: usize = 5;

/// Elements that do not carve that are listed.
const NOT_CARVED: usize = 10;

pub fn write(out: &mut String, p: &PartitionReport) -> std::fmt::Result {
    writeln!(
        out,
        "{} slabs, {} columns, lattice step {:.1} um",
        p.levels.len().saturating_sub(1),
        p.columns,
        p.lattice_step * 1e6
    )?;
    for (kind, cells) in &p.cells {
        let volume = p.volumes.get(kind).copied().unwrap_or_default();
        // Unlabelled air is void or exterior only once cells know what it reaches.
        let pieces = p.pieces.get(kind).map_or(String::new(), |pieces| format!(" (merged from {pieces})"));
        writeln!(out, "  {cells:>10} {kind} cells{pieces}, {volume:.3} m3")?;
    }
    if p.slivers_volume > 0.0 {
        writeln!(out, "{:.4} m3 of thin air joined to {} rooms", p.slivers_volume, p.slivers.len())?;
    }
    for (i, void) in p.voids.iter().enumerate().take(VOIDS) {
        if i == 0 {
            writeln!(out, "the largest of {} voids:", p.voids.len())?;
        }
        let [lo, hi] = void.bounds;
        writeln!(
            out,
            "  {:>10.3} m3 within ({:.3} {:.3} {:.3}) to ({:.3} {:.3} {:.3})",
            void.volume, lo[0], lo[1], lo[2], hi[0], hi[1], hi[2]
        )?;
    }
    writeln!(out, "{} components of solid elements carve", p.carved)?;
    for (why, count) in &p.not_carved {
        writeln!(out, "{count} do not, and stay detail: {}", why.text())?;
    }
    for (path, why) in p.not_carved_elements.iter().take(NOT_CARVED) {
        writeln!(out, "  {path}: {}", why.text())?;
    }
    if p.not_carved_elements.len() > NOT_CARVED {
        writeln!(out, "  and {} more (--json lists all)", p.not_carved_elements.len() - NOT_CARVED)?;
    }
    let share = |part: f64, whole: f64| if whole > 0.0 { 100.0 * part / whole } else { 0.0 };
    let d = &p.detail;
    writeln!(
        out,
        "detail: {} of {} triangles, {:.1} of {:.1} m2 ({:.1} %)",
        d.triangles,
        d.of_triangles,
        d.area,
        d.of_area,
        share(d.area, d.of_area)
    )?;
    let a = &p.audit;
    writeln!(
        out,
        "of what carves, {} of {} triangles are neither on nor in matter, and are detail: {:.4} of {:.1} m2",
        a.detail.triangles, a.triangles, a.detail.exposed, a.area
    )?;
    let s = &p.surfaces;
    writeln!(
        out,
        "of {} faces between air and matter, {} are matter that no triangle bounds: {:.4} of {:.1} m2",
        s.faces, s.false_faces, s.false_area, s.area
    )?;
    if s.given_back > 0 {
        let (cells, volume) = (s.given_back, s.given_back_volume);
        writeln!(
            out,
            "{cells} cells of matter without a surface, {volume:.6} m3, were given back to the air"
        )?;
    }
    Ok(())
}
