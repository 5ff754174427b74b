//! The pinhole camera with the distortion of its lens.
//!
//! D. C. Brown, *Close-range camera calibration* (1971), in the form and order of coefficients every
//! calibration tool writes: k1 k2 p1 p2 k3.

use super::RgbdError;
use crate::geom::Point3;

/// Where points appear in the picture. Pixel centres have whole coordinates.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Focal length along rows [px].
    pub fx: f64,
    /// Focal length along columns [px].
    pub fy: f64,
    /// Column of the optical axis [px].
    pub cx: f64,
    /// Row of the optical axis [px].
    pub cy: f64,
    /// What the lens does to it.
    #[serde(default)]
    pub distortion: Distortion,
}

/// Brown's distortion of a lens: radial k1, k2, k3 and tangential p1, p2; all 0 for none.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Distortion {
    /// Radial, times the square of the distance from the axis.
    pub k1: f64,
    /// Radial, times its fourth power.
    pub k2: f64,
    /// Tangential.
    pub p1: f64,
    /// Tangential.
    pub p2: f64,
    /// Radial, times its sixth power.
    pub k3: f64,
}

impl Camera {
    /// No larger picture is taken for one [px a side]: bounds what is allocated for it.
    pub const LARGEST: usize = 1 << 14;

    /// A Kinect as drivers assume it before calibration.
    pub const KINECT: Self = Self::pinhole([640, 480], [525.0, 525.0], [319.5, 239.5]);

    /// The colour camera of the TUM sequences `freiburg1`, with its distortion.
    pub const FREIBURG1: Self = Self {
        distortion: Distortion { k1: 0.2624, k2: -0.9531, p1: -0.0054, p2: 0.0026, k3: 1.1633 },
        ..Self::pinhole([640, 480], [517.3, 516.5], [318.6, 255.3])
    };

    /// A camera without distortion, by its size, focal lengths and optical centre [px].
    pub const fn pinhole(size: [usize; 2], focal: [f64; 2], centre: [f64; 2]) -> Self {
        let ([width, height], [fx, fy], [cx, cy]) = (size, focal, centre);
        let distortion = Distortion { k1: 0.0, k2: 0.0, p1: 0.0, p2: 0.0, k3: 0.0 };
        Self { width, height, fx, fy, cx, cy, distortion }
    }

    /// Refuses what is no camera.
    pub fn check(&self) -> Result<(), RgbdError> {
        let refuse = |key, value, rule| Err(RgbdError::Number { key, value, rule });
        for (key, n) in [("width", self.width), ("height", self.height)] {
            if !(1..=Self::LARGEST).contains(&n) {
                return refuse(key, n as f64, "from 1 to 16384");
            }
        }
        for (key, focal) in [("fx", self.fx), ("fy", self.fy)] {
            if !(focal > 0.0 && focal.is_finite()) {
                return refuse(key, focal, "a positive number of pixels");
            }
        }
        let Distortion { k1, k2, p1, p2, k3 } = self.distortion;
        let others =
            [("cx", self.cx), ("cy", self.cy), ("k1", k1), ("k2", k2), ("p1", p1), ("p2", p2)];
        for (key, value) in others.into_iter().chain([("k3", k3)]) {
            if !value.is_finite() {
                return refuse(key, value, "a finite number");
            }
        }
        Ok(())
    }

    /// Where `point`, in the camera's frame, appears [px]; `None` behind the camera, and so far off
    /// the axis that the distortion folds back. It may lie outside the picture.
    pub fn project(&self, point: &Point3) -> Option<[f64; 2]> {
        // A comparison that NaN fails.
        let is_before = point.z > 0.0;
        if !is_before {
            return None;
        }
        let [x, y] = self.distortion.distort([point.x / point.z, point.y / point.z])?;
        Some([self.fx * x + self.cx, self.fy * y + self.cy])
    }

    /// The point of `depth` [mm] that appears at `pixel`, in the camera's frame: the thesis'
    /// equation 1.5, undistorted.
    pub fn unproject(&self, pixel: [f64; 2], depth: f64) -> Point3 {
        let [x, y] = self.ray(pixel);
        Point3::new(x * depth, y * depth, depth)
    }

    /// The direction (x, y, 1) that appears at `pixel`, by its x and y.
    pub fn ray(&self, pixel: [f64; 2]) -> [f64; 2] {
        self.distortion.undistort([(pixel[0] - self.cx) / self.fx, (pixel[1] - self.cy) / self.fy])
    }

    /// True if `pixel` lies in the picture: not farther than half a pixel outside the outermost
    /// centres.
    pub fn sees(&self, pixel: [f64; 2]) -> bool {
        let [x, y] = pixel;
        -0.5 <= x && x < self.width as f64 - 0.5 && -0.5 <= y && y < self.height as f64 - 0.5
    }

    /// The same camera behind a perfect lens.
    #[must_use]
    pub fn without_distortion(self) -> Self {
        Self { distortion: Distortion::default(), ..self }
    }

    /// The camera of a picture of half the size, whose pixels are the means of 2 x 2.
    #[must_use]
    pub fn halved(self) -> Self {
        // The centre of the first such pixel lies at (0.5, 0.5) of the larger picture.
        let centre = |c: f64| (c - 0.5) / 2.0;
        Self {
            width: self.width / 2,
            height: self.height / 2,
            fx: self.fx / 2.0,
            fy: self.fy / 2.0,
            cx: centre(self.cx),
            cy: centre(self.cy),
            ..self
        }
    }
}

impl Distortion {
    /// Steps until undistortion gives up getting closer.
    const MOST_STEPS: usize = 20;

    /// True if the lens is perfect.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Where a direction (x, y, 1) seems to come from; `None` where the model folds back, so that a
    /// point far outside the picture would appear in it.
    pub fn distort(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        if self.is_none() {
            return Some([x, y]);
        }
        self.rises_up_to(x * x + y * y).then(|| self.formula([x, y]))
    }

    /// The direction (x, y, 1) that seems to come from `seen`: the inverse of [`Self::distort`], by
    /// Newton's method.
    pub fn undistort(&self, seen: [f64; 2]) -> [f64; 2] {
        if self.is_none() {
            return seen;
        }
        let [mut x, mut y] = seen;
        for _ in 0..Self::MOST_STEPS {
            let [fx, fy] = self.formula([x, y]);
            let (ex, ey) = (fx - seen[0], fy - seen[1]);
            if ex.abs().max(ey.abs()) < 1e-14 {
                break;
            }
            let [[a, b], [c, d]] = self.derivatives([x, y]);
            let det = a * d - b * c;
            // On the fold there is no better answer than the place reached.
            if det.abs() < 1e-6 {
                break;
            }
            x -= (d * ex - b * ey) / det;
            y -= (a * ey - c * ex) / det;
        }
        [x, y]
    }

    fn formula(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let Self { k1, k2, p1, p2, k3 } = *self;
        let s = x * x + y * y;
        let radial = 1.0 + s * (k1 + s * (k2 + s * k3));
        [
            x * radial + 2.0 * p1 * x * y + p2 * (s + 2.0 * x * x),
            y * radial + p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y,
        ]
    }

    /// Of both coordinates (rows) by x and y (columns).
    fn derivatives(&self, [x, y]: [f64; 2]) -> [[f64; 2]; 2] {
        let Self { k1, k2, p1, p2, k3 } = *self;
        let s = x * x + y * y;
        let radial = 1.0 + s * (k1 + s * (k2 + s * k3));
        let by_s = k1 + s * (2.0 * k2 + s * 3.0 * k3);
        let mixed = 2.0 * (x * y * by_s + p1 * x + p2 * y);
        [
            [radial + 2.0 * (x * x * by_s + p1 * y + 3.0 * p2 * x), mixed],
            [mixed, radial + 2.0 * (y * y * by_s + 3.0 * p1 * y + p2 * x)],
        ]
    }

    /// True if the radial part rises all the way from the axis to the squared distance `s`: its slope
    /// 1 + 3 k1 s + 5 k2 s^2 + 7 k3 s^3 is positive at both ends and wherever it turns between.
    fn rises_up_to(&self, s: f64) -> bool {
        let Self { k1, k2, k3, .. } = *self;
        let slope = |s: f64| 1.0 + s * (3.0 * k1 + s * (5.0 * k2 + s * 7.0 * k3));
        let (a, b, c) = (21.0 * k3, 10.0 * k2, 3.0 * k1);
        let root = (b * b - 4.0 * a * c).sqrt();
        let turns =
            if a == 0.0 { [-c / b; 2] } else { [-1.0, 1.0].map(|n| (n * root - b) / (2.0 * a)) };
        // Turns that are no numbers, or lie outside, hold no candidate.
        slope(s) > 0.0 && turns.into_iter().all(|t| !(0.0 < t && t < s) || slope(t) > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_unprojected_projects_to_the_same_pixel() {
        for camera in [Camera::KINECT, Camera::FREIBURG1] {
            for x in (0..640).step_by(71) {
                for y in (0..480).step_by(53) {
                    let pixel = [f64::from(x), f64::from(y)];
                    let point = camera.unproject(pixel, 1234.5);
                    assert_eq!(point.z, 1234.5);
                    let again = camera.project(&point).unwrap();
                    let off = (again[0] - pixel[0]).hypot(again[1] - pixel[1]);
                    assert!(off < 1e-9, "{pixel:?}: {again:?}"); // px; Newton's tolerance is 1e-14
                }
            }
        }
    }

    #[test]
    fn distortion_is_browns_formula() {
        let lens = Distortion { k1: 0.1, k2: 0.01, p1: 0.001, p2: 0.002, k3: 0.5 };
        // s = 0.25, radial = 1 + 0.025 + 0.000625 + 0.0078125.
        let [x, y] = lens.distort([0.3, 0.4]).unwrap();
        assert!((x - (0.3 * 1.033_437_5 + 0.000_24 + 0.002 * 0.43)).abs() < 1e-15);
        assert!((y - (0.4 * 1.033_437_5 + 0.001 * 0.57 + 0.000_48)).abs() < 1e-15);
    }

    #[test]
    fn derivatives_are_those_of_the_formula() {
        let lens = Camera::FREIBURG1.distortion;
        let (at, h) = ([0.31, -0.22], 1e-6);
        for (i, step) in [[h, 0.0], [0.0, h]].into_iter().enumerate() {
            let ahead = lens.formula([at[0] + step[0], at[1] + step[1]]);
            let behind = lens.formula([at[0] - step[0], at[1] - step[1]]);
            for k in 0..2 {
                let slope = (ahead[k] - behind[k]) / (2.0 * h);
                assert!((slope - lens.derivatives(at)[k][i]).abs() < 1e-8);
            }
        }
    }

    #[test]
    fn points_behind_the_camera_or_beyond_the_fold_appear_nowhere() {
        assert_eq!(Camera::KINECT.project(&Point3::new(0.0, 0.0, -1.0)), None);
        assert_eq!(Camera::KINECT.project(&Point3::new(0.0, 0.0, f64::NAN)), None);
        // 1 - 3 * 0.3 s turns negative at s = 1.11: what lies farther out would come back in.
        let distortion = Distortion { k1: -0.3, ..Distortion::default() };
        let barrel = Camera { distortion, ..Camera::KINECT };
        assert!(barrel.project(&Point3::new(1.0, 0.0, 1.0)).is_some());
        assert_eq!(barrel.project(&Point3::new(1.1, 0.0, 1.0)), None);
        // Falls between s = 0.47 and 0.86 only: what lies beyond is not seen either.
        let distortion = Distortion { k1: 0.0, k2: -2.0, p1: 0.0, p2: 0.0, k3: 1.55 };
        assert!(!distortion.rises_up_to(0.6) && !distortion.rises_up_to(2.0));
        assert!(distortion.rises_up_to(0.3));
    }

    #[test]
    fn half_the_camera_sees_the_same_point_in_the_middle_of_four_pixels() {
        let camera = Camera::KINECT;
        let point = camera.unproject([100.5, 200.5], 1000.0);
        let [x, y] = camera.halved().project(&point).unwrap();
        assert!((x - 50.0).abs() < 1e-12 && (y - 100.0).abs() < 1e-12);
        assert_eq!((camera.halved().width, camera.halved().height), (320, 240));
    }

    #[test]
    fn what_is_no_camera_is_refused_by_the_key() {
        let good = Camera::KINECT;
        let cases = [
            (Camera { width: 0, ..good }, "width is 0: it must be from 1 to 16384"),
            (Camera { height: 1 << 20, ..good }, "height is 1048576"),
            (Camera { fy: -525.0, ..good }, "fy is -525: it must be a positive number of pixels"),
            (Camera { cx: f64::NAN, ..good }, "cx is NaN: it must be a finite number"),
        ];
        good.check().unwrap();
        for (camera, message) in cases {
            let error = camera.check().unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }

    #[test]
    fn the_picture_ends_half_a_pixel_beyond_the_outermost_centres() {
        let camera = Camera::KINECT;
        assert!(camera.sees([-0.5, -0.5]) && camera.sees([639.4, 479.4]));
        assert!(!camera.sees([639.5, 0.0]) && !camera.sees([f64::NAN, 0.0]));
    }
}
