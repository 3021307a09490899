//! What figures of measurements are drawn with: scales, lines, dots.

use crate::plan::{Anchor, Color, Shape};

/// Axes and titles.
pub(super) const BLACK: Color = [20, 20, 20];
/// Grids.
pub(super) const GREY: Color = [215, 215, 215];

/// From numbers to places on a sheet, along one axis.
#[derive(Clone, Copy)]
pub(super) struct Scale {
    /// What is at its ends: exponents of ten, or the numbers themselves.
    ends: [f64; 2],
    /// Where those are on the sheet.
    places: [f64; 2],
    is_log: bool,
}

impl Scale {
    /// From the power of ten at or below the least of some numbers to that at or above the greatest.
    pub fn powers(numbers: impl Iterator<Item = f64>, places: [f64; 2]) -> Scale {
        let [lo, hi] = numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], number| {
            let power = number.log10();
            [lo.min(power), hi.max(power)]
        });
        let [lo, hi] = if lo.is_finite() && hi.is_finite() { [lo.floor(), hi.ceil()] } else { [0.0, 1.0] };
        Scale { ends: [lo, hi.max(lo + 1.0)], places, is_log: true }
    }

    /// Even, from one number to another.
    pub fn even(ends: [f64; 2], places: [f64; 2]) -> Scale {
        Scale { ends, places, is_log: false }
    }

    /// Where a number is on the sheet.
    pub fn place(&self, number: f64) -> f64 {
        let [lo, hi] = self.ends;
        let number = if self.is_log { number.log10() } else { number };
        let share = (number - lo) / (hi - lo);
        self.places[0] + share * (self.places[1] - self.places[0])
    }

    /// Where its lines are, and how they are called: powers of ten, or quarters.
    pub fn marks(&self) -> Vec<(f64, String)> {
        let [lo, hi] = self.ends;
        if self.is_log {
            let name = |power: i32| match power {
                0..=4 => 10_i32.pow(power as u32).to_string(),
                _ => format!("1e{power}"),
            };
            let powers = lo as i32..=hi as i32;
            return powers.map(|power| (self.place(10f64.powi(power)), name(power))).collect();
        }
        let quarters = (0..=4).map(|quarter| lo + (hi - lo) * f64::from(quarter) / 4.0);
        quarters.map(|number| (self.place(number), number.to_string())).collect()
    }
}

pub(super) fn text(at: [f64; 2], size: f64, anchor: Anchor, text: String) -> Shape {
    Shape::Text { at, size, anchor, color: BLACK, text }
}

pub(super) fn lines(lines: Vec<Vec<[f64; 2]>>, color: Color, width: f64) -> Shape {
    Shape::Lines { lines, color, width }
}

/// A disc.
pub(super) fn dot([x, y]: [f64; 2], radius: f64, fill: Color, title: String) -> Shape {
    let corners = (0..24).map(|i| f64::from(i) / 24.0 * std::f64::consts::TAU);
    let polygon = corners.map(|angle| [x + radius * angle.cos(), y + radius * angle.sin()]).collect();
    Shape::Area { polygons: vec![polygon], fill, stroke: None, title }
}
