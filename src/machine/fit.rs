//! Which tools go onto which machine.

use super::{Machine, MachineError, Mount};
use crate::tool::{Profile, Shape, Tool};

impl Mount {
    /// True if a cutter of this shape cuts when mounted so: wheels across, all others along the
    /// attack axis.
    pub fn takes(self, profile: &Profile) -> bool {
        (self == Self::Across) == (profile.shape() == Shape::Wheel)
    }
}

impl Machine {
    /// Refuses a tool that cannot be mounted.
    pub fn check_tool(&self, tool: &Tool) -> Result<(), MachineError> {
        if self.mount.takes(&tool.profile) {
            return Ok(());
        }
        Err(MachineError::Misfit { tool: tool.name.clone(), mount: self.mount })
    }
}
