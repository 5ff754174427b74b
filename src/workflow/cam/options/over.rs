//! Flags over a job file.

use super::CamOptions;

impl CamOptions {
    /// These options, and where they say nothing those of `base`: flags over a job file. What one of
    /// these says, none of `base` contradicts.
    #[must_use]
    pub fn over(&self, base: &Self) -> Self {
        let base = base.without_rivals_of(self);
        let words = |ours: &Option<String>, theirs: Option<String>| ours.clone().or(theirs);
        Self {
            tool: words(&self.tool, base.tool),
            strategy: self.strategy.or(base.strategy),
            pitch: self.pitch.or(base.pitch),
            points_per_turn: self.points_per_turn.or(base.points_per_turn),
            step: self.step.or(base.step),
            points_per_mm: self.points_per_mm.or(base.points_per_mm),
            scallop: self.scallop.or(base.scallop),
            allowance: self.allowance.or(base.allowance),
            overrun: self.overrun.or(base.overrun),
            axis: words(&self.axis, base.axis),
            flip: self.flip || base.flip,
            centre: self.centre.or(base.centre),
            start_angle: self.start_angle.or(base.start_angle),
            mirror: self.mirror || base.mirror,
            feed: self.feed.or(base.feed),
            rpm: self.rpm.or(base.rpm),
            speed: self.speed.or(base.speed),
            stock: self.stock.or(base.stock),
            rough_with: words(&self.rough_with, base.rough_with),
            rough_strategy: self.rough_strategy.or(base.rough_strategy),
            rough_pitch: self.rough_pitch.or(base.rough_pitch),
            rough_allowance: self.rough_allowance.or(base.rough_allowance),
            block: words(&self.block, base.block),
            max_depth: self.max_depth.or(base.max_depth),
            off_part: self.off_part.or(base.off_part),
            tolerance: self.tolerance.or(base.tolerance),
            min_step: self.min_step.or(base.min_step),
            thin: self.thin || base.thin,
            no_certify: self.no_certify || base.no_certify,
            mode: self.mode.or(base.mode),
            method: self.method.or(base.method),
            compute: self.compute.or(base.compute),
            adapter: words(&self.adapter, base.adapter),
            hold: if self.hold.is_empty() { base.hold } else { self.hold.clone() },
            dialect: words(&self.dialect, base.dialect),
            corner_tolerance: self.corner_tolerance.or(base.corner_tolerance),
            coolant: self.coolant.or(base.coolant),
            program_number: self.program_number.or(base.program_number),
            split_bytes: self.split_bytes.or(base.split_bytes),
        }
    }

    /// These options but for those that contradict what `flags` say.
    fn without_rivals_of(&self, flags: &Self) -> Self {
        let is_bounded = flags.tolerance.is_some() || flags.min_step.is_some() || flags.thin;
        let mut left = self.clone();
        left.pitch = left.pitch.filter(|_| flags.scallop.is_none());
        left.scallop = left.scallop.filter(|_| flags.pitch.is_none());
        left.points_per_turn = left.points_per_turn.filter(|_| flags.points_per_mm.is_none());
        left.step = left.step.filter(|_| flags.points_per_mm.is_none());
        let is_counted = flags.points_per_turn.is_some() || flags.step.is_some();
        left.points_per_mm = left.points_per_mm.filter(|_| !is_counted);
        left.feed = left.feed.filter(|_| flags.rpm.is_none());
        left.rpm = left.rpm.filter(|_| flags.feed.is_none());
        left.tolerance = left.tolerance.filter(|_| !flags.no_certify);
        left.min_step = left.min_step.filter(|_| !flags.no_certify);
        left.thin &= !flags.no_certify;
        left.no_certify &= !is_bounded;
        left
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_win_over_the_job_file_and_drop_what_contradicts_them() {
        let job = CamOptions {
            pitch: Some(1.0),
            allowance: Some(0.5),
            mirror: true,
            ..Default::default()
        };
        let flags = CamOptions { scallop: Some(0.02), allowance: Some(1.0), ..Default::default() };
        let both = flags.over(&job);
        assert_eq!((both.pitch, both.scallop), (None, Some(0.02)));
        assert_eq!((both.allowance, both.mirror), (Some(1.0), true));
    }

    #[test]
    fn a_number_that_is_none_is_not_taken_for_one_left_out() {
        let flags = CamOptions { pitch: Some(f64::NAN), ..Default::default() };
        let refusal = flags.over(&CamOptions::default()).check().unwrap_err();
        assert_eq!(refusal.to_string(), "--pitch is NaN; it must be a number above 0");
    }

    #[test]
    fn a_proof_and_doing_without_drop_each_other() {
        let without = CamOptions { no_certify: true, ..Default::default() };
        let proof = CamOptions { tolerance: Some(0.02), thin: true, ..Default::default() };
        assert_eq!(without.over(&proof), without);
        assert_eq!(proof.over(&without), proof);
    }

    #[test]
    fn a_rotation_and_a_feed_drop_each_other() {
        let feed = CamOptions { feed: Some(900.0), ..Default::default() };
        let rpm = CamOptions { rpm: Some(60.0), ..Default::default() };
        let both = rpm.over(&feed);
        assert_eq!((both.feed, both.rpm), (None, Some(60.0)));
        let both = feed.over(&rpm);
        assert_eq!((both.feed, both.rpm), (Some(900.0), None));
        let both = CamOptions { feed: Some(900.0), ..rpm }.check().unwrap_err();
        assert_eq!(both.to_string(), "give --feed or --rpm, not both");
    }
}
