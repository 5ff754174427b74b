//! The machines that come with horma, embedded, so that `-m last-lathe` works anywhere.

use super::{Machine, MachineError};
use crate::tool::nearest;

const TEXTS: [(&str, &str); 6] = [
    ("last-lathe", include_str!("../../machines/last-lathe.toml")),
    ("last-lathe-cone", include_str!("../../machines/last-lathe-cone.toml")),
    ("last-lathe-pair", include_str!("../../machines/last-lathe-pair.toml")),
    ("mill-rotary", include_str!("../../machines/mill-rotary.toml")),
    ("mill-3axis", include_str!("../../machines/mill-3axis.toml")),
    ("mill-5axis", include_str!("../../machines/mill-5axis.toml")),
];

impl Machine {
    /// The names of the embedded machines.
    pub fn builtin_names() -> impl Iterator<Item = &'static str> {
        TEXTS.iter().map(|(name, _)| *name)
    }

    /// The file of the embedded machine `name`, to be copied and changed.
    pub fn builtin_text(name: &str) -> Result<&'static str, MachineError> {
        let found = TEXTS.iter().find(|(own, _)| *own == name);
        found.map(|(_, text)| *text).ok_or_else(|| MachineError::Unknown {
            name: name.to_owned(),
            nearest: nearest(name, Self::builtin_names()).map(str::to_owned),
            known: Self::builtin_names().map(str::to_owned).collect(),
        })
    }

    /// The embedded machine `name`.
    pub fn builtin(name: &str) -> Result<Self, MachineError> {
        Self::parse(Self::builtin_text(name)?, &format!("machines/{name}.toml"))
    }
}
