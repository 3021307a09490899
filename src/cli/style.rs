//! The options of `generate` that say how a building is written.

use clap::{Args, ValueEnum};
use enfilade::generate::{Style, Unit};

/// How to write the building.
#[derive(Args, Debug, Clone)]
#[command(
    next_help_heading = "Export style (docs/GENERATE.md; SHARE: of the elements, 0 to 1, by default all)"
)]
pub struct StyleArguments {
    /// Start from the building as it is, or from the usual mix of a drawing tool's export.
    #[arg(long, value_enum, value_name = "STYLE", default_value = "exact")]
    style: Preset,
    /// Start from all oddities, each with this probability, by the style's seed.
    #[arg(long, value_name = "P", value_parser = parse_share, conflicts_with = "style")]
    damage: Option<f64>,
    /// Which elements get an oddity, and how much of it, follows from this.
    #[arg(long, value_name = "S", default_value_t = 0)]
    style_seed: u64,
    #[command(flatten)]
    shares: Shares,
    /// All rooms end so far before walls, floor and ceiling, metres; if negative, they reach into them.
    #[arg(long, value_name = "METRES", value_parser = parse_length, allow_hyphen_values = true)]
    room_gap: Option<f64>,
    /// All faces of walls, slabs and the like lie so far inward, metres; if negative, outward.
    #[arg(long, value_name = "METRES", value_parser = parse_length, allow_hyphen_values = true)]
    solid_gap: Option<f64>,
    /// Each corner of each element is off by up to so much along each axis, metres: no face is quite planar.
    #[arg(long, value_name = "METRES", value_parser = parse_size)]
    jitter: Option<f64>,
    /// Each corner of each triangle is off by up to so much along each axis, metres: nothing is closed.
    #[arg(long, value_name = "METRES", value_parser = parse_size)]
    noise: Option<f64>,
    /// A space over all rooms of each storey.
    #[arg(long)]
    storey_spaces: bool,
    /// No coordinate a round number, no face quite planar: all moved by a third of a metre and the like, each corner
    /// by up to 5 micrometres.
    #[arg(long)]
    off_grid: bool,
    /// All turned by 23.7 degrees.
    #[arg(long)]
    turned: bool,
    /// All 5,400 km away.
    #[arg(long)]
    far: bool,
    /// Unit of coordinates: glTF has a root node with the scale, OBJ nothing that says so.
    #[arg(long, value_enum, value_name = "UNIT")]
    written_in: Option<UnitName>,
}

/// Declares one flag for each share: its field, and what it does.
macro_rules! shares {
    ($($field:ident: $help:literal;)*) => {
        #[derive(Args, Debug, Clone)]
        struct Shares {
            $(
                #[doc = $help]
                #[arg(
                    long,
                    value_name = "SHARE",
                    value_parser = parse_share,
                    num_args = 0..=1,
                    require_equals = true,
                    default_missing_value = "1",
                )]
                $field: Option<f64>,
            )*
        }

        impl Shares {
            /// Sets the shares that were given.
            fn apply(&self, style: &mut Style) {
                $(
                    if let Some(share) = self.$field {
                        style.$field = share;
                    }
                )*
            }
        }
    };
}

shares! {
    wall_ends: "Walls run on into what their ends meet.";
    walls_touching: "Walls of two closed bodies that touch.";
    walls_lapped: "Walls of two closed bodies that overlap by 20 mm.";
    walls_inner_face: "Walls with a face inside, so that they are not closed.";
    openings_protruding: "Openings that stick out of their walls by 10 to 150 mm.";
    openings_shallow: "Openings that end within their wall.";
    rooms_smaller: "Rooms that end 0.1 to 10 mm before walls, floor and ceiling.";
    rooms_larger: "Rooms that reach 0.1 to 10 mm into walls, floor and ceiling.";
    floors: "Finish floors of 10 to 30 mm, within the rooms' volumes.";
    floors_below: "Finish floors of 10 to 30 mm, on which the rooms' volumes begin.";
    nameless: "Elements without a name.";
    doubled_names: "Elements with the name of the first of their class.";
    doubled_ids: "Elements with the identity of an earlier one.";
    openings_missing: "Openings left out.";
    rooms_missing: "Rooms left out.";
    doubled_faces: "Triangles (in OBJ polygons) that are there twice; a share of those.";
    inside_out: "Elements whose faces all look inward.";
    mixed_winding: "Elements of whose faces half look inward.";
    unwelded: "Elements whose triangles share no vertices.";
    noisy_corners: "Elements whose triangles share no vertices and miss each other by up to 1 micrometre.";
    split_by_material: "Elements of several materials as a group with a node for each material.";
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Preset {
    Exact,
    Cad,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum UnitName {
    M,
    Cm,
    Mm,
}

impl StyleArguments {
    /// The style that the arguments ask for.
    pub fn style(&self) -> Style {
        let mut style = match (self.damage, self.style) {
            (Some(p), _) => Style::damage(p, self.style_seed),
            (None, Preset::Cad) => Style::cad(self.style_seed),
            (None, Preset::Exact) => Style::exact(),
        };
        style.seed = self.style_seed;
        self.shares.apply(&mut style);
        for (length, given) in [
            (&mut style.room_gap, self.room_gap),
            (&mut style.solid_gap, self.solid_gap),
            (&mut style.jitter, self.jitter),
            (&mut style.noise, self.noise),
        ] {
            *length = given.unwrap_or(*length);
        }
        style.storey_spaces |= self.storey_spaces;
        style.off_grid |= self.off_grid;
        style.turned |= self.turned;
        style.far |= self.far;
        match self.written_in {
            None => {}
            Some(UnitName::M) => style.unit = Unit::Metre,
            Some(UnitName::Cm) => style.unit = Unit::Centimetre,
            Some(UnitName::Mm) => style.unit = Unit::Millimetre,
        }
        style
    }
}

fn parse_share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(share) if (0.0..=1.0).contains(&share) => Ok(share),
        _ => Err("must be a number from 0 to 1".to_owned()),
    }
}

fn parse_length(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(length) if length.is_finite() => Ok(length),
        _ => Err("must be a number".to_owned()),
    }
}

fn parse_size(text: &str) -> Result<f64, String> {
    match parse_length(text)? {
        size if size >= 0.0 => Ok(size),
        _ => Err("must not be negative".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        style: StyleArguments,
    }

    fn style(line: &str) -> Result<Style, clap::Error> {
        Line::try_parse_from(line.split(' ')).map(|line| line.style.style())
    }

    #[test]
    fn every_share_has_a_flag_of_its_name() {
        assert_eq!(style("x").unwrap(), Style::exact());
        let mut expected = Style::exact();
        for (name, _) in Style::exact().shares_mut() {
            let found = style(&format!("x --{name} --style-seed 3")).unwrap();
            expected.seed = 3;
            for (other, share) in expected.shares_mut() {
                *share = f64::from(u8::from(other == name));
            }
            assert_eq!(found, expected, "--{name}");
            let mut some = style(&format!("x --{name}=0.25")).unwrap();
            let sum: f64 = some.shares_mut().iter().map(|(_, share)| **share).sum();
            assert_eq!(sum, 0.25);
        }
    }

    #[test]
    fn every_length_has_a_flag_of_its_name() {
        for (name, _) in Style::exact().lengths_mut() {
            let mut expected = Style::exact();
            *expected.lengths_mut().into_iter().find(|(other, _)| *other == name).unwrap().1 = 0.002;
            assert_eq!(style(&format!("x --{name} 0.002")).unwrap(), expected);
        }
        let mut overlapping = Style::exact();
        (overlapping.room_gap, overlapping.solid_gap) = (-0.01, -1e-3);
        assert_eq!(style("x --room-gap -0.01 --solid-gap -1e-3").unwrap(), overlapping);
        assert!(style("x --jitter -1").is_err() && style("x --noise inf").is_err());
    }

    #[test]
    fn flags_go_on_from_a_style() {
        let cad = style("x --style cad --wall-ends=0 --far --written-in mm").unwrap();
        let mut expected = Style::cad(0);
        (expected.wall_ends, expected.far, expected.unit) = (0.0, true, Unit::Millimetre);
        assert_eq!(cad, expected);
        assert_eq!(style("x --damage 0.5 --style-seed 9").unwrap(), Style::damage(0.5, 9));
        assert!(style("x --damage 0.5 --style cad").is_err());
        assert!(style("x --damage 2").is_err() && style("x --nameless=-1").is_err());
    }
}
