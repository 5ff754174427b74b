//! What sensors write, as depth in mm: disparities of a Kinect, numbers of a depth picture.
//!
//! Morell (2014), equation 1.4, with a slip mended: the base line runs from the infrared *projector* to
//! the infrared camera; the colour camera takes no part.

use super::{Image, RgbdError};

/// How the disparities of a Kinect (first kind) become depth.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct KinectDisparity {
    /// From the infrared projector to the infrared camera [mm].
    pub baseline: f64,
    /// Focal length of the infrared camera [px].
    pub focal_px: f64,
    /// The disparity of a point infinitely far away [1/8 px].
    pub offset: f64,
}

impl Default for KinectDisparity {
    /// About what every Kinect has; a calibration says it better.
    fn default() -> Self {
        Self { baseline: 75.0, focal_px: 580.0, offset: 1090.0 }
    }
}

impl KinectDisparity {
    /// The disparity that stands for no reading.
    pub const NO_READING: u16 = 2047;

    /// The depth of the disparity `kd` [mm], 0 for no reading. A disparity at the offset or above has
    /// none: its depth would be infinite or negative.
    pub fn depth(&self, kd: u16) -> Option<f64> {
        if kd == Self::NO_READING {
            return Some(0.0);
        }
        let normalised = (self.offset - f64::from(kd)) / 8.0;
        (normalised > 0.0).then(|| self.baseline * self.focal_px / normalised)
    }

    /// The disparity of `depth`, not yet rounded.
    pub fn disparity(&self, depth: f64) -> f64 {
        self.offset - 8.0 * self.baseline * self.focal_px / depth
    }

    /// Refuses what is no sensor.
    pub fn check(&self) -> Result<(), RgbdError> {
        positive("baseline", self.baseline)?;
        positive("focal-px", self.focal_px)?;
        positive("offset", self.offset)
    }

    /// A picture of disparities as one of depth.
    pub fn depth_image(&self, disparities: &Image<u16>) -> Result<Image<f32>, RgbdError> {
        self.check()?;
        let width = disparities.width();
        let depth = |(i, &kd): (usize, &u16)| {
            let place = RgbdError::Disparity {
                column: i % width,
                row: i / width,
                value: kd,
                offset: self.offset,
            };
            self.depth(kd).map(|depth| depth as f32).ok_or(place)
        };
        let pixels =
            disparities.pixels().iter().enumerate().map(depth).collect::<Result<_, _>>()?;
        Image::new(width, disparities.height(), pixels)
    }
}

/// A picture of whole numbers, `per_metre` of them to a metre, as depth; 0 is no reading. The TUM
/// benchmark has 5000, most drivers 1000.
pub fn depth_from_numbers(numbers: &Image<u16>, per_metre: f64) -> Result<Image<f32>, RgbdError> {
    positive("depth-scale", per_metre)?;
    Ok(numbers.map(|&number| (f64::from(number) * 1000.0 / per_metre) as f32))
}

/// Depth as whole numbers, `per_metre` of them to a metre. What is no depth, or too far for the
/// numbers, is 0.
pub fn numbers_from_depth(depth: &Image<f32>, per_metre: f64) -> Result<Image<u16>, RgbdError> {
    positive("depth-scale", per_metre)?;
    Ok(depth.map(|&depth| {
        let number = (f64::from(depth) * per_metre / 1000.0).round();
        if (0.0..=65535.0).contains(&number) { number as u16 } else { 0 }
    }))
}

fn positive(key: &'static str, value: f64) -> Result<(), RgbdError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(RgbdError::Number { key, value, rule: "a positive number" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disparity_has_the_depth_of_equation_1_4() {
        let kinect = KinectDisparity::default();
        // 75 * 580 / ((1090 - 742) / 8) = 1000.
        assert!((kinect.depth(742).unwrap() - 1000.0).abs() < 1e-9);
        assert!((kinect.disparity(1000.0) - 742.0).abs() < 1e-9);
        assert_eq!(kinect.depth(2047), Some(0.0));
        assert_eq!((kinect.depth(1090), kinect.depth(1091)), (None, None));
        assert!(kinect.depth(1089).unwrap() > 300_000.0);
    }

    #[test]
    fn a_disparity_without_depth_is_told_with_its_place() {
        let disparities = Image::new(2, 2, vec![742, 2047, 500, 1100]).unwrap();
        let error = KinectDisparity::default().depth_image(&disparities).unwrap_err().to_string();
        assert!(
            error.starts_with("the disparity 1100 at column 1 of row 1 is not below"),
            "{error}"
        );
        let fine = KinectDisparity { offset: 1200.0, ..KinectDisparity::default() };
        assert_eq!(fine.depth_image(&disparities).unwrap()[(1, 0)], 0.0);
        let broken = KinectDisparity { baseline: 0.0, ..fine };
        assert!(broken.depth_image(&disparities).is_err());
    }

    #[test]
    fn numbers_of_a_picture_go_by_its_scale_and_back() {
        let numbers = Image::new(3, 1, vec![0, 5000, 65535]).unwrap();
        let depth = depth_from_numbers(&numbers, 5000.0).unwrap();
        assert_eq!(depth.pixels(), [0.0, 1000.0, 13107.0]);
        assert_eq!(numbers_from_depth(&depth, 5000.0).unwrap(), numbers);
        let odd = Image::new(3, 1, vec![13108.0, f32::NAN, -1.0]).unwrap();
        assert_eq!(numbers_from_depth(&odd, 5000.0).unwrap().pixels(), [0, 0, 0]);
        for scale in [0.0, -1.0, f64::NAN] {
            let error = depth_from_numbers(&numbers, scale).unwrap_err().to_string();
            assert!(error.starts_with("depth-scale is "), "{error}");
        }
    }
}
