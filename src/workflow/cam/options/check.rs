//! Options that mean nothing, or contradict each other.

use super::{CamOptions, OptionsError};
use crate::compute::ComputeChoice;

impl CamOptions {
    /// Refuses numbers that mean nothing.
    pub fn check(&self) -> Result<(), OptionsError> {
        let above_0 = [
            ("--pitch", self.pitch),
            ("--step", self.step),
            ("--points-per-mm", self.points_per_mm),
            ("--scallop", self.scallop),
            ("--feed", self.feed),
            ("--rpm", self.rpm),
            ("--speed", self.speed),
            ("--corner-tolerance", self.corner_tolerance),
            ("--tolerance", self.tolerance),
            ("--min-step", self.min_step),
            ("--rough-pitch", self.rough_pitch),
            ("--points-per-turn", self.points_per_turn.map(f64::from)),
        ];
        let from_0 = [
            ("--allowance", self.allowance),
            ("--rough-allowance", self.rough_allowance),
            ("--overrun", self.overrun),
            ("--stock", self.stock),
        ];
        let named = |(option, value): (&'static str, Option<f64>)| Some((option, value?));
        for (option, value) in above_0.into_iter().filter_map(named) {
            if !(value > 0.0 && value.is_finite()) {
                return Err(OptionsError::OutOfRange { option, value, must: "a number above 0" });
            }
        }
        for (option, value) in from_0.into_iter().filter_map(named) {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(OptionsError::OutOfRange { option, value, must: "0 or more" });
            }
        }
        if let Some(value) = self.start_angle.filter(|value| !value.is_finite()) {
            return Err(OptionsError::OutOfRange {
                option: "--start-angle",
                value,
                must: "finite",
            });
        }
        if self.scallop.is_some() && self.pitch.is_some() {
            return Err(OptionsError::Conflict("give --pitch or --scallop, not both"));
        }
        if self.rpm.is_some() && self.feed.is_some() {
            return Err(OptionsError::Conflict("give --feed or --rpm, not both"));
        }
        if self.no_certify && (self.tolerance.is_some() || self.min_step.is_some() || self.thin) {
            return Err(OptionsError::Conflict(
                "--no-certify leaves nothing for --tolerance, --min-step and --thin to say",
            ));
        }
        let on_device = matches!(self.compute, Some(ComputeChoice::Gpu | ComputeChoice::Auto));
        if self.adapter.is_some() && !on_device {
            return Err(OptionsError::Conflict(
                "--adapter names a device, and the processor computes unless --compute gpu or auto is given",
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_device_is_named_only_where_one_is_used() {
        let named = CamOptions { adapter: Some("llvmpipe".into()), ..Default::default() };
        let of = |compute| CamOptions { compute, ..named.clone() }.check();
        for compute in [None, Some(ComputeChoice::Cpu)] {
            assert!(of(compute).unwrap_err().to_string().contains("--compute gpu"));
        }
        assert!(of(Some(ComputeChoice::Gpu)).is_ok() && of(Some(ComputeChoice::Auto)).is_ok());
    }

    #[test]
    fn numbers_that_mean_nothing_are_refused_by_name() {
        let error = |options: CamOptions| options.check().unwrap_err().to_string();
        let pitch = CamOptions { pitch: Some(-1.0), ..Default::default() };
        assert_eq!(error(pitch), "--pitch is -1; it must be a number above 0");
        let allowance = CamOptions { allowance: Some(f64::NAN), ..Default::default() };
        assert_eq!(error(allowance), "--allowance is NaN; it must be 0 or more");
    }
}
