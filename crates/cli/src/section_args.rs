//! What `vitral draw` does to the model first: parts moved apart, planes of section, hatching.

use crate::help;
use crate::report::Failure;
use crate::values;
use clap::Args;
use vitral::{Hatch, Scene, SectionPlane, section};

/// Most planes of one drawing.
const MOST_PLANES: usize = 8;
/// The least distance of hatching in millimetres: lines closer than this are a grey.
const LEAST_DISTANCE: f64 = 0.1;

/// Sections and exploded views.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = help::SECTIONS)]
pub(crate) struct SectionArgs {
    /// Cut away the side of a plane to which its normal points; repeatable, up to 8 planes
    ///
    /// X,Y,Z is a point of the plane and NX,NY,NZ its normal, in the model's coordinates. The cut
    /// through a closed body is hatched, and the edges along it are lines of the class section.
    /// Several planes cut one after the other
    #[arg(long, value_name = "X,Y,Z,NX,NY,NZ", value_parser = plane, allow_hyphen_values = true)]
    pub(crate) section_plane: Vec<SectionPlane>,
    /// Angle of the hatching in degrees and distance of its lines on paper, or none [default:
    /// 45,2mm]
    ///
    /// Each material has its own pattern: angles of 45, 135, 30, 120, 60 and 150 degrees, then the
    /// same angles at 1.5 times the distance. Each object without a material has a pattern of its
    /// own, too
    #[arg(long, value_name = "ANGLE,DISTANCE", value_parser = hatch, allow_hyphen_values = true, requires = "section_plane")]
    pub(crate) hatch: Option<Hatching>,
    /// Exploded view: move parts from the centre by F times their distance from it, before planes
    /// cut
    ///
    /// Parts are the objects of the scene; of a single object its groups, or else its connected
    /// bodies
    #[arg(long, value_name = "F", value_parser = values::not_negative, allow_negative_numbers = true)]
    pub(crate) explode: Option<f64>,
}

/// What caps are filled with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Hatching {
    /// Nothing.
    None,
    /// Lines.
    Lines(Hatch),
}

impl SectionArgs {
    /// Refuses more planes than are of use.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        let count = self.section_plane.len();
        if count > MOST_PLANES {
            return Err(Failure::usage(format!(
                "--section-plane: {count} planes are given, at most {MOST_PLANES} are possible"
            )));
        }
        Ok(())
    }

    /// The hatching of a drawing with lines.
    pub(crate) fn hatch(&self) -> Option<Hatch> {
        match self.hatch {
            None => Some(Hatch::default()),
            Some(Hatching::None) => None,
            Some(Hatching::Lines(hatch)) => Some(hatch),
        }
    }

    /// The scene with its parts moved and its planes cut, and a warning where there is nothing to
    /// see of that.
    pub(crate) fn apply(
        &self,
        mut scene: Scene,
        execution: &vitral::Execution,
    ) -> Result<Scene, Failure> {
        let (workers, budget) = (&execution.workers, &execution.budget);
        if let Some(factor) = self.explode.filter(|&factor| factor > 0.0) {
            scene = scene
                .exploded_on(factor, workers)
                .map_err(section::SectionError::from)
                .map_err(vitral::Error::from)?;
        }
        if self.section_plane.is_empty() {
            return Ok(scene);
        }
        scene = section::cut(&scene, &self.section_plane, workers, budget)
            .map_err(vitral::Error::from)?;
        let warning = match scene.nodes.iter().any(|node| node.mesh.is_some()) {
            false => Some("--section-plane: nothing is left of the model"),
            true if !scene.is_cut() => Some("--section-plane: no plane cuts the model"),
            true => (!scene.has_caps()).then_some(
                "--section-plane: no cut body is closed, so there is no cut surface to hatch",
            ),
        };
        scene.warnings.extend(warning.map(str::to_owned));
        Ok(scene)
    }
}

/// `0,0,0,0,0,1`.
fn plane(text: &str) -> Result<SectionPlane, String> {
    let numbers: Vec<f64> = text.split(',').map(values::number).collect::<Result<_, _>>()?;
    let &[x, y, z, nx, ny, nz] = &numbers[..] else {
        return Err("six numbers X,Y,Z,NX,NY,NZ are required, such as 0,0,0,0,0,1".to_owned());
    };
    SectionPlane::new([x, y, z], [nx, ny, nz])
        .ok_or_else(|| "the normal NX,NY,NZ must not be 0,0,0".to_owned())
}

/// `45,2mm` or `none`.
fn hatch(text: &str) -> Result<Hatching, String> {
    if text == "none" {
        return Ok(Hatching::None);
    }
    let (angle, distance) =
        text.split_once(',').ok_or("ANGLE,DISTANCE is required, such as 45,2mm; or none")?;
    let angle = values::number(angle)?;
    let distance = values::positive(distance.strip_suffix("mm").unwrap_or(distance))?;
    if !(LEAST_DISTANCE..=1000.0).contains(&distance) {
        return Err(format!("a distance from {LEAST_DISTANCE} to 1000 mm is required"));
    }
    Ok(Hatching::Lines(Hatch { angle: (angle % 360.0).to_radians(), distance }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_and_hatching_are_read() {
        assert_eq!(
            plane("1,2,-3,0,0,5").ok(),
            SectionPlane::new([1.0, 2.0, -3.0], [0.0, 0.0, 1.0])
        );
        assert!(plane("1,2,3").unwrap_err().contains("six numbers"));
        assert!(
            plane("0,0,0,0,0,0").unwrap_err().contains("must not be 0,0,0")
                && plane("0,0,0,0,0,x").is_err()
        );
        assert_eq!(hatch("45,2mm"), Ok(Hatching::Lines(Hatch::default())));
        assert_eq!(hatch("405,2"), hatch("45,2mm"));
        assert_eq!(hatch("none"), Ok(Hatching::None));
        assert!(
            ["45", "45,0mm", "45,.01mm", "x,2mm", "45,2cm"].iter().all(|text| hatch(text).is_err())
        );
    }
}
