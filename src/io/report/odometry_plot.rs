//! Two trajectories and how far they are apart, as one SVG file.

use super::chart::{Labels, sheet};
use super::svg::{Series, line_chart, plan_chart};
use crate::geom::Point3;
use crate::register::{Delta, OdometryError, RelativeError, RelativeErrors};

/// Both trajectories from above (the estimate laid over the truth), the absolute error and the relative
/// errors over time; a file of its own.
pub fn odometry_plot(error: &OdometryError) -> String {
    let absolute = &error.absolute;
    let from_above = |name: &str, points: &[Point3]| Series {
        name: name.to_owned(),
        points: points.iter().map(|p| [p.x, p.y]).collect(),
    };
    let plan = [from_above("estimate", &absolute.estimate), from_above("truth", &absolute.truth)];
    let begin = absolute.stamps.first().copied().unwrap_or_default();
    let over_time = |name: String, errors: &mut dyn Iterator<Item = (f64, f64)>| Series {
        name,
        points: errors.map(|(stamp, error)| [stamp - begin, error]).collect(),
    };
    let ate = absolute.stamps.iter().copied().zip(absolute.errors.iter().copied());
    let ate = over_time("absolute".into(), &mut { ate });
    let relative = |value: fn(&RelativeError) -> f64| -> Vec<Series> {
        let one = |relative: &RelativeErrors| {
            let mut errors = relative.errors.iter().map(|e| (e.stamp, value(e)));
            over_time(format!("over {}", step(&relative.delta)), &mut errors)
        };
        error.relative.iter().map(one).collect()
    };
    let time = "time [s]";
    let charts = [
        plan_chart(&plan, Labels { x: "x [mm], seen from above", y: "y [mm]" }),
        line_chart(&[ate], Labels { x: time, y: "absolute error [mm]" }),
        line_chart(&relative(|e| e.translation), Labels { x: time, y: "relative error [mm]" }),
        line_chart(
            &relative(|e| e.rotation.to_degrees()),
            Labels { x: time, y: "relative error [deg]" },
        ),
    ];
    sheet(&charts)
}

fn step(delta: &Delta) -> String {
    match delta {
        Delta::Poses(1) => "1 pose".into(),
        Delta::Poses(n) => format!("{n} poses"),
        Delta::Seconds(seconds) => format!("{seconds} s"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::html::tests::assert_balanced;
    use super::*;
    use crate::geom::Pose;
    use crate::register::{OdometryErrorOptions, odometry_error};
    use crate::rgbd::{CameraTrajectory, StampedPose};

    #[test]
    fn a_plot_holds_both_trajectories_and_all_errors() {
        let walk = |bend: f64| {
            let pose = |i: i32| {
                let t = f64::from(i) / 30.0;
                let world_from_camera = Pose::translation(300.0 * t, bend * t * t, 0.0);
                StampedPose { stamp: 1e9 + t, world_from_camera }
            };
            CameraTrajectory::new((0..90).map(pose).collect()).unwrap()
        };
        let options = OdometryErrorOptions::default();
        let error = odometry_error(&walk(50.0), &walk(0.0), &options).unwrap();
        let plot = odometry_plot(&error);
        assert_balanced(&plot);
        assert_eq!(plot.matches("<polyline").count(), 2 + 1 + 2 + 2);
        assert!(plot.contains("over 1 pose") && plot.contains("over 1 s"));
        assert!(plot.starts_with("<svg xmlns=") && !plot.contains("NaN"));
    }
}
