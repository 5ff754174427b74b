//! An angle that is radians inside and degrees in files: `#[serde(with = "degrees")]`.

use serde::{Deserialize, Deserializer, Serializer};

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
pub(super) fn serialize<S: Serializer>(radians: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_f64(of(*radians))
}

pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    f64::deserialize(deserializer).map(f64::to_radians)
}

/// Degrees of an angle for people: 15 stays 15, not 14.999999999999998.
pub(super) fn of(radians: f64) -> f64 {
    (radians.to_degrees() * 1e9).round() / 1e9
}
