//! A kernel: the text a device compiles, put together from parts.

/// A kernel, by the parts of its text; its entry point is `main`.
///
/// Parts may use `real`, the number type of this `precision`, and `WORKGROUP`, the threads of a
/// workgroup.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Kernel {
    /// What it is called by, in errors.
    pub name: &'static str,
    /// Texts of `kernels/`, in an order in which each is complete.
    pub parts: Vec<&'static str>,
    /// The numbers it computes with.
    pub precision: Precision,
    /// Threads of a workgroup.
    pub workgroup: u32,
}

/// The numbers a kernel computes with.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum Precision {
    /// 32 bits: what every device has.
    #[default]
    Single,
    /// 64 bits: some devices, slowly.
    Double,
}

impl Kernel {
    /// The whole text.
    pub fn source(&self) -> String {
        let real = match self.precision {
            Precision::Single => "f32",
            Precision::Double => "f64",
        };
        let mut text = format!("alias real = {real};\nconst WORKGROUP = {}u;\n\n", self.workgroup);
        for part in &self.parts {
            text.push_str(part);
            text.push('\n');
        }
        text
    }
}
