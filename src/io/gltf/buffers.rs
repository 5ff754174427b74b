//! The bytes behind a glTF: in the file, in a `data:` address, or in a file beside it.

use crate::io::fault::{Fault, Place};
use base64::Engine;
use gltf::buffer::Source as Origin;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

/// All buffers of `document`; `bin` is the one in the file itself, `folder` where the file lies.
pub(super) fn load(
    document: &gltf::Document,
    mut bin: Option<Vec<u8>>,
    folder: &Path,
) -> Result<Vec<Vec<u8>>, Fault> {
    let load = |buffer: gltf::Buffer<'_>| {
        let place = Place::Thing("buffer", buffer.index() as u64);
        let mut bytes = match buffer.source() {
            Origin::Bin => bin.take().ok_or_else(|| {
                Fault::malformed(place, "it is said to be in the file, where it is not")
            })?,
            Origin::Uri(uri) => match uri.strip_prefix("data:") {
                Some(data) => decode(data, place)?,
                None => read_beside(uri, folder, buffer.length(), place)?,
            },
        };
        if bytes.len() < buffer.length() {
            let (claimed, n) = (buffer.length(), bytes.len());
            let problem = format!("{n} bytes where {claimed} are promised");
            return Err(Fault::malformed(place, problem));
        }
        bytes.truncate(buffer.length());
        Ok(bytes)
    };
    document.buffers().map(load).collect()
}

/// `[type][;base64],bytes`.
fn decode(data: &str, place: Place) -> Result<Vec<u8>, Fault> {
    let bad = |problem: &str| Fault::malformed(place, problem);
    let (kind, text) = data.split_once(',').ok_or_else(|| bad("its data: address has no comma"))?;
    if !kind.ends_with(";base64") {
        return Err(bad("its data: address is not base64"));
    }
    base64::engine::general_purpose::STANDARD
        .decode(text)
        .map_err(|error| Fault::malformed(place, format!("its data: address: {error}")))
}

/// At most the `length` bytes promised, of a file in the folder of the glTF or below it.
fn read_beside(uri: &str, folder: &Path, length: usize, place: Place) -> Result<Vec<u8>, Fault> {
    let path = PathBuf::from(percent_decoded(uri));
    if !path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir)) {
        return Err(Fault::Malformed {
            place,
            problem: format!("its address {uri:?} leaves the folder of the file"),
            remedy: "put the buffer beside the glTF, or export a GLB",
        });
    }
    let missing = |error: std::io::Error| Fault::Malformed {
        place,
        problem: format!("its file {}: {error}", path.display()),
        remedy: "put it beside the glTF, or export a GLB",
    };
    let file = std::fs::File::open(folder.join(&path)).map_err(missing)?;
    let mut bytes = Vec::new();
    file.take(length as u64).read_to_end(&mut bytes).map_err(missing)?;
    Ok(bytes)
}

/// With `%20` and its like turned into what they stand for.
fn percent_decoded(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&byte, after)) = rest.split_first() {
        let code = after.get(..2).filter(|_| byte == b'%');
        let code = code.and_then(|hex| u8::from_str_radix(std::str::from_utf8(hex).ok()?, 16).ok());
        bytes.push(code.unwrap_or(byte));
        rest = if code.is_some() { &after[2..] } else { after };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_decoded() {
        assert_eq!(percent_decoded("left%20foot%2ebin"), "left foot.bin");
        assert_eq!(percent_decoded("50%.bin%"), "50%.bin%");
    }

    #[test]
    fn a_buffer_outside_the_folder_is_refused() {
        for uri in ["../secret.bin", "/etc/passwd", "a/../../b"] {
            let error = read_beside(uri, Path::new("."), 9, Place::Thing("buffer", 0)).unwrap_err();
            assert!(error.to_string().contains("leaves the folder"), "{error}");
        }
    }
}
