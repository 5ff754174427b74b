//! Typed values out of a glTF buffer; an accessor that points outside it is refused.

use crate::io::fault::{Fault, Place};
use gltf::accessor::{DataType, Dimensions};

/// The rows of `accessor`, `N` numbers each; integers as they are, or, if normalized, from 0 to 1.
pub(super) fn rows<const N: usize>(
    accessor: &gltf::Accessor<'_>,
    buffers: &[Vec<u8>],
) -> Result<Vec<[f64; N]>, Fault> {
    let place = Place::Thing("accessor", accessor.index() as u64);
    let bad = |problem: String| Fault::malformed(place, problem);
    let n_wide = match accessor.dimensions() {
        Dimensions::Scalar => 1,
        Dimensions::Vec2 => 2,
        Dimensions::Vec3 => 3,
        Dimensions::Vec4 => 4,
        _ => 0,
    };
    if n_wide < N {
        return Err(bad(format!("{n_wide} numbers a row where {N} must be")));
    }
    if accessor.sparse().is_some() {
        return Err(Fault::Malformed {
            place,
            problem: "it is sparse, which horma does not read".into(),
            remedy: "export without morph targets",
        });
    }
    let Some(view) = accessor.view() else {
        return Err(bad("it has no buffer view".into()));
    };
    let buffer = &buffers[view.buffer().index()];
    let view_end = view.offset().checked_add(view.length());
    let data = view_end.and_then(|end| buffer.get(view.offset()..end)).ok_or_else(|| {
        let (offset, length, size) = (view.offset(), view.length(), buffer.len());
        bad(format!("its view of {length} bytes from {offset} lies outside a buffer of {size}"))
    })?;
    let size = accessor.data_type().size();
    let row_size = n_wide * size;
    let stride = view.stride().unwrap_or(row_size);
    let end = accessor
        .count()
        .checked_sub(1)
        .and_then(|n| n.checked_mul(stride)?.checked_add(accessor.offset())?.checked_add(row_size));
    if stride == 0
        || end.is_some_and(|end| end > data.len())
        || (end.is_none() && accessor.count() > 0)
    {
        let (count, offset, room) = (accessor.count(), accessor.offset(), data.len());
        return Err(bad(format!("{count} rows from byte {offset} lie outside a view of {room}")));
    }
    let number = |bytes: &[u8]| decode(accessor.data_type(), accessor.normalized(), bytes);
    Ok((0..accessor.count())
        .map(|i_row| accessor.offset() + i_row * stride)
        .map(|at| std::array::from_fn(|k| number(&data[at + k * size..at + (k + 1) * size])))
        .collect())
}

fn decode(kind: DataType, normalized: bool, bytes: &[u8]) -> f64 {
    let mut wide = [0; 4];
    wide[..bytes.len()].copy_from_slice(bytes);
    let bits = u32::from_le_bytes(wide);
    let (value, full) = match kind {
        DataType::I8 => (f64::from(bits as i8), 127.0),
        DataType::U8 => (f64::from(bits as u8), 255.0),
        DataType::I16 => (f64::from(bits as i16), 32_767.0),
        DataType::U16 => (f64::from(bits as u16), 65_535.0),
        DataType::U32 => (f64::from(bits), 1.0),
        DataType::F32 => (f64::from(f32::from_bits(bits)), 1.0),
    };
    if normalized { (value / full).max(-1.0) } else { value }
}
