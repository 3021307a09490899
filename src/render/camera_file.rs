//! Camera files: a line `ex ey ez tx ty tz vfov_degrees` per view.

use enfilade_importers::Frame;

use super::camera::{Camera, CameraError};

/// A line of a camera file makes no camera.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{file}:{line}: {kind}")]
pub struct CameraFileError {
    /// The file's name as it was given.
    pub file: String,
    /// The line, from 1.
    pub line: usize,
    /// What is wrong with it.
    #[source]
    pub kind: CameraLineError,
}

/// Why a line of a camera file makes no camera.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraLineError {
    /// It has not seven words.
    #[error("{0} words instead of the 7 of 'ex ey ez tx ty tz vfov_degrees'")]
    Words(usize),
    /// A word is no number.
    #[error("'{word}' ({field}) is no number")]
    NotANumber {
        /// The word; long ones are cut.
        word: String,
        /// Which of the seven it is.
        field: &'static str,
    },
    /// The numbers make no camera.
    #[error("{0}")]
    Camera(#[from] CameraError),
}

const FIELDS: [&str; 7] = ["ex", "ey", "ez", "tx", "ty", "tz", "vfov_degrees"];

/// The cameras of a file's `text`, one a line: eye and target as points in `frame`, then the vertical field of view in
/// degrees. What follows a `#`, and blank lines, are left out. What is up in the frame is up in the picture.
///
/// `frame` is the source's own, [`Scene::frame`](crate::Scene::frame), or `Frame::default()` for files in the internal
/// one. `file` is named in errors.
///
/// # Errors
/// [`CameraFileError`] for the first line that makes no camera.
pub fn parse_cameras(text: &str, file: &str, frame: &Frame) -> Result<Vec<Camera>, CameraFileError> {
    let mut cameras = Vec::new();
    // A byte order mark, as some editors write.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    for (index, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or("").trim();
        if line.is_empty() {
            continue;
        }
        let camera = parse_line(line, frame).map_err(|kind| CameraFileError {
            file: file.to_owned(),
            line: index + 1,
            kind,
        })?;
        cameras.push(camera);
    }
    Ok(cameras)
}

fn parse_line(line: &str, frame: &Frame) -> Result<Camera, CameraLineError> {
    let words: Vec<&str> = line.split_whitespace().collect();
    if words.len() != FIELDS.len() {
        return Err(CameraLineError::Words(words.len()));
    }
    let mut numbers = [0.0; FIELDS.len()];
    for ((number, word), field) in numbers.iter_mut().zip(words).zip(FIELDS) {
        *number = word
            .parse()
            .map_err(|_| CameraLineError::NotANumber { word: word.chars().take(40).collect(), field })?;
    }
    let [ex, ey, ez, tx, ty, tz, vfov] = numbers;
    let (eye, target) = ([ex, ey, ez], [tx, ty, tz]);
    // The direction first, so that the offset of a model far from its origin does not blur it.
    let direction = frame.direction_to_internal([0, 1, 2].map(|i| target[i] - eye[i]));
    Ok(Camera::looking(frame.point_to_internal(eye), direction, [0.0, 0.0, 1.0], vfov)?)
}

/// The text of a file with `cameras`, that [`parse_cameras`] reads in the same `frame`. Each target lies one unit of
/// the frame before its eye. The format has no word for what is up: Z (internal) will be.
pub fn write_cameras(cameras: &[Camera], frame: &Frame) -> String {
    let mut text = String::from("# ex ey ez tx ty tz vfov_degrees\n");
    for camera in cameras {
        let eye = frame.point_to_source(camera.eye());
        let forward = frame.direction_to_source(camera.forward());
        let target = [0, 1, 2].map(|i| eye[i] + forward[i]);
        for number in eye.iter().chain(&target) {
            text.push_str(&format!("{number} "));
        }
        text.push_str(&format!("{}\n", camera.vfov_degrees()));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use enfilade_importers::UpAxis;

    #[test]
    fn reads_either_frame() {
        let text = "\u{feff}# a comment\n\n 1 2 3  1 2 4 60 # south\r\n0 0 0 1e0 0 0 45\n";
        let internal = parse_cameras(text, "views.txt", &Frame::default()).unwrap();
        assert_eq!(internal.len(), 2);
        assert_eq!(internal[0].eye(), [1.0, 2.0, 3.0]);
        assert_eq!(internal[0].forward(), [0.0, 0.0, 1.0]);
        assert_eq!(internal[1].vfov_degrees(), 45.0);
        let frame = Frame { unit: 0.5, up: UpAxis::Y, offset: [10.0, 0.0, 0.0] };
        let source = parse_cameras(text, "views.txt", &frame).unwrap();
        assert_eq!(source[0].eye(), [-9.5, -1.5, 1.0]);
        assert_eq!(source[0].forward(), [0.0, -1.0, 0.0]);
        assert_eq!(source[0].up(), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn there_and_back() {
        let frame = Frame { unit: 0.001, up: UpAxis::Y, offset: [458_123.0, 5_427_891.0, 112.0] };
        let cameras: Vec<Camera> = [[1.0, 0.0, 0.0], [1.0, 2.0, -0.5], [-3.0, 0.1, 0.2]]
            .map(|d| Camera::looking([1.25, -7.5, 1.6], d, [0.0, 0.0, 1.0], 63.5).unwrap())
            .to_vec();
        let text = write_cameras(&cameras, &frame);
        let read = parse_cameras(&text, "views.txt", &frame).unwrap();
        for (a, b) in cameras.iter().zip(&read) {
            assert_eq!(a.vfov_degrees(), b.vfov_degrees());
            for (p, q) in [(a.eye(), b.eye()), (a.forward(), b.forward()), (a.up(), b.up())] {
                assert!((0..3).all(|i| (p[i] - q[i]).abs() < 1e-6), "{p:?} {q:?}");
            }
        }
        assert_eq!(read.len(), cameras.len());
    }

    #[test]
    fn errors_name_file_line_and_word() {
        let message =
            |text: &str| parse_cameras(text, "views.txt", &Frame::default()).unwrap_err().to_string();
        assert_eq!(
            message("0 0 0 1 0 0 60\n\n1 2 3 4"),
            "views.txt:3: 4 words instead of the 7 of 'ex ey ez tx ty tz vfov_degrees'"
        );
        assert_eq!(message("0 0 0 1 x 0 60"), "views.txt:1: 'x' (ty) is no number");
        assert!(message("0 0 0 0 0 0 60").contains("its eye is its target"));
        assert!(message("0 0 0 1 0 0 180").contains("180 degrees"));
        assert!(message("nan 0 0 1 0 0 60").contains("not finite"));
        assert!(message("1 2 3 4 5 6 7 8").contains("8 words"));
    }
}
