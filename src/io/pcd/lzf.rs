//! LZF, the compression of `binary_compressed`: runs of literal bytes and copies of what came before.
//!
//! A control byte c < 32 is followed by c + 1 literal bytes; else its upper three bits are a length
//! (7: the next byte adds to it), its lower five the high bits of a distance whose low byte follows.

/// The `n_bytes` that `packed` holds; `None` if it does not hold exactly so many.
pub(super) fn decompress(packed: &[u8], n_bytes: usize) -> Option<Vec<u8>> {
    // Three bytes give at most 264, so that a lying size is refused before it is allocated.
    if n_bytes / 88 > packed.len() {
        return None;
    }
    let mut bytes = Vec::with_capacity(n_bytes);
    let mut rest = packed.iter();
    while let Some(&control) = rest.next() {
        if control < 32 {
            let (run, after) = rest.as_slice().split_at_checked(usize::from(control) + 1)?;
            bytes.extend_from_slice(run);
            rest = after.iter();
        } else {
            let mut length = usize::from(control >> 5);
            if length == 7 {
                length += usize::from(*rest.next()?);
            }
            let distance = (usize::from(control & 31) << 8) + usize::from(*rest.next()?) + 1;
            let start = bytes.len().checked_sub(distance)?;
            // The copy may reach into what it is making.
            for i in start..start + length + 2 {
                bytes.push(bytes[i]);
            }
        }
        if bytes.len() > n_bytes {
            return None;
        }
    }
    (bytes.len() == n_bytes).then_some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_copy_may_overlap_itself() {
        assert_eq!(decompress(&[0, b'a', 0x60, 0], 6).as_deref(), Some(&b"aaaaaa"[..]));
    }

    #[test]
    fn damage_is_noticed() {
        assert_eq!(decompress(&[5, b'a'], 6), None, "the run is cut off");
        assert_eq!(decompress(&[0, b'a', 0x60, 1], 6), None, "copies from before the front");
        assert_eq!(decompress(&[0, b'a', 0xe0], 6), None, "the length is cut off");
        assert_eq!(decompress(&[0, b'a'], 2), None, "too few");
        assert_eq!(decompress(&[1, b'a', b'b'], 1), None, "too many");
        assert_eq!(decompress(&[0, b'a'], usize::MAX), None, "impossible");
    }
}
