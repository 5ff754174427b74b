//! One exposure of a depth camera.

use super::{Camera, Image, OrganisedCloud, RgbdError};

/// What depth cameras see [mm].
const PLAUSIBLE: std::ops::Range<f32> = 100.0..20_000.0;

/// One exposure of a depth camera: depth, and what else the sensor gave, all of one size.
#[derive(Debug, Clone, PartialEq)]
pub struct RgbdFrame {
    /// When it was taken [s].
    pub stamp: f64,
    /// Red, green, blue, seen from where the depth is.
    pub color: Option<Image<[u8; 3]>>,
    /// z of what is seen [mm]; 0 where there is no reading.
    pub depth: Image<f32>,
    /// How sure the sensor is of each reading, 0 to 1; time-of-flight cameras tell.
    pub confidence: Option<Image<f32>>,
}

impl RgbdFrame {
    /// Refuses pictures of different sizes, and a camera of another.
    pub fn check(&self, camera: &Camera) -> Result<(), RgbdError> {
        let size = |what, width, height, other, (found_width, found_height)| {
            if (found_width, found_height) == (width, height) {
                return Ok(());
            }
            Err(RgbdError::Size { what, found_width, found_height, other, width, height })
        };
        let depth = (self.depth.width(), self.depth.height());
        size("depth image", camera.width, camera.height, "camera", depth)?;
        if let Some(color) = &self.color {
            let color = (color.width(), color.height());
            size("color image", depth.0, depth.1, "depth image", color)?;
        }
        if let Some(confidence) = &self.confidence {
            let confidence = (confidence.width(), confidence.height());
            size("confidence map", depth.0, depth.1, "depth image", confidence)?;
        }
        Ok(())
    }

    /// Refuses a frame without readings, or with depths no depth camera sees: most often a wrong scale.
    pub fn check_depth(&self) -> Result<(), RgbdError> {
        let is_reading = |depth: &f32| *depth > 0.0;
        let mut readings: Vec<f32> =
            self.depth.pixels().iter().copied().filter(is_reading).collect();
        if readings.is_empty() {
            return Err(RgbdError::NoReadings);
        }
        let middle = readings.len() / 2;
        let median = *readings.select_nth_unstable_by(middle, f32::total_cmp).1;
        if PLAUSIBLE.contains(&median) { Ok(()) } else { Err(RgbdError::Scale { median }) }
    }

    /// How many pixels have a depth.
    pub fn n_readings(&self) -> usize {
        self.depth.pixels().iter().filter(|depth| **depth > 0.0).count()
    }

    /// Takes back readings the sensor is less sure of than `least`; how many there were.
    pub fn drop_doubtful(&mut self, least: f32) -> usize {
        let Some(confidence) = &self.confidence else { return 0 };
        let mut n_dropped = 0;
        for (depth, sure) in self.depth.pixels_mut().iter_mut().zip(confidence.pixels()) {
            // NaN is not sure.
            if *depth > 0.0 && (sure.is_nan() || *sure < least) {
                *depth = 0.0;
                n_dropped += 1;
            }
        }
        n_dropped
    }

    /// The points the frame shows, in the camera's frame, with their colours.
    pub fn cloud(&self, camera: &Camera) -> Result<OrganisedCloud, RgbdError> {
        self.check(camera)?;
        Ok(OrganisedCloud::of(&self.depth, self.color.as_ref(), camera))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> RgbdFrame {
        let depth = Image::new(2, 2, vec![1000.0, 0.0, 500.0, 800.0]).unwrap();
        RgbdFrame { stamp: 0.0, color: None, depth, confidence: None }
    }

    fn camera() -> Camera {
        Camera::pinhole([2, 2], [2.0, 2.0], [0.5, 0.5])
    }

    #[test]
    fn pictures_of_different_sizes_are_told_with_both() {
        let color = Some(Image::filled(3, 2, [0; 3]));
        let error = RgbdFrame { color, ..frame() }.check(&camera()).unwrap_err().to_string();
        let expected = "the color image is 3 x 2, but the depth image is 2 x 2";
        assert!(error.starts_with(expected), "{error}");
        let error = frame().check(&Camera::KINECT).unwrap_err().to_string();
        assert!(error.contains("the depth image is 2 x 2, but the camera is 640 x 480"), "{error}");
        let confidence = Some(Image::filled(2, 3, 1.0));
        let error = RgbdFrame { confidence, ..frame() }.check(&camera()).unwrap_err().to_string();
        assert!(error.starts_with("the confidence map is 2 x 3"), "{error}");
    }

    #[test]
    fn a_wrong_depth_scale_and_a_covered_sensor_are_told() {
        frame().check_depth().unwrap();
        let scaled =
            |factor: f32| RgbdFrame { depth: frame().depth.map(|d| d * factor), ..frame() };
        for factor in [1e-3, 1e3] {
            let error = scaled(factor).check_depth().unwrap_err().to_string();
            assert!(error.contains("depth scale is wrong"), "{error}");
        }
        let error = scaled(0.0).check_depth().unwrap_err().to_string();
        assert!(error.starts_with("no pixel has a depth"), "{error}");
    }

    #[test]
    fn readings_the_sensor_doubts_are_dropped_and_counted() {
        let confidence = Image::new(2, 2, vec![0.9, 0.1, 0.2, f32::NAN]).unwrap();
        let mut frame = RgbdFrame { confidence: Some(confidence), ..frame() };
        assert_eq!((frame.n_readings(), frame.drop_doubtful(0.5)), (3, 2));
        assert_eq!(frame.depth.pixels(), [1000.0, 0.0, 0.0, 0.0]);
        frame.confidence = None;
        assert_eq!(frame.drop_doubtful(0.5), 0);
    }
}
