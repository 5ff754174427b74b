//! Pixels as a PNG file in memory.

use super::Raster;

/// The bytes of a PNG file of `raster`; an error if it has no pixels or not as many as its size
/// says.
pub fn encode_png(raster: &Raster) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, raster.width, raster.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(raster.pixels.as_flattened())?;
    Ok(bytes)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Size and pixels of a PNG file of three bytes per pixel.
    pub(in crate::io::report) fn decode_png(bytes: &[u8]) -> Raster {
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut data = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut data).unwrap();
        assert_eq!(info.color_type, png::ColorType::Rgb);
        let pixels = data.as_chunks().0.to_vec();
        Raster { width: info.width, height: info.height, pixels }
    }

    #[test]
    fn png_decodes_to_the_same_pixels() {
        let pixels = (0..35).map(|i| [i, 2 * i, 255 - i]).collect();
        let raster = Raster { width: 7, height: 5, pixels };
        assert_eq!(decode_png(&encode_png(&raster).unwrap()), raster);
    }

    #[test]
    fn raster_that_lies_about_its_size_is_refused() {
        let raster = Raster { width: 7, height: 5, pixels: vec![[0; 3]; 34] };
        assert!(encode_png(&raster).is_err());
        assert!(encode_png(&Raster { width: 0, height: 0, pixels: vec![] }).is_err());
    }
}
