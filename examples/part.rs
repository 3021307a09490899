use enfilade::importers::*;
use enfilade::partition::{self, cells::*};
use enfilade::lattice::*;
fn main() {
    for path in std::env::args().skip(1) {
        let model = import(path.as_ref(), &ImportOptions::default()).unwrap();
        let t = std::time::Instant::now();
        let (p, r) = match partition::partition(&model, Untagged::default()) { Ok(x) => x, Err(e) => { println!("{path}: ERROR {e}"); continue } };
        let secs = t.elapsed().as_secs_f64();
        let mut count = std::collections::BTreeMap::<&str, usize>::new();
        let kind = |l: &Label| match l { Label::Solid(_) => "solid", Label::Exterior => "exterior", Label::Void => "void",
            Label::Air(e) => match model.elements[e.0 as usize].semantic { Semantic::Door|Semantic::Window|Semantic::Opening => "opening", _ => "room" } };
        for c in &p.cells { *count.entry(kind(&c.label)).or_default() += 1; }
        let air = p.cells.iter().filter(|c| c.label.is_air()).count();
        let fine = |pl: u32, pt: Point| p.planes[pl as usize].height(pt) as i128;
        let mut vol = 0i128; let mut neg = 0; let mut none = 0; let mut portals = 0;
        for c in &p.cells {
            let f: Vec<Point> = p.footprint(c).collect();
            for i in 1..f.len() - 1 {
                let tri = [f[0], f[i], f[i + 1]];
                let h: i128 = tri.iter().map(|&q| fine(c.ceiling, q) - fine(c.floor, q)).sum();
                vol += orient(tri[0], tri[1], tri[2]) as i128 * h;
            }
            if f.iter().any(|&q| fine(c.ceiling, q) < fine(c.floor, q)) { neg += 1; }
            for s in &p.sections[c.sections.start as usize..c.sections.end as usize] { for fa in &p.faces[s.faces.start as usize..s.faces.end as usize] {
                if fa.cover.cell == NONE { none += 1 } else if c.label.is_air() && p.cells[fa.cover.cell as usize].label.is_air() { portals += 1 } } }
        }
        let d = |i: usize| (p.hull[1][i] - p.hull[0][i]) as i128;
        let hull = d(0) * d(1) * d(2) * 6 * FINE as i128;
        let mut why = std::collections::BTreeMap::<String, usize>::new();
        for (_, w) in &r.not_carved { *why.entry(format!("{w:?}")).or_default() += 1; }
        println!("{}: {:.3}s slabs {} columns {} air pieces {} AIR {} {:?} portals {} volume diff {} neg {} hullfaces {} displ {:.6} notcarved {:?} detail {}", path.rsplit('/').next().unwrap(), secs, r.levels.len() - 1, r.columns, r.air_pieces, air, count, portals / 2, vol - hull, neg, none, r.largest_displacement, why, p.detail.len());
        println!("   {:?}", r.stages.iter().map(|(n, s)| format!("{n} {s:.3}")).collect::<Vec<_>>());
    }
}
