//! Where a building stands: turned, moved off all grids, far away, in another unit.

use super::dice::Random;
use super::{Style, Unit};
use crate::importers::{Camera, Frame, Light};

/// Cosine and sine of 23.7 degrees, rounded once: a library's functions may differ from machine to machine.
const TURN: [f64; 2] = [0.9156625933395611, 0.4019477766559601];

/// What is off the grid is moved by so much, metres, Z up: no number of which has an end in binary or decimal.
const OFF_GRID: [f64; 3] = [1.0 / 3.0, -1.0 / 7.0, 1.0 / 11.0];

/// How far a corner off the grid is from its place at most, along each axis, metres.
const JITTER: f64 = 5e-6;

/// Where far buildings stand, metres, Z up: a place in a national grid.
const FAR: [f64; 3] = [458_123.4, 5_427_891.7, 112.3];

/// From the building's axes to those of a style, before the placement.
#[derive(Clone, Copy, Debug)]
pub struct Move {
    turn: Option<[f64; 2]>,
    shift: Option<[f64; 3]>,
    /// How far corners are off at most, along each axis, metres.
    jitter: f64,
}

impl Move {
    pub fn of(style: &Style) -> Move {
        let jitter = length(style.jitter) + if style.off_grid { JITTER } else { 0.0 };
        Move { turn: style.turned.then_some(TURN), shift: style.off_grid.then_some(OFF_GRID), jitter }
    }

    pub fn direction(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        match self.turn {
            Some([cosine, sine]) => [cosine * x - sine * y, sine * x + cosine * y, z],
            None => [x, y, z],
        }
    }

    pub fn point(&self, p: [f64; 3]) -> [f64; 3] {
        let q = self.direction(p);
        match self.shift {
            Some(shift) => [0, 1, 2].map(|i| q[i] + shift[i]),
            None => q,
        }
    }

    /// Moves the corners of an element, and shakes them.
    pub fn corners(&self, points: &mut [[f64; 3]], random: impl FnOnce() -> Random) {
        if self.turn.is_some() || self.shift.is_some() {
            points.iter_mut().for_each(|p| *p = self.point(*p));
        }
        if self.jitter > 0.0 {
            let mut random = random();
            for p in points {
                let off = random.around(self.jitter);
                *p = [0, 1, 2].map(|i| p[i] + off[i]);
            }
        }
    }

    pub fn light(&self, light: &Light) -> Light {
        let (position, direction) = (self.point(light.position), self.direction(light.direction));
        Light { position, direction, ..light.clone() }
    }

    pub fn camera(&self, camera: &Camera) -> Camera {
        Camera {
            eye: self.point(camera.eye),
            direction: self.direction(camera.direction),
            up: self.direction(camera.up),
            ..camera.clone()
        }
    }
}

/// A length of a style: what is none is zero.
pub fn length(metres: f64) -> f64 {
    if metres.is_finite() { metres } else { 0.0 }
}

impl Style {
    /// Where a point of the building as it was drawn lies in a file of this style: metres, Z up.
    pub(in super::super) fn place(&self, point: [f64; 3]) -> [f64; 3] {
        let (moved, origin) = (Move::of(self).point(point), Placement::of(self).origin);
        [0, 1, 2].map(|i| moved[i] + origin[i])
    }

    /// Where a direction of the building as it was drawn points.
    pub(in super::super) fn direction(&self, direction: [f64; 3]) -> [f64; 3] {
        Move::of(self).direction(direction)
    }
}

/// From coordinates in metres, Z up, to those of a file and its root node, Y up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    unit: Unit,
    /// Metres, Z up.
    origin: [f64; 3],
}

impl Placement {
    pub fn of(style: &Style) -> Placement {
        Placement { unit: style.unit, origin: if style.far { FAR } else { [0.0; 3] } }
    }

    /// Whether files of this placement need no root node.
    pub fn is_plain(&self) -> bool {
        *self == Placement { unit: Unit::Metre, origin: [0.0; 3] }
    }

    pub fn unit(&self) -> Unit {
        self.unit
    }

    /// A point below the root node.
    pub fn local(&self, p: [f64; 3]) -> [f64; 3] {
        self.in_unit(y_up(p))
    }

    /// A point in a file without root node.
    pub fn global(&self, p: [f64; 3]) -> [f64; 3] {
        self.in_unit(y_up([0, 1, 2].map(|i| p[i] + self.origin[i])))
    }

    fn in_unit(&self, p: [f64; 3]) -> [f64; 3] {
        match self.unit {
            Unit::Metre => p,
            unit => p.map(|c| c / unit.metres()),
        }
    }

    /// The root node's matrix, column by column.
    pub fn matrix(&self) -> [f64; 16] {
        let s = self.unit.metres();
        let [x, y, z] = y_up(self.origin);
        [s, 0.0, 0.0, 0.0, 0.0, s, 0.0, 0.0, 0.0, 0.0, s, 0.0, x, y, z, 1.0]
    }

    /// A point below the root node in metres: what a reader makes of it.
    pub fn in_metres(&self, local: [f64; 3]) -> [f64; 3] {
        if self.is_plain() {
            return local;
        }
        let origin = y_up(self.origin);
        [0, 1, 2].map(|i| local[i] * self.unit.metres() + origin[i])
    }
}

/// In glTF's and OBJ's axes; no negative zero.
pub fn y_up(p: [f64; 3]) -> [f64; 3] {
    Frame::GLTF.direction_to_source(p).map(|c| c + 0.0)
}

#[cfg(test)]
mod tests {
    use super::super::dice::Dice;
    use super::*;

    #[test]
    fn the_turn_is_a_turn_by_its_angle() {
        let [cosine, sine] = TURN;
        assert!((sine.atan2(cosine).to_degrees() - 23.7).abs() < 1e-12);
        assert!((cosine * cosine + sine * sine - 1.0).abs() < 1e-15);
        let style = Style { turned: true, ..Style::exact() };
        let [x, y, z] = Move::of(&style).point([1.0, 0.0, 5.0]);
        assert_eq!([x, y, z], [cosine, sine, 5.0]);
    }

    #[test]
    fn corners_shake_by_micrometres() {
        let style = Style { off_grid: true, ..Style::exact() };
        let mut points = vec![[1.0, 2.0, 3.0]; 100];
        Move::of(&style).corners(&mut points, || Dice::new(1).draw("jitter", "x"));
        let off = |p: &[f64; 3]| [0, 1, 2].map(|i| p[i] - [1.0, 2.0, 3.0][i] - OFF_GRID[i]);
        assert!(points.iter().flat_map(off).all(|c| c.abs() <= 5.001e-6));
        assert!(points.iter().flat_map(off).any(|c| c.abs() > 4e-6));
    }

    #[test]
    fn root_nodes_undo_units() {
        let style = Style { far: true, unit: Unit::Millimetre, ..Style::exact() };
        let placement = Placement::of(&style);
        let p = [1.25, 2.5, 3.0];
        let there = placement.in_metres(placement.local(p));
        let global = placement.global(p).map(|c| c * 0.001);
        for i in 0..3 {
            assert!((there[i] - y_up([p[0] + FAR[0], p[1] + FAR[1], p[2] + FAR[2]])[i]).abs() < 1e-8);
            assert!((there[i] - global[i]).abs() < 1e-8);
        }
        assert!(!placement.is_plain() && Placement::of(&Style::exact()).is_plain());
        assert_eq!(
            Placement::of(&Style::exact()).local([1.0, 0.0, 2.0]).map(f64::to_bits),
            [1.0, 2.0, 0.0].map(f64::to_bits)
        );
    }
}
