//! PNG pictures of colour, of depth and of confidence.

use crate::io::fault::{Fault, Place, ReadError};
use crate::rgbd::{Camera, Image};
use png::{BitDepth, ColorType, Transformations};
use std::fs::File;
use std::io::{BufReader, Write};
use std::path::Path;

/// Where in a picture something is wrong: all of it.
const PICTURE: Place = Place::Part("the picture");

/// Reads a picture of depth (or of disparity): 16 bits of grey a pixel, as the numbers it holds.
pub fn read_numbers(path: &Path) -> Result<Image<u16>, ReadError> {
    numbers(path).map_err(|fault| ReadError { path: path.into(), fault })
}

/// Reads a picture of depth with `per_metre` units to a metre, as mm.
pub fn read_depth(path: &Path, per_metre: f64) -> Result<Image<f32>, ReadError> {
    let read = || Ok(crate::rgbd::depth_from_numbers(&numbers(path)?, per_metre)?);
    read().map_err(|fault| ReadError { path: path.into(), fault })
}

/// Reads a picture of colours; grey ones are taken too, and what lets light through is not.
pub fn read_color(path: &Path) -> Result<Image<[u8; 3]>, ReadError> {
    color(path).map_err(|fault| ReadError { path: path.into(), fault })
}

/// Reads a picture of confidence: grey of 8 or 16 bits, white for 1.
pub(super) fn read_confidence(path: &Path) -> Result<Image<f32>, ReadError> {
    confidence(path).map_err(|fault| ReadError { path: path.into(), fault })
}

/// Writes 16 bits of grey a pixel.
pub(super) fn write_numbers(out: &mut dyn Write, image: &Image<u16>) -> std::io::Result<()> {
    let bytes: Vec<u8> = image.pixels().iter().flat_map(|n| n.to_be_bytes()).collect();
    encode(out, image, (ColorType::Grayscale, BitDepth::Sixteen), &bytes)
}

/// Writes three bytes a pixel.
pub(super) fn write_color(out: &mut dyn Write, image: &Image<[u8; 3]>) -> std::io::Result<()> {
    encode(out, image, (ColorType::Rgb, BitDepth::Eight), image.pixels().as_flattened())
}

fn encode<T>(
    out: &mut dyn Write,
    image: &Image<T>,
    (color, depth): (ColorType, BitDepth),
    bytes: &[u8],
) -> std::io::Result<()> {
    let mut encoder = png::Encoder::new(out, image.width() as u32, image.height() as u32);
    encoder.set_color(color);
    encoder.set_depth(depth);
    // A scan has hundreds of them: a third larger, several times as fast.
    encoder.set_compression(png::Compression::Fast);
    encoder.write_header()?.write_image_data(bytes)?;
    Ok(())
}

fn numbers(path: &Path) -> Result<Image<u16>, Fault> {
    let picture = Picture::decode(path, Transformations::IDENTITY)?;
    if (picture.color, picture.depth) != (ColorType::Grayscale, BitDepth::Sixteen) {
        let found = picture.kind();
        return Err(Fault::Malformed {
            place: PICTURE,
            problem: format!("it has {found}, but depth is grey of 16 bits a pixel"),
            remedy: "export depth as 16-bit grey PNG, or name the folder of the depth pictures",
        });
    }
    let pixels = picture.bytes.as_chunks().0.iter().map(|pair| u16::from_be_bytes(*pair));
    Ok(Image::new(picture.width, picture.height, pixels.collect())?)
}

fn color(path: &Path) -> Result<Image<[u8; 3]>, Fault> {
    let expand = Transformations::EXPAND | Transformations::STRIP_16;
    let picture = Picture::decode(path, expand)?;
    let grey = |pixel: &[u8]| [pixel[0]; 3];
    let rgb = |pixel: &[u8]| [pixel[0], pixel[1], pixel[2]];
    let bytes = &picture.bytes;
    let pixels: Vec<[u8; 3]> = match picture.color {
        ColorType::Grayscale => bytes.iter().map(|c| [*c; 3]).collect(),
        ColorType::GrayscaleAlpha => bytes.chunks_exact(2).map(grey).collect(),
        ColorType::Rgb => bytes.chunks_exact(3).map(rgb).collect(),
        ColorType::Rgba => bytes.chunks_exact(4).map(rgb).collect(),
        ColorType::Indexed => return Err(Fault::malformed(PICTURE, "it has no palette")),
    };
    Ok(Image::new(picture.width, picture.height, pixels)?)
}

fn confidence(path: &Path) -> Result<Image<f32>, Fault> {
    let picture = Picture::decode(path, Transformations::EXPAND)?;
    let bytes = &picture.bytes;
    let pixels = match (picture.color, picture.depth) {
        (ColorType::Grayscale, BitDepth::Sixteen) => {
            let pairs = bytes.as_chunks().0.iter();
            pairs.map(|pair| f32::from(u16::from_be_bytes(*pair)) / 65535.0).collect()
        }
        (ColorType::Grayscale, BitDepth::Eight) => {
            bytes.iter().map(|byte| f32::from(*byte) / 255.0).collect()
        }
        _ => {
            let problem = format!("it has {}, but confidence is grey", picture.kind());
            return Err(Fault::Malformed {
                place: PICTURE,
                problem,
                remedy: "export confidence as grey PNG",
            });
        }
    };
    Ok(Image::new(picture.width, picture.height, pixels)?)
}

/// A decoded picture.
struct Picture {
    width: usize,
    height: usize,
    color: ColorType,
    depth: BitDepth,
    bytes: Vec<u8>,
}

impl Picture {
    fn decode(path: &Path, transformations: Transformations) -> Result<Self, Fault> {
        let file = File::open(path)?;
        if file.metadata()?.len() == 0 {
            return Err(Fault::Empty);
        }
        let mut decoder = png::Decoder::new(BufReader::new(file));
        decoder.set_transformations(transformations);
        let mut reader = decoder.read_info().map_err(broken)?;
        let (width, height) = (reader.info().width as usize, reader.info().height as usize);
        // Before anything is allocated for it.
        if width.max(height) > Camera::LARGEST {
            let problem =
                format!("it is {width} x {height}, but no camera has more than 16384 a side");
            return Err(Fault::malformed(PICTURE, problem));
        }
        let size = reader.output_buffer_size();
        let size = size.ok_or_else(|| Fault::malformed(PICTURE, "it is too large"))?;
        let mut bytes = vec![0; size];
        let info = reader.next_frame(&mut bytes).map_err(broken)?;
        bytes.truncate(info.buffer_size());
        Ok(Self { width, height, color: info.color_type, depth: info.bit_depth, bytes })
    }

    /// "8-bit colour", "16-bit grey".
    fn kind(&self) -> String {
        let color = match self.color {
            ColorType::Grayscale => "grey",
            ColorType::GrayscaleAlpha => "grey with transparency",
            ColorType::Rgb => "colour",
            ColorType::Rgba => "colour with transparency",
            ColorType::Indexed => "colours of a palette",
        };
        format!("{} bits of {color}", self.depth as u8)
    }
}

fn broken(error: png::DecodingError) -> Fault {
    match error {
        png::DecodingError::IoError(error) if error.kind() != std::io::ErrorKind::UnexpectedEof => {
            Fault::System(error)
        }
        error => Fault::Malformed {
            place: PICTURE,
            problem: format!("it is no whole PNG file ({error})"),
            remedy: "copy or export it again",
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::{Overwrite, write_file};

    #[test]
    fn pictures_come_back_as_they_were_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let depth = Image::new(3, 2, vec![0, 1, 256, 5000, 65535, 7]).unwrap();
        write_file(&path, Overwrite::Refuse, |out| write_numbers(out, &depth)).unwrap();
        assert_eq!(read_numbers(&path).unwrap(), depth);
        assert_eq!(read_depth(&path, 5000.0).unwrap()[(0, 1)], 1000.0);
        assert!((read_confidence(&path).unwrap()[(1, 1)] - 1.0).abs() < 1e-6);
        let shade = read_color(&path).unwrap();
        assert_eq!((shade[(2, 0)], shade[(1, 1)]), ([1; 3], [255; 3]), "grey is taken for colour");
        let color = Image::new(2, 2, vec![[1, 2, 3], [255, 0, 9], [7; 3], [0; 3]]).unwrap();
        write_file(&path, Overwrite::Replace, |out| write_color(out, &color)).unwrap();
        assert_eq!(read_color(&path).unwrap(), color);
    }

    #[test]
    fn what_is_no_depth_is_told_by_what_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let told = || read_numbers(&path).unwrap_err().to_string();
        let color = Image::filled(2, 2, [9; 3]);
        write_file(&path, Overwrite::Refuse, |out| write_color(out, &color)).unwrap();
        assert!(
            told().contains("it has 8 bits of colour, but depth is grey of 16 bits"),
            "{}",
            told()
        );
        let whole = std::fs::read(&path).unwrap();
        std::fs::write(&path, &whole[..whole.len() - 20]).unwrap();
        assert!(told().contains("no whole PNG file"), "{}", told());
        std::fs::write(&path, "no picture").unwrap();
        assert!(told().contains("no whole PNG file"), "{}", told());
        std::fs::write(&path, "").unwrap();
        assert!(told().contains("the file is empty"), "{}", told());
        std::fs::remove_file(&path).unwrap();
        assert!(told().contains("check that the file is there"), "{}", told());
    }

    #[test]
    fn a_picture_of_absurd_size_is_refused_before_it_is_allocated() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let mut bytes = Vec::new();
        let mut writer = png::Encoder::new(&mut bytes, 1 << 20, 1 << 20).write_header().unwrap();
        writer.write_chunk(png::chunk::IDAT, &[0]).unwrap();
        drop(writer);
        std::fs::write(&path, bytes).unwrap();
        let told = read_numbers(&path).unwrap_err().to_string();
        assert!(told.contains("it is 1048576 x 1048576"), "{told}");
    }
}
