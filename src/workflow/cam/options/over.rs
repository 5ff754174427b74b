//! Flags over a job file.

use super::CamOptions;

impl CamOptions {
    /// These options, and where they say nothing those of `base`: flags over a job file.
    #[must_use]
    pub fn over(&self, base: &Self) -> Self {
        let keys = |options: &Self| match serde_json::to_value(options) {
            Ok(serde_json::Value::Object(keys)) => keys,
            _ => serde_json::Map::new(),
        };
        let (mut all, ours) = (keys(base), keys(self));
        // What one of these says, the other must not contradict.
        let rivals = [
            ("scallop", &["pitch"][..]),
            ("pitch", &["scallop"]),
            ("points-per-mm", &["points-per-turn", "step"]),
            ("points-per-turn", &["points-per-mm"]),
            ("step", &["points-per-mm"]),
            ("feed", &["rpm"]),
            ("rpm", &["feed"]),
            ("no-certify", &["tolerance", "min-step", "thin"]),
            ("tolerance", &["no-certify"]),
            ("min-step", &["no-certify"]),
            ("thin", &["no-certify"]),
        ];
        for rival in rivals.iter().filter(|(key, _)| ours.contains_key(*key)).flat_map(|r| r.1) {
            all.remove(*rival);
        }
        all.extend(ours);
        serde_json::from_value(all.into()).unwrap_or_else(|_| self.clone())
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
