//! What judges kernels in tests: naga, and the structs of the host beside those of the kernel.

use super::{Kernel, Precision};
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// Name and offset of each member of a struct, and its size.
pub(crate) type Shape = (Vec<(String, usize)>, usize);

/// Fails unless the kernel is valid, has one entry point, and needs `f64` only where it computes with it.
pub(crate) fn assert_valid(kernel: &Kernel) {
    let capabilities = match kernel.precision {
        Precision::Single => Capabilities::empty(),
        Precision::Double => Capabilities::FLOAT64,
    };
    let module = module(kernel);
    let mut validator = Validator::new(ValidationFlags::all(), capabilities);
    if let Err(error) = validator.validate(&module) {
        panic!("{}: {}", kernel.name, error.emit_to_string(&kernel.source()));
    }
    assert_eq!(module.entry_points.len(), 1, "{}", kernel.name);
}

/// How the struct `name` of the kernel lies in memory.
pub(crate) fn in_wgsl(kernel: &Kernel, name: &str) -> Shape {
    let module = module(kernel);
    let mut types = module.types.iter().map(|(_, found)| found);
    let found = types.find(|found| found.name.as_deref() == Some(name));
    let naga::TypeInner::Struct { members, span } = &found.expect(name).inner else {
        panic!("{name} is no struct")
    };
    let member = |member: &naga::StructMember| {
        (member.name.clone().unwrap_or_default(), member.offset as usize)
    };
    (members.iter().map(member).collect(), *span as usize)
}

/// How a struct of the host lies in memory.
macro_rules! in_rust {
    ($of:ty: $($member:ident),+) => {
        (
            vec![$((stringify!($member).to_owned(), std::mem::offset_of!($of, $member))),+],
            size_of::<$of>(),
        )
    };
}
pub(crate) use in_rust;

fn module(kernel: &Kernel) -> naga::Module {
    let source = kernel.source();
    naga::front::wgsl::parse_str(&source)
        .unwrap_or_else(|error| panic!("{}: {}", kernel.name, error.emit_to_string(&source)))
}
