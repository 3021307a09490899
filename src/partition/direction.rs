//! The direction of a building's walls in the plan.

use enfilade_importers::Model;
use glam::{DVec2, DVec3};

/// Walls whose directions differ by no more than this have one direction, but for noise, radians.
const NOISE: f64 = 2e-6;

/// The direction along which most of the vertical area of `elements` runs, as cosine and sine of an angle of less than an
/// eighth turn either way: buildings have two directions a quarter turn apart. Exactly `[1, 0]` if that direction
/// is the internal frame's own, as far as it matters over `reach` metres with steps of `step` metres.
pub(super) fn direction(
    model: &Model,
    elements: impl Iterator<Item = u32>,
    reach: f64,
    step: f64,
) -> [f64; 2] {
    // Angles in a quarter turn about 0, and areas.
    let mut walls: Vec<(f64, f64)> = Vec::new();
    for element in elements {
        let mesh = &model.elements[element as usize].mesh;
        for t in 0..mesh.triangles.len() {
            let [a, b, c] = mesh.corners(t).map(DVec3::from);
            let normal = (b - a).cross(c - a);
            let across = normal.truncate();
            if normal.z.abs() <= 1e-6 * across.length() && across.length_squared() > 0.0 {
                walls.push((folded(across), across.length()));
            }
        }
    }
    let quarter = std::f64::consts::FRAC_PI_2;
    // The ends of the quarter turn are one direction.
    let wrapped: Vec<(f64, f64)> =
        walls.iter().filter(|w| w.0 < -quarter / 2.0 + NOISE).map(|w| (w.0 + quarter, w.1)).collect();
    walls.extend(wrapped);
    walls.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let Some(window) = heaviest(&walls) else { return [1.0, 0.0] };
    // The median: exact where most walls are, whatever the others do.
    let half = window.iter().map(|w| w.1).sum::<f64>() / 2.0;
    let mut sum = 0.0;
    let median = window.iter().find(|w| {
        sum += w.1;
        sum >= half
    });
    let angle = median.map_or(0.0, |w| w.0);
    let angle = angle - (angle / quarter).round() * quarter;
    if angle.abs() * reach <= step / 4.0 { [1.0, 0.0] } else { [libm::cos(angle), libm::sin(angle)] }
}

/// Of the runs of sorted walls within [`NOISE`] the one of most area, the first of equals.
fn heaviest(walls: &[(f64, f64)]) -> Option<&[(f64, f64)]> {
    let (mut start, mut area) = (0, 0.0);
    let mut best: Option<(f64, usize, usize)> = None;
    for (end, wall) in walls.iter().enumerate() {
        area += wall.1;
        while wall.0 - walls[start].0 > NOISE {
            area -= walls[start].1;
            start += 1;
        }
        if best.is_none_or(|best| area > best.0) {
            best = Some((area, start, end));
        }
    }
    best.map(|(_, start, end)| &walls[start..=end])
}

/// The angle of a direction in the plan, a quarter turn making no difference.
fn folded(d: DVec2) -> f64 {
    // Exactly 0 along the axes.
    let (x, y) = if d.x.abs() >= d.y.abs() { (d.x, d.y) } else { (d.y, -d.x) };
    libm::atan(y / x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_fold() {
        for (x, y, angle) in [
            (1.0, 0.0, 0.0),
            (0.0, 1.0, 0.0),
            (-1.0, 0.0, 0.0),
            (0.0, -2.0, 0.0),
            (2.0, 1.0, 0.46364760900080615),
            (-1.0, 2.0, 0.46364760900080615),
        ] {
            assert!((folded(DVec2::new(x, y)) - angle).abs() < 1e-15, "{x} {y}");
        }
    }
}
