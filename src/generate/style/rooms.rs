//! By how much the faces of rooms are off the walls.

use super::super::lattice::metres;
use super::dice::Random;
use super::planes::Plane;

/// By how far the planes of a room move outward, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RoomShift {
    /// Upright planes. They have one step: corners between walls at a flat angle could not follow two.
    sides: f64,
    /// Planes that look up.
    above: f64,
    /// Planes that look down.
    below: f64,
    /// The height of the lowest planes, units, and how much of the room there is another thing's, metres.
    floor: Option<(i64, f64)>,
}

impl RoomShift {
    /// 0.1 to 10 mm to the outside (`sign` 1) or the inside (-1).
    pub fn off(sign: f64, mut random: Random) -> RoomShift {
        let mut step = || {
            // A tenth of a millimetre as often as a whole one.
            let scale = if random.fraction() < 0.5 { 1e-4 } else { 1e-3 };
            sign * scale * random.between(1.0, 10.0)
        };
        RoomShift { sides: step(), above: step(), below: step(), floor: None }
    }

    /// The same, farther out by `step` on all sides.
    pub fn farther(self, step: f64) -> RoomShift {
        RoomShift { sides: self.sides + step, above: self.above + step, below: self.below + step, ..self }
    }

    /// The same with the floor at `lowest` raised by `thickness`, both in units.
    pub fn on_floor(self, lowest: i32, thickness: i32) -> RoomShift {
        // Seen from the room the floor looks down.
        RoomShift { floor: Some((-i64::from(lowest), metres(thickness))), ..self }
    }

    /// What a plane of the room moves by.
    pub fn of(&self, (normal, height): &Plane) -> f64 {
        match normal[2].signum() {
            0 => self.sides,
            1 => self.above,
            _ => {
                let raised = self.floor.filter(|floor| *normal == [0, 0, -1] && floor.0 == *height);
                self.below - raised.map_or(0.0, |floor| floor.1)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::dice::Dice;
    use super::*;

    #[test]
    fn steps_are_of_tenths_of_millimetres_to_centimetres() {
        let dice = Dice::new(3);
        let mut all = Vec::new();
        for i in 0..200 {
            let off = RoomShift::off(-1.0, dice.draw("x", &i.to_string()));
            all.extend([[1, 0, 0], [0, 0, 1], [0, 0, -1]].map(|normal| -off.of(&(normal, 5))));
        }
        assert!(all.iter().all(|step| (1e-4..=1e-2).contains(step)));
        let small = all.iter().filter(|step| **step < 1e-3).count();
        assert!((200..400).contains(&small), "{small} of 600");
    }

    #[test]
    fn only_the_lowest_floor_is_raised() {
        let raised = RoomShift::default().on_floor(-64, 32);
        assert_eq!(raised.of(&([0, 0, -1], 64)), -0.03125);
        assert_eq!(raised.of(&([0, 0, -1], 63)), 0.0);
        assert_eq!(raised.of(&([0, 0, 1], 64)), 0.0);
    }
}
