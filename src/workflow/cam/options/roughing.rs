//! What roughing is told, alone and before finishing.

use super::{CamOptions, OptionsError};

/// Left for finishing where nothing is said [mm].
const ALLOWANCE: f64 = 1.0;
/// Pitch where nothing is said [mm].
const PITCH: f64 = 4.0;
/// The block where nothing is said.
const BLOCK: &str = "cylinder";

impl CamOptions {
    /// The block in the words of the command line.
    pub fn block(&self) -> &str {
        self.block.as_deref().unwrap_or(BLOCK)
    }

    /// Refuses to finish alone with options that rough.
    pub(in crate::workflow::cam) fn check_finishing(&self) -> Result<(), OptionsError> {
        if self.for_finishing() == *self {
            return Ok(());
        }
        Err(OptionsError::Conflict(
            "--block, --max-depth and what begins with --rough are for roughing: name its tool with \
             --rough-with, or make a program of its own with horma rough",
        ))
    }

    /// The options of a program that roughs alone, with what is usual where they say nothing.
    pub(in crate::workflow::cam) fn for_rough(&self) -> Result<Self, OptionsError> {
        let alone = Self { block: None, max_depth: None, ..self.clone() };
        if alone.for_finishing() != alone {
            return Err(OptionsError::Conflict(
                "what begins with --rough is for roughing and finishing in one go: horma rough takes \
                 --tool, --strategy, --pitch and --allowance",
            ));
        }
        Ok(Self {
            allowance: Some(self.allowance.unwrap_or(ALLOWANCE)),
            pitch: self.pitch.or(self.scallop.is_none().then_some(PITCH)),
            ..self.clone()
        })
    }

    /// The options of the roughing before the finishing these are of: the part is set up and spoken
    /// about in the same way, but the tool runs as it usually does.
    pub(in crate::workflow::cam) fn for_roughing(&self) -> Self {
        let left = self.allowance.unwrap_or(0.0) + self.rough_allowance.unwrap_or(ALLOWANCE);
        Self {
            tool: self.rough_with.clone(),
            strategy: self.rough_strategy.or(self.strategy),
            pitch: Some(self.rough_pitch.unwrap_or(PITCH)),
            allowance: Some(left),
            points_per_turn: None,
            step: None,
            points_per_mm: None,
            scallop: None,
            feed: None,
            rpm: None,
            speed: None,
            stock: None,
            tolerance: None,
            min_step: None,
            thin: false,
            no_certify: false,
            rough_with: None,
            rough_strategy: None,
            rough_pitch: None,
            rough_allowance: None,
            ..self.clone()
        }
    }

    /// The options of the finishing alone.
    pub(in crate::workflow::cam) fn for_finishing(&self) -> Self {
        Self {
            rough_with: None,
            rough_strategy: None,
            rough_pitch: None,
            rough_allowance: None,
            block: None,
            max_depth: None,
            ..self.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn both() -> CamOptions {
        CamOptions {
            rough_with: Some("flat-12".into()),
            rough_pitch: Some(3.0),
            max_depth: Some(5.0),
            pitch: Some(0.5),
            allowance: Some(0.2),
            feed: Some(900.0),
            mirror: true,
            ..CamOptions::default()
        }
    }

    #[test]
    fn roughing_before_finishing_sets_the_part_up_alike_and_runs_in_its_own_way() {
        let rough = both().for_roughing();
        assert_eq!((rough.mirror, rough.tool.as_deref()), (true, Some("flat-12")));
        assert_eq!((rough.pitch, rough.allowance, rough.feed), (Some(3.0), Some(1.2), None));
        assert_eq!((rough.max_depth, rough.rough_with), (Some(5.0), None));
    }

    #[test]
    fn one_operation_is_not_told_what_the_other_needs() {
        let told = both().check_finishing().unwrap_err().to_string();
        assert!(told.contains("name its tool with --rough-with"), "{told}");
        assert!(both().for_finishing().check_finishing().is_ok());
        let told = both().for_rough().unwrap_err().to_string();
        assert!(told.contains("horma rough takes --tool"), "{told}");
        let alone = CamOptions { max_depth: Some(5.0), ..CamOptions::default() };
        let rough = alone.for_rough().unwrap();
        assert_eq!((rough.block(), rough.pitch, rough.allowance), (BLOCK, Some(4.0), Some(1.0)));
    }
}
