//! Fewer points that say the same: growing neural gas.
//!
//! Morell (2014), chapter 3.

pub mod gng;
